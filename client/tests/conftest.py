# SPDX-License-Identifier: MIT
"""What the tests share."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import OpenEXR
import pytest

import sheaf
from fake_service import FakeJob, FakeService
from sheaf.cli import main


@pytest.fixture(scope="session", autouse=True)
def default_signals() -> Iterator[None]:
    """SIGINT interrupts, though a shell starts what runs in its background with SIGINT ignored."""
    before = signal.getsignal(signal.SIGINT)
    if before == signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture
def service() -> Iterator[FakeService]:
    fake = FakeService()
    yield fake
    fake.close()


@pytest.fixture
def client(service: FakeService, pauses: list[float]) -> Iterator[sheaf.Client]:
    with sheaf.Client(service.url) as made:
        yield made


@pytest.fixture
def pauses(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """Nothing sleeps; the pauses are listed, and the clock goes on by them."""
    taken: list[float] = []
    monkeypatch.setattr("sheaf._session.time.sleep", taken.append)
    monkeypatch.setattr("sheaf._http.random.random", lambda: 0.0)  # and nothing is left to chance
    return taken


@pytest.fixture
def exr(tmp_path: Path) -> bytes:
    return exr_bytes(tmp_path, colour(4, 6))


@pytest.fixture
def done_job(service: FakeService, exr: bytes) -> FakeJob:
    """Frames 3 and 4 rendered."""
    return service.add(FakeJob("abc", frames={3: exr, 4: exr}))


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    path = tmp_path / "box.gltf"
    path.write_text('{"asset": {"version": "2.0"}}')
    return path


@pytest.fixture
def run(service: FakeService, exr: bytes, monkeypatch: pytest.MonkeyPatch, pauses: list[float]) -> Callable[..., int]:
    """Runs the command against the service, which renders frames 0 and 1 of everything at once."""

    def finish(job: FakeJob) -> None:
        job.state, job.frames, job.warnings = "done", {0: exr, 1: exr}, ["box.gltf: no light"]

    service.new_job = finish
    monkeypatch.setenv("SHEAF_SERVER", service.url)
    monkeypatch.delenv("SHEAF_TOKEN", raising=False)

    def command(*arguments: str | Path) -> int:
        try:
            return main([str(argument) for argument in arguments])
        except SystemExit as end:  # argparse's own
            return int(end.code or 0)

    return command


def colour(height: int, width: int) -> dict[str, npt.NDArray[Any]]:
    ramp = np.linspace(0.0, 2.0, height * width, dtype=np.float16).reshape(height, width)
    return {"R": ramp, "G": ramp * np.float16(0.5), "B": ramp * np.float16(0.25), "A": np.ones_like(ramp)}


def exr_bytes(folder: Path, channels: dict[str, npt.NDArray[Any]], **attributes: Any) -> bytes:
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage, **attributes}
    path = folder / "made.exr"
    OpenEXR.File(header, dict(channels)).write(str(path))
    data = path.read_bytes()
    path.unlink()
    return data
