# SPDX-License-Identifier: MIT
"""A short run of load.py, so that it stays in order; README.md has the long one."""

import json
import os
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
BUILD = pathlib.Path(os.environ.get("SHEAF_BUILD", HERE / "../../build")).resolve()


def test_some_clients_for_some_seconds(tmp_path: pathlib.Path) -> None:
    figures = tmp_path / "figures.json"
    small = ["--clients", "12", "--seconds", "8", "--kill-every", "1", "--json", str(figures)]
    ended = subprocess.run(
        [sys.executable, str(HERE / "load.py"), "--build", str(BUILD), *small],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert ended.returncode == 0, ended.stdout + ended.stderr
    told = json.loads(figures.read_text())
    assert told["jobs_finished"] > 0
    assert sum(told["kills"].values()) > 0
    assert told["status_requests"] > 0
