# SPDX-License-Identifier: MIT
"""The evaluation that the published algorithm asks for.

Rays per second, and how many tests sorting and rasterising save. Under the same picture: every strategy finds the same
hits, so that only the way to them differs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ._measure import KINDS, Trial
from ._plan import Settings

# Whole algorithm, and the same without one of its parts.
_COMPARISONS: tuple[tuple[str, Settings, Settings], ...] = (
    ("sorting, in crsh", {"strategy": "crsh", "sort": "on"}, {"strategy": "crsh", "sort": "off"}),
    ("sorting, crsh against rsh", {"strategy": "crsh", "sort": "on"}, {"strategy": "rsh"}),
    ("sorting, in hybrid", {"strategy": "hybrid", "sort": "on"}, {"strategy": "hybrid", "sort": "off"}),
    (
        "rasterising, in crsh",
        {"strategy": "crsh", "sort": "on"},
        {"strategy": "crsh", "sort": "on", "primary": "trace"},
    ),
    (
        "rasterising, in hybrid",
        {"strategy": "hybrid", "sort": "on"},
        {"strategy": "hybrid", "sort": "on", "primary": "trace"},
    ),
    ("rasterising, in bvh", {"strategy": "bvh"}, {"strategy": "bvh", "primary": "trace"}),
    ("the rays' hierarchy, hybrid against bvh", {"strategy": "hybrid", "sort": "on"}, {"strategy": "bvh"}),
)


@dataclass(frozen=True)
class Saving:
    """What a part of the algorithm saves.

    Attributes:
        part: which.
        whole: label of the algorithm with it.
        without: label of the algorithm without it.
        tests: share of tests saved, by kind of ray and under "all"; negative where it costs some; None without tests.
        speedup: wall-clock time without over time with it.
        by_level: tests with and without by kind and level of the rays' hierarchy, the root's level first.
    """

    part: str
    whole: str
    without: str
    tests: dict[str, float | None]
    speedup: float | None
    by_level: dict[str, tuple[list[int], list[int]]]


def savings(trials: Sequence[Trial]) -> list[Saving]:
    """All comparisons whose two sides were measured."""
    found = []
    by_settings = {tuple(sorted(trial.point.settings.items(), key=str)): trial for trial in trials if not trial.failure}
    for part, whole, without in _COMPARISONS:
        pair = [by_settings.get(tuple(sorted(side.items(), key=str))) for side in (whole, without)]
        if pair[0] and pair[1]:
            found.append(_saving(part, pair[0], pair[1]))
    return found


def _saving(part: str, whole: Trial, without: Trial) -> Saving:
    counts = {kind: (whole.tests.get(kind, 0), without.tests.get(kind, 0)) for kind in KINDS}
    counts["all"] = (whole.all_tests, without.all_tests)
    levels = {kind: (whole.tests_by_level.get(kind, []), without.tests_by_level.get(kind, [])) for kind in KINDS}
    speedup = None if not (whole.median_ms and without.median_ms) else without.median_ms / whole.median_ms
    return Saving(
        part,
        whole.point.label,
        without.point.label,
        {kind: 1 - ours / theirs if theirs else None for kind, (ours, theirs) in counts.items()},
        speedup,
        {kind: pair for kind, pair in levels.items() if any(pair)},
    )
