# SPDX-License-Identifier: MIT
"""The event stream's parser and the decisions of following, without any I/O."""

from __future__ import annotations

import itertools

import pytest

import sheaf
from sheaf._watch import SILENCE_SECONDS, Listen, Poll, SseParser, Watch

STREAM = (
    b"\xef\xbb\xbf: hello\r\n\r\n"
    b'id: 1\r\nevent: state\r\ndata: {"state":\r\ndata: "running"}\r\n\r\n'
    b'data:{"a": "\xc3\xa4"}\n\n'
    b"id: 2\nevent: nothing\n\n"
    b'retry: 5\nid\nevent: frame\ndata: {"frame": 3}\n\n'
    b'id: 4\ndata: {"cut": '
)
EVENTS = [
    sheaf.Event("1", "state", {"state": "running"}),
    sheaf.Event("1", "message", {"a": "ä"}),
    sheaf.Event("", "frame", {"frame": 3}),  # an id without a value takes the last one back,
]


@pytest.mark.parametrize("size", [1, 2, 3, 7, 50, 1000])
def test_parses_however_it_is_cut(size: int) -> None:
    parser = SseParser()
    blocks = [STREAM[begin : begin + size] for begin in range(0, len(STREAM), size)]
    assert list(itertools.chain.from_iterable(map(parser.feed, blocks))) == EVENTS


def test_lone_carriage_returns_end_lines() -> None:
    assert list(SseParser().feed(b'id: 9\rdata: {"x": 1}\r\r:')) == [sheaf.Event("9", "message", {"x": 1})]


@pytest.mark.parametrize("data", [b"data: {\n\n", b"data: [1]\n\n", b"data: \xff\n\n"])
def test_refuses_what_is_no_object(data: bytes) -> None:
    with pytest.raises(sheaf.ProtocolError, match="event"):
        list(SseParser().feed(data))


def test_ends_with_the_jobs_state_not_with_a_frames() -> None:
    assert not sheaf.Event("1", "frame", {"frame": 3, "state": "done"}).ends_job
    assert not sheaf.Event("1", "state", {"state": "running"}).ends_job
    for state in ("done", "failed", "cancelled"):
        assert sheaf.Event("1", "state", {"state": state}).ends_job


def test_polls_near_the_deadline_and_never_beyond_it() -> None:
    watch = Watch(None, sheaf.RetryPolicy(), deadline=100.0)
    assert watch.next_step(0.0) == Listen()
    assert not watch.should_leave_stream(100.0 - SILENCE_SECONDS)
    assert watch.should_leave_stream(100.5 - SILENCE_SECONDS)
    assert watch.next_step(70.0) == Poll(20.0)
    assert watch.next_step(97.5) == Poll(2.5)
    assert watch.pause(5.0, 97.5) == 2.5
    with pytest.raises(sheaf.Timeout):
        watch.next_step(100.0)


def test_patience_begins_anew_with_every_event() -> None:
    watch = Watch(None, sheaf.RetryPolicy(first_pause=1.0, longest_pause=3.0, jitter=0.0, outage=6.0))
    lost = sheaf.TransportError("lost")
    assert [watch.lost(lost, streaming=True) for _ in range(3)] == [1.0, 2.0, 3.0]
    assert watch.next_step(0.0) == Poll(20.0)
    watch.heard(sheaf.Event("7", "state", {}))
    assert watch.last == "7"
    assert watch.next_step(0.0) == Listen()
    assert [watch.lost(lost, streaming=True) for _ in range(3)] == [1.0, 2.0, 3.0]
    with pytest.raises(sheaf.TransportError):
        watch.lost(lost, streaming=True)
    with pytest.raises(sheaf.NotFound):
        Watch(None, sheaf.RetryPolicy()).lost(sheaf.NotFound(404, "gone"), streaming=True)


def test_a_retry_after_is_kept_to_and_pauses_are_spread(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sheaf._http.random.random", lambda: 1.0)
    policy = sheaf.RetryPolicy(first_pause=1.0, jitter=0.25)
    assert policy.pause(1, sheaf.TransportError("lost")) == 0.75
    assert policy.pause(1, sheaf.Unavailable(503, "full", retry_after=7.0)) == 7.0
    assert Watch(None, policy).lost(sheaf.Unavailable(503, "full", retry_after=60.0), streaming=False) == 60.0
    assert policy.backoff(10_000) == 7.5
