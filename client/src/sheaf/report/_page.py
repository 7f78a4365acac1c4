# SPDX-License-Identifier: MIT
"""A study as one HTML page that needs nothing beside it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ._canvas import short
from ._html import NONE, STYLE, Cell, escaped, image, number, percent, table
from ._measure import KINDS, Trial
from ._pictures import pictures
from ._stability import Stability
from ._study import SceneStudy, Study
from ._words import headlines, method

_EMPTY: list[Cell | str] = [""] * 9

Drawn = Mapping[str, tuple[str, bytes, bytes]]
"""Plots by stem: words, and PNG for a light and a dark ground."""


def page(study: Study, drawn: Mapping[str, Drawn]) -> str:
    """The page; `drawn` has each scene's plots."""
    parts = [
        f"<h1>Error against run time</h1><p class=quiet>Sheaf {escaped(study.versions['sheaf'])} on "
        f"{escaped(study.device.get('name', 'an unknown device'))}, {escaped(study.made)}</p>",
        f"<div class=headline><ul>{''.join(f'<li>{line}</li>' for line in headlines(study))}</ul></div>",
        _contents(study),
        *(_scene(scene, drawn.get(scene.name, {})) for scene in study.scenes),
        _stability(study.stability),
        f'<h2 id="method">Method</h2><ul>{"".join(f"<li>{line}</li>" for line in method(study))}</ul>',
    ]
    body = "\n".join(parts)
    return (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>Sheaf: error against run time</title>'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<style>{STYLE}</style></head><body>\n{body}\n</body></html>\n"
    )


def _contents(study: Study) -> str:
    links = [(_anchor(scene), scene.name) for scene in study.scenes]
    links += [("stability", "Stability"), ("method", "Method")]
    items = "".join(f'<li><a href="#{escaped(anchor)}">{escaped(text)}</a></li>' for anchor, text in links)
    return f'<nav aria-label="Contents"><ul>{items}</ul></nav>'


def _anchor(scene: SceneStudy) -> str:
    return f"scene-{'-'.join(scene.name.split())}"


def _scene(scene: SceneStudy, drawn: Drawn) -> str:
    title = f'<h2 id="{escaped(_anchor(scene))}">{escaped(scene.name)}</h2>'
    if scene.failure:
        return f"{title}<p>Not measured: {escaped(scene.failure)}</p>"
    holds = scene.fastest.scene if scene.fastest else {}
    facts = ", ".join(
        f"{holds[name]:,} {name}" for name in ("triangles", "instances", "lights", "materials") if holds.get(name)
    )
    parts = [title, f"<p class=quiet>{escaped(facts)}</p>", _strip(scene)]
    parts += ["<h3>What an error costs</h3>", _figure(drawn, "error-time"), _figure(drawn, "error-tests")]
    parts += [_front(scene), "<h3>Ways to the same picture</h3>", _ways(scene)]
    parts += [_figure(drawn, stem) for stem in ("rays-per-second", "stages", "tests-per-ray")]
    parts += ["<h3>What sorting and rasterising save</h3>", _savings(scene), _figure(drawn, "tests-by-level")]
    if scene.skipped:
        parts.append(f"<p class=quiet>No time was left for: {escaped('; '.join(scene.skipped))}.</p>")
    return "\n".join(parts)


def _strip(scene: SceneStudy) -> str:
    figures = []
    for shown in pictures(scene):
        both = image(shown.picture, shown.caption)
        if shown.difference:
            both += image(shown.difference, f"difference of {shown.caption} from the reference")
        figures.append(f"<figure>{both}<figcaption>{escaped(shown.caption)}</figcaption></figure>")
    return f'<div class="strip">{"".join(figures)}</div>'


def _figure(drawn: Drawn, stem: str) -> str:
    if stem not in drawn:
        return ""
    words, light, dark = drawn[stem]
    return f"<figure>{image(light, words, dark)}<figcaption>{escaped(words)}</figcaption></figure>"


