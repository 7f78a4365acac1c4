# SPDX-License-Identifier: MIT
"""Camera paths: what helpers make, and what is refused."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sheaf import CameraKey, CameraPath


def test_turntable_stays_on_its_circle_and_closes() -> None:
    path = CameraPath.turntable((1, 2, 3), radius=4, height=0.5, seconds=2, fps=12, fov_degrees=30)
    eyes = np.array([key.eye for key in path.keys])
    assert len(eyes) == 25
    np.testing.assert_allclose(np.hypot(eyes[:, 0] - 1, eyes[:, 2] - 3), 4, rtol=1e-12)
    assert set(eyes[:, 1]) == {2.5}
    np.testing.assert_allclose(eyes[0], (1, 2.5, 7))
    np.testing.assert_allclose(eyes[6], (5, 2.5, 3), atol=1e-12)  # a quarter on: counterclockwise from above
    np.testing.assert_allclose(eyes[-1], eyes[0], atol=1e-12)
    assert [key.time for key in path.keys] == [frame / 12 for frame in range(25)]
    assert {key.target for key in path.keys} == {(1.0, 2.0, 3.0)}
    assert path.fps == 12


def test_turntable_backwards_by_a_half() -> None:
    path = CameraPath.turntable((0, 0, 0), 1, revolutions=-0.5, seconds=1, fps=2, start_degrees=90)
    np.testing.assert_allclose(np.array([key.eye for key in path.keys]), [(1, 0, 0), (0, 0, 1), (-1, 0, 0)], atol=1e-12)


@pytest.mark.parametrize(
    "wrong", [{"radius": 0}, {"radius": math.inf}, {"seconds": -1}, {"fps": math.nan}, {"fov_degrees": 180}]
)
def test_turntable_refuses(wrong: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=next(iter(wrong))):
        CameraPath.turntable(**{"center": (0, 0, 0), "radius": 1, **wrong})


def test_the_file_is_as_the_format_says(tmp_path: Path) -> None:
    path = CameraPath.look_at_keys(
        [(0, (0, 0, 5), (0, 0, 0)), (1.5, (5, 0, 0), (0, 1, 0))], fps="24000/1001", loop=True
    )
    file = tmp_path / "path.json"
    path.save(file)
    up = [0.0, 1.0, 0.0]
    assert json.loads(file.read_text()) == {
        "version": 1,
        "fps": "24000/1001",
        "interpolation": "catmull-rom",
        "loop": True,
        "fov_axis": "vertical",
        "keys": [
            {"time": 0.0, "eye": [0.0, 0.0, 5.0], "target": [0.0, 0.0, 0.0], "up": up, "fov_degrees": 45.0},
            {"time": 1.5, "eye": [5.0, 0.0, 0.0], "target": [0.0, 1.0, 0.0], "up": up, "fov_degrees": 45.0},
        ],
    }
    assert CameraPath.load(file) == path
    assert list(tmp_path.iterdir()) == [file]


def test_every_form_of_key_goes_there_and_back() -> None:
    keys = [
        CameraKey(0, position=(0, 1, 2), rotation=(0, 0, 0, 1), focal_mm=35, sensor_mm=(36, 24), near=0.1, far=100),
        CameraKey(1, matrix=np.eye(4).ravel().tolist(), ortho_height=2),
        CameraKey(2, eye=np.array([0, 0, 1]), target=(0, 0, 0)),  # type: ignore[arg-type]
    ]
    path = CameraPath(keys, interpolation="step", fov_axis="horizontal")
    assert CameraPath.from_dict(path.to_dict()) == path
    assert "fps" not in path.to_dict()


@pytest.mark.parametrize(
    ("key", "reason"),
    [
        ({}, "needs position and rotation"),
        ({"position": (0, 0, 0)}, "needs position and rotation"),
        ({"eye": (0, 0, 0), "target": (1, 0, 0), "matrix": (1.0,) * 16}, "needs position and rotation"),
        ({"eye": (0, 0, 0), "target": (0, 0, 0)}, "no direction"),
        ({"eye": (0, 0, 0), "target": (0, 3, 0)}, "no direction"),
        ({"eye": (0, 0), "target": (0, 3, 0)}, "eye: 3 numbers"),
        ({"eye": (0, 0, math.nan), "target": (0, 3, 0)}, "eye: not finite"),
        ({"eye": "abc", "target": (0, 3, 0)}, "eye: 3 numbers"),
        ({"eye": 5, "target": (0, 3, 0)}, "eye: 3 numbers"),
        ({"position": (0, 0, 0), "rotation": (0, 0, 0, 0)}, "quaternion is zero"),
        ({"matrix": (1.0,) * 16, "up": (0, 1, 0)}, "up goes with"),
        ({"matrix": (1.0,) * 16, "fov_degrees": 45, "ortho_height": 1}, "one lens"),
        ({"matrix": (1.0,) * 16, "fov_degrees": 0}, "between 0 and 180"),
        ({"matrix": (1.0,) * 16, "focal_mm": 35}, "go together"),
        ({"matrix": (1.0,) * 16, "focal_mm": 35, "sensor_mm": (36, 0)}, r"sensor_mm\[1\] must be positive"),
        ({"matrix": (1.0,) * 16, "ortho_height": -1}, "must be positive"),
        ({"matrix": (1.0,) * 16, "near": -1}, "near"),
        ({"matrix": (1.0,) * 16, "near": 2, "far": 1}, "beyond near"),
        ({"matrix": (1.0,) * 16, "time": "soon"}, "time: not a number"),
    ],
)
def test_impossible_keys(key: dict[str, Any], reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        CameraKey(**{"time": 0, **key})


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"version": 2}, "version"),
        ({"frames": 5}, "frames: not known"),
        ({"keys": None}, "keys: missing"),
        ({"keys": []}, "a camera path needs at least one key"),
        ({"keys": [5]}, r"keys\[0\]: not an object"),
        ({"keys": [{"time": 0, "fov": 5}]}, r"keys\[0\]\.fov: not known"),
        ({"keys": [{"matrix": [1] * 16}]}, r"keys\[0\]\.time: missing"),
        ({"keys": [{"time": 0, "matrix": [1] * 15}]}, r"keys\[0\]: matrix: 16 numbers"),
        ({"keys": [{"time": 1, "matrix": [1] * 16}, {"time": 1, "matrix": [1] * 16}]}, r"keys\[1\]: its time"),
        ({"interpolation": "bezier"}, "interpolation is one of"),
        ({"fov_axis": "diagonal"}, "fov_axis"),
        ({"fps": 0}, "fps must be positive"),
    ],
)
def test_wrong_documents_name_file_and_place(tmp_path: Path, change: dict[str, Any], reason: str) -> None:
    file = tmp_path / "bad.json"
    file.write_text(json.dumps({"version": 1, "keys": [{"time": 0, "matrix": [1] * 16}], **change}))
    with pytest.raises(ValueError, match=rf"bad\.json: {reason}"):
        CameraPath.load(file)


@pytest.mark.parametrize("text", ["", "[]", "{"])
def test_what_is_no_document(tmp_path: Path, text: str) -> None:
    (tmp_path / "bad.json").write_text(text)
    with pytest.raises(ValueError, match=r"bad\.json"):
        CameraPath.load(tmp_path / "bad.json")


def test_a_failed_save_leaves_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "path.json"
    file.write_text("old")

    def full(*_: Any) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "replace", full)
    with pytest.raises(OSError, match="No space"):
        CameraPath.turntable((0, 0, 0), 1).save(file)
    assert file.read_text() == "old"
    assert list(tmp_path.iterdir()) == [file]
