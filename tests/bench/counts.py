# SPDX-License-Identifier: MIT
"""Tests by kind of ray, strategy against strategy: counted in runs of their own, since counting costs time."""

from __future__ import annotations

from typing import Any

from engine import Engine, TookTooLongError
from measure import Scene, size_text

COUNTED = ("rsh", "crsh", "hybrid", "bvh", "frustum", "classify")
KINDS = ("primary", "shadow", "reflection", "refraction")


def tests_of(frame: dict[str, Any]) -> dict[str, dict[str, float]]:
    """Per kind that was traced: rays, all tests, and those of rays against triangles."""
    tests, found = frame["tests"], {}
    for kind in KINDS:
        if kind == "primary" or not frame["rays"][kind]:
            continue  # the rasteriser's
        every = sum(tests[what].get(kind, 0) for what in ("node_object", "ray_box", "ray_triangle"))
        found[kind] = {"rays": frame["rays"][kind], "tests": every, "ray_triangle": tests["ray_triangle"].get(kind, 0)}
    return found


def count(
    engine: Engine, scene: Scene, size: tuple[int, int], strategies: tuple[str, ...], patience: float
) -> dict[str, Any]:
    """A strategy whose run takes longer than patience allows is left out, and said to be."""
    counted: dict[str, Any] = {"left_out": {}}
    for strategy in strategies:
        if strategy not in COUNTED:
            continue
        options = [*scene.options, "--size", size_text(size), "--strategy", strategy, "--count", "on"]
        try:
            run = engine.render(scene.path, options, "1", patience)
        except TookTooLongError:
            counted["left_out"][strategy] = f"{size_text(size)} takes over {patience:g} s"
            continue
        counted[strategy] = tests_of(run.stats["frames"][0])
    return counted


def fewer(counted: dict[str, Any], strategy: str, than: str, kind: str | None = None) -> float | None:
    """1 − tests by one strategy / tests by the other; None where either is not there."""
    if strategy not in counted or than not in counted:
        return None
    kinds = [kind] if kind else list(counted[than])
    ours, theirs = (sum(counted[s].get(k, {}).get("tests", 0) for k in kinds) for s in (strategy, than))
    return 1 - ours / theirs if theirs else None


def triangles_a_ray(counted: dict[str, Any], strategy: str) -> float | None:
    """Ray–triangle tests a traced ray; primary rays are the rasteriser's."""
    if strategy not in counted:
        return None
    rays = sum(c["rays"] for c in counted[strategy].values())
    return sum(c["ray_triangle"] for c in counted[strategy].values()) / rays if rays else None
