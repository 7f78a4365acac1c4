#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Prints what a frame costs beside the figures aimed at (2 cores, lavapipe, Mesa 25). Times are shown, never asserted.

    tests/bench/targets.py [--build build] [--assets ../shared/assets]

Every figure is of a second run, so that the shader cache is warm; the least of several frames is shown.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import tempfile
import time
from pathlib import Path
from typing import Any

import sponza

ROOT = Path(__file__).resolve().parents[2]
WHITTED = ROOT / "tests/scenes/whitted.glb"


def render(sheaf: Path, scene: Path, folder: Path, *options: str) -> tuple[dict[str, Any], float]:
    """The stats, and the seconds of the whole process."""
    stats = folder / "stats.json"
    command = [sheaf, "render", scene, "--out", folder / "out", "--stats", stats, "--progress", "none", *options]
    begun = time.monotonic()
    subprocess.run([str(word) for word in command], check=True)
    return json.loads(stats.read_text()), time.monotonic() - begun


def row(name: str, stats: dict[str, Any], aim: str) -> None:
    """The frame that took least, and where its time went."""
    frame = min((f for f in stats["frames"] if f["stages"]), key=lambda f: f["wall_ms"])
    most = sorted(frame["stages"].items(), key=lambda s: -s[1])[:4]
    tests, rays = stats["totals"]["tests_per_ray"], sum(frame["rays"].values())
    memory = f"{frame['peak_device_mib']:.0f} MiB"
    print(f"{name:34} {frame['wall_ms'] / 1000:6.2f} s  (aim {aim})  {rays / 1e6:.2f} M rays, {memory}")
    print(f"{'':34} {', '.join(f'{stage} {ms:.0f}' for stage, ms in most)} ms; tests per ray {json.dumps(tests)}")


def main() -> None:
    """Whitted's scene and Sponza by each strategy that may win, and the start of a small job."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=Path, default=ROOT / "build")
    parser.add_argument(
        "--assets", type=Path, default=Path(os.environ.get("SHEAF_ASSETS", ROOT.parent / "shared/assets"))
    )
    arguments = parser.parse_args()
    sheaf = arguments.build / "sheaf"
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        for strategy in ("bvh", "hybrid", "auto"):
            options: tuple[str, ...] = ("--size", "640x360", "--depth", "4", "--strategy", strategy)
            render(sheaf, WHITTED, folder, *options, "--frames", "0")
            row(
                f"whitted 640x360 depth 4, {strategy}",
                render(sheaf, WHITTED, folder, *options, "--frames", "0-9")[0],
                "0.5 s",
            )
        asset = arguments.assets / "Sponza/Sponza.gltf"
        if asset.is_file():
            scene = sponza.make(asset, folder / "sponza")
            for strategy in ("bvh", "hybrid", "auto"):
                options = ("--size", "1280x720", "--depth", "2", "--strategy", strategy, "--frames", "0")
                render(sheaf, scene, folder, *options)
                row(f"Sponza 1280x720 depth 2, {strategy}", render(sheaf, scene, folder, *options)[0], "2 s, 2048 MiB")
        options = ("--size", "160x90", "--frames", "0")
        render(sheaf, WHITTED, folder, *options)
        seconds = render(sheaf, WHITTED, folder, *options)[1]
        print(f"{'start to first frame, 160x90':34} {seconds:6.2f} s  (aim 2 s)")


if __name__ == "__main__":
    main()
