# SPDX-License-Identifier: MIT
"""What all plots share: two themes, colours that people with any eyes tell apart, and figures as PNG bytes."""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

# Okabe and Ito's colours: distinct for all common kinds of colour blindness.
KIND_COLOURS = {"primary": "#0072B2", "shadow": "#E69F00", "reflection": "#009E73", "refraction": "#CC79A7"}
ACCENT = "#D55E00"
# Marks differ in shape too, so that a print in grey still tells them apart.
KIND_MARKS = {"primary": "o", "shadow": "s", "reflection": "D", "refraction": "^"}

DPI = 144


@dataclass(frozen=True)
class Theme:
    """Colours of what is not data."""

    name: str
    ground: str
    ink: str
    quiet: str
    grid: str


THEMES = (
    Theme("light", "#ffffff", "#1c2024", "#6b7480", "#e3e6ea"),
    Theme("dark", "#16191d", "#e8eaed", "#9aa3ad", "#2c3138"),
)

Draw = Callable[[Figure, Theme], None]


def draw_png(draw: Draw, size: tuple[float, float], theme: Theme) -> bytes:
    """A figure as PNG; `size` in inches."""
    settings: dict[str, Any] = {
        "font.size": 9,
        "font.family": "sans-serif",
        "figure.facecolor": theme.ground,
        "savefig.facecolor": theme.ground,
        "axes.facecolor": theme.ground,
        "axes.edgecolor": theme.quiet,
        "axes.labelcolor": theme.ink,
        "axes.titlesize": 10,
        "axes.titleweight": "bold",
        "axes.titlelocation": "left",
        "axes.titlecolor": theme.ink,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.axisbelow": True,
        "grid.color": theme.grid,
        "grid.linewidth": 0.7,
        "text.color": theme.ink,
        "xtick.color": theme.quiet,
        "ytick.color": theme.quiet,
        "xtick.labelcolor": theme.ink,
        "ytick.labelcolor": theme.ink,
        "legend.frameon": False,
        "legend.fontsize": 8,
        # No date and no version in the file: the same study gives the same bytes.
        "svg.hashsalt": "sheaf",
    }
    with mpl.rc_context(settings):  # type: ignore[arg-type]
        figure = Figure(figsize=size, dpi=DPI, layout="constrained")
        draw(figure, theme)
        out = io.BytesIO()
        figure.savefig(out, format="png", metadata={"Software": None})
    return out.getvalue()


def rows(axes: Axes, labels: Sequence[str]) -> None:
    """Labels rows from the top, without a vertical axis line."""
    axes.set_yticks(range(len(labels)), labels)
    axes.set_ylim(len(labels) - 0.4, -0.6)
    axes.spines["left"].set_visible(False)
    axes.tick_params(axis="y", length=0)


def short(number: float) -> str:
    """A number in three digits with a letter for its thousands."""
    for limit, letter in ((1e9, "G"), (1e6, "M"), (1e3, "k")):
        if abs(number) >= limit:
            return f"{number / limit:.3g} {letter}"
    return f"{number:.3g}"
