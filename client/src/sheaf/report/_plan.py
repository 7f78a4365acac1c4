# SPDX-License-Identifier: MIT
"""What is measured: the points of the settings' space that are worth rendering, the most telling ones first."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass, field

from .._program import Program

Settings = Mapping[str, object]

# Each with what it takes away from the whole algorithm.
_PUBLISHED: tuple[Settings, ...] = (
    {"strategy": "bvh"},
    {"strategy": "hybrid", "sort": "on"},
    {"strategy": "hybrid", "sort": "off"},
    {"strategy": "crsh", "sort": "on"},
    {"strategy": "crsh", "sort": "off"},
    {"strategy": "rsh"},
    {"strategy": "hybrid", "sort": "on", "primary": "trace"},
    {"strategy": "crsh", "sort": "on", "primary": "trace"},
    {"strategy": "bvh", "primary": "trace"},
    {"strategy": "rayquery"},
    {"strategy": "frustum"},
    {"strategy": "classify"},
)


@dataclass(frozen=True)
class StudyOptions:
    """How large a study is; the defaults take some minutes a scene on two cores.

    Attributes:
        size: of the pictures.
        frame: the frame that is rendered, at `fps` frames per second.
        fps: see `frame`.
        reference_spp: samples per pixel of the reference, which is rendered in double precision.
        reference_depth: generations of the reference; its cutoff is 0.
        repeats: timed runs of a point, beside a first one that does not count.
        minutes: when to stop beginning new measurements; what is left over is listed.
        point_seconds: when to end a run that takes too long.
        spp: samples per pixel to try.
        adaptive: errors to try with adaptive samples, of at most 256.
        depth: generations to try.
        cutoff: least weights to try.
        memory: budgets to try, MiB; they change time alone.
        strategies: which to try; None: all that the program has.
        knobs: further options of the program, with the values to try.
        common: options that every run is given, such as a camera.
    """

    size: str = "192x108"
    frame: int = 0
    fps: float = 24.0
    reference_spp: int = 64
    reference_depth: int = 16
    repeats: int = 3
    minutes: float = 10.0
    point_seconds: float = 60.0
    spp: tuple[int, ...] = (1, 2, 4, 8, 16)
    adaptive: tuple[float, ...] = (0.05, 0.02, 0.01)
    depth: tuple[int, ...] = (1, 2, 4, 8)
    cutoff: tuple[float, ...] = (0.0, 0.002, 0.02, 0.1)
    memory: tuple[int, ...] = (16,)
    strategies: tuple[str, ...] | None = None
    knobs: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    common: Settings = field(default_factory=dict)


@dataclass(frozen=True)
class Point:
    """One set of settings to measure.

    Attributes:
        settings: options of `sheaf render`.
        name: of a named setting.
        environment: variables that the program is given.
    """

    settings: Settings
    name: str | None = None
    environment: Settings = field(default_factory=dict)

    @property
    def label(self) -> str:
        """The settings in words."""
        words = [f"{name}={value}" for name, value in self.environment.items()]
        for name, value in self.settings.items():
            bare = name in ("strategy", "quality")
            words.append(str(value) if bare else f"{name} {value}")
        return " ".join(words) or "defaults"


def strategy_points(program: Program, options: StudyOptions) -> list[Point]:
    """The ways to find the same hits: what the report's own evaluation compares."""
    known = options.strategies or program.strategies
    points = [Point(settings) for settings in _PUBLISHED if settings["strategy"] in known]
    published = {settings["strategy"] for settings in _PUBLISHED}
    # auto is one of the others after a trial, reference is what all are held against, brute is for small scenes.
    asked = () if options.strategies is None else options.strategies
    return points + [Point({"strategy": name}) for name in asked if name not in published]


def memory_points(options: StudyOptions, strategy: str) -> list[Point]:
    """Budgets for what scales with the picture."""
    return [Point({"strategy": strategy, "memory": mib}) for mib in options.memory]


def error_points(program: Program, options: StudyOptions, strategy: str) -> list[Point]:
    """The knobs that trade error for time, under the strategy that is fastest here."""
    named = [Point({"strategy": strategy, "quality": name}, name) for name in program.qualities]
    middle = options.depth[len(options.depth) // 2]
    sweeps: list[Settings] = [{"spp": spp, "depth": middle} for spp in options.spp]
    most = options.spp[len(options.spp) // 2]
    sweeps += [{"spp": most, "depth": depth} for depth in options.depth]
    sweeps += [{"spp": most, "depth": max(options.depth), "cutoff": cutoff} for cutoff in options.cutoff]
    if "filter" in program.options:
        sweeps += [{"spp": f"adaptive:{error}:256", "depth": max(options.depth)} for error in options.adaptive]
        sweeps += [{"spp": most, "depth": middle, "filter": name} for name in ("box", "triangle")]
    for knob, values in options.knobs.items():
        sweeps += [{"spp": most, "depth": middle, knob: value} for value in values]
    sweeps += [{"spp": spp, "depth": depth} for spp, depth in itertools.product(options.spp, options.depth)]
    distinct = {tuple(settings.items()): settings for settings in sweeps}
    return named + [Point({"strategy": strategy, **settings}) for settings in distinct.values()]
