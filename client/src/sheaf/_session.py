# SPDX-License-Identifier: MIT
"""Blocking I/O: sends the calls that `_calls` describes. `_async_session` is its asynchronous twin."""

from __future__ import annotations

import base64
import contextlib
import hashlib
import time
from collections.abc import Callable, Iterator
from typing import Any, TypeVar

import httpx

from ._errors import SheafError
from ._http import Call, Part, RetryPolicy, api_error, is_answer, translated
from ._version import __version__

T = TypeVar("T")


class Session:
    """Connections to one service, with its token, its time limits and its patience."""

    def __init__(
        self,
        url: str,
        token: str | None,
        timeout: float | httpx.Timeout,
        transport: httpx.BaseTransport | None,
        retry: RetryPolicy,
    ) -> None:
        self.retry = retry
        self._http = httpx.Client(
            base_url=checked_url(url), headers=own_headers(token), timeout=timeout, transport=transport
        )

    def close(self) -> None:
        """Closes all connections."""
        self._http.close()

    def sleep(self, seconds: float) -> None:
        """The only place that sleeps."""
        time.sleep(seconds)

    def now(self) -> float:
        """The clock of deadlines, seconds."""
        return time.monotonic()

    def call(self, call: Call[T]) -> T:
        """Sends and reads the answer, again where the policy says so."""
        return self.patiently(lambda: self.once(call))

    def patiently(self, action: Callable[[], T]) -> T:
        """Does something, again where it fails and the policy says so."""
        failures = 0
        while True:
            try:
                return action()
            except SheafError as error:
                failures += 1
                pause = self.retry.pause(failures, error)
                if pause is None:
                    raise
            self.sleep(pause)

    @contextlib.contextmanager
    def stream(self, call: Call[Any]) -> Iterator[httpx.Response]:
        """The answer with its body yet to be read; failures while reading it are translated too."""
        request = build_request(self._http, call)
        with translated(f"{call.method} {request.url}"):
            response = self._http.send(request, stream=True)
            try:
                if not is_answer(call, response):
                    response.read()
                    raise api_error(response)
                yield response
            finally:
                response.close()

    def once(self, call: Call[T]) -> T:
        """Sends and reads the answer, with one try."""
        with contextlib.ExitStack() as files:
            request = build_request(self._http, call, files)
            tell_digest(request, call)
            with translated(f"{call.method} {request.url}"):
                response = self._http.send(request)
        if not is_answer(call, response):
            raise api_error(response)
        return call.parse(response)


def checked_url(url: str) -> str:
    """The address of a service.

    Raises:
        ValueError: it is not an http or https one.
    """
    try:
        scheme = httpx.URL(url).scheme
    except httpx.InvalidURL as error:
        raise ValueError(f"{url!r}: {error}") from error
    if scheme not in ("http", "https"):
        raise ValueError(f"{url!r}: the service's address must begin with http:// or https://")
    return url


def own_headers(token: str | None) -> dict[str, str]:
    """What every request says."""
    headers = {"user-agent": f"sheaf-client/{__version__}", "accept": "application/json"}
    return headers | ({"authorization": f"Bearer {token}"} if token else {})


def build_request(
    http: httpx.Client | httpx.AsyncClient, call: Call[Any], files: contextlib.ExitStack | None = None
) -> httpx.Request:
    """The request of a call; its files are closed by `files`, and without it there are none."""
    multipart = [_opened(part, files) for part in call.parts] if files is not None else []
    request = http.build_request(
        call.method, call.path, params=call.params, headers=call.headers, files=multipart or None
    )
    if call.read_timeout is not None:
        request.extensions["timeout"]["read"] = call.read_timeout
    return request


def tell_digest(request: httpx.Request, call: Call[Any]) -> None:
    """Adds the checksum of an upload, for the service to hold against what arrives (RFC 9530). Reads its files once."""
    if not call.parts or not isinstance(request.stream, httpx.SyncByteStream):
        return
    digest = hashlib.sha256()
    for block in request.stream:
        digest.update(block)
    request.headers["content-digest"] = f"sha-256=:{base64.b64encode(digest.digest()).decode()}:"


def _opened(part: Part, files: contextlib.ExitStack) -> tuple[str, tuple[str | None, Any, str]]:
    content = part.open()
    if hasattr(content, "close"):
        files.callback(content.close)
    return part.field, (part.filename, content, part.content_type)
