# SPDX-License-Identifier: MIT
"""Labels of logarithmic axes: some are there, in order, and none touches the next."""

from __future__ import annotations

import itertools
from pathlib import Path

import pytest

pytest.importorskip("matplotlib")

from matplotlib.figure import Figure

from sheaf.report._canvas import THEMES, Theme, draw_png
from sheaf.report._errors import Errors
from sheaf.report._measure import Trial
from sheaf.report._plan import Point
from sheaf.report._scatter import scatter
from sheaf.report._study import SceneStudy

SPANS = [
    (low, low * factor)
    for low, factor in itertools.product((1.7e-7, 0.0421, 1.0, 3.3e5), (1.04, 1.5, 4.0, 30.0, 700.0, 1e5, 1e9))
]


def check_labels(figure: Figure) -> None:
    """After the figure was drawn."""
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            low, high = sorted(axis.get_view_interval())
            shown = [
                tick.label1
                for tick in axis.get_major_ticks()
                if tick.label1.get_visible() and tick.label1.get_text() and low <= tick.get_loc() <= high
            ]
            assert len(shown) >= 2 or not axis.get_tick_params()["labelbottom" if axis is axes.xaxis else "labelleft"]
            boxes = [label.get_window_extent() for label in shown]
            for one, other in itertools.pairwise(boxes):
                apart = other.x0 - one.x1 if axis is axes.xaxis else other.y0 - one.y1
                assert apart > 1.0, [label.get_text() for label in shown]


@pytest.mark.parametrize(("low", "high"), SPANS)
def test_labels_of_error_against_cost_do_not_touch(low: float, high: float) -> None:
    trials = [
        Trial(Point({"spp": 1, "depth": 1}), wall_ms=[cost], errors=Errors(error, error, error, error, (0, 0)))
        for cost, error in ((low, high), (high, low))
    ]
    scene = SceneStudy(Path("whitted.glb"), "whitted", knobs=trials)
    drawn: list[Figure] = []

    def draw(figure: Figure, theme: Theme) -> None:
        scatter(scene, "time")(figure, theme)
        drawn.append(figure)

    draw_png(draw, (9.2, 6.2), THEMES[0])
    check_labels(drawn[0])
