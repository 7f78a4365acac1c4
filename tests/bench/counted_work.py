#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The work that small frames take, counted: rays, hits, tests, bundles, pairs, bytes on the device.

    tests/bench/counted_work.py             what differs from counted_work.json, exit 1 if anything does
    tests/bench/counted_work.py --rewrite   writes that file anew: when a change is meant to do more, or less

SHEAF_BUILD names another build folder. Counts do not depend on threads or load; they do on the width of a subgroup, on
the rasteriser and on the driver's arithmetic, so the file says which device they are of.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
SCENES = HERE.parent / "scenes"
SHEAF = Path(os.environ.get("SHEAF_BUILD", HERE.parents[1] / "build")).resolve() / "sheaf"
EXPECTED = HERE / "counted_work.json"
NARROW = {"LP_NATIVE_VECTOR_WIDTH": "256"}  # the same subgroups on every CPU with AVX
OPTIONS = ("--depth", "4", "--count", "on", "--progress", "none")
PUBLISHED = ("rsh", "crsh")  # level by level, as the papers have it
STRATEGIES = ("hybrid", "bvh", "crsh", "rsh", "frustum", "classify", "brute")
# Ten meshes, a mirror and glass at rest; the animation: skins, morphs, moving glass; nine instances; an alpha mask;
# lists cut into tiles by a small budget.
CASES: dict[str, tuple[str, tuple[str, ...], tuple[str, ...]]] = {
    "cornell": ("cornell", ("--frames", "0", "--spp", "2"), STRATEGIES),
    "cornell traced": ("cornell", ("--frames", "0", "--primary", "trace"), ("hybrid", "bvh")),
    "cornell unsorted": ("cornell", ("--frames", "0", "--sort", "off"), ("hybrid",)),
    "whitted": ("whitted", ("--frames", "0,30"), ("hybrid", "bvh", "crsh", "rsh", "frustum", "classify")),
    "whitted in tiles": ("whitted", ("--frames", "30", "--size", "256x144", "--memory", "16"), ("hybrid", "bvh")),
    "instanced": ("instanced", ("--frames", "0"), ("hybrid", "bvh")),
    "alpha mask": ("alpha_mask", ("--frames", "0"), ("hybrid", "bvh")),
}


def known_strategies() -> list[str]:
    """What this build has."""
    done = subprocess.run([SHEAF, "options", "--json"], capture_output=True, text=True, check=True)
    return next(setting["choices"] for setting in json.loads(done.stdout) if setting["name"] == "strategy")


def device() -> dict[str, Any]:
    """The first device: its kind, its subgroups and its driver up to the minor version."""
    done = subprocess.run(
        [SHEAF, "devices", "--json"], capture_output=True, text=True, check=True, env=os.environ | NARROW
    )
    first = json.loads(done.stdout)[0]
    name, _, version = first["driver"].partition(" Mesa ")
    driver = f"{name} Mesa {'.'.join(version.split('.')[:2])}" if version else first["driver"]
    return {"kind": first["kind"], "subgroup": first["subgroup"], "driver": driver}


def work_of(frame: dict[str, Any], strategy: str) -> dict[str, Any]:
    """What is counted of a frame, without its times."""
    tests = {name: value for name, value in frame["tests"].items() if name != "brute_force"}
    if strategy in PUBLISHED:
        # Pairs are appended in the order that threads come; how near the best hit is by then decides what a ray skips.
        tests = {name: tests[name] for name in ("node_object", "node_object_by_level")}
    generations = [{k: v for k, v in g.items() if k not in ("sort_reason", "key_bits")} for g in frame["generations"]]
    work = {"rays": frame["rays"], "hits": frame["hits"], "tests": tests, "generations": generations}
    work["device_bytes"] = round(frame["peak_device_mib"] * 2**20)
    work["dispatches"] = frame["dispatches"]
    return work


def count(case: str, strategy: str, threads: int | None = None) -> list[dict[str, Any]]:
    """One run's frames."""
    scene, options, _ = CASES[case]
    environment = os.environ | NARROW | ({"LP_NUM_THREADS": str(threads)} if threads is not None else {})
    with tempfile.TemporaryDirectory() as folder:
        stats = Path(folder) / "stats.json"
        command = [SHEAF, "render", SCENES / f"{scene}.glb", "--out", folder, "--stats", stats, "--strategy", strategy]
        size = () if "--size" in options else ("--size", "128x72")
        subprocess.run([*map(str, command), *OPTIONS, *size, *options], check=True, env=environment)
        return [work_of(frame, strategy) for frame in json.loads(stats.read_text())["frames"]]


def cases() -> list[tuple[str, str]]:
    """Every case and strategy that this build can be asked for."""
    known = known_strategies()
    return [(case, strategy) for case, (_, _, names) in CASES.items() for strategy in names if strategy in known]


def differences(expected: Any, found: Any, path: str = "") -> list[str]:
    """Each place where two counts differ: where, what was expected, what was found, and by how much."""
    if isinstance(expected, dict) and isinstance(found, dict):
        keys = [*expected, *(key for key in found if key not in expected)]
        return [
            d for key in keys for d in differences(expected.get(key), found.get(key), f"{path}.{key}" if path else key)
        ]
    if isinstance(expected, list) and isinstance(found, list) and len(expected) == len(found):
        return [
            d for k, pair in enumerate(zip(expected, found, strict=True)) for d in differences(*pair, f"{path}[{k}]")
        ]
    if expected == found:
        return []
    numbers = all(isinstance(n, int) and not isinstance(n, bool) for n in (expected, found))
    change = f" ({(found - expected) / expected:+.2%})" if numbers and expected else ""
    return [f"{path}: {expected} expected, {found} found{change}"]


def load_expected() -> dict[str, Any]:
    return json.loads(EXPECTED.read_text())


def main() -> int:
    """Compares, or writes."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rewrite", action="store_true")
    arguments = parser.parse_args()
    found = {f"{case}, {strategy}": count(case, strategy) for case, strategy in cases()}
    if arguments.rewrite:
        text = json.dumps({"device": device(), "work": found}, indent=1)
        EXPECTED.write_text(compact(text) + "\n")
        return 0
    told = [
        f"{name}: {d}" for name, work in found.items() for d in differences(load_expected()["work"].get(name), work)
    ]
    print("\n".join(told))
    return 1 if told else 0


def compact(text: str) -> str:
    """Objects and lists of plain values on one line each: a change of one count is a change of one line."""
    lines: list[str] = []
    for line in text.split("\n"):
        lines.append(line)
        if line.strip().rstrip(",") not in ("}", "]"):
            continue
        opening = next(k for k in range(len(lines) - 1, -1, -1) if lines[k].rstrip()[-1:] in "{[")
        inner = [part.strip() for part in lines[opening + 1 : -1]]
        joined = lines[opening] + " ".join(inner) + line.strip()
        if (
            not any(part[-1:] in "{[" for part in inner)
            and len(joined) <= 240
            and not any("{" in part for part in inner)
        ):
            lines[opening:] = [joined]
    return "\n".join(lines)


if __name__ == "__main__":
    sys.exit(main())
