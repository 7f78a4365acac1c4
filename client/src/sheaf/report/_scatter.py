# SPDX-License-Identifier: MIT
"""Error against what it costs, in time or in tests: one panel a measure of error."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ._canvas import ACCENT, Theme
from ._errors import Errors, pareto
from ._measure import Trial
from ._study import SceneStudy
from ._ticks import log_ticks

_MEASURES: tuple[tuple[str, Callable[[Errors], float | None]], ...] = (
    ("RMSE", lambda errors: errors.rmse),
    ("Relative MSE", lambda errors: errors.relative_mse),
    ("FLIP (mean)", lambda errors: errors.flip),
    ("Worst pixel", lambda errors: errors.worst),
)
_LEAST = 1e-8  # where an error of 0 is drawn: a logarithm has none
_MARKS = "ovs^DPX*"
_LINE: dict[str, Any] = {"color": ACCENT, "linewidth": 1.4, "zorder": 2, "drawstyle": "steps-post"}


def cost_of(trial: Trial, cost: str) -> float | None:
    """Milliseconds, or tests."""
    return trial.median_ms if cost == "time" else float(trial.all_tests) or None


def scatter(scene: SceneStudy, cost: str) -> Callable[[Figure, Theme], None]:
    """What draws the panels; `cost` is "time" or "tests"."""

    def draw(figure: Figure, theme: Theme) -> None:
        axes = figure.subplots(2, 2, sharex=True).flat
        for panel, (title, measure) in zip(axes, _MEASURES, strict=True):
            _panel(panel, scene, cost, measure, theme)
            panel.set_title(title)
        for panel in (axes[2], axes[3]):
            panel.set_xlabel("wall-clock time of a frame, ms" if cost == "time" else "intersection tests of a frame")
        figure.legend(handles=_legend(scene, theme), loc="outside right upper")

    return draw


def _panel(axes: Axes, scene: SceneStudy, cost: str, measure: Callable[[Errors], float | None], theme: Theme) -> None:
    points: list[tuple[float, float, Trial]] = []
    for trial in scene.timed:
        x, y = cost_of(trial, cost), measure(trial.errors) if trial.errors else None
        if x is not None and y is not None and math.isfinite(y):
            points.append((x, max(y, _LEAST), trial))
    axes.set(xscale="log", yscale="log")
    axes.grid(which="major")
    log_ticks(axes.xaxis)
    log_ticks(axes.yaxis)
    if not points:
        axes.text(0.5, 0.5, "not measured", transform=axes.transAxes, ha="center", color=theme.quiet)
        return
    on = pareto([(x, y) for x, y, _ in points])
    front = sorted((x, y) for (x, y, _), is_on in zip(points, on, strict=True) if is_on)
    axes.plot(*zip(*front, strict=True), **_LINE)
    heights = [y for _, y, _ in points]
    middle = math.sqrt(min(heights) * max(heights))
    spread = max(math.sqrt(max(heights) / min(heights)) * 1.3, 2.5)  # a flat row of points needs some axis, too
    axes.set_ylim(middle / spread, middle * spread)
    samples, depths = _levels(scene)
    for (x, y, trial), is_on in zip(points, on, strict=True):
        edge: dict[str, Any] = {"edgecolors": ACCENT if is_on else theme.ground, "linewidths": 1.4 if is_on else 0.5}
        if cost == "time":
            axes.plot([min(trial.wall_ms), max(trial.wall_ms)], [y, y], color=theme.quiet, linewidth=0.8, zorder=1)
        axes.scatter(x, y, s=34, zorder=3, **_look(trial, samples, depths, theme), **edge)
    named = sorted(((x, y, trial.point.name) for x, y, trial in points if trial.point.name), reverse=True)
    for x, y, name in named:
        axes.annotate(
            name,
            (x, y),
            xytext=(7, 7),
            textcoords="offset points",
            fontsize=8,
            fontweight="bold",
            arrowprops={"arrowstyle": "-", "color": theme.ink, "linewidth": 0.6},
            bbox={"boxstyle": "round,pad=0.15", "facecolor": theme.ground, "edgecolor": "none", "alpha": 0.8},
            zorder=4,
        )


def _levels(scene: SceneStudy) -> tuple[list[int], list[int]]:
    """All samples and depths that were tried."""
    settings = [trial.point.settings for trial in scene.knobs]
    numbers = [
        sorted({value for each in settings if isinstance(value := each.get(name), int)}) for name in ("spp", "depth")
    ]
    return numbers[0], numbers[1]


def _look(trial: Trial, samples: list[int], depths: list[int], theme: Theme) -> dict[str, Any]:
    """Colour by samples, mark by depth; what gives the default picture in another way is grey."""
    spp, depth = trial.point.settings.get("spp"), trial.point.settings.get("depth")
    if not isinstance(spp, int) or not isinstance(depth, int):
        return {"color": theme.quiet, "marker": "."}
    return {"color": _colour(samples.index(spp), len(samples)), "marker": _MARKS[depths.index(depth) % len(_MARKS)]}


def _colour(index: int, count: int) -> Any:
    return colormaps["viridis"](0.12 + 0.78 * index / max(1, count - 1))


def _legend(scene: SceneStudy, theme: Theme) -> list[Line2D]:
    samples, depths = _levels(scene)
    dot: dict[str, Any] = {"linestyle": "", "markeredgewidth": 0}
    handles = [Line2D([], [], **{k: v for k, v in _LINE.items() if k != "zorder"}, label="Pareto front")]
    handles += [Line2D([], [], marker=".", color=theme.quiet, label="same picture, other way", **dot)]
    handles += [
        Line2D([], [], marker="o", color=_colour(i, len(samples)), label=f"{spp} spp", **dot)
        for i, spp in enumerate(samples)
    ]
    handles += [
        Line2D([], [], marker=_MARKS[i % len(_MARKS)], color=theme.quiet, label=f"depth {depth}", **dot)
        for i, depth in enumerate(depths)
    ]
    return handles
