# SPDX-License-Identifier: MIT
"""Sends the calls that `_calls` describes, and reads the answers."""

from __future__ import annotations

import contextlib
import time
from collections.abc import AsyncIterator, Awaitable, Callable
from typing import Any, TypeVar

import httpx

from ._async_workers import aside, sleep
from ._errors import SheafError
from ._http import Call, RetryPolicy, api_error, is_answer, translated
from ._request import build_request, checked_url, own_headers, tell_digest

T = TypeVar("T")


class AsyncSession:
    """Connections to one service, with its token, its time limits and its patience."""

    def __init__(
        self,
        url: str,
        token: str | None,
        timeout: float | httpx.Timeout,
        transport: httpx.AsyncBaseTransport | None,
        retry: RetryPolicy,
    ) -> None:
        self.retry = retry
        self._http = httpx.AsyncClient(
            base_url=checked_url(url), headers=own_headers(token), timeout=timeout, transport=transport
        )

    async def close(self) -> None:
        """Closes all connections."""
        await self._http.aclose()

    async def sleep(self, seconds: float) -> None:
        """The only place that sleeps."""
        await sleep(seconds)

    def now(self) -> float:
        """The clock of deadlines, seconds."""
        return time.monotonic()

    async def call(self, call: Call[T]) -> T:
        """Sends and reads the answer, again where the policy says so."""
        return await self.patiently(lambda: self.once(call))

    async def patiently(self, action: Callable[[], Awaitable[T]]) -> T:
        """Does something, again where it fails and the policy says so."""
        failures = 0
        while True:
            try:
                return await action()
            except SheafError as error:
                failures += 1
                pause = self.retry.pause(failures, error)
                if pause is None:
                    raise
            await self.sleep(pause)

    @contextlib.asynccontextmanager
    async def stream(self, call: Call[Any]) -> AsyncIterator[httpx.Response]:
        """The answer with its body yet to be read; failures while reading it are translated too."""
        request = build_request(self._http, call)
        with translated(f"{call.method} {request.url}"):
            response = await self._http.send(request, stream=True)
            try:
                if not is_answer(call, response):
                    await response.aread()
                    raise api_error(response)
                yield response
            finally:
                await response.aclose()

    async def once(self, call: Call[T]) -> T:
        """Sends and reads the answer, with one try."""
        with contextlib.ExitStack() as files:
            request = build_request(self._http, call, files)
            await aside(tell_digest, request, call)
            with translated(f"{call.method} {request.url}"):
                response = await self._http.send(request)
        if not is_answer(call, response):
            raise api_error(response)
        return call.parse(response)
