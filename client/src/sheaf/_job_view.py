# SPDX-License-Identifier: MIT
"""What a blocking and an asynchronous job have in common: what they know, and how their end is judged."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator

from ._errors import JobCancelled, JobFailed, ProtocolError
from ._models import JobInfo, JobState, Progress
from ._progress import ProgressBar

Reporter = Callable[[Progress], object]


class JobView:
    """What the service said last about a job."""

    def __init__(self, info: JobInfo) -> None:
        self.info = info

    def __repr__(self) -> str:
        progress = self.progress
        return f"{type(self).__name__}({self.id!r}, {self.state!r}, {progress.done} of {progress.total} frames)"

    @property
    def id(self) -> str:
        """The job's name on the service."""
        return self.info.id

    @property
    def state(self) -> JobState:
        """queued, running, done, failed or cancelled, as of the last answer."""
        return self.info.state

    @property
    def progress(self) -> Progress:
        """How far the job was at the last answer."""
        return self.info.progress


def unless_bad(info: JobInfo) -> None:
    """Raises what a job that is over but not done stands for."""
    if info.state == "failed":
        error = info.error or {}
        code, message = (str(error.get(name) or "unknown") for name in ("code", "message"))
        exit_code = error.get("exit_code")
        raise JobFailed(info.id, code, message, exit_code if isinstance(exit_code, int) else None)
    if info.state == "cancelled":
        raise JobCancelled(info.id)
    if info.state != "done":
        raise ProtocolError(f"job {info.id}: its events ended, but it is {info.state}")


@contextlib.contextmanager
def reporting(progress: Reporter | bool | None) -> Iterator[Reporter]:
    """What to call with progress: the caller's own, a bar that is closed at the end, or nothing."""
    bar = ProgressBar() if progress is True else None
    try:
        yield bar.update if bar else progress if callable(progress) else _no_report
    finally:
        if bar:
            bar.close()


def _no_report(_: Progress) -> None:
    pass
