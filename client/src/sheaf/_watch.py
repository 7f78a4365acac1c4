# SPDX-License-Identifier: MIT
"""Following a job: server-sent events, and the decisions of when to listen, poll, pause or give up.

`Watch` decides and remembers; whoever drives it does the I/O, blocking or not:

    step = watch.next_step(now)    Listen: open the stream; Poll: ask once
    watch.heard(event)             for every event that came
    watch.quiet(seconds)           the exchange ended well after so long, but without news: seconds to pause
    watch.lost(error)              it broke: seconds to pause, or the error again once patience is over
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass

from ._errors import ProtocolError, SheafError, Timeout, Unavailable
from ._http import RetryPolicy, worth_trying_again
from ._models import Event

POLL_SECONDS = 20.0
"""The longest single poll; well below what proxies cut off."""

SILENCE_SECONDS = 45.0
"""A stream that is silent for longer (services send a comment much more often) is taken for lost."""

_BARREN_STREAMS = 2
"""Streams in a row without a single event, after which polling takes over: some proxies hold streams back."""


@dataclass(frozen=True)
class Listen:
    """Open the event stream."""


@dataclass(frozen=True)
class Poll:
    """Ask once, letting the service hold the answer for that long."""

    seconds: float


class Watch:
    """Where a caller is in a job's events.

    Args:
        after: id of the last event already known; None begins with the first.
        retry: its `outage` is the patience with lost connections, counted anew whenever something arrives.
        deadline: end of the caller's patience on the clock that `next_step` is given; None waits for ever.
    """

    def __init__(self, after: str | None, retry: RetryPolicy, deadline: float | None = None) -> None:
        self.last = after
        self._retry = retry
        self._deadline = deadline
        self._failures = 0
        self._paused = 0.0
        self._barren = 0

    def next_step(self, now: float) -> Listen | Poll:
        """What to do next. Near the deadline only polls, for a poll can end on time.

        Raises:
            Timeout: the deadline is over.
        """
        left = None if self._deadline is None else self._deadline - now
        if left is not None and left <= 0:
            raise Timeout("the job did not end in the time allowed; it goes on")
        if self._barren < _BARREN_STREAMS and not self._is_close(now):
            return Listen()
        return Poll(POLL_SECONDS if left is None else min(POLL_SECONDS, left))

    def should_leave_stream(self, now: float) -> bool:
        """Whether an open stream must be left for polling, so as not to wait in it beyond the deadline."""
        return self._is_close(now)

    def pause(self, seconds: float, now: float) -> float:
        """A pause that does not reach beyond the deadline."""
        return seconds if self._deadline is None else max(0.0, min(seconds, self._deadline - now))

    def heard(self, event: Event) -> None:
        """Notes an event: the next exchange goes on after it."""
        if event.id:
            self.last = event.id
        self._answered()
        self._barren = 0

    def skip_to(self, last: str | None) -> None:
        """Notes the id that a poll ended with; it may lie beyond the last event told."""
        self.last = last if last is not None else self.last

    def quiet(self, elapsed: float, *, streaming: bool) -> float:
        """Notes an exchange that ended well but without news.

        Gives the seconds to pause, so that a service that ends exchanges at once is not asked in a tight loop.
        """
        self._answered()
        if streaming:
            self._barren += 1
        return max(0.0, 1.0 - elapsed)

    def use_polls(self) -> None:
        """Notes that this service, or something before it, does not stream."""
        self._barren = _BARREN_STREAMS

    def lost(self, error: SheafError, *, streaming: bool) -> float:
        """Notes a failed exchange; gives the seconds to pause, or raises `error` once patience is over.

        A service that restarts keeps its jobs, so this is far more patient than a single call is.
        """
        self._failures += 1
        if streaming:
            self._barren += 1
        if not worth_trying_again(error) or self._paused >= self._retry.outage:
            raise error
        asked = error.retry_after if isinstance(error, Unavailable) else None
        pause = self._retry.backoff(self._failures) if asked is None else asked
        pause = min(pause, self._retry.outage - self._paused)
        self._paused += pause
        return pause

    def _answered(self) -> None:
        self._failures = 0
        self._paused = 0.0

    def _is_close(self, now: float) -> bool:
        return self._deadline is not None and self._deadline - now < SILENCE_SECONDS


class SseParser:
    """Turns the bytes of a text/event-stream body into events, however they are cut.

    An event that the end of the stream cuts short is dropped, as the standard asks: it will come again.
    """

    def __init__(self) -> None:
        self._buffer = b""
        self._fields: dict[str, list[str]] = {}
        self._id = ""
        self._started = False

    def feed(self, data: bytes) -> Iterator[Event]:
        """The events that `data` completes.

        Raises:
            ProtocolError: an event's data is not a JSON object.
        """
        self._buffer += data
        if not self._started and len(self._buffer) >= 3:
            self._buffer = self._buffer.removeprefix(b"\xef\xbb\xbf")
            self._started = True
        # A lone CR at the end may be half of CRLF: it waits for what follows.
        ready, self._buffer = _complete_lines(self._buffer)
        for line in ready:
            event = self._line(line.decode("utf-8", "replace"))
            if event is not None:
                yield event

    def _line(self, line: str) -> Event | None:
        if not line:
            return self._dispatch()
        name, _, value = line.partition(":")
        if name:  # a line that begins with a colon is a comment
            self._fields.setdefault(name, []).append(value.removeprefix(" "))
        return None

    def _dispatch(self) -> Event | None:
        fields, self._fields = self._fields, {}
        if fields.get("id") and "\0" not in fields["id"][-1]:
            self._id = fields["id"][-1]
        if "data" not in fields:
            return None
        try:
            body = json.loads("\n".join(fields["data"]))
        except ValueError as error:
            raise ProtocolError(f"event {self._id}: its data is not JSON ({error})") from error
        if not isinstance(body, dict):
            raise ProtocolError(f"event {self._id}: its data is not a JSON object")
        return Event(self._id, fields.get("event", [""])[-1] or "message", body)


def _complete_lines(data: bytes) -> tuple[list[bytes], bytes]:
    """Lines ended by CRLF, LF or CR, and the rest."""
    held = b"\r" if data.endswith(b"\r") else b""
    text = data[: len(data) - len(held)].replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    *lines, rest = text.split(b"\n")
    return lines, rest + held
