# SPDX-License-Identifier: MIT
"""The same bytes from every strategy, on every committed scene; and what may differ at edges when camera rays are
traced instead of rasterised."""

import json

import numpy as np
import pytest
from rendering import SCENE_NAMES, Sheaf

STRATEGIES = {"bvh": (), "hybrid": (), "hybrid sorted": ("--sort", "on"), "hybrid unsorted": ("--sort", "off"), "crsh": (),
              "rsh": (), "frustum": (), "frustum unsorted": ("--sort", "off"), "classify": (), "brute": (),
              "rayquery": ()}
FRAME = 29  # of an animated scene, one in the middle
OPTIONS = ("--frames", FRAME, "--aov", "id")


@pytest.fixture(scope="module")
def strategies(sheaf_once) -> dict:
    """Those that this device has."""
    run = sheaf_once("devices", "--json")
    has_ray_query = json.loads(run.stdout)[0]["ray_query"]
    return {name: options for name, options in STRATEGIES.items() if has_ray_query or name != "rayquery"}


def render_all(sheaf: Sheaf, scene: str, strategies: dict, *more: object, size="64x36") -> dict:
    calls = [{"scene": scene, "options": (*OPTIONS, *options, *more), "strategy": name.split()[0], "size": size}
             for name, options in strategies.items()]
    return {name: run.frame(FRAME) for name, run in zip(strategies, sheaf.all(calls))}


@pytest.mark.parametrize("scene", SCENE_NAMES)
def test_every_strategy_gives_the_same_pixels(sheaf, strategies, scene):
    pictures = render_all(sheaf, scene, strategies)
    first = pictures["bvh"]
    for name, picture in pictures.items():
        assert picture.channels.keys() == first.channels.keys()
        for channel, values in picture.channels.items():
            differs = np.argwhere(values.view(np.uint8) != first.channels[channel].view(np.uint8))
            assert not len(differs), f"{name} against bvh: {channel} at (row, byte) {differs[0]} and {len(differs)} more"
    if scene not in ("empty", "no_triangles"):
        assert len(np.unique(first.rgba.reshape(-1, 4), axis=0)) > 1 or scene in ("slab", "prism")


@pytest.mark.parametrize("scene", ["whitted", "cornell"])
def test_deeper_finer_and_more_samples(sheaf, strategies, scene):
    """Two samples a pixel, eight generations, every ray followed: long lists, deep media."""
    names = ("bvh", "hybrid", "hybrid sorted", "hybrid unsorted", "crsh", "frustum", "classify")
    few = {name: strategies[name] for name in names}
    pictures = render_all(sheaf, scene, few, "--spp", 2, "--depth", 8, "--cutoff", 0, size="50x31")
    for name, picture in pictures.items():
        assert np.array_equal(picture.rgba.view(np.uint16), pictures["bvh"].rgba.view(np.uint16)), name


@pytest.mark.parametrize("scene", ["whitted", "cornell"])
def test_vectors_of_any_width_give_the_same_pixels(sheaf, sheaf_once, scene):
    """Bundles of 64 rays are 16 vectors of four lanes on a CPU without AVX, and few of many lanes on a GPU."""
    if json.loads(sheaf_once("devices", "--json").stdout)[0]["kind"] != "cpu":
        pytest.skip("the width of a GPU's vectors cannot be chosen")
    names = ("bvh", "hybrid", "crsh", "frustum", "classify")
    cases = [(name, bits) for name in names for bits in (256, 128, 512)]
    calls = [{"scene": scene, "options": (*OPTIONS, "--depth", 3), "strategy": name, "size": "160x90",
              "env": {"LP_NATIVE_VECTOR_WIDTH": str(bits), "LP_NUM_THREADS": "1"}} for name, bits in cases]
    pictures = [run.frame(FRAME).rgba.view(np.uint16) for run in sheaf.all(calls)]
    for (name, bits), picture in zip(cases, pictures):
        differ = int((picture != pictures[0]).any(-1).sum())
        assert differ == 0, f"{name}, {bits} bits: {differ} pixels"


def beside_an_edge(ids: np.ndarray) -> np.ndarray:
    """Pixels with another id among their eight neighbours."""
    padded = np.pad(ids, 1, mode="edge")
    height, width = ids.shape
    shifted = [padded[dy : dy + height, dx : dx + width] for dy in range(3) for dx in range(3)]
    return np.any([other != ids for other in shifted], axis=0)


@pytest.mark.parametrize("scene", ["whitted", "cornell", "still_life", "interpolation", "skin", "cameras"])
def test_traced_camera_rays_agree_but_at_edges(sheaf, scene):
    """The rasteriser snaps corners to a fraction of a pixel: a sample that close to an edge may name the neighbour."""
    runs = sheaf.all({"scene": scene, "options": ("--primary", way, "--aov", "id,N", "--frames", 7), "size": "96x54"}
                     for way in ("raster", "trace"))
    raster, trace = (run.frame(7) for run in runs)
    ids = raster.channels["id.object"]
    other = raster.channels["id.object"] != trace.channels["id.object"]
    assert not (other & ~beside_an_edge(ids)).any()
    differs = (raster.rgba.view(np.uint16) != trace.rgba.view(np.uint16)).any(-1)
    assert differs.mean() < 0.02
    # A sample beside an inner edge may also take the neighbouring triangle of the same object: but for creases no visible step.
    bends = [np.abs(raster.channels[f"N.{axis}"] - trace.channels[f"N.{axis}"]) for axis in "XYZ"]
    within = differs & ~other & (np.max(bends, axis=0) < 0.01)
    np.testing.assert_allclose(raster.rgb[within], trace.rgb[within], rtol=0.02, atol=0.002)