def _front(scene: SceneStudy) -> str:
    shown = [*scene.front(), *(trial for trial in scene.knobs if trial.point.name and trial.wall_ms)]
    distinct = {id(trial): trial for trial in shown}.values()
    front = {id(trial) for trial in scene.front()}
    body: list[list[Cell | str]] = []
    for trial in sorted(distinct, key=lambda trial: trial.median_ms or 0.0):
        errors = trial.errors
        if errors is None:  # what is on the front has them; a named setting may not
            continue
        name = f"{trial.point.name}: " if trial.point.name else ""
        mark = "front" if id(trial) in front else ""
        body.append(
            [
                Cell(name + trial.point.label, mark=mark),
                *_times(trial),
                Cell(short(trial.all_tests), True),
                number(errors.rmse),
                number(errors.relative_mse),
                number(errors.flip),
                number(errors.worst),
                f"({errors.worst_at[0]}, {errors.worst_at[1]})",
                "yes" if mark else "no",
            ]
        )
    head = ["settings", "ms", "spread", "tests", "RMSE", "rel. MSE", "FLIP", "worst", "at", "on front"]
    return table("The Pareto front of RMSE against time, and the named settings", head, body)


def _ways(scene: SceneStudy) -> str:
    body: list[list[Cell | str]] = []
    for trial in [*scene.strategies, *scene.budgets]:
        if trial.failure:
            body.append([trial.point.label, Cell(trial.failure, mark="bad"), *_EMPTY])
            continue
        rays = sum(trial.rays.values())
        rates = [_rate(trial.tests.get(kind, 0), trial.rays.get(kind, 0)) for kind in KINDS]
        saved = 1 - trial.all_tests / trial.brute_force if trial.brute_force else None
        row: list[Cell | str] = [trial.point.label, *_times(trial), number(trial.rays_per_second, ",.0f")]
        body.append([*row, number(trial.all_tests, ",d"), _rate(trial.all_tests, rays), *rates, number(saved, ".2%")])
    head = ["settings", "ms", "spread", "rays/s", "tests", "tests/ray", *KINDS, "saved of brute force"]
    return table("Rays per second, and tests per ray by kind; the picture is the same", head, body)


def _savings(scene: SceneStudy) -> str:
    body: list[list[Cell | str]] = []
    for saving in scene.savings:
        shares = [percent(saving.tests.get(kind)) for kind in ("all", *KINDS)]
        body.append([saving.part, saving.whole, saving.without, *shares, number(saving.speedup, ".2f")])
    head = ["part", "whole", "without it", "tests saved", *KINDS, "times as fast"]
    return table("Share of intersection tests that a part of the algorithm saves, by kind of ray", head, body)


def _stability(rows: Sequence[Stability]) -> str:
    body: list[list[Cell | str]] = []
    for row in rows:
        body.append(
            [
                row.scene,
                row.label,
                Cell(row.ended, mark="" if row.ended == "well" else "bad"),
                _verdict(row.finite),
                _verdict(row.same_again),
                number(row.other_pixels, "d", mark="bad" if row.other_pixels else ""),
                number(row.other_hits, "d"),
                number(row.worst),
            ]
        )
    head = ["scene", "settings", "ended", "finite", "same again", "other pixels", "other hits", "worst difference"]
    words = (
        "Pictures that should be equal, bit for bit. Other pixels: against the scene's first row with the same kind of "
        "camera rays. Other hits, worst difference: against double precision under the same settings."
    )
    return f'<h2 id="stability">Stability</h2>{table(words, head, body)}'


def _times(trial: Trial) -> list[Cell]:
    if not trial.wall_ms:
        return [Cell(NONE, True), Cell(NONE, True)]
    return [number(trial.median_ms, ".1f"), Cell(f"{min(trial.wall_ms):.1f} … {max(trial.wall_ms):.1f}", True)]


def _rate(tests: int, rays: int) -> Cell:
    return number(tests / rays if rays else None, ".1f")


def _verdict(value: bool | None) -> Cell:
    return Cell(NONE) if value is None else Cell("yes" if value else "no", mark="good" if value else "bad")
