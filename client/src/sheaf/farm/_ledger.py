# SPDX-License-Identifier: MIT
"""Which frames are still to be rendered, in chunks of what size, and what a failure means for them.

Nothing here talks to a cluster: it is told what happened and says what to do, so that it can be tested without one.

- The first chunks are single frames, which measure; later ones take about `chunk_seconds`, and less towards the end, so
  that all workers finish together.
- Where a chunk fails, the frames that are whole by then count. The first of the others was being rendered: it is to
  blame, and is tried again alone; the rest goes back to the queue.
- What is bad about the input (exit codes 2, 3, 5) is so on every machine and is not tried again. All else (device lost,
  disk full, killed, timed out) is, `retries` times per frame.
- A chunk that is far later than its like gets a copy on another worker; the first to be done counts.
"""

from __future__ import annotations

import itertools
import math
import statistics
from collections import deque
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

PERMANENT = frozenset({2, 3, 5})
"""Exit codes of `sheaf` that another try does not mend: usage, input, limit."""

_REMEMBERED = 25
_NOTHING_YET = "no frame is done"


@dataclass(frozen=True)
class FarmOptions:
    """How frames are shared out.

    Attributes:
        chunk_seconds: about how long a chunk takes a worker: long enough that starting the program and loading the
            scene matter little, short enough that little is lost with a worker.
        largest_chunk: frames, however fast they are.
        retries: further tries of a frame that failed for a reason that may pass.
        late_factor: a chunk that takes this many times as long as its like is late, and gets a copy.
        least_late_seconds: no chunk is late before that.
        frame_seconds: what the first frame may take, while nothing is known; the program is ended then.
        timeout_factor: what a chunk may take, as a multiple of what its like takes, once that is known.
        least_timeout_seconds: no program is ended before that.
    """

    chunk_seconds: float = 60.0
    largest_chunk: int = 1000
    retries: int = 3
    late_factor: float = 3.0
    least_late_seconds: float = 60.0
    frame_seconds: float = 3600.0
    timeout_factor: float = 20.0
    least_timeout_seconds: float = 300.0


@dataclass(frozen=True)
class Chunk:
    """Frames that one worker renders in one go; `timeout` in seconds."""

    id: int
    frames: tuple[int, ...]
    timeout: float
    is_copy: bool = False


@dataclass
class _Flight:
    chunk: Chunk
    begun: float
    expected: float | None
    has_copy: bool = False


