# SPDX-License-Identifier: MIT
"""The program itself: its command line, how it fails to start, and the file that tells its port."""

import pathlib
import subprocess
from collections.abc import Callable

import pytest

from service import Service, program


def run(*options: str) -> subprocess.CompletedProcess:
    return subprocess.run([program("sheafd"), *options], capture_output=True, text=True, timeout=60, check=False)


@pytest.mark.parametrize(
    "options",
    [
        ["--listen", "nowhere"],
        ["--listen", "127.0.0.1:99999"],
        ["--jobs", "0"],
        ["--colour"],
        ["--max-upload", "x"],
        ["--listen", "[::1:80"],
    ],
)
def test_bad_usage(options: list[str]) -> None:
    ended = run(*options)
    assert ended.returncode == 2
    assert ended.stderr.startswith("sheafd: ")
    assert ended.stderr.count("\n") == 1


def test_help_version_and_io_failures(tmp_path: pathlib.Path, sheafd: Service) -> None:
    assert "--retention" in run("--help").stdout
    assert run("--version").stdout.startswith("sheafd ")
    taken = run("--listen", sheafd.address, "--data", str(tmp_path / "other"))
    assert taken.returncode == 6
    assert "in use" in taken.stderr
    (tmp_path / "file").write_text("")
    assert run("--data", str(tmp_path / "file"), "--listen", "127.0.0.1:0").returncode == 6


def test_the_port_file(start: Callable[..., Service], tmp_path: pathlib.Path) -> None:
    service = start("--port-file", str(tmp_path / "port"))
    assert (tmp_path / "port").read_text() == service.address + "\n"
