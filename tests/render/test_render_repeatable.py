# SPDX-License-Identifier: MIT
"""Pixels are a function of scene, camera, frame and settings: not of memory, threads, range or of what ran before."""

import json
import random

import numpy as np
import pytest


def same(a, b) -> bool:
    return np.array_equal(a.rgba.view(np.uint16), b.rgba.view(np.uint16))


@pytest.mark.parametrize("strategy", ["bvh", "hybrid"])
def test_memory_budget_does_not_show(sheaf, strategy):
    """The least budget there is: tiles, and tiles cut again where their rays do not fit."""
    small, usual = sheaf.all(
        {
            "scene": "whitted",
            "options": ("--depth", 6, "--cutoff", 0, "--memory", mib),
            "stats": True,
            "size": "256x144",
            "strategy": strategy,
        }
        for mib in (16, 1024)
    )
    assert same(small.frame(), usual.frame())
    counts = [run.stats()["frames"][0] for run in (small, usual)]
    assert counts[0]["rays"] == counts[1]["rays"]
    assert counts[0]["hits"] == counts[1]["hits"]
    assert counts[0]["peak_device_mib"] < 0.6 * counts[1]["peak_device_mib"]


@pytest.mark.parametrize("strategy", ["crsh", "rsh", "frustum", "classify", "rayquery", "brute"])
def test_memory_from_the_least_to_no_bound(sheaf, strategy):
    """The least there is, the greatest that may be asked for, and one between that ends tiles somewhere else."""
    if strategy == "rayquery" and not json.loads(sheaf("devices", "--json").stdout)[0]["ray_query"]:
        pytest.skip("the device has no ray query")
    runs = sheaf.all(
        {"scene": "cornell", "options": ("--depth", 3, "--memory", mib), "size": "96x54", "strategy": strategy}
        for mib in (16, 37, 1048576)
    )
    for run in runs[1:]:
        assert same(run.frame(), runs[0].frame())
    assert len(np.unique(runs[0].frame().rgba.reshape(-1, 4), axis=0)) > 100


def test_frames_alone_and_in_a_range(sheaf):
    runs = sheaf.all(
        {"scene": "whitted", "options": ("--frames", frames), "strategy": "hybrid"}
        for frames in ("9-13", "11", "13,11,10", "9-13")
    )
    one, *others = runs
    assert sorted(one.files) == [9, 10, 11, 12, 13]
    for run in others:
        for number, path in run.files.items():
            assert path.read_bytes() == one.files[number].read_bytes(), f"{number} of {sorted(run.files)}"
    assert not same(one.frame(9), one.frame(10))


def test_threads_do_not_show(sheaf):
    files = [
        sheaf.render("whitted", "--frames", "5", strategy="hybrid", size="96x54", env={"LP_NUM_THREADS": threads})
        .files[5]
        .read_bytes()
        for threads in ("1", "2", "3")
    ]
    assert files[0] == files[1] == files[2]


@pytest.mark.parametrize("strategy", ["bvh", "crsh", "frustum", "classify"])
def test_more_threads_than_cores_do_not_show(sheaf, strategy):
    """And none but the caller's own."""
    files = [
        sheaf.render("cornell", strategy=strategy, size="96x54", env={"LP_NUM_THREADS": threads}).files[0].read_bytes()
        for threads in ("0", "1", "16")
    ]
    assert files[0] == files[1] == files[2]


def test_any_split_over_unlike_nodes(sheaf):
    """Frames dealt out at random to runs of other strategies, budgets and threads: the same pixels as one run gives."""
    frames = range(20, 32)
    (whole,) = sheaf.all([{"scene": "whitted", "options": ("--frames", "20-31"), "size": "48x27"}])
    dice = random.Random(5)
    shuffled = dice.sample(frames, len(frames))
    parts = [shuffled[:1], shuffled[1:3], shuffled[3:6], shuffled[6:8], shuffled[8:10], shuffled[10:]]
    nodes = [
        ("hybrid", 16, "1"),
        ("bvh", 64, "3"),
        ("crsh", 16, "2"),
        ("hybrid", 4096, "0"),
        ("frustum", 16, "1"),
        ("classify", 16, "1"),
    ]
    for part, (strategy, mib, threads) in zip(parts, nodes, strict=True):
        run = sheaf.render(
            "whitted",
            "--frames",
            ",".join(map(str, part)),
            "--memory",
            mib,
            strategy=strategy,
            size="48x27",
            env={"LP_NUM_THREADS": threads},
        )
        for number in part:
            assert same(run.frame(number), whole.frame(number)), f"frame {number} by {strategy}"


def test_a_second_run_over_the_first(sheaf):
    """In the same folder, files already there: the same bytes again."""
    first = sheaf.render("still_life", "--frames", "0-1", strategy="hybrid")
    before = {number: path.read_bytes() for number, path in first.files.items()}
    again = sheaf.render("still_life", "--frames", "0-1", strategy="hybrid", out=first.out)
    assert {number: path.read_bytes() for number, path in again.files.items()} == before


def test_counting_does_not_show(sheaf):
    runs = sheaf.all(
        {"scene": "cornell", "options": ("--count", way), "stats": True, "strategy": "hybrid"} for way in ("on", "off")
    )
    assert same(runs[0].frame(), runs[1].frame())
    counted, timed = (run.stats()["frames"][0] for run in runs)
    assert counted["counted"]
    assert not timed["counted"]
    assert timed["tests"]["ray_triangle"] == {}


def test_auto_says_why(sheaf):
    run = sheaf.render("cornell", strategy="auto", stats=True)
    stats = run.stats()
    assert stats["strategy"] in ("hybrid", "bvh", "crsh", "rsh", "frustum", "classify", "brute", "rayquery")
    assert any(c.isdigit() for c in stats["chosen_because"])
    assert same(run.frame(), sheaf.render("cornell").frame())


def test_auto_takes_no_more_memory_than_its_choice(sheaf):
    auto = sheaf.render("cornell", "--count", "off", size="1280x720", strategy="auto", stats=True).stats()
    fixed = sheaf.render("cornell", "--count", "off", size="1280x720", strategy=auto["strategy"], stats=True).stats()
    took, needed = (run["totals"]["peak_device_mib"] for run in (auto, fixed))
    assert took <= 1.02 * needed


def test_lossless_compressions_hold_the_same_pixels(sheaf):
    ways = ("zip", "none", "rle", "zips", "piz")
    runs = sheaf.all({"scene": "still_life", "options": ("--compression", way), "size": "33x17"} for way in ways)
    for way, run in zip(ways, runs, strict=True):
        assert same(run.frame(), runs[0].frame())
        assert run.frame().header["compression"].name == f"{way.replace('none', 'no').upper()}_COMPRESSION"
