# SPDX-License-Identifier: MIT
"""A job on the service."""

from __future__ import annotations

import contextlib
import os
from collections.abc import AsyncGenerator, Callable, Iterable
from pathlib import Path

from . import _calls
from ._async_session import AsyncSession
from ._async_workers import aside, in_order
from ._download import Wanted, plan
from ._errors import NotFound, SheafError
from ._exr import Frame, read_exr
from ._files import file_sha256, whole_file
from ._job_view import JobView, reporting, unless_bad
from ._models import Event, JobInfo, Progress
from ._stats import Stats
from ._watch import Listen, Poll, SseParser, Watch


class AsyncJob(JobView):
    """A submitted animation; made by `AsyncClient.submit`, `AsyncClient.job` and `AsyncClient.jobs`.

    What it says about itself is what the service said last: `refresh` and `wait` bring it up to date. Every method
    that asks the service raises `TransportError`, `ProtocolError` or an `ApiError`, `NotFound` once the job is gone.

    Attributes:
        info: all that the service said last.
    """

    def __init__(self, session: AsyncSession, info: JobInfo) -> None:
        super().__init__(info)
        self._session = session

    async def refresh(self) -> AsyncJob:
        """Asks the service how the job is; returns the job itself."""
        self.info = await self._session.call(_calls.job(self.id))
        return self

    async def events(self, after: str | None = None, timeout: float | None = None) -> AsyncGenerator[Event, None]:
        """What happens to the job, from its beginning (or after the event with that id) to its end.

        Listens to server-sent events, going on after the last one where the connection is lost, and turns to long
        polls where streams do not get through.

        Args:
            after: id of an event; those up to it are left out.
            timeout: seconds from now after which to stop waiting; None waits for ever.

        Raises:
            Timeout: the job is not over by then.
        """
        deadline = None if timeout is None else self._session.now() + timeout
        watch = Watch(after, self._session.retry, deadline)
        while True:
            step = watch.next_step(self._session.now())
            begun = self._session.now()
            news = False
            pause = 0.0
            try:
                async for event in self._listen(watch) if isinstance(step, Listen) else self._poll(watch, step):
                    news = True
                    watch.heard(event)
                    yield event
                    if event.ends_job:
                        return
                if not news:
                    self.info = await self._session.once(_calls.job(self.id))
                    if self.info.is_over:
                        return
                    pause = watch.quiet(self._session.now() - begun, streaming=isinstance(step, Listen))
            except SheafError as error:
                pause = watch.lost(error, streaming=isinstance(step, Listen))
            await self._session.sleep(watch.pause(pause, self._session.now()))

    async def wait(
        self, progress: Callable[[Progress], object] | bool | None = None, timeout: float | None = None
    ) -> AsyncJob:
        """Waits until the job is over.

        Args:
            progress: called with every change; True draws a bar on standard error.
            timeout: seconds; None waits for ever.

        Returns:
            The job itself, in state "done".

        Raises:
            JobFailed: it failed; `code` and `message` say why.
            JobCancelled: it was cancelled.
            Timeout: it is not over in time. It goes on; `wait` may be called again.
        """
        with reporting(progress) as report:
            await self._refresh_patiently()
            report(self.progress)
            if not self.info.is_over:
                async with contextlib.aclosing(self.events(timeout=timeout)) as events:
                    async for event in events:
                        self.info = self.info.after(event)
                        report(self.progress)
                await self._refresh_patiently()
                report(self.progress)
        unless_bad(self.info)
        return self

    async def _refresh_patiently(self) -> None:
        watch = Watch(None, self._session.retry)
        while True:
            try:
                self.info = await self._session.once(_calls.job(self.id))
                return
            except SheafError as error:
                await self._session.sleep(watch.lost(error, streaming=False))

    async def frame(self, number: int) -> Frame:
        """A rendered frame as arrays.

        Raises:
            NotFound: the job has no such frame.
            Conflict: it is not rendered yet.
            FrameError: what came is no frame.
        """
        data = await self._session.call(_calls.frame(self.id, number, "exr"))
        return await aside(read_exr, data, number)

    async def frames(self, numbers: Iterable[int] | None = None) -> AsyncGenerator[Frame, None]:
        """Frames as arrays, one in memory at a time.

        Args:
            numbers: which; None gives all that are rendered by now.

        Raises:
            As `frame`.
        """
        if numbers is None:
            await self.refresh()
            numbers = self.info.rendered
        for number in numbers:
            yield await self.frame(number)

    async def preview(self, number: int) -> bytes:
        """A frame's tone-mapped preview, as PNG.

        Raises:
            NotFound: the job has no such frame.
            Conflict: it is not rendered yet.
        """
        return await self._session.call(_calls.frame(self.id, number, "png"))

    async def stats(self) -> Stats:
        """What the engine measured; see `sheaf.Stats`.

        Raises:
            Conflict: there is nothing measured yet.
        """
        return await self._session.call(_calls.stats(self.id))

    async def log(self) -> str:
        """What the renderer printed."""
        return await self._session.call(_calls.log(self.id))

    async def cancel(self) -> AsyncJob:
        """Stops the job, keeping the frames that are whole; does nothing where it is over.

        Returns the job itself; its state is "cancelled" once the renderer has stopped, within about a second.
        """
        self.info = await self._session.call(_calls.cancel(self.id))
        return self

    async def delete(self) -> None:
        """Stops the job and removes it with all its frames; does nothing where it is gone already."""
        with contextlib.suppress(NotFound):
            await self._session.call(_calls.delete(self.id))
            # A service may only stop what runs, and remove it once it has ended.
            await self.refresh()
            await self._session.call(_calls.delete(self.id))

    async def download(
        self,
        folder: str | os.PathLike[str],
        previews: bool = False,
        overwrite: bool = False,
        *,
        name: str | None = None,
        numbers: Iterable[int] | None = None,
        on_file: Callable[[int, Path], object] | None = None,
        connections: int = 4,
    ) -> list[Path]:
        """Fetches frames into a folder, made where it is missing, several at once.

        Files appear under their name only when whole, with the checksum that the service tells. One that is there
        already and the same is left alone.

        Args:
            folder: where to.
            previews: the PNG beside each frame too.
            overwrite: fetch again what is there.
            name: pattern of the names, the run of `#` becomes the frame number; None takes the service's names, which
                are the scene's with the number in four digits, or the setting `name`.
            numbers: which frames; None gives all that are rendered by now.
            on_file: called with frame number and path as each file is there, in frame order.
            connections: how many files are fetched at once.

        Returns:
            Paths of all files, fetched or left alone, in frame order.

        Raises:
            TransportError: a file did not come whole, again and again.
            OSError: a file cannot be written.
            ValueError: the name pattern is not one.
        """
        target = Path(folder)
        await self.refresh()
        files = plan(self.info, target, numbers, name, previews)
        target.mkdir(parents=True, exist_ok=True)
        fetched = in_order(lambda wanted: self._fetch(wanted, overwrite), files, connections)
        async with contextlib.aclosing(fetched) as coming:
            async for wanted in coming:
                if on_file:
                    on_file(wanted.number, wanted.path)
        return [wanted.path for wanted in files]

    async def _fetch(self, wanted: Wanted, overwrite: bool) -> None:
        is_there = wanted.path.is_file() and not overwrite
        have = await aside(file_sha256, wanted.path) if is_there else None
        if have is None or have != wanted.sha256:
            await self._session.patiently(lambda: self._fetch_once(wanted, have))

    async def _fetch_once(self, wanted: Wanted, have: str | None) -> None:
        async with self._session.stream(_calls.frame(self.id, wanted.number, wanted.kind, have)) as response:
            if response.status_code == 304:
                return
            with whole_file(wanted.path) as file:
                async for block in response.aiter_bytes(1 << 20):
                    file.write(block)
                await aside(file.finish, response, wanted.sha256)

    async def _listen(self, watch: Watch) -> AsyncGenerator[Event, None]:
        async with self._session.stream(_calls.listen(self.id, watch.last)) as response:
            if response.status_code == 204:  # there is nothing more to tell
                return
            if not response.headers.get("content-type", "").startswith("text/event-stream"):
                watch.use_polls()
                return
            parser = SseParser()
            async for block in response.aiter_bytes():
                for event in parser.feed(block):
                    yield event
                if watch.should_leave_stream(self._session.now()):
                    return

    async def _poll(self, watch: Watch, step: Poll) -> AsyncGenerator[Event, None]:
        page = await self._session.once(_calls.poll(self.id, watch.last, step.seconds))
        for event in page.events:
            yield event
        watch.skip_to(page.last)
