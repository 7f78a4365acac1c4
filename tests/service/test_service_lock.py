# SPDX-License-Identifier: MIT
"""One data folder, one service; and what a killed one leaves behind may hold it for a moment longer."""

import fcntl
import json
import pathlib
import subprocess
from collections.abc import Iterator

import pytest
from service import FAKE, PATIENCE, program


@pytest.fixture
def second(tmp_path: pathlib.Path) -> Iterator[subprocess.Popen[str]]:
    """A service on a folder that somebody has locked; `held` is closed to let go."""
    command = [program("sheafd"), "--listen", "127.0.0.1:0", "--data", tmp_path, "--sheaf", FAKE, "--min-free", "0"]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        yield process
        process.kill()


def messages(process: subprocess.Popen[str]) -> Iterator[str]:
    assert process.stderr
    for line in process.stderr:
        yield json.loads(line)["message"] if line.startswith("{") else line


@pytest.fixture
def held(tmp_path: pathlib.Path) -> Iterator[list[object]]:
    with (tmp_path / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield [lock]


def test_waits_for_what_a_killed_service_left(held: list, second: subprocess.Popen[str]) -> None:
    said = messages(second)
    assert "waiting for the data folder" in said
    held[0].close()
    assert "listening" in said


def test_refuses_the_folder_of_a_service_that_runs(held: list, second: subprocess.Popen[str]) -> None:
    assert any("another sheafd uses this data folder" in line for line in messages(second))
    assert second.wait(PATIENCE) == 6
