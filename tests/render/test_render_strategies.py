# SPDX-License-Identifier: MIT
"""The same bytes from every strategy, on every committed scene."""

import json

import numpy as np
import pytest

from rendering import SCENE_NAMES, Sheaf

STRATEGIES = {
    "bvh": (),
    "hybrid": (),
    "hybrid sorted": ("--sort", "on"),
    "hybrid unsorted": ("--sort", "off"),
    "crsh": (),
    "rsh": (),
    "frustum": (),
    "frustum unsorted": ("--sort", "off"),
    "classify": (),
    "brute": (),
    "rayquery": (),
}
FRAME = 29  # of an animated scene, one in the middle
OPTIONS = ("--frames", FRAME, "--aov", "id")


@pytest.fixture(scope="module")
def strategies(sheaf_once) -> dict:
    """Those that this device has."""
    run = sheaf_once("devices", "--json")
    has_ray_query = json.loads(run.stdout)[0]["ray_query"]
    return {name: options for name, options in STRATEGIES.items() if has_ray_query or name != "rayquery"}


def render_all(sheaf: Sheaf, scene: str, strategies: dict, *more: object, size="64x36") -> dict:
    calls = [
        {"scene": scene, "options": (*OPTIONS, *options, *more), "strategy": name.split()[0], "size": size}
        for name, options in strategies.items()
    ]
    return {name: run.frame(FRAME) for name, run in zip(strategies, sheaf.all(calls), strict=True)}


@pytest.mark.parametrize("scene", SCENE_NAMES)
def test_every_strategy_gives_the_same_pixels(sheaf, strategies, scene):
    pictures = render_all(sheaf, scene, strategies)
    first = pictures["bvh"]
    for name, picture in pictures.items():
        assert picture.channels.keys() == first.channels.keys()
        for channel, values in picture.channels.items():
            differs = np.argwhere(values.view(np.uint8) != first.channels[channel].view(np.uint8))
            assert not len(differs), (
                f"{name} against bvh: {channel} at (row, byte) {differs[0]} and {len(differs)} more"
            )
    if scene not in ("empty", "no_triangles"):
        assert len(np.unique(first.rgba.reshape(-1, 4), axis=0)) > 1 or scene in ("slab", "prism")


@pytest.mark.parametrize("scene", ["whitted", "cornell"])
def test_deeper_finer_and_more_samples(sheaf, strategies, scene):
    """Two samples per pixel, eight generations, every ray followed: long lists, deep media."""
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
    calls = [
        {
            "scene": scene,
            "options": (*OPTIONS, "--depth", 3),
            "strategy": name,
            "size": "160x90",
            "env": {"LP_NATIVE_VECTOR_WIDTH": str(bits), "LP_NUM_THREADS": "1"},
        }
        for name, bits in cases
    ]
    pictures = [run.frame(FRAME).rgba.view(np.uint16) for run in sheaf.all(calls)]
    for (name, bits), picture in zip(cases, pictures, strict=True):
        differ = int((picture != pictures[0]).any(-1).sum())
        assert differ == 0, f"{name}, {bits} bits: {differ} pixels"


@pytest.mark.parametrize("bits", [128, 256, 512])
def test_a_width_that_was_asked_for_is_kept(sheaf_once, bits):
    run = sheaf_once("devices", "--json", env={"LP_NATIVE_VECTOR_WIDTH": str(bits)})
    first = json.loads(run.stdout)[0]
    assert first["kind"] != "cpu" or first["subgroup"] == bits // 32
