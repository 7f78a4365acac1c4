# SPDX-License-Identifier: MIT
"""What the service says, as types. Fields that a newer service adds are kept in `raw` and otherwise ignored."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal, TypeVar, cast, get_args

from ._errors import ProtocolError

JobState = Literal["queued", "running", "done", "failed", "cancelled"]
TERMINAL: frozenset[str] = frozenset({"done", "failed", "cancelled"})

T = TypeVar("T")


@dataclass(frozen=True)
class Progress:
    """How far a job is.

    Attributes:
        state: the job's state.
        done: frames that are whole.
        total: frames in all; 0 until the scene has been looked at.
        fraction: 0 ... 1, parts of frames included where the service knows them.
        eta_s: seconds left as the service estimates them; None where it does not know.
    """

    state: JobState
    done: int = 0
    total: int = 0
    fraction: float = 0.0
    eta_s: float | None = None


@dataclass(frozen=True)
class FrameState:
    """One frame of a job.

    Attributes:
        frame: its number.
        state: "done"; "pending" while it may still come; "missing" where the job ended without it.
        name: the file name that the service gave it.
        bytes: length of the EXR file.
        sha256: of the EXR file, in hexadecimal.
    """

    frame: int
    state: str
    name: str | None = None
    bytes: int | None = None
    sha256: str | None = None


@dataclass(frozen=True)
class JobInfo:
    """A job as the service last described it.

    Attributes:
        id: the job's name in all routes.
        state: queued, running, done, failed or cancelled.
        progress: how far it is.
        frames: each frame's state, in rendering order.
        settings: the settings in force, defaults resolved.
        error: `code` and `message` where the job failed.
        cancel_requested: whether it will be cancelled once the renderer has stopped.
        warnings: what the renderer warned of.
        created: when it was submitted, RFC 3339.
        expires: when the service will remove it; None where it will not.
        raw: the whole answer.
    """

    id: str
    state: JobState
    progress: Progress
    frames: Sequence[FrameState] = ()
    settings: Mapping[str, Any] = field(default_factory=dict)
    error: Mapping[str, Any] | None = None
    cancel_requested: bool = False
    warnings: Sequence[str] = ()
    created: str | None = None
    expires: str | None = None
    raw: Mapping[str, Any] = field(default_factory=dict, repr=False)

    @property
    def is_over(self) -> bool:
        """Whether nothing more will happen."""
        return self.state in TERMINAL

    @property
    def rendered(self) -> list[int]:
        """Numbers of the frames that can be fetched."""
        return [frame.frame for frame in self.frames if frame.state == "done"]

    def after(self, event: Event) -> JobInfo:
        """What is known once an event has been heard."""
        news = event.data
        is_jobs = "frame" not in news and "state" in news  # a frame's event has a state too, but it is the frame's
        state = job_state(news["state"], "event.state") if is_jobs else self.state
        counts = _mapping(news, "progress") or news
        told = progress_of(state, counts)
        if "done" not in counts or told.done < self.progress.done:  # no news of it, or from before the last answer
            told = replace(self.progress, state=state)
        return replace(self, state=state, progress=told)

    @classmethod
    def from_json(cls, body: Mapping[str, Any]) -> JobInfo:
        """Reads a job object.

        Raises:
            ProtocolError: a field is missing or of another type; the text names it.
        """
        state = job_state(body.get("state"), "job.state")
        frames = [_frame_state(index, entry) for index, entry in enumerate(_list(body, "frames"))]
        return cls(
            id=_get(body, "id", str, "job"),
            state=state,
            progress=progress_of(state, _mapping(body, "progress")),
            frames=frames,
            settings=_mapping(body, "settings"),
            error=_mapping(body, "error") or None,
            cancel_requested=body.get("cancel_requested") is True,
            warnings=[str(warning) for warning in _list(body, "warnings")],
            created=_optional(body, "created", str, "job"),
            expires=_optional(body, "expires", str, "job"),
            raw=dict(body),
        )


@dataclass(frozen=True)
class JobPage:
    """A page of the list of jobs; `next` is the cursor of the one after it."""

    jobs: Sequence[JobInfo]
    next: str | None

    @classmethod
    def from_json(cls, body: Mapping[str, Any]) -> JobPage:
        """Reads a page."""
        following = body.get("next") or body.get("next_cursor")
        return cls([JobInfo.from_json(entry) for entry in _list(body, "jobs")], str(following) if following else None)


@dataclass(frozen=True)
class Event:
    """Something that happened to a job.

    Attributes:
        id: where to go on after it (`Job.events(after=...)`).
        type: the kind, for example "state", "frame" or "progress".
        data: what happened.
    """

    id: str
    type: str
    data: Mapping[str, Any]

    @property
    def ends_job(self) -> bool:
        """Whether this is the job's last event; a frame's event has a state too, but it is the frame's."""
        return "frame" not in self.data and self.data.get("state") in TERMINAL

    @classmethod
    def from_json(cls, body: Mapping[str, Any]) -> Event:
        """Reads an entry of a long poll's list."""
        identity = body.get("id")
        if isinstance(identity, bool) or not isinstance(identity, (str, int)):
            raise ProtocolError(f"event.id: {identity!r}")
        return cls(str(identity), str(body.get("event") or body.get("type") or "message"), _mapping(body, "data"))


