# SPDX-License-Identifier: MIT
"""Whether every way to the picture gives the same one, each time, without a number that is none, and the right hits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ._errors import Picture
from ._measure import Trial

DEPTH_TOLERANCE = 1e-4
"""Relative difference in depth above which a pixel's hit counts as another one; the device computes in single."""


@dataclass(frozen=True)
class Stability:
    """A row of the table.

    Attributes:
        scene: its name.
        label: the settings.
        ended: "well", or the reason why not.
        finite: whether all pixels are numbers.
        same_again: whether a second run gave the same bytes; None where there was none.
        other_pixels: how many pixels differ, in any bit, from those of the first row with the same primary rays.
        other_hits: how many pixels see another object or depth than in double precision under the same settings.
        worst: largest difference of a channel from the picture in double precision under the same settings.
    """

    scene: str
    label: str
    ended: str
    finite: bool | None = None
    same_again: bool | None = None
    other_pixels: int | None = None
    other_hits: int | None = None
    worst: float | None = None

    @property
    def is_good(self) -> bool:
        """Whether there is nothing to explain; hits are, since double precision sees edges elsewhere."""
        return self.ended == "well" and self.finite is True and self.same_again is not False and not self.other_pixels


def stability(scene: str, trials: Sequence[Trial], exact: Trial | None) -> list[Stability]:
    """Rows for trials that should all give one picture; `exact` is that picture in double precision."""
    rows = []
    firsts: dict[object, Trial] = {}
    for trial in trials:
        if trial.failure or trial.picture is None:
            rows.append(Stability(scene, trial.point.label, trial.failure or "no picture"))
            continue
        first = firsts.setdefault(trial.point.settings.get("primary", "raster"), trial)
        other = differing_pixels(trial.picture, trial.picture if first.picture is None else first.picture)
        rows.append(_row(scene, trial, trial.picture, other, exact))
    return rows


def differing_pixels(picture: Picture, other: Picture) -> int:
    """Pixels that differ in any bit."""
    bits = [np.ascontiguousarray(image).view(np.uint32) for image in (picture, other)]
    return int((bits[0] != bits[1]).any(axis=2).sum())


def _row(scene: str, trial: Trial, picture: Picture, other: int, exact: Trial | None) -> Stability:
    worst = None
    if exact is not None and exact.picture is not None:
        worst = float(np.abs(picture.astype(np.float64) - exact.picture).max())
    return Stability(
        scene,
        trial.point.label,
        "well",
        finite=bool(np.isfinite(picture).all()),
        same_again=trial.same_again,
        other_pixels=other,
        other_hits=None if exact is None else other_hits(trial, exact),
        worst=worst,
    )


def other_hits(trial: Trial, exact: Trial) -> int | None:
    """Pixels whose object or depth is another; None where a layer is missing."""
    if not {"Z", "id.object"} <= set(trial.hits) & set(exact.hits):
        return None
    depth, right = (np.asarray(hits["Z"], np.float64) for hits in (trial.hits, exact.hits))
    seen = np.isfinite(depth) & np.isfinite(right)
    apart = np.isfinite(depth) != np.isfinite(right)
    with np.errstate(invalid="ignore"):
        apart |= seen & (np.abs(depth - right) > DEPTH_TOLERANCE * np.abs(right))
    return int((apart | (trial.hits["id.object"] != exact.hits["id.object"])).sum())
