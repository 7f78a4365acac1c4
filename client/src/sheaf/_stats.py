# SPDX-License-Identifier: MIT
"""The stats document (`Job.stats`, `--stats`), schema 1. Times are milliseconds of the device unless said otherwise."""

from __future__ import annotations

from typing import Any, TypedDict


class DeviceStats(TypedDict, total=False):
    """The device that rendered."""

    name: str
    driver: str


class SceneStats(TypedDict, total=False):
    """What the scene holds."""

    triangles: int
    instances: int
    meshes: int
    lights: int
    materials: int
    features: list[str]


class LeftOut(TypedDict):
    """A stage that the scene did not need, and why."""

    stage: str
    reason: str


class TestStats(TypedDict, total=False):
    """Intersection tests by kind of ray; `brute_force` is rays times triangles."""

    brute_force: int
    node_object: dict[str, int]
    node_object_by_level: dict[str, list[int]]
    ray_box: dict[str, int]
    ray_triangle: dict[str, int]


class FrameStats(TypedDict, total=False):
    """One frame. A stage that was left out is absent from `stages`; `wall_ms` is wall-clock time."""

    frame: int
    time_s: float
    wall_ms: float
    peak_device_mib: float
    dispatches: int
    counted: bool
    stages: dict[str, float]
    rays: dict[str, int]
    hits: dict[str, int]
    tests: TestStats
    generations: list[dict[str, Any]]
    strategies: list[str]


class TotalStats(TypedDict, total=False):
    """Sums over all frames, and what follows from them; None where there was nothing to divide by."""

    rays_per_second: float | None
    tests_per_ray: float | None
    reduction_vs_brute_force: float | None


class Stats(TypedDict, total=False):
    """The whole document; newer services may add to it."""

    schema: int
    version: str
    device: DeviceStats
    strategy: str
    chosen_because: str
    scene: SceneStats
    left_out: list[LeftOut]
    frames: list[FrameStats]
    totals: TotalStats
