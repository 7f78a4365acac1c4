#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What `--strategy auto` costs: whole processes by auto, bvh and hybrid, in turn, and auto's time over the better's.

    tests/bench/auto_cost.py                     scenes, sizes, frames and samples of the plan, kernels cached
    tests/bench/auto_cost.py --cold              each run with a cache of kernels of its own, empty
    tests/bench/auto_cost.py --only whitted,24   lines of the plan whose text has all of these

A line: wall and CPU seconds of each strategy (the least of the rounds), and both ratios. CPU time holds on a
machine that others use. Times are shown, never asserted.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "scenes")]

from cases import CASES, SCENES, camera_path  # noqa: E402

STRATEGIES = ("auto", "bvh", "hybrid")
BUILD = Path(os.environ.get("SHEAF_BUILD", HERE.parents[1] / "build")).resolve()
# Scene, size, frames, samples.
PLAN = [
    *(("whitted", size, frames, 1) for size in ("320x180", "640x360", "1280x720") for frames in (1, 2, 5, 24)),
    ("whitted", "320x180", 240, 1), ("whitted", "320x180", 1, 16), ("whitted", "640x360", 5, 16),
    ("whitted", "1280x720", 1, 16),
    ("cornell", "320x180", 240, 1), ("cornell", "640x360", 24, 1), ("cornell", "1280x720", 2, 16),
    ("nested_glass", "640x360", 1, 1), ("nested_glass", "640x360", 1, 16), ("nested_glass", "1280x720", 1, 16),
    ("spheres", "320x180", 24, 1), ("spheres", "640x360", 5, 1), ("spheres", "1280x720", 24, 1),
    ("city 100K", "320x180", 24, 1), ("city 100K", "1280x720", 1, 1), ("city 100K", "1280x720", 5, 1),
]  # fmt: skip


@dataclass
class Taken:
    """Seconds of one process, and what its stats say."""

    wall: float
    cpu: float
    strategy: str
    because: str
    frames: list[list[str]]


def scene_options(name: str, cache: Path) -> list[str]:
    """The file and the camera of a case of the benchmark, or of a committed scene."""
    for case in CASES:
        if case.name == name:
            return [str(case.make(cache)), *camera_path(case, cache), *case.options]
    return [str(SCENES / f"{name}.glb")]


def run(options: list[str], strategy: str, work: Path, kernels: Path) -> Taken:
    """One process from its start to its end. Stats do not count tests: these are other kernels."""
    stats, out = work / "stats.json", work / "out"
    command = [str(BUILD / "sheaf"), "render", *options, "--out", str(out), "--stats", str(stats), "--count", "off"]
    environment = os.environ | {"MESA_SHADER_CACHE_DIR": str(kernels)}
    begun, before = time.monotonic(), os.times()
    subprocess.run([*command, "--strategy", strategy, "--progress", "none"], check=True, env=environment)
    wall, after = time.monotonic() - begun, os.times()
    cpu = after.children_user + after.children_system - before.children_user - before.children_system
    shutil.rmtree(out)
    told = json.loads(stats.read_text())
    return Taken(wall, cpu, told["strategy"], told["chosen_because"], [f["strategies"] for f in told["frames"]])


def measure(options: list[str], rounds: int, cold: bool, work: Path) -> dict[str, list[Taken]]:
    """Rounds of all strategies in turn; kernels are cached by two runs before, or never."""
    kernels = work / "kernels"
    if not cold:
        for strategy in ("bvh", "hybrid"):
            first = [*options]
            first[first.index("--frames") + 1] = "0"
            run(first, strategy, work, kernels)
    taken: dict[str, list[Taken]] = {strategy: [] for strategy in STRATEGIES}
    for _ in range(rounds):
        for strategy in STRATEGIES:
            if cold:
                shutil.rmtree(kernels, ignore_errors=True)
            taken[strategy].append(run(options, strategy, work, kernels))
    return taken


def show(title: str, taken: dict[str, list[Taken]]) -> None:
    """A line of the table, and why auto did what it did."""
    wall = {s: min(t.wall for t in of) for s, of in taken.items()}
    cpu = {s: min(t.cpu for t in of) for s, of in taken.items()}
    best_wall, best_cpu = (min(times["bvh"], times["hybrid"]) for times in (wall, cpu))
    cells = "  ".join(f"{s} {wall[s]:6.2f} {cpu[s]:6.2f}" for s in STRATEGIES)
    print(f"{title:38}  {cells}  auto/best wall {wall['auto'] / best_wall:.3f} cpu {cpu['auto'] / best_cpu:.3f}")
    last = taken["auto"][-1]
    by_hybrid = sum("hybrid" in names for names in last.frames)
    print(f"    {last.strategy}, hybrid in {by_hybrid} of {len(last.frames)} frames: {last.because}", flush=True)


def main() -> int:
    """Line by line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cold", action="store_true")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--only", default="")
    arguments = parser.parse_args()
    cache = BUILD / "bench"
    cache.mkdir(parents=True, exist_ok=True)
    for scene, size, frames, samples in PLAN:
        title = f"{scene}, {size}, {frames} frames, {samples} spp"
        if not all(text in title for text in arguments.only.split(",")):
            continue
        options = [*scene_options(scene, cache), "--size", size, "--frames", f"0-{frames - 1}", "--spp", str(samples)]
        with tempfile.TemporaryDirectory() as work:
            show(title, measure(options, arguments.rounds, arguments.cold, Path(work)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
