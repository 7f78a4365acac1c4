#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Every strategy, Embree and ray queries on the same frames, in turn; a table with the targets, and JSON.

    tests/bench/compare.py                                  everything: hours
    tests/bench/compare.py --quick                          four small scenes: two minutes
    tests/bench/compare.py --scenes sponza,whitted --strategies auto,hybrid,bvh --depths 2 --rounds 5
    tests/bench/compare.py --table compare.json             the table of an earlier run

README.md beside this file says what is measured and how.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import sys
import tempfile
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(HERE), str(HERE.parent / "scenes")]
sys.dont_write_bytecode = True

from cases import ASSETS, CASES  # noqa: E402
from counts import count  # noqa: E402
from engine import Engine  # noqa: E402
from measure import Settings, measure, prepare  # noqa: E402
from report import lines_of, print_frames, print_lines  # noqa: E402
from sweeps import job, linearity  # noqa: E402

QUICK = ("cornell", "whitted", "spheres", "city 10K")
STRATEGIES = ("auto", "hybrid", "bvh", "rayquery", "frustum", "classify", "crsh", "rsh", "brute")


def words(text: str) -> tuple[str, ...]:
    return tuple(word.strip() for word in text.split(",") if word.strip())


def size_of(text: str) -> tuple[int, int]:
    width, height = (int(n) for n in text.split("x"))
    return width, height


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help=f"{', '.join(QUICK)} at 640x360, depth 2, two rounds")
    parser.add_argument("--scenes", type=words, help=f"of: {', '.join(case.name for case in CASES)}")
    parser.add_argument("--strategies", type=words, default=STRATEGIES, help="default: all that the program knows")
    parser.add_argument("--embree", choices=("yes", "no"), default="yes")
    parser.add_argument("--counts", choices=("yes", "no"), default="yes", help="tests by kind")
    parser.add_argument(
        "--sweeps", choices=("yes", "no"), help="rays against time, and a long job; default: not with --quick"
    )
    parser.add_argument("--size", type=size_of, help="default 1280x720")
    parser.add_argument("--count-size", type=size_of, default=(320, 180), help="of the runs that count tests")
    parser.add_argument("--depths", type=lambda t: tuple(int(n) for n in words(t)), help="default 2,6")
    parser.add_argument("--rounds", type=int, help="alternations that count; default 3")
    parser.add_argument(
        "--patience", type=float, help="seconds of a frame beyond which a strategy is left out; default 20"
    )
    parser.add_argument("--build", type=Path, default=Path(os.environ.get("SHEAF_BUILD", ROOT / "build")))
    parser.add_argument(
        "--embree-program", type=Path, help="default: tests/sheaf_bench_embree in the build, or in build/"
    )
    parser.add_argument("--device", help="as of sheaf render")
    parser.add_argument("--cache", type=Path, default=ROOT / "build/bench", help="generated scenes")
    parser.add_argument("--json", type=Path, default=ROOT / "build/bench/compare.json")
    parser.add_argument("--add", action="store_true", help="keep what the JSON file holds of other scenes and depths")
    parser.add_argument("--table", type=Path, help="only print what this file holds")
    a = parser.parse_args()
    a.scenes = a.scenes or (QUICK if a.quick else tuple(case.name for case in CASES))
    a.size = a.size or ((640, 360) if a.quick else (1280, 720))
    a.depths = a.depths or ((2,) if a.quick else (2, 6))
    a.rounds = a.rounds or (2 if a.quick else 3)
    a.patience = a.patience or (3 if a.quick else 20)
    a.sweeps = (a.sweeps or ("no" if a.quick else "yes")) == "yes"
    unknown = set(a.scenes) - {case.name for case in CASES}
    if unknown:
        parser.error(f"no such scene: {', '.join(sorted(unknown))}")
    return a


def embree_program(a: argparse.Namespace) -> Path | None:
    """Beside the build that is measured, else in the tree's own; none without Embree."""
    if a.embree == "no":
        return None
    places = (
        [a.embree_program] if a.embree_program else [b / "tests/sheaf_bench_embree" for b in (a.build, ROOT / "build")]
    )
    found = next((place for place in places if place.is_file()), None)
    if found is None:
        print("Embree left out: sheaf_bench_embree is not built (libembree-dev)", file=sys.stderr)
    return found


def write(path: Path, data: dict[str, Any]) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(data, indent=1) + "\n")


def known_strategies(engine: Engine, wanted: tuple[str, ...]) -> tuple[str, ...]:
    """Those that this build and device have: a scene of nothing shows it."""
    known = []
    for strategy in wanted:
        try:
            engine.render(ROOT / "tests/scenes/unlit.glb", ["--size", "16x9", "--strategy", strategy], "0")
            known.append(strategy)
        except RuntimeError as error:
            print(f"{strategy} left out: {str(error).splitlines()[-1]}", file=sys.stderr)
    return tuple(known)


def run_all(a: argparse.Namespace, data: dict[str, Any], work: Path) -> None:
    """Results go to the file as they come."""
    engine, program = Engine(a.build, work, a.device), embree_program(a)
    strategies = known_strategies(engine, a.strategies)
    settings = Settings(a.size, a.rounds, a.patience, strategies)
    cases = {case.name: case for case in CASES}
    for name in a.scenes:
        case = cases[name]
        if name == "sponza" and not (ASSETS / "Sponza/Sponza.gltf").is_file():
            print(f"sponza left out: no {ASSETS} (SHEAF_ASSETS names the folder)", file=sys.stderr)
            continue
        for depth in a.depths:
            print(f"-- {name}, depth {depth}", file=sys.stderr, flush=True)
            scene = prepare(case, a.cache, depth)
            result = measure(engine, program, scene, settings, work)
            if a.counts == "yes":
                result["counts"] = count(engine, scene, a.count_size, strategies, 3 * a.patience)
            data["scenes"].setdefault(name, {})[str(depth)] = result
            data["device"] = data.get("device") or device_of(engine)
            write(a.json, data)
    if a.sweeps:
        print("-- sweeps", file=sys.stderr, flush=True)
        data["sweeps"] = {"linearity": linearity(engine, cases["whitted"], a.cache, a.rounds)}
        data["sweeps"]["job"] = job(engine, cases["whitted"], a.cache)


def device_of(engine: Engine) -> dict[str, Any]:
    stats = json.loads((engine.work / "stats.json").read_text())
    return {"name": stats["device"]["name"], "driver": stats["device"]["driver"], "version": stats["version"]}


def main() -> None:
    """Measures, or shows what was measured."""
    a = parse()
    shining = {case.name for case in CASES if case.shines}
    if a.table:
        data = json.loads(a.table.read_text())
    else:
        settings = {"size": a.size, "depths": a.depths, "rounds": a.rounds, "patience_s": a.patience}
        machine = {"cores": os.cpu_count(), "system": platform.platform(), "processor": processor()}
        data = {"schema": 1, "machine": machine, "settings": settings, "scenes": {}}
        if a.add and a.json.is_file():
            data = json.loads(a.json.read_text())
            data["settings"]["depths"] = sorted({*data["settings"]["depths"], *a.depths})
        with tempfile.TemporaryDirectory() as work:
            run_all(a, data, Path(work))
        data["figures"] = [line.as_json() for line in lines_of(data, shining)]
        write(a.json, data)
    print(f"{data['device']['name']}, {data['device']['driver']}, {data['machine']['cores']} cores")
    print_frames(data)
    print_lines(lines_of(data, shining))


def processor() -> str:
    """As the system names it."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor()
    return next(
        (line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), platform.processor()
    )


if __name__ == "__main__":
    main()
