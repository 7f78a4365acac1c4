# SPDX-License-Identifier: MIT
"""What an HTTP exchange means, without doing any: calls, answers, errors, and when to try again.

Nothing here reads a socket or sleeps, so that a blocking and an asynchronous client can share it.
"""

from __future__ import annotations

import contextlib
import email.utils
import json
import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime, timezone
from typing import Any, Generic, TypeVar

import httpx

from ._errors import (
    ApiError,
    Conflict,
    DamagedUpload,
    InvalidRequest,
    NotFound,
    ProtocolError,
    SheafError,
    TooLarge,
    TransportError,
    Unauthorized,
    Unavailable,
)

T = TypeVar("T")

_BY_STATUS: dict[int, type[ApiError]] = {
    400: InvalidRequest,
    401: Unauthorized,
    403: Unauthorized,
    404: NotFound,
    409: Conflict,
    410: NotFound,
    413: TooLarge,
    422: InvalidRequest,
}


@dataclass(frozen=True)
class Part:
    """One part of a multipart body; `open` gives a fresh readable file or the bytes, once for every try."""

    field: str
    filename: str | None
    content_type: str
    open: Callable[[], Any]


@dataclass(frozen=True)
class Call(Generic[T]):
    """A request and how to read its answer. All of them may be sent twice: POST carries an Idempotency-Key."""

    method: str
    path: str
    parse: Callable[[httpx.Response], T]
    params: Mapping[str, str] = field(default_factory=dict)
    headers: Mapping[str, str] = field(default_factory=dict)
    parts: Sequence[Part] = ()
    accept: frozenset[int] = frozenset()
    """Statuses beside 2xx that are answers, not refusals."""
    read_timeout: float | None = None
    """Seconds of silence to bear, where other than the client's."""


@dataclass(frozen=True)
class RetryPolicy:
    """When a call is tried again: after a lost connection, 429 or 503.

    Attributes:
        attempts: tries in all, at least 1.
        first_pause: seconds before the second try; doubles with every further one.
        longest_pause: seconds; also the longest Retry-After that is waited for. A longer one is raised.
        jitter: share of a pause, 0 ... 1, by which it is shortened at random, so that many clients that lost the same
            service do not all come back at once. A Retry-After is never shortened.
        outage: seconds without any answer that waiting for a job bears, for example while the service restarts.
    """

    attempts: int = 4
    first_pause: float = 0.25
    longest_pause: float = 10.0
    jitter: float = 0.25
    outage: float = 300.0

    def pause(self, failures: int, error: SheafError) -> float | None:
        """Seconds to wait after the given number of failures in a row; None: give up and raise `error`."""
        if failures >= self.attempts or not worth_trying_again(error):
            return None
        if isinstance(error, Unavailable) and error.retry_after is not None:
            return error.retry_after if error.retry_after <= self.longest_pause else None
        return self.backoff(failures)

    def backoff(self, failures: int) -> float:
        """Seconds after the given number of failures in a row, where nobody says how many."""
        doublings = min(failures - 1, 60)
        longest = min(self.first_pause * 2.0**doublings, self.longest_pause)
        return longest * (1.0 - self.jitter * random.random())  # noqa: S311 - no secret


def worth_trying_again(error: SheafError) -> bool:
    """Whether the same call may do better later."""
    return isinstance(error, (TransportError, Unavailable, DamagedUpload))


def api_error(response: httpx.Response) -> ApiError:
    """The exception for a problem answer whose body has been read."""
    problem: dict[str, Any] = {}
    with contextlib.suppress(ValueError):
        body = json.loads(response.content)
        problem = body if isinstance(body, dict) else {}
    title = str(problem.pop("title", "") or response.reason_phrase or "Error")
    detail = str(problem.pop("detail", "") or "")
    kind = str(problem.pop("type", "") or "about:blank")
    problem.pop("status", None)
    status = response.status_code
    if status in (429, 503):
        pause = retry_after(response.headers.get("retry-after"), datetime.now(timezone.utc))
        return Unavailable(status, title, detail, type=kind, extra=problem, retry_after=pause)
    if kind.endswith("digest-mismatch"):
        return DamagedUpload(status, title, detail, type=kind, extra=problem)
    if kind.endswith("limit-exceeded"):
        return TooLarge(status, title, detail, type=kind, extra=problem)
    return _BY_STATUS.get(status, ApiError)(status, title, detail, type=kind, extra=problem)


def retry_after(value: str | None, now: datetime) -> float | None:
    """Seconds that a Retry-After header asks for: a number of them, or an HTTP date."""
    if value is None:
        return None
    if value.strip().isdigit():
        return float(value)
    try:
        when = email.utils.parsedate_to_datetime(value)
    except ValueError:
        return None
    if when.tzinfo is None:  # "-0000": the sender does not say; HTTP dates are UTC
        when = when.replace(tzinfo=timezone.utc)
    return max(0.0, (when - now).total_seconds())


@contextlib.contextmanager
def translated(what: str) -> Iterator[None]:
    """Turns httpx's failures into ours, naming what was asked."""
    try:
        yield
    except httpx.TimeoutException as error:
        kind = "could not connect" if isinstance(error, httpx.ConnectTimeout) else "no answer"
        raise TransportError(f"{what}: {kind} in the time allowed") from error
    except httpx.UnsupportedProtocol as error:
        raise ValueError(f"{what}: the service's URL must begin with http:// or https://") from error
    except httpx.TransportError as error:
        raise TransportError(f"{what}: {str(error) or type(error).__name__}") from error
    except httpx.DecodingError as error:
        raise TransportError(f"{what}: the answer's encoding is broken ({error})") from error


def is_answer(call: Call[Any], response: httpx.Response) -> bool:
    """Whether the service did what it was asked to."""
    return response.is_success or response.status_code in call.accept


def json_object(response: httpx.Response) -> dict[str, Any]:
    """The answer's JSON object.

    Raises:
        ProtocolError: it is something else.
    """
    try:
        body = json.loads(response.content)
    except ValueError as error:
        raise ProtocolError(f"{response.request.url}: the answer is not JSON ({error})") from error
    if not isinstance(body, dict):
        raise ProtocolError(f"{response.request.url}: the answer is not a JSON object")
    return body


def whole_body(response: httpx.Response) -> bytes:
    """The answer's bytes, exactly as many as it announced.

    Raises:
        TransportError: fewer or more came.
    """
    check_length(response, len(response.content))
    return response.content


def check_length(response: httpx.Response, received: int) -> None:
    """Raises TransportError where an unencoded answer announced a length other than `received` bytes."""
    announced = response.headers.get("content-length")
    if announced is None or response.headers.get("content-encoding", "identity") != "identity":
        return
    if announced.isdigit() and int(announced) != received:
        raise TransportError(f"{response.request.url}: {received} of {announced} bytes came")
