# SPDX-License-Identifier: MIT
# Made by client/make_sync.py from _async_session.py: change that.
"""Sends the calls that `_calls` describes, and reads the answers."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterator
from typing import Any, TypeVar

import httpx

from ._errors import SheafError
from ._http import Call, RetryPolicy, api_error, is_answer, translated
from ._request import build_request, checked_url, own_headers, tell_digest
from ._workers import aside, sleep

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
        sleep(seconds)

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
            aside(tell_digest, request, call)
            with translated(f"{call.method} {request.url}"):
                response = self._http.send(request)
        if not is_answer(call, response):
            raise api_error(response)
        return call.parse(response)
