# SPDX-License-Identifier: MIT
"""The Python client and a service that goes away and comes back."""

import asyncio
import concurrent.futures
import pathlib
from collections.abc import Callable

import pytest

import sheaf
from conftest import Gate
from service import PATIENCE, Service, gltf


def render(url: str, scene: pathlib.Path) -> list[str]:
    """What `Job.wait` and the events told."""
    with sheaf.Client(url, timeout=PATIENCE) as client:
        job = client.submit(scene, frames="0-2").wait(timeout=PATIENCE)
        return [job.state, *(event.id for event in job.events())]


async def render_async(url: str, scene: pathlib.Path) -> list[str]:
    async with sheaf.AsyncClient(url, timeout=PATIENCE) as client:
        job = await (await client.submit(scene, frames="0-2")).wait(timeout=PATIENCE)
        return [job.state, *[event.id async for event in job.events()]]


@pytest.mark.parametrize("kind", ["blocking", "async"])
def test_waiting_goes_on_after_the_service_was_killed(
    restart: Callable[..., Service], gate: Gate, tmp_path: pathlib.Path, kind: str
) -> None:
    scene = tmp_path / "scene.gltf"
    scene.write_bytes(gltf(gates={"1": gate.path}))
    service = restart()
    with concurrent.futures.ThreadPoolExecutor(1) as pool:
        if kind == "blocking":
            told = pool.submit(render, service.url, scene)
        else:
            told = pool.submit(lambda: asyncio.run(render_async(service.url, scene)))
        while not (jobs := service.http.get("/v1/jobs").json()["jobs"]):
            pass
        service.wait_for_frame(jobs[0]["id"], 0)
        service.process.kill()
        service.stop()
        service = restart("--listen", service.address)
        gate.open()
        state, *ids = told.result(PATIENCE)
    assert state == "done"
    assert ids == [str(i + 1) for i in range(len(ids))]
    assert service.job(jobs[0]["id"])["starts"] == 2
