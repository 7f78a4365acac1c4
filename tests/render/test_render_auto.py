# SPDX-License-Identifier: MIT
"""`--strategy auto`: short runs do no more than `bvh` does, longer ones change hands without a trace in the pixels."""

from __future__ import annotations

import numpy as np
import pytest

# Kernels that cost nothing are worth making at once, and are waited for: what a run does then is the same each time.
FREE = {"SHEAF_AUTO_PRICE": "0"}
DEAR = {"SHEAF_AUTO_PRICE": "1e9"}


def same(a, b):
    return a.channels.keys() == b.channels.keys() and all(
        np.array_equal(a.channels[c].view(np.uint32), b.channels[c].view(np.uint32)) for c in a.channels
    )


def both(sheaf, scene, *options, env=None, size="96x54", fixed="bvh"):
    """The run by `auto` and by a fixed strategy."""
    return sheaf.all(
        {"scene": scene, "options": options, "size": size, "strategy": strategy, "stats": True, "env": env}
        for strategy in ("auto", fixed)
    )


@pytest.mark.parametrize(
    ("scene", "options", "size"),
    [
        ("cornell", ("--frames", "0"), "96x54"),
        ("whitted", ("--frames", "0-1"), "320x180"),
        ("nested_glass", ("--frames", "0", "--spp", "4"), "96x54"),
        ("whitted", ("--frames", "3"), "640x360"),
    ],
)
def test_short_runs_do_what_bvh_does(sheaf, scene, options, size):
    """No pixel twice, no kernel more, no byte more on the device."""
    auto, fixed = both(sheaf, scene, *options, size=size)
    for a, b in zip(auto.stats()["frames"], fixed.stats()["frames"], strict=True):
        assert a["strategies"] == b["strategies"] == ["bvh"]
        for name in ("rays", "hits", "tests", "dispatches", "peak_device_mib", "generations"):
            assert a[name] == b[name], name
        assert same(auto.frame(a["frame"]), fixed.frame(a["frame"]))
    assert auto.stats()["strategy"] == "bvh"
    assert "hybrid could save" in auto.stats()["chosen_because"]


def test_a_sequence_changes_hands_between_frames(sheaf):
    auto, fixed = both(sheaf, "whitted", "--frames", "0-5", env=FREE)
    strategies = [frame["strategies"] for frame in auto.stats()["frames"]]
    assert strategies[:3] == [["bvh"], ["hybrid"], ["hybrid"]]  # the second brings its kernels, the third is measured
    assert all(len(names) == 1 for names in strategies)
    for a, b in zip(auto.stats()["frames"], fixed.stats()["frames"], strict=True):
        assert a["rays"] == b["rays"]
        assert same(auto.frame(a["frame"]), fixed.frame(a["frame"]))
    assert auto.stats()["strategy"] in ("bvh", "hybrid")
    assert "ns per ray" in auto.stats()["chosen_because"]


@pytest.mark.parametrize(
    ("options", "size"),
    [
        (("--spp", "6"), "96x54"),
        (("--spp", "1", "--memory", "16"), "320x180"),
        (("--spp", "adaptive:0.02:64"), "96x54"),
    ],
)
def test_a_frame_changes_hands_between_samples_and_tiles(sheaf, options, size):
    auto, fixed = both(sheaf, "whitted", "--frames", "7-8", *options, size=size, env=FREE)
    for a, b in zip(auto.stats()["frames"], fixed.stats()["frames"], strict=True):
        assert a["rays"] == b["rays"]
        assert a["hits"] == b["hits"]
        assert same(auto.frame(a["frame"]), fixed.frame(a["frame"]))
    assert auto.stats()["frames"][0]["strategies"] == ["bvh", "hybrid"]
    assert auto.frame(7).header["sheaf:strategy"] == "bvh, hybrid"


def test_the_layer_of_tests_is_one_strategys(sheaf):
    options = ("--frames", "0-2", "--spp", "3", "--aov", "tests")
    auto, bvh = both(sheaf, "whitted", *options, env=FREE)
    hybrid = sheaf.render("whitted", *options, size="96x54", strategy="hybrid", stats=True)
    assert [frame["strategies"] for frame in auto.stats()["frames"]][:2] == [["bvh"], ["hybrid"]]
    assert same(auto.frame(0), bvh.frame(0))
    assert same(auto.frame(1), hybrid.frame(1))


def test_a_price_too_high_is_said(sheaf):
    auto = sheaf.render("whitted", "--frames", "0-3", strategy="auto", stats=True, env=DEAR).stats()
    assert [frame["strategies"] for frame in auto["frames"]] == [["bvh"]] * 4
    assert "1000000.00 s" in auto["chosen_because"]


def test_kernels_once_compiled_are_remembered(sheaf, tmp_path):
    """Beside the driver's cache, so that the mark is lost with it."""
    cache = tmp_path / "kernels"
    for strategy in ("bvh", "hybrid"):
        sheaf.render("cornell", strategy=strategy, env={"MESA_SHADER_CACHE_DIR": str(cache)})
        assert len(list(cache.rglob(f"compiled-{strategy}-*"))) == 1
    sheaf.render("cornell", "--opaque", strategy="hybrid", env={"MESA_SHADER_CACHE_DIR": str(cache)})
    assert len(list(cache.rglob("compiled-hybrid-*"))) == 2  # other kernels
