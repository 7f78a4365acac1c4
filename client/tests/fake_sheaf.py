#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A `sheaf` that renders nothing: pictures by formula, counts made up, and faults on demand.

A picture is a ramp, wrong by an amount that falls with samples and depth; every strategy gives the same. What a file in
the folder $FAKE_SHEAF_FAULTS is called decides what happens in place of rendering, once, for the file is taken away:
`fail-N-CODE` ends with CODE at frame N, `hang-N` never ends, `kill-N` kills the parent process first, and `nan` gives a
picture of numbers that are none. `always-…` stays.
"""

from __future__ import annotations

import json
import os
import re
import signal
import sys
import threading
from pathlib import Path
from typing import Any

OPTIONS: list[dict[str, Any]] = [
    {"name": "out", "choices": None},
    {"name": "frames", "choices": None},
    {"name": "quality", "choices": ["draft", "production", "exact"]},
    {"name": "strategy", "choices": ["auto", "hybrid", "crsh", "rsh", "bvh", "reference"]},
    {"name": "sort", "choices": ["auto", "on", "off"]},
    {"name": "spp", "choices": None},
]
QUALITIES = {
    "draft": {"spp": "1", "depth": "2"},
    "production": {"spp": "4", "depth": "6"},
    "exact": {"spp": "16", "depth": "12"},
}


def main() -> None:
    if sys.argv[1:] == ["--version"]:
        print("sheaf 9.9.9")
        return
    if sys.argv[1:] == ["options", "--json"]:
        print(json.dumps(OPTIONS))
        return
    scene, options = Path(sys.argv[2]), parsed(sys.argv[3:])
    if not scene.is_file():
        fail(3, f"{scene}: no such file")
    render(scene, Path(options["out"]), options)


def parsed(arguments: list[str]) -> dict[str, str]:
    """Options by name, given as `--name=value` or `--name value`; switches are "yes"."""
    options = {}
    for text, following in zip(arguments, [*arguments[1:], "--"], strict=True):
        if match := re.fullmatch(r"--([a-z-]+)(?:=(.*))?", text):
            options[match[1]] = match[2] or ("yes" if following.startswith("--") else following)
    return options


def render(scene: Path, out: Path, options: dict[str, str]) -> None:
    from sheaf._frames import parse_frames

    options = QUALITIES.get(options.get("quality", ""), {}) | options
    out.mkdir(parents=True, exist_ok=True)
    frames = parse_frames(options.get("frames", "0"))
    moves = "still" not in scene.name
    pattern = options.get("name", f"{scene.stem}.####.exr")
    for number in frames:
        meet_faults(number)
        digits = re.search("#+", pattern)
        assert digits
        target = out / pattern.replace(digits.group(), str(number).zfill(len(digits.group())))
        if not ("resume" in options and target.exists()):
            write_frame(target, number if "report" not in scene.name else 0, options)
        if options.get("progress") == "json":
            print(json.dumps({"event": "frame", "frame": number, "file": str(target), "wall_ms": 5.0}), flush=True)
    if "stats" in options:
        Path(options["stats"]).write_text(json.dumps(stats(frames, moves, options)))


def write_frame(target: Path, number: int, options: dict[str, str]) -> None:
    import numpy as np
    import OpenEXR

    width, height = (int(side) for side in options.get("size", "16x8").split("x"))
    ramp = np.linspace(0.1, 1.0, width * height, dtype=np.float32).reshape(height, width) + number
    wrong = 0.0 if options.get("strategy") == "reference" else 0.1 / int(options.get("spp", 1))
    wrong += 0.05 / (1 + int(options.get("depth", 4)))
    colour = (ramp + np.float32(wrong)).astype(np.float16)
    if fault("nan"):
        colour[0, 0] = np.nan
    channels: dict[str, Any] = dict.fromkeys("RGB", colour) | {"A": np.ones_like(colour)}
    if "Z" in options.get("aov", ""):
        channels |= {"Z": ramp, "id.object": np.ones((height, width), np.uint32)}
    part = target.with_name(f".{target.name}.{os.getpid()}.part")
    OpenEXR.File({"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}, channels).write(str(part))
    part.replace(target)


def stats(frames: list[int], moves: bool, options: dict[str, str]) -> dict[str, Any]:
    spp, depth = int(options.get("spp", 1)), int(options.get("depth", 4))
    rays = {"primary": 100 * spp, "shadow": 100 * spp, "reflection": 10 * spp * depth, "refraction": 0}
    sorting = 2 if options.get("sort") == "on" else 3
    nodes = {kind: count * sorting for kind, count in rays.items()}
    if options.get("primary") != "trace":
        nodes["primary"] = 0
    tests = {
        "brute_force": sum(rays.values()) * 1000,
        "node_object": nodes,
        "node_object_by_level": {kind: [count // 2, count - count // 2] for kind, count in nodes.items()},
        "ray_box": dict.fromkeys(rays, 0),
        "ray_triangle": dict.fromkeys(rays, 1),
    }
    times = [10.0 * spp + depth + index for index in range(len(frames))]
    entries = [
        {
            "frame": number,
            "wall_ms": times[index],
            "counted": options.get("count") != "off",
            "repeated": index > 0 and not moves,
            "stages": {"raster": 1.0, "traverse": 3.0 * spp},
            "rays": rays,
            "tests": tests,
        }
        for index, number in enumerate(frames)
    ]
    return {
        "schema": 1,
        "device": {"name": "llvmpipe (made up)", "driver": "none"},
        "scene": {"triangles": 1000},
        "frames": entries,
        "totals": {"wall_ms": sum(times), "frames": len(entries)},
    }


def meet_faults(number: int) -> None:
    if fault(f"hang-{number}"):
        threading.Event().wait()
    if fault(f"kill-{number}"):
        os.kill(os.getppid(), signal.SIGKILL)
        threading.Event().wait()
    for code in (3, 4, 5, 6):
        if fault(f"fail-{number}-{code}"):
            fail(code, f"frame {number}: made to fail")


def fault(name: str) -> bool:
    folder = os.environ.get("FAKE_SHEAF_FAULTS")
    if not folder:
        return False
    if Path(folder, f"always-{name}").exists():
        return True
    try:
        Path(folder, name).unlink()
    except FileNotFoundError:
        return False
    return True


def fail(code: int, text: str) -> None:
    print(f"sheaf: {text}", file=sys.stderr)
    sys.exit(code)


if __name__ == "__main__":
    main()
