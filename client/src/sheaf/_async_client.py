# SPDX-License-Identifier: MIT
"""The client of one service."""

from __future__ import annotations

import uuid
from collections.abc import AsyncIterator
from types import TracebackType
from typing import TYPE_CHECKING, Any

import httpx

from . import _calls
from ._async_job import AsyncJob
from ._async_session import AsyncSession
from ._calls import CameraSource, SceneSource
from ._http import RetryPolicy
from ._models import JobState
from ._settings import RenderSettings

if TYPE_CHECKING:
    from typing_extensions import Unpack


class AsyncClient:
    """Talks to one sheafd. An async context manager; connections are kept and reused until it closes.

    ::

        async with AsyncClient("http://127.0.0.1:8080") as client:
            job = await client.submit("box.glb", frames="0-23", size="640x360")
            await job.wait(progress=True)
            async for frame in job.frames():
                print(frame.number, frame.rgba.mean())

    Args:
        url: the service's address; a path in it is kept, for services behind a proxy.
        token: bearer token, where the service wants one.
        timeout: seconds of silence in any one exchange (not in `AsyncJob.wait`), or an `httpx.Timeout`.
        transport: an httpx transport to use in place of the network, such as `httpx.MockTransport`.
        retry: when to try again; the default rides out a few seconds.

    Raises:
        ValueError: the address is not an http or https one.
    """

    def __init__(
        self,
        url: str,
        *,
        token: str | None = None,
        timeout: float | httpx.Timeout = 30.0,
        transport: httpx.AsyncBaseTransport | None = None,
        retry: RetryPolicy | None = None,
    ) -> None:
        self._session = AsyncSession(url, token, timeout, transport, retry or RetryPolicy())

    async def __aenter__(self) -> AsyncClient:
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self.close()

    async def close(self) -> None:
        """Closes all connections; jobs go on."""
        await self._session.close()

    async def submit(
        self,
        scene: SceneSource,
        camera: CameraSource | None = None,
        *,
        idempotency_key: str | None = None,
        **settings: Unpack[RenderSettings],
    ) -> AsyncJob:
        """Sends a scene to be rendered.

        Args:
            scene: a .glb or .gltf file, sent with the buffers and images beside it; a .zip; or the bytes of one.
            camera: a camera path: its file, its document, or a `CameraPath`; None takes the scene's first camera.
            idempotency_key: the same key and the same job gives the job that is there already. Every call without
                one has a key of its own, so that trying again never makes a second job.
            settings: as `RenderSettings` lists them: frames, size, fps, animation, spp, depth, strategy, aov, ...

        Returns:
            The job, queued or running.

        Raises:
            SceneError: the scene or camera cannot be read, or a file that it needs is not beside it.
            InvalidRequest: the service finds settings, scene or camera bad.
            TooLarge: a limit was exceeded.
            Unavailable: the service takes no jobs now.
            TypeError: a setting has an unknown name.
        """
        call = _calls.submit(scene, camera, settings, idempotency_key or uuid.uuid4().hex)
        return AsyncJob(self._session, await self._session.call(call))

    async def job(self, job_id: str) -> AsyncJob:
        """A job by its id.

        Raises:
            NotFound: there is none, or no more.
        """
        return AsyncJob(self._session, await self._session.call(_calls.job(job_id)))

    async def jobs(self, state: JobState | None = None, *, page_size: int | None = None) -> AsyncIterator[AsyncJob]:
        """All jobs, newest first, page by page as they are asked for.

        Args:
            state: only those in this state.
            page_size: jobs per request; the service's default where not given.
        """
        cursor: str | None = None
        while True:
            page = await self._session.call(_calls.jobs(state, cursor, page_size))
            for info in page.jobs:
                yield AsyncJob(self._session, info)
            if page.next is None or page.next == cursor:
                return
            cursor = page.next

    async def health(self) -> dict[str, Any]:
        """Whether the service is fit for work.

        Raises:
            Unavailable: it is not; `detail` or `extra` say what is missing.
        """
        return await self._session.call(_calls.health("readyz"))
