# SPDX-License-Identifier: MIT
"""First hits by raster against those of traced camera rays: the same bytes where triangles' spans are tested (CPU
devices), and all but edges where the graphics pipeline draws."""

import numpy as np
import pytest

from glb import Glb
from rendering import SCENE_NAMES
from shapes import Shape

SPANS = {"SHEAF_RASTER": "spans"}


def both_ways(sheaf, scene, *options, size="64x36", env=SPANS) -> list:
    return sheaf.all(
        {"scene": scene, "options": ("--primary", way, "--aov", "id,Z", *options), "size": size, "env": env}
        for way in ("raster", "trace")
    )


def same_bytes(runs, frame: int) -> None:
    raster, trace = (run.frame(frame) for run in runs)
    for channel, values in trace.channels.items():
        differs = np.argwhere(values.view(np.uint8) != raster.channels[channel].view(np.uint8))
        assert not len(differs), f"{channel} at (row, byte) {differs[0]} and {len(differs)} more"


@pytest.mark.parametrize("scene", SCENE_NAMES)
def test_spans_show_what_traced_rays_see(sheaf, scene):
    same_bytes(both_ways(sheaf, scene, "--frames", 7), 7)


def test_spans_of_samples_and_tiles(sheaf):
    """Places other than pixels' centres, and a picture of several tiles."""
    same_bytes(both_ways(sheaf, "whitted", "--spp", 3, "--memory", 16, "--frames", 7, size="333x187"), 7)


def soup(lens, seed: int) -> bytes:
    """Triangles of a millimetre to a kilometre round the eye: beside it, behind it, seen edge on, needles, specks."""
    rng = np.random.default_rng(seed)
    count = 3000
    middle = rng.normal(size=(count, 1, 3)) * 10 ** rng.uniform(-1, 3, (count, 1, 1))
    corners = middle + rng.normal(size=(count, 3, 3)) * 10 ** rng.uniform(-3, 3, (count, 1, 1))
    needles = rng.random(count) < 0.2
    corners[needles, 2] = corners[needles, 1] + rng.normal(size=(needles.sum(), 3)) * 1e-5
    edge_on = rng.random(count) < 0.1
    corners[edge_on, 2] = corners[edge_on, 0] * 0.3 + corners[edge_on, 1] * 0.6  # in a plane with the eye
    small = np.abs(corners).max((1, 2)) < 30
    corners = np.concatenate([corners[small], corners[~small][:60]])  # few large ones, that some small ones be seen
    glb = Glb()
    shape = Shape(corners.reshape(-1, 3).astype(np.float32), np.arange(corners.shape[0] * 3).reshape(-1, 3))
    nodes = [
        glb.node(
            f"part {k}",
            mesh=glb.mesh(
                glb.primitive(
                    Shape(shape.positions, shape.triangles[k::4]), glb.unlit(f"colour {k}", (0.2 * k, 1 - 0.2 * k, 0.5))
                )
            ),
        )
        for k in range(4)
    ]
    glb.scene([*nodes, glb.node("camera", (0, 0, 0), camera=glb.add("cameras", lens))], "soup")
    return glb.bytes()


LENSES = {
    "wide": {"type": "perspective", "perspective": {"yfov": 2.0, "znear": 1e-3}},
    "telephoto": {"type": "perspective", "perspective": {"yfov": 1e-4, "znear": 1e-3}},
    "near and far": {"type": "perspective", "perspective": {"yfov": 1.0, "znear": 2.0, "zfar": 9.0}},
    "orthographic": {"type": "orthographic", "orthographic": {"xmag": 16, "ymag": 9, "znear": 0.5, "zfar": 50}},
    "orthographic speck": {
        "type": "orthographic",
        "orthographic": {"xmag": 1.6e-3, "ymag": 9e-4, "znear": 0, "zfar": 1e4},
    },
}


@pytest.mark.parametrize("lens", LENSES)
def test_spans_of_a_soup(sheaf, tmp_path, lens):
    for seed in range(3):
        path = tmp_path / f"soup{seed}.glb"
        path.write_bytes(soup(LENSES[lens], seed))
        runs = both_ways(sheaf, path, "--depth", 0, size="160x90")
        same_bytes(runs, 0)
        seen = len(np.unique(runs[0].frame(0).channels["Z"]))
        assert seen > 20, "nothing to see"


def beside_an_edge(ids: np.ndarray) -> np.ndarray:
    """Pixels with another id among their eight neighbours."""
    padded = np.pad(ids, 1, mode="edge")
    height, width = ids.shape
    shifted = [padded[dy : dy + height, dx : dx + width] for dy in range(3) for dx in range(3)]
    return np.any([other != ids for other in shifted], axis=0)


@pytest.mark.parametrize("scene", ["whitted", "cornell", "still_life", "interpolation", "skin", "cameras"])
def test_the_pipeline_and_traced_rays_agree_but_at_edges(sheaf, scene):
    """A device's own rasteriser snaps corners to a fraction of a pixel: samples near an edge may name the neighbour."""
    runs = sheaf.all(
        {
            "scene": scene,
            "options": ("--primary", way, "--aov", "id,N", "--frames", 7),
            "size": "96x54",
            "env": {"SHEAF_RASTER": "pipeline"},
        }
        for way in ("raster", "trace")
    )
    raster, trace = (run.frame(7) for run in runs)
    ids = raster.channels["id.object"]
    other = raster.channels["id.object"] != trace.channels["id.object"]
    assert not (other & ~beside_an_edge(ids)).any()
    differs = (raster.rgba.view(np.uint16) != trace.rgba.view(np.uint16)).any(-1)
    assert differs.mean() < 0.02
    # A sample beside an inner edge may also take the neighbouring triangle of the same object: no visible step but at
    # creases.
    bends = [np.abs(raster.channels[f"N.{axis}"] - trace.channels[f"N.{axis}"]) for axis in "XYZ"]
    within = differs & ~other & (np.max(bends, axis=0) < 0.01)
    np.testing.assert_allclose(raster.rgb[within], trace.rgb[within], rtol=0.02, atol=0.002)
