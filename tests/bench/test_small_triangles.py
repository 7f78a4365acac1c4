# SPDX-License-Identifier: MIT
"""Where triangles are small and mirrors are round, neighbouring rays part: cells and packets must not meet half of it.

A hundred spheres of 5,200 triangles, 160x90. Cells cut by the number of their rays alone tested 16,000 nodes a
reflection ray, packets of neighbours alone 5,700.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "scenes")]
sys.dont_write_bytecode = True

import cases  # noqa: E402
from counted_work import NARROW, SHEAF  # noqa: E402


@pytest.fixture(scope="module")
def spheres(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    folder = tmp_path_factory.mktemp("spheres")
    case = next(c for c in cases.CASES if c.name == "spheres at rest")
    return [str(case.make(folder)), *cases.camera_path(case, folder)]


@pytest.mark.parametrize("strategy", ["frustum", "classify"])
def test_cells_part_where_rays_part(spheres: list[str], strategy: str, tmp_path: Path) -> None:
    stats = tmp_path / "stats.json"
    options = f"--size 160x90 --depth 2 --frames 0 --progress none --strategy {strategy}".split()
    command: list[str | Path] = [SHEAF, "render", *spheres, *options, "--out", tmp_path, "--stats", stats]
    subprocess.run(command, check=True, env=os.environ | NARROW)  # a vector's lanes are all counted
    frame = json.loads(stats.read_text())["frames"][0]
    for kind in ("shadow", "reflection"):
        assert frame["rays"][kind] > 500
        assert frame["tests"]["node_object"][kind] < 500 * frame["rays"][kind]
        assert frame["tests"]["ray_box"][kind] < 500 * frame["rays"][kind]
