# SPDX-License-Identifier: MIT
"""What takes more than one scene at one setting: time against rays, and the wall time of a job outside the device."""

from __future__ import annotations

import statistics
from pathlib import Path
from typing import Any

from engine import Engine
from measure import calmest, prepare, size_text

SWEEP_SIZE = (352, 198)  # with depth 4, a quarter of a million rays of the animation at one sample per pixel
SAMPLES = (1, 4, 16, 64)
JOB_FRAMES = 240


def linearity(engine: Engine, case: Any, cache: Path, rounds: int) -> list[dict[str, Any]]:
    """Rays and milliseconds of a frame at each number of samples."""
    scene = prepare(case, cache, depth=4)
    runs: dict[int, list[Any]] = {spp: [] for spp in SAMPLES}
    for _ in range(rounds):
        for spp in SAMPLES:
            options = [
                *scene.options,
                "--size",
                size_text(SWEEP_SIZE),
                "--spp",
                spp,
                "--strategy",
                "auto",
                "--count",
                "off",
            ]
            runs[spp].append(engine.render(scene.path, options, "0-3"))
    found = []
    for spp, taken in runs.items():
        calm = calmest(taken, max(1, rounds - 1))
        cpu = [run.cpu for run in taken if run.cpu is not None]
        point = {
            "spp": spp,
            "rays": sum(taken[0].stats["frames"][1]["rays"].values()),
            "wall_ms": statistics.median(f.wall for run in calm for f in run.frames),
            "cpu_ms": statistics.median(cpu) if cpu else 0.0,
            "others": statistics.median(run.others for run in calm),
            "strategy": taken[0].stats["strategy"],
        }
        found.append(point)
    return found


def job(engine: Engine, case: Any, cache: Path) -> dict[str, float]:
    """Where the seconds of a whole job go, its files written as by default."""
    scene = prepare(case, cache, depth=2)
    options = [o for o in scene.options if o not in ("--compression", "none")]
    options += ["--size", "320x180", "--strategy", "auto", "--count", "off"]
    run = engine.render(scene.path, options, f"0-{JOB_FRAMES - 1}")
    frames = run.stats["frames"]
    device = sum(ms for frame in frames for stage, ms in frame["stages"].items() if stage != "write") / 1000
    return {
        "frames": len(frames),
        "wall_s": run.seconds,
        "device_s": device,
        "frames_wall_s": sum(frame["wall_ms"] for frame in frames) / 1000,
        "outside": 1 - device / run.seconds,
        "others": run.others,
    }
