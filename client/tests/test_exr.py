# SPDX-License-Identifier: MIT
"""EXR layers against the arrays they were made of."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import sheaf
from conftest import colour, exr_bytes
from sheaf._exr import group_layers

RANDOM = np.random.default_rng(7)


def test_every_layer_comes_back_exactly(tmp_path: Path) -> None:
    floats = {
        name: RANDOM.normal(size=(5, 9)).astype(np.float32) for name in ("Z", "N.X", "N.Y", "N.Z", "UV.X", "UV.Y")
    }
    ids = {
        "id.object": np.full((5, 9), 4_000_000_001, np.uint32),
        "id.material": np.arange(45, dtype=np.uint32).reshape(5, 9),
    }
    albedo = {f"albedo.{c}": RANDOM.random((5, 9)).astype(np.float16) for c in "RGB"}
    channels = colour(5, 9) | floats | ids | albedo
    frame = sheaf.read_exr(exr_bytes(tmp_path, channels))

    assert set(frame.layers) == {"RGBA", "Z", "N", "UV", "id.object", "id.material", "albedo"}
    np.testing.assert_array_equal(frame.rgba, np.stack([channels[c].astype(np.float32) for c in "RGBA"], -1))
    assert frame.rgba.dtype == np.float32
    np.testing.assert_array_equal(frame.layers["Z"], channels["Z"])
    np.testing.assert_array_equal(frame.layers["N"], np.stack([channels[f"N.{c}"] for c in "XYZ"], -1))
    np.testing.assert_array_equal(frame.layers["UV"], np.stack([channels[f"UV.{c}"] for c in "XY"], -1))
    np.testing.assert_array_equal(frame.layers["albedo"][..., 1], channels["albedo.G"].astype(np.float32))
    for name, pixels in ids.items():
        assert frame.layers[name].dtype == np.uint32
        np.testing.assert_array_equal(frame.layers[name], pixels)
    assert frame.size == (9, 5)


def test_rows_run_from_the_top_and_infinities_survive(tmp_path: Path) -> None:
    depth = np.array([[1.0, np.inf], [2.0, 3.0]], np.float32)
    frame = sheaf.read_exr(exr_bytes(tmp_path, colour(2, 2) | {"Z": depth}))
    np.testing.assert_array_equal(frame.layers["Z"], depth)


def test_attributes_and_number(tmp_path: Path) -> None:
    matrix = np.arange(16, dtype=np.float32).reshape(4, 4)
    attributes = {"worldToCamera": matrix, "sheaf:strategy": "hybrid", "sheaf:frame": 12}
    data = exr_bytes(tmp_path, colour(2, 2), **attributes)
    frame = sheaf.read_exr(data)
    assert frame.number == 12
    assert frame.attributes["sheaf:strategy"] == "hybrid"
    np.testing.assert_array_equal(frame.attributes["worldToCamera"], matrix)
    assert "channels" not in frame.attributes
    assert sheaf.read_exr(data, 7).number == 7
    assert repr(frame) == "Frame(12, 2x2, RGBA)"


def test_path_and_bytes_give_the_same(tmp_path: Path) -> None:
    data = exr_bytes(tmp_path, colour(3, 2))
    path = tmp_path / "a.exr"
    path.write_bytes(data)
    np.testing.assert_array_equal(sheaf.read_exr(path).rgba, sheaf.read_exr(data).rgba)
    np.testing.assert_array_equal(sheaf.read_exr(str(path)).rgba, sheaf.read_exr(data).rgba)


def test_groups_only_what_belongs_together() -> None:
    one = np.zeros((1, 1), np.float32)
    names = [
        "R",
        "G",
        "B",
        "tests",
        "crypto00.r",
        "crypto00.g",
        "crypto00.b",
        "crypto00.a",
        "odd.X",
        "odd.Q",
        "a.x",
        "a.X",
    ]
    layers = group_layers(dict.fromkeys(names, one))
    assert {name: array.shape for name, array in layers.items()} == {
        "RGB": (1, 1, 3),
        "tests": (1, 1),
        "crypto00": (1, 1, 4),
        "odd.X": (1, 1),
        "odd.Q": (1, 1),
        "a.x": (1, 1),
        "a.X": (1, 1),
    }


@pytest.mark.parametrize("data", [b"", b"junk" * 100, b"\x76\x2f\x31\x01", b"\x89PNG\r\n\x1a\n"])
def test_what_is_no_exr_is_refused(data: bytes) -> None:
    with pytest.raises(sheaf.FrameError):
        sheaf.read_exr(data)


def test_a_truncated_file_is_refused_wherever_it_is_cut(tmp_path: Path) -> None:
    data = exr_bytes(tmp_path, colour(40, 30))
    for length in (len(data) - 1, len(data) - 200, len(data) // 2, 300):
        with pytest.raises(sheaf.FrameError):
            sheaf.read_exr(data[:length])


def test_a_missing_file_is_the_systems_error(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        sheaf.read_exr(tmp_path / "absent.exr")
