#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Prints what a run of `sheaf render --stats DIR/stats.json --preview` left in DIR, and its figures in a few lines."""

from __future__ import annotations

import json
import sys
from pathlib import Path


def number(value: float | None) -> str:
    if value is None:
        return "-"
    return f"{value:,.0f}" if value >= 100 else f"{value:.3g}"


def listed(values: dict[str, float], unit: str = "") -> str:
    return ", ".join(f"{name} {number(value)}{unit}" for name, value in values.items() if value)


def files(folder: Path, suffix: str) -> str:
    found = sorted(folder.glob(f"*{suffix}"))
    if not found:
        sys.exit(f"{folder}: no {suffix} file")
    return f"{len(found)} files, {found[0]} to {found[-1].name}"


def main() -> None:
    folder = Path(sys.argv[1])
    stats = json.loads((folder / "stats.json").read_text())
    frames, totals = stats["frames"], stats["totals"]
    if not frames:
        sys.exit(f"{folder}/stats.json: no frame was rendered")
    stages: dict[str, float] = {}
    for frame in frames:
        for stage, milliseconds in frame["stages"].items():
            stages[stage] = stages.get(stage, 0) + milliseconds / len(frames)
    wall = [frame["wall_ms"] for frame in frames]
    print(f"frames    {files(folder, '.exr')}")
    print(f"previews  {files(folder, '.png')}")
    print(f"stats     {folder}/stats.json")
    print(f"device    {stats['device']['name']}; strategy {stats['strategy']}: {stats['chosen_because']}")
    print(f"a frame   {sum(wall) / len(wall):.0f} ms in the mean, {min(wall):.0f} to {max(wall):.0f} ms")
    print(f"stages    {listed(stages, ' ms')}")
    print(f"rays      {listed(totals['rays'])}; {number(totals['rays_per_second'])} a second")
    tests, less = totals["tests_per_ray"], totals["reduction_vs_brute_force"]
    print(f"tests     {number(tests)} a ray; brute force needs {number(stats['scene']['triangles'])}", end="")
    print(f" ({less:.2%} saved)" if less is not None else "")


main()
