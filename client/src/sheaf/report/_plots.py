# SPDX-License-Identifier: MIT
"""The plots of the strategies: rays per second, tests per ray, stages, and tests by level of the rays' hierarchy."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from matplotlib import colormaps
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from ._canvas import KIND_COLOURS, KIND_MARKS, Draw, Theme, rows, short
from ._measure import KINDS, Trial
from ._scatter import scatter
from ._study import SceneStudy
from ._ticks import log_ticks


@dataclass(frozen=True)
class Plot:
    """A plot of a scene: its file's stem, what it shows in words, its size in inches, and what draws it."""

    stem: str
    words: str
    size: tuple[float, float]
    draw: Draw


def plots(scene: SceneStudy) -> list[Plot]:
    """All plots that the scene has data for."""
    timed = [trial for trial in scene.strategies if trial.wall_ms]
    made: list[Plot] = []
    if scene.timed:
        made.append(Plot("error-time", "Error against wall-clock time", (9.2, 6.2), scatter(scene, "time")))
        made.append(Plot("error-tests", "Error against intersection tests", (9.2, 6.2), scatter(scene, "tests")))
    if timed:
        high = 1.1 + 0.3 * len(timed)
        made.append(Plot("rays-per-second", "Rays per second", (8.2, high), _bars(timed)))
        made.append(Plot("stages", "Device time by stage", (8.2, high + 0.5), _stages(timed)))
    counted = [trial for trial in scene.strategies if trial.all_tests]
    if counted:
        made.append(
            Plot("tests-per-ray", "Tests per ray, by kind of ray", (8.2, 1.3 + 0.3 * len(counted)), _dots(counted))
        )
    if any(has_levels(trial) for trial in counted):
        made.append(Plot("tests-by-level", "Tests by level of the rays' hierarchy", (9.2, 3.4), _levels(counted)))
    return made


def has_levels(trial: Trial) -> bool:
    """Whether it counted any test against a node of the rays' hierarchy."""
    return any(any(levels) for levels in trial.tests_by_level.values())


def _bars(trials: list[Trial]) -> Callable[[Figure, Theme], None]:
    def draw(figure: Figure, theme: Theme) -> None:
        axes = figure.subplots()
        ordered = sorted(trials, key=lambda trial: -(trial.rays_per_second or 0))
        for row, trial in enumerate(ordered):
            rays, middle = sum(trial.rays.values()) * 1000, trial.rays_per_second or 0.0
            ends = rays / max(trial.wall_ms), rays / min(trial.wall_ms)
            axes.barh(row, middle, height=0.62, color=KIND_COLOURS["primary"])
            axes.plot(ends, [row, row], color=theme.ink, linewidth=1.2, marker="|", markersize=6)
            axes.annotate(
                short(middle), (max(ends), row), xytext=(6, 0), textcoords="offset points", va="center", fontsize=8
            )
        rows(axes, [trial.point.label for trial in ordered])
        axes.grid(axis="x")
        axes.margins(x=0.12)
        axes.xaxis.set_major_formatter(lambda value, _: short(value))
        axes.set_xlabel("rays of all kinds a second of wall-clock time; whiskers: slowest and fastest run")

    return draw


def _stages(trials: list[Trial]) -> Callable[[Figure, Theme], None]:
    def draw(figure: Figure, theme: Theme) -> None:
        axes = figure.subplots()
        ordered = sorted(trials, key=lambda trial: trial.median_ms or 0)
        names = list(dict.fromkeys(name for trial in ordered for name in trial.stages))
        # The few that take the time get a colour; the rest is one grey.
        total = {name: sum(trial.stages.get(name, 0.0) for trial in ordered) for name in names}
        main = sorted(names, key=lambda name: -total[name])[:8]
        palette = colormaps["tab10"]
        colours = {name: palette(i if i < 7 else i + 1) for i, name in enumerate(main)}
        for row, trial in enumerate(ordered):
            left = 0.0
            for name in [*main, *(name for name in names if name not in main)]:
                width = trial.stages.get(name, 0.0)
                axes.barh(row, width, left=left, height=0.62, color=colours.get(name, theme.quiet))
                left += width
        for name in main:
            axes.barh(0, 0, color=colours[name], label=name)
        if len(names) > len(main):
            axes.barh(0, 0, color=theme.quiet, label="other stages")
        rows(axes, [trial.point.label for trial in ordered])
        axes.grid(axis="x")
        axes.set_xlabel("device time of a frame, ms")
        figure.legend(loc="outside upper left", ncols=5)

    return draw


def _dots(trials: list[Trial]) -> Callable[[Figure, Theme], None]:
    def draw(figure: Figure, theme: Theme) -> None:
        axes = figure.subplots()
        ordered = sorted(trials, key=lambda trial: trial.all_tests)
        for kind in KINDS:
            rates = [_rate(trial, kind) for trial in ordered]
            seen = [(rate, row) for row, rate in enumerate(rates) if rate]
            if seen:
                look: dict[str, Any] = {"marker": KIND_MARKS[kind], "color": KIND_COLOURS[kind], "label": kind}
                across, down = zip(*seen, strict=True)
                axes.scatter(across, down, s=42, zorder=3, **look)
        for row, trial in enumerate(ordered):
            span = [rate for kind in KINDS if (rate := _rate(trial, kind))]
            if span:
                axes.plot([min(span), max(span)], [row, row], color=theme.grid, linewidth=2, zorder=1)
        axes.set_xscale("log")
        log_ticks(axes.xaxis)
        axes.grid(axis="x", which="major")
        rows(axes, [trial.point.label for trial in ordered])
        axes.set_xlabel("intersection tests per ray (a rasterised camera ray costs none)")
        figure.legend(loc="outside upper left", ncols=4)

    return draw


def _rate(trial: Trial, kind: str) -> float | None:
    rays = trial.rays.get(kind, 0)
    return trial.tests.get(kind, 0) / rays if rays else None


def _levels(trials: list[Trial]) -> Callable[[Figure, Theme], None]:
    levelled = [trial for trial in trials if has_levels(trial)]
    kinds = [kind for kind in KINDS if any(any(trial.tests_by_level.get(kind, ())) for trial in levelled)]
    deepest = max(2, *(len(levels) for trial in levelled for levels in trial.tests_by_level.values()))
    shown = [trial for trial in levelled if "primary" not in trial.point.settings] or levelled

    def draw(figure: Figure, theme: Theme) -> None:
        panels = figure.subplots(1, len(kinds), sharey=True, squeeze=False)[0]
        palette = colormaps["tab10"]
        for axes, kind in zip(panels, kinds, strict=True):
            for index, trial in enumerate(shown):
                levels = [count or math.nan for count in trial.tests_by_level.get(kind, ())]
                sorted_ = trial.point.settings.get("sort") == "on"
                style: dict[str, Any] = {"linestyle": "-" if sorted_ else "--", "marker": "o", "markersize": 4}
                label = trial.point.label if axes is panels[0] else None
                axes.plot(range(len(levels)), levels, color=palette(index), label=label, **style)
            axes.set(title=kind, yscale="log", xlabel="level, 0: the roots")
            log_ticks(axes.yaxis)
            axes.set_xlim(-0.4, deepest - 0.6)
            axes.xaxis.set_major_locator(MaxNLocator(integer=True))
            axes.grid()
        panels[0].set_ylabel("node-object tests")
        figure.legend(loc="outside upper left", ncols=5)

    return draw