@dataclass
class Ledger:
    """Who has what, and what is left.

    Attributes:
        frames: all that are wanted.
        options: how they are shared out.
        failed: reasons of the frames that are given up, with the program's exit code where there is one.
        retried: how often a frame was tried again.
        copies: how many chunks were late.
    """

    frames: Sequence[int]
    options: FarmOptions = field(default_factory=FarmOptions)
    failed: dict[int, tuple[str, int | None]] = field(default_factory=dict)
    retried: int = 0
    copies: int = 0

    def __post_init__(self) -> None:
        self._pending: deque[int] = deque(dict.fromkeys(self.frames))
        self._alone: deque[int] = deque()
        self._tries: dict[int, int] = {}
        self._flights: dict[int, _Flight] = {}
        self._done: set[int] = set()
        self._seconds: deque[float] = deque(maxlen=_REMEMBERED)
        self._ids = itertools.count()

    @property
    def is_over(self) -> bool:
        """Whether every frame is done or given up."""
        return len(self._done) + len(self.failed) == len(set(self.frames))

    @property
    def done(self) -> int:
        """How many frames are done."""
        return len(self._done)

    @property
    def seconds_a_frame(self) -> float | None:
        """What a frame takes a worker, starting and loading included; None while none is done."""
        return statistics.median(self._seconds) if self._seconds else None

    def eta(self, workers: int) -> float | None:
        """Seconds left, as far as one can tell."""
        left = len(set(self.frames)) - len(self._done) - len(self.failed)
        each = self.seconds_a_frame
        return None if each is None else left * each / max(1, workers)

    def already_there(self, frames: Iterable[int]) -> None:
        """Notes frames that are whole from an earlier run."""
        there = set(frames)
        self._done |= there
        self._pending = deque(frame for frame in self._pending if frame not in there)

    def next_chunk(self, now: float, workers: int) -> Chunk | None:
        """What to hand to a worker that has nothing to do; None: nothing now."""
        if self._alone:
            return self._begin((self._alone.popleft(),), now)
        if not self._pending:
            return self._copy(now)
        size = min(self._size(workers), len(self._pending))
        return self._begin(tuple(self._pending.popleft() for _ in range(size)), now)

    def late_chunk(self, now: float) -> Chunk | None:
        """A copy of a chunk that is so late that its worker may be lost, even if nobody is idle."""
        return self._copy(now, 2.0)

    def finished(self, chunk: Chunk, whole: Iterable[int], seconds: float) -> list[int]:
        """Notes frames that are whole; gives those that were not before."""
        self._flights.pop(chunk.id, None)
        new = [frame for frame in whole if frame not in self._done]
        self._done |= set(new)
        for frame in new:
            self.failed.pop(frame, None)
        self._alone = deque(frame for frame in self._alone if frame not in self._done)
        self._pending = deque(frame for frame in self._pending if frame not in self._done)
        if new and len(new) == len(chunk.frames):
            self._seconds.append(seconds / len(new))
        return new

    def broke(self, chunk: Chunk, reason: str, exit_code: int | None, *, knows_frame: bool = True) -> None:
        """Notes that what of the chunk is not whole failed.

        Args:
            chunk: which.
            reason: why.
            exit_code: the program's; None where it had none.
            knows_frame: whether the first frame that is not whole is the one to blame. It is not where the worker is
                gone with all it knew: then all are.
        """
        self._flights.pop(chunk.id, None)
        left = [frame for frame in chunk.frames if frame not in self._done and frame not in self.failed]
        left = [frame for frame in left if not self._is_elsewhere(frame)]
        if exit_code in PERMANENT and not self._done and len(chunk.frames) == len(left):
            self._give_up(f"{reason} ({_NOTHING_YET})" if len(left) > 1 else reason, exit_code)
            return
        for index, frame in enumerate(left):
            if index and knows_frame:
                self._pending.appendleft(frame)
                continue
            if exit_code in PERMANENT:
                self.failed[frame] = (reason, exit_code)
                continue
            self._tries[frame] = self._tries.get(frame, 0) + 1
            if self._tries[frame] > self.options.retries:
                self.failed[frame] = (f"{reason} (tried {self._tries[frame]} times)", exit_code)
            else:
                self.retried += 1
                self._alone.append(frame)

    def _is_elsewhere(self, frame: int) -> bool:
        """Whether a copy still renders it, or it waits already."""
        flying = any(frame in flight.chunk.frames for flight in self._flights.values())
        return flying or frame in self._alone or frame in self._pending

    def _give_up(self, reason: str, exit_code: int | None) -> None:
        for frame in self.frames:
            self.failed.setdefault(frame, (reason, exit_code))
        self._pending.clear()
        self._alone.clear()

    def _size(self, workers: int) -> int:
        each = self.seconds_a_frame
        if each is None:
            return 1
        by_time = max(1, int(self.options.chunk_seconds / max(each, 1e-6)))
        # Halves of what is left a worker, so that the last chunks are small and all workers end together.
        by_share = math.ceil(len(self._pending) / (2 * max(1, workers)))
        return max(1, min(by_time, by_share, self.options.largest_chunk))

    def _begin(self, frames: tuple[int, ...], now: float, *, is_copy: bool = False) -> Chunk:
        each = self.seconds_a_frame
        expected = None if each is None else each * len(frames)
        timeout = self.options.frame_seconds * len(frames)
        if expected is not None:
            timeout = max(self.options.least_timeout_seconds, self.options.timeout_factor * expected)
        chunk = Chunk(next(self._ids), frames, timeout, is_copy)
        self._flights[chunk.id] = _Flight(chunk, now, expected, has_copy=is_copy)
        return chunk

    def _copy(self, now: float, factor: float = 1.0) -> Chunk | None:
        for flight in sorted(self._flights.values(), key=lambda flight: flight.begun):
            left = tuple(frame for frame in flight.chunk.frames if frame not in self._done)
            each = self.seconds_a_frame
            if flight.has_copy or each is None or not left:
                continue
            usual = flight.expected if flight.expected is not None else each * len(flight.chunk.frames)
            limit = max(self.options.least_late_seconds, self.options.late_factor * usual)
            if now - flight.begun > factor * limit:
                flight.has_copy = True
                self.copies += 1
                return self._begin(left, now, is_copy=True)
        return None
