# SPDX-License-Identifier: MIT
import os
import pathlib
import sys
from collections.abc import Callable, Iterator

import pytest

HERE = pathlib.Path(__file__).parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

from default_signals import default_signals  # noqa: F401 - a fixture of every test
from service import PATIENCE, Service


@pytest.fixture
def start(tmp_path: pathlib.Path) -> Iterator[Callable[..., Service]]:
    """Starts services with options of the test's own; each must end well."""
    started: list[Service] = []

    def begin(*options: str, **kwargs: object) -> Service:
        data = kwargs.pop("data", tmp_path / f"data{len(started)}")
        started.append(Service(data, *options, **kwargs))  # type: ignore[arg-type]
        return started[-1]

    yield begin
    for service in started:
        assert service.stop() == 0, service.log


@pytest.fixture
def sheafd(start: Callable[..., Service]) -> Service:
    """A service whose worker is the fake one."""
    return start("--grace", "1")


class Gate:
    """A FIFO that holds a worker until it is opened."""

    def __init__(self, path: pathlib.Path) -> None:
        self.path = str(path)
        os.mkfifo(path)

    def open(self) -> None:
        """Lets the worker that waits, or will wait, go on."""
        pathlib.Path(self.path).open("wb").close()


@pytest.fixture
def gate(tmp_path: pathlib.Path) -> Gate:
    return Gate(tmp_path / "gate")


@pytest.fixture(autouse=True)
def patience() -> None:
    """Nothing in these tests may wait for ever."""
    assert PATIENCE < 600


@pytest.fixture
def restart(tmp_path: pathlib.Path) -> Iterator[Callable[..., Service]]:
    """Starts the service on one data folder again and again; what was started before is gone by then."""
    running: list[Service] = []

    def begin(*options: str, **kwargs: object) -> Service:
        running.append(Service(tmp_path / "data", "--grace", "1", *options, **kwargs))  # type: ignore[arg-type]
        return running[-1]

    yield begin
    for service in running:
        service.stop()
