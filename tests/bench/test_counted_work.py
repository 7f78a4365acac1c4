# SPDX-License-Identifier: MIT
"""A change that makes the engine do more, or less, is seen: counts of work are exactly those of counted_work.json.

Where more or less is meant, `tests/bench/counted_work.py --rewrite` writes that file; its diff tells the cost.
"""

from __future__ import annotations

import functools
import sys
from pathlib import Path
from typing import Any

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent))
sys.dont_write_bytecode = True

import counted_work  # noqa: E402

EXPECTED = counted_work.load_expected()


@functools.cache
def measured(case: str, strategy: str) -> list[dict[str, Any]]:
    """What this build does: counted once, for all tests."""
    return counted_work.count(case, strategy)


@pytest.fixture(scope="module", autouse=True)
def _same_device() -> None:
    found = counted_work.device()
    if found != EXPECTED["device"]:
        pytest.skip(f"counts are of {EXPECTED['device']}; this is {found}")


@pytest.mark.parametrize(("case", "strategy"), counted_work.cases())
def test_work_is_as_counted(case: str, strategy: str) -> None:
    expected = EXPECTED["work"].get(f"{case}, {strategy}")
    assert expected is not None, f"no counts of {case}, {strategy}: tests/bench/counted_work.py --rewrite"
    told = counted_work.differences(expected, measured(case, strategy))
    assert not told, "\n".join(["tests/bench/counted_work.py --rewrite, if this is meant:", *told])


@pytest.mark.parametrize("strategy", ["hybrid", "crsh"])
def test_threads_do_not_change_counts(strategy: str) -> None:
    one, three = (counted_work.count("cornell", strategy, threads) for threads in (1, 3))
    assert not counted_work.differences(one, three)


@pytest.mark.parametrize(
    ("case", "kind", "least"),
    [
        ("cornell", "shadow", 0.5),
        ("cornell", "reflection", 0.25),
        ("whitted", "shadow", 0.5),
        ("whitted", "reflection", 0.25),
    ],
)
def test_sorting_and_meshes_save_what_was_published(case: str, kind: str, least: float) -> None:
    """C, section 5: half of the tests of shadow rays and a quarter of those of reflection rays, against H."""
    for crsh, rsh in zip(measured(case, "crsh"), measured(case, "rsh"), strict=True):
        ours, theirs = (frame["tests"]["node_object"][kind] for frame in (crsh, rsh))
        assert 1 - ours / theirs >= least, f"{ours} against {theirs}"


def test_nothing_is_expected_that_is_not_counted() -> None:
    """A strategy that this build lacks may be missing; a case may not."""
    known = {case for case, _ in counted_work.cases()}
    assert {name.rsplit(", ", 1)[0] for name in EXPECTED["work"]} <= known


def test_differences_are_found() -> None:
    expected = {"rays": {"shadow": 100}, "pairs": [1, 2]}
    assert counted_work.differences(expected, {"rays": {"shadow": 110}, "pairs": [1, 2]}) == [
        "rays.shadow: 100 expected, 110 found (+10.00%)"
    ]
    assert counted_work.differences(expected, {"rays": {"shadow": 100}, "pairs": [1, 2, 3]})
    assert counted_work.differences(expected, {"rays": {}, "pairs": [1, 2]})
    assert counted_work.differences(None, expected)
    assert not counted_work.differences(expected, dict(expected))
