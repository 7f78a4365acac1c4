# SPDX-License-Identifier: MIT
"""How frames are shared out, without a cluster."""

from __future__ import annotations

import random

import pytest

from sheaf.farm._ledger import Chunk, FarmOptions, Ledger

OPTIONS = FarmOptions(chunk_seconds=10.0, least_late_seconds=5.0, least_timeout_seconds=1.0, retries=2)


def taken(ledger: Ledger, now: float = 0.0, workers: int = 1) -> Chunk:
    chunk = ledger.next_chunk(now, workers)
    assert chunk is not None
    return chunk


def test_the_first_chunks_measure_and_later_ones_take_their_time() -> None:
    ledger = Ledger(range(100), OPTIONS)
    first = taken(ledger)
    assert first.frames == (0,)
    assert first.timeout == 3600.0
    assert taken(ledger).frames == (1,)
    assert ledger.finished(first, first.frames, 2.0) == [0]
    assert ledger.seconds_a_frame == 2.0
    third = taken(ledger)
    assert third.frames == (2, 3, 4, 5, 6)  # 10 s
    assert third.timeout == 20 * 10.0
    assert ledger.eta(workers=2) == 99 * 2.0 / 2


def test_the_last_chunks_are_small() -> None:
    ledger = Ledger(range(9), OPTIONS)
    first = taken(ledger)
    ledger.finished(first, first.frames, 0.001)
    sizes = []
    while chunk := ledger.next_chunk(0.0, 2):
        sizes.append(len(chunk.frames))
    assert sizes == [2, 2, 1, 1, 1, 1]


def test_what_is_bad_about_one_frame_costs_that_frame() -> None:
    ledger = Ledger(range(5), OPTIONS)
    first = taken(ledger)
    ledger.finished(first, first.frames, 1.0)
    chunk = taken(ledger)
    assert chunk.frames == (1, 2)
    ledger.finished(chunk, (1,), 2.0)
    ledger.broke(chunk, "frame 2: NaN", 3)
    assert ledger.failed == {2: ("frame 2: NaN", 3)}
    while chunk := ledger.next_chunk(0.0, 1):  # type: ignore[assignment]
        ledger.finished(chunk, chunk.frames, 1.0)
    assert ledger.is_over
    assert ledger.done == 4


def test_a_bad_scene_ends_all_at_once() -> None:
    ledger = Ledger(range(1000), OPTIONS)
    ledger.broke(taken(ledger), "box.glb: no glTF", 3)
    assert ledger.is_over
    assert ledger.failed[999] == ("box.glb: no glTF", 3)
    assert ledger.next_chunk(0.0, 1) is None


def test_what_may_pass_is_tried_again_alone_and_not_for_ever() -> None:
    ledger = Ledger(range(6), OPTIONS)
    first = taken(ledger)
    ledger.finished(first, first.frames, 1.0)
    chunk = taken(ledger)
    assert len(chunk.frames) == 3
    ledger.broke(chunk, "device lost", 4)
    for _ in range(2):
        again = taken(ledger)
        assert again.frames == (1,)
        ledger.broke(again, "device lost", 4)
    assert ledger.failed == {1: ("device lost (tried 3 times)", 4)}
    assert ledger.retried == 2
    rest = taken(ledger)
    assert set(rest.frames) <= {2, 3, 4, 5}  # tried again, too, but not blamed


def test_where_a_worker_dies_all_its_frames_are_suspects() -> None:
    ledger = Ledger(range(6), OPTIONS)
    first = taken(ledger)
    ledger.finished(first, first.frames, 1.0)
    chunk = taken(ledger)
    ledger.broke(chunk, "killed", None, knows_frame=False)
    assert [taken(ledger).frames for _ in chunk.frames] == [(frame,) for frame in chunk.frames]


def test_a_late_chunk_gets_one_copy_and_the_first_counts() -> None:
    ledger = Ledger(range(4), OPTIONS)
    first = taken(ledger)
    ledger.finished(first, first.frames, 2.0)
    slow, other, last = (taken(ledger, 100.0, workers=2) for _ in range(3))
    ledger.finished(other, other.frames, 2.0)
    ledger.finished(last, last.frames, 2.0)
    assert ledger.next_chunk(105.9, 2) is None  # three times 2 s is late
    copy = taken(ledger, 106.1)
    assert copy.is_copy
    assert copy.frames == slow.frames
    assert ledger.next_chunk(999.0, 2) is None
    ledger.broke(slow, "timed out", None)
    assert not ledger.failed  # the copy is still at it
    assert ledger.next_chunk(999.0, 2) is None
    assert ledger.finished(copy, copy.frames, 2.0) == [1]
    assert ledger.finished(slow, slow.frames, 900.0) == []
    assert ledger.is_over
    assert ledger.copies == 1


def test_a_very_late_chunk_gets_a_copy_while_others_wait() -> None:
    ledger = Ledger(range(10), OPTIONS)
    first = taken(ledger)
    ledger.finished(first, first.frames, 1.0)
    slow = taken(ledger)
    assert ledger.late_chunk(29.0) is None
    copy = ledger.late_chunk(31.0)
    assert copy is not None
    assert copy.frames == slow.frames


def test_what_is_there_already_is_left_out() -> None:
    ledger = Ledger([1, 2, 3, 3], OPTIONS)
    ledger.already_there([1, 2, 3])
    assert ledger.is_over
    assert ledger.next_chunk(0.0, 1) is None


@pytest.mark.parametrize("seed", range(50))
def test_whatever_happens_every_frame_ends_once(seed: int) -> None:
    """Chunks that finish, finish in part, fail, die or are late, in any order."""
    chance = random.Random(seed)
    frames = range(chance.randrange(1, 60))
    bad = set(chance.sample(frames, min(len(frames), 3)))
    ledger = Ledger(frames, OPTIONS)
    flying: list[Chunk] = []
    told: list[int] = []
    now = 0.0
    for _ in range(5000):
        if ledger.is_over:
            break
        now += chance.random() * 4
        while len(flying) < 4 and (chunk := ledger.next_chunk(now, 2)):
            flying.append(chunk)
        if late := ledger.late_chunk(now):
            flying.append(late)
        if not flying:
            continue
        chunk = flying.pop(chance.randrange(len(flying)))
        fate = chance.random()
        good = [frame for frame in chunk.frames if frame not in bad]
        if fate < 0.1:
            ledger.broke(chunk, "killed", None, knows_frame=False)
        elif len(good) < len(chunk.frames):
            before = chunk.frames[: min(chunk.frames.index(frame) for frame in chunk.frames if frame in bad)]
            told += ledger.finished(chunk, before, 1.0)
            ledger.broke(chunk, "bad", 4)
        else:
            told += ledger.finished(chunk, chunk.frames, chance.random() * 5)
    assert ledger.is_over
    assert len(told) == len(set(told))
    assert set(told) | set(ledger.failed) == set(frames)
    assert not set(told) & set(ledger.failed)
