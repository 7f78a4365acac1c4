# SPDX-License-Identifier: MIT
"""A study's files: report.json, the CSV tables, a PNG a plot, and report.html."""

from __future__ import annotations

from pathlib import Path

from .._files import write_whole, write_whole_bytes
from ._canvas import THEMES, draw_png
from ._page import Drawn, page
from ._plots import plots
from ._study import Study
from ._tables import csv_tables, json_text


def write_report(study: Study, folder: Path) -> list[Path]:
    """Writes all files; gives their paths, the page first.

    Raises:
        OSError: one cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    drawn: dict[str, Drawn] = {}
    pictures: dict[str, bytes] = {}
    for scene in study.scenes:
        made = {}
        for plot in plots(scene):
            light, dark = (draw_png(plot.draw, plot.size, theme) for theme in THEMES)
            made[plot.stem] = (f"{scene.name}: {plot.words}", light, dark)
            pictures[f"{scene.name}-{plot.stem}.png"] = light
        drawn[scene.name] = made
    texts = {"report.html": page(study, drawn), "report.json": json_text(study), **csv_tables(study)}
    for name, text in texts.items():
        write_whole(folder / name, text)
    for name, png in pictures.items():
        write_whole_bytes(folder / name, png)
    return [folder / name for name in [*texts, *pictures]]