@dataclass(frozen=True)
class EventPage:
    """What a long poll brought; `last` is the id to go on after."""

    events: Sequence[Event]
    last: str | None

    @classmethod
    def from_json(cls, body: Mapping[str, Any]) -> EventPage:
        """Reads a long poll's answer."""
        last = body.get("last")
        return cls([Event.from_json(entry) for entry in _list(body, "events")], None if last is None else str(last))


def progress_of(state: JobState, body: Mapping[str, Any]) -> Progress:
    """Reads a progress object."""
    done, total = (_get(body, name, int, "progress", 0) for name in ("done", "total"))
    share = done / total if total else 0.0
    fraction = min(1.0, max(0.0, _get(body, "fraction", float, "progress", share)))
    return Progress(state, done, total, fraction, _optional(body, "eta_s", float, "progress"))


def job_state(value: Any, place: str) -> JobState:
    """Checks a job's state."""
    if value not in get_args(JobState):
        raise ProtocolError(f"{place}: {value!r} is not a job's state")
    return cast(JobState, value)


def _frame_state(index: int, entry: Any) -> FrameState:
    place = f"job.frames[{index}]"
    if not isinstance(entry, Mapping):
        raise ProtocolError(f"{place}: not an object")
    return FrameState(
        _get(entry, "frame", int, place),
        _get(entry, "state", str, place),
        name=_optional(entry, "name", str, place),
        bytes=_optional(entry, "bytes", int, place),
        sha256=_optional(entry, "sha256", str, place),
    )


def _get(body: Mapping[str, Any], name: str, kind: Callable[[Any], T], place: str, default: T | None = None) -> T:
    value = body.get(name)
    value = default if value is None else value
    accepted = (int, float) if kind is float else (kind,)
    if isinstance(value, bool) or not isinstance(value, accepted):  # type: ignore[arg-type]
        raise ProtocolError(f"{place}.{name}: {value!r}")
    return kind(value)


def _optional(body: Mapping[str, Any], name: str, kind: Callable[[Any], T], place: str) -> T | None:
    return None if body.get(name) is None else _get(body, name, kind, place)


def _list(body: Mapping[str, Any], name: str) -> list[Any]:
    value = body.get(name)
    if value is None:
        return []
    if not isinstance(value, list):
        raise ProtocolError(f"{name}: not a list")
    return value


def _mapping(body: Mapping[str, Any], name: str) -> dict[str, Any]:
    value = body.get(name)
    if value is None:
        return {}
    if not isinstance(value, dict):
        raise ProtocolError(f"{name}: not an object")
    return value
