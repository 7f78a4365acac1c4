# SPDX-License-Identifier: MIT
"""The asynchronous twin does what the blocking client does; both are held against the same fake service."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sheaf
from fake_service import FakeJob, FakeService
from faults import cut_short, hang_up, problem

Use = Callable[[sheaf.AsyncClient], Awaitable[Any]]


@pytest.fixture
def use(service: FakeService, monkeypatch: pytest.MonkeyPatch, pauses: list[float]) -> Callable[[Use], Any]:
    """Runs something with a client, in an event loop of its own, without sleeping."""

    async def sleep(_: object, seconds: float) -> None:
        pauses.append(seconds)

    monkeypatch.setattr("sheaf._async_session.AsyncSession.sleep", sleep)

    async def run(action: Use) -> Any:
        async with sheaf.AsyncClient(service.url) as client:
            return await action(client)

    return lambda action: asyncio.run(run(action))


def test_submit_wait_and_frames(
    use: Callable[[Use], Any], service: FakeService, scene: Path, exr: bytes, pauses: list[float]
) -> None:
    def begin(job: FakeJob) -> None:
        job.state, job.after_events = "running", "done"
        job.frames = {0: exr, 1: exr}
        job.events = [("state", {"state": "running"}), ("frame", {"frame": 0}), ("state", {"state": "done"})]

    service.new_job = begin
    service.fault("POST", problem(503, "Full"), times=2)
    service.fault("GET .*/events", hang_up)
    seen: list[sheaf.Progress] = []

    async def action(client: sheaf.AsyncClient) -> None:
        job = await client.submit(scene, frames="0-1", size=(6, 4))
        await job.wait(progress=seen.append)
        assert job.state == "done"
        frames = [frame async for frame in job.frames()]
        assert [frame.number for frame in frames] == [0, 1]
        np.testing.assert_array_equal(frames[0].rgba, sheaf.read_exr(exr).rgba)
        assert await job.preview(1) == b"\x89PNG of 1"
        assert (await job.stats())["schema"] == 1
        assert "rendered" in await job.log()
        assert [listed.id async for listed in client.jobs()] == [job.id]
        assert (await client.health())["status"] == "ok"

    use(action)
    assert seen[-1].done == 2
    assert service.jobs["job1"].settings == {"frames": "0-1", "size": "6x4"}
    keys = {headers["idempotency-key"] for _, _, headers in service.asked("POST")}
    assert len(service.asked("POST")) == 3
    assert len(keys) == 1
    assert len(pauses) >= 3


def test_a_long_outage_is_waited_out(use: Callable[[Use], Any], service: FakeService, pauses: list[float]) -> None:
    service.add(FakeJob("abc", "running", events=[("state", {"state": "done"})], after_events="done"))

    async def action(client: sheaf.AsyncClient) -> str:
        job = await client.job("abc")
        service.fault("GET", hang_up, times=12)
        return (await job.wait()).state

    assert use(action) == "done"
    assert sum(pauses) > 20


def test_download(
    use: Callable[[Use], Any], service: FakeService, done_job: FakeJob, tmp_path: Path, exr: bytes
) -> None:
    service.fault("GET .*3.exr", cut_short(exr))
    told: list[int] = []

    async def action(client: sheaf.AsyncClient) -> list[Path]:
        job = await client.job("abc")
        return await job.download(tmp_path, previews=True, on_file=lambda number, _: told.append(number))

    paths = use(action)
    assert [path.name for path in paths] == ["box.0003.exr", "box.0003.png", "box.0004.exr", "box.0004.png"]
    assert told == [3, 3, 4, 4]
    assert paths[0].read_bytes() == exr
    assert sorted(tmp_path.iterdir()) == sorted(paths)
    service.requests.clear()
    use(action)
    assert service.asked("GET .*exr") == []  # there already, and the same


def test_a_failed_download_leaves_nothing_half_done(
    use: Callable[[Use], Any], service: FakeService, done_job: FakeJob, tmp_path: Path, exr: bytes
) -> None:
    service.fault("GET .*exr", lambda handler: handler.send(200, b"\0" * len(exr), {}), times=20)

    async def action(client: sheaf.AsyncClient) -> None:
        await (await client.job("abc")).download(tmp_path)

    with pytest.raises(sheaf.TransportError, match="checksum"):
        use(action)
    assert list(tmp_path.iterdir()) == []


def test_failures_cancel_and_delete(use: Callable[[Use], Any], service: FakeService) -> None:
    service.add(FakeJob("bad", "failed", error={"code": "bad-scene", "message": "why", "exit_code": 3}))
    service.add(FakeJob("run", "running", pending=[1]))

    async def action(client: sheaf.AsyncClient) -> None:
        with pytest.raises(sheaf.JobFailed, match="why"):
            await (await client.job("bad")).wait()
        with pytest.raises(sheaf.NotFound):
            await client.job("absent")
        job = await client.job("run")
        with pytest.raises(sheaf.Conflict):
            await job.frame(1)
        assert (await job.cancel()).state == "cancelled"
        with pytest.raises(sheaf.JobCancelled):
            await job.wait()
        await job.delete()
        await job.delete()

    use(action)
    assert list(service.jobs) == ["bad"]


def test_a_job_that_ends_while_it_is_cancelled_keeps_its_frames(
    use: Callable[[Use], Any], service: FakeService, exr: bytes
) -> None:
    service.add(FakeJob("abc", "running", frames={3: exr}, ends_unseen=True))

    async def action(client: sheaf.AsyncClient) -> None:
        job = await client.job("abc")
        assert (await job.cancel()).state == "done"
        assert [frame.number async for frame in job.frames()] == [3]

    use(action)
    assert list(service.jobs) == ["abc"]


def test_the_deadline_is_kept(use: Callable[[Use], Any], service: FakeService) -> None:
    service.add(FakeJob("run", "running", pending=[1]))

    async def action(client: sheaf.AsyncClient) -> None:
        await (await client.job("run")).wait(timeout=0.0)

    with pytest.raises(sheaf.Timeout):
        use(action)


def test_wrong_addresses() -> None:
    for url in ("ftp://x", "x", ""):
        with pytest.raises(ValueError, match="http://"):
            sheaf.AsyncClient(url)
