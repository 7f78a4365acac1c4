# SPDX-License-Identifier: MIT
"""`--instances shared`: triangles transformed when they are read. The bits of copied ones, a tenth of the memory."""

import filecmp

import numpy as np
import pytest

from glb import Glb

SIDE, COPIES = 100, 25  # a sheet of 20,000 triangles


def both(sheaf, scene, *options, **how):
    calls = ({"scene": scene, "options": (*options, "--instances", way), **how} for way in ("copied", "shared"))
    return sheaf.all(calls)


@pytest.mark.parametrize(
    ("strategy", "primary"),
    [("bvh", "raster"), ("hybrid", "trace"), ("crsh", "trace"), ("frustum", "raster"), ("classify", "trace")],
)
@pytest.mark.parametrize("scene", ["instanced", "whitted", "hierarchy", "negative_scale", "alpha_mask"])
def test_same_bytes_as_copied(sheaf, scene, strategy, primary):
    """Rigid, skinned, morphed and mirrored; materials that are asked; frames in which things move."""
    options = ("--frames", "1-2", "--primary", primary, "--aov", "all", "--depth", 3)
    copied, shared = both(sheaf, scene, *options, strategy=strategy)
    assert copied.files.keys() == shared.files.keys()
    for number, path in copied.files.items():
        assert path.read_bytes() == shared.files[number].read_bytes()


def test_same_dump_as_copied(sheaf):
    folders = []
    for way in ("copied", "shared"):
        folders.append(sheaf.new_folder())
        sheaf.render("whitted", "--instances", way, "--dump", folders[-1], "--frames", 1)
    names = sorted(path.name for path in folders[0].iterdir())
    assert any("triangles" in name for name in names)
    assert filecmp.cmpfiles(folders[0], folders[1], names, shallow=False) == (names, [], [])


def sheets() -> bytes:
    glb = Glb()
    x, y = np.meshgrid(np.linspace(-1, 1, SIDE + 1), np.linspace(-1, 1, SIDE + 1))
    points = np.stack([x, y, 0.1 * np.sin(5 * x)], axis=-1).reshape(-1, 3)
    corner = (np.arange(SIDE)[:, None] * (SIDE + 1) + np.arange(SIDE)).reshape(-1, 1)
    triangles = np.concatenate([corner + np.array(offsets) for offsets in ((0, 1, SIDE + 2), (0, SIDE + 2, SIDE + 1))])
    sheet = glb.mesh(
        {"attributes": {"POSITION": glb.attribute(points, bounds=True)}, "indices": glb.indices(triangles)}
    )
    places = [(2.5 * (n % 5), 2.5 * (n // 5), -20) for n in range(COPIES)]
    extension = glb.uses("EXT_mesh_gpu_instancing", required=True)
    attributes = {"TRANSLATION": glb.accessor(np.asarray(places))}
    glb.scene([glb.node("sheets", mesh=sheet, extensions={extension: {"attributes": attributes}})])
    return glb.bytes()


def test_shared_ones_cost_a_word_a_triangle(sheaf):
    """In place of ten words."""
    scene = sheaf.new_folder().with_suffix(".glb")
    scene.write_bytes(sheets())
    copied, shared = (run.stats() for run in both(sheaf, scene, stats=True))
    assert copied["scene"]["triangles"] == COPIES * 2 * SIDE**2
    saved = (copied["totals"]["peak_device_mib"] - shared["totals"]["peak_device_mib"]) * 2**20
    assert saved == pytest.approx(36 * COPIES * 2 * SIDE**2, rel=0.01)
    assert "triangles in world space" in {left["stage"] for left in shared["left_out"]}
    assert "triangles in world space" not in {left["stage"] for left in copied["left_out"]}
