# SPDX-License-Identifier: MIT
"""One data folder, one service; that the lock of a killed one goes with it is shown by unit/server_files_test.cpp."""

import fcntl
import json
import pathlib
import subprocess
from collections.abc import Iterator

import pytest

from service import FAKE, PATIENCE, program


@pytest.fixture
def second(tmp_path: pathlib.Path) -> Iterator[subprocess.Popen[str]]:
    """A service on a folder that somebody has locked."""
    command: list[str | pathlib.Path] = [
        program("sheafd"),
        "--listen",
        "127.0.0.1:0",
        "--data",
        tmp_path,
        "--sheaf",
        FAKE,
        "--min-free",
        "0",
    ]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        yield process
        process.kill()


def messages(process: subprocess.Popen[str]) -> Iterator[str]:
    assert process.stderr
    for line in process.stderr:
        yield json.loads(line)["message"] if line.startswith("{") else line


@pytest.fixture
def held(tmp_path: pathlib.Path) -> Iterator[None]:
    with (tmp_path / "lock").open("w") as lock:
        fcntl.lockf(lock, fcntl.LOCK_EX)
        yield


def test_refuses_the_folder_of_a_service_that_runs(held: None, second: subprocess.Popen[str]) -> None:
    assert any("another sheafd uses this data folder" in line for line in messages(second))
    assert second.wait(PATIENCE) == 6
