#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Checks every ray that the engine traces against Embree and double precision, and prints a table.

  check_rays.py                          a million rays over a dozen scenes
  check_rays.py --rays 1e8               at the scale that the engine is held to; in slices, deleted when checked
  check_rays.py --scenes soup,cornell    some scenes: names of soups.py or of tests/scenes, or files
  check_rays.py --list                   the scenes it would use

Scenes are committed ones, generated soups, and models of $SHEAF_ASSETS (default ../shared/assets) where there are any.
A camera flies round and through each; slices take turns between strategies, and between `--opaque` and the scene as it
is (then without shadow rays, which pass some surfaces). The exit code is 1 if the engine was wrong anywhere.
"""

from __future__ import annotations

import argparse
import json
import os
import pathlib
import shutil
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "scenes")]
sys.dont_write_bytecode = True

import oracle  # noqa: E402
from oracle import FAILURES, SETTLED, Sums  # noqa: E402
from soups import SOUPS  # noqa: E402

COMMITTED = ("whitted", "cornell", "still_life", "still_life_far", "nested_glass", "degenerate", "skin8", "mirrors")
ASSETS = (
    "Sponza/Sponza.gltf",
    "Duck/glTF-Binary/Duck.glb",
    "Fox/Fox.glb",
    "CesiumMan/CesiumMan.glb",
    "BoomBoxWithAxes/glTF/BoomBoxWithAxes.gltf",
    "CornellBox/cornellBox.glb",
)
LEAST_SLICE = 2000  # rays; a scene that gives fewer a frame is left after one slice


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rays", type=float, default=1e6, help="to check, over all scenes (default 1e6)")
    parser.add_argument("--scenes", help="comma-separated; default all that --list shows")
    parser.add_argument("--strategies", default="hybrid,bvh", help="that take turns (default hybrid,bvh)")
    parser.add_argument("--size", default="320x180", help="of a frame; larger for many rays (default 320x180)")
    parser.add_argument("--depth", type=int, default=6)
    parser.add_argument(
        "--pairs", type=float, default=5e6, help="brute-force tests per batch, for samples (default 5e6)"
    )
    parser.add_argument("--json", type=pathlib.Path, help="all counts, and every disagreement that was listed")
    parser.add_argument("--work", type=pathlib.Path, help="folder for a slice's dump (default: a temporary one)")
    parser.add_argument("--list", action="store_true", help="name the scenes and stop")
    return parser.parse_args()


def known_scenes() -> dict[str, pathlib.Path | None]:
    """By name; a soup has no file yet."""
    assets = pathlib.Path(os.environ.get("SHEAF_ASSETS", oracle.ROOT / "../shared/assets")).resolve()
    found: dict[str, pathlib.Path | None] = dict.fromkeys(SOUPS)
    found |= {name: HERE.parent / "scenes" / f"{name}.glb" for name in COMMITTED}
    return found | {path.split("/")[0]: assets / path for path in ASSETS if (assets / path).is_file()}


def file_of(name: str, work: pathlib.Path) -> pathlib.Path:
    known = known_scenes()
    if name in SOUPS:
        path = work / f"{name}.glb"
        path.write_bytes(SOUPS[name]())
        return path
    return known.get(name) or pathlib.Path(name)


def check_scene(name: str, wanted: float, options: argparse.Namespace, work: pathlib.Path) -> Sums:
    """Slices of a frame each, until the scene has had its share."""
    scene = file_of(name, work)
    camera = oracle.orbit(scene, work)
    see_through = not oracle.has_alpha_mask(scene)
    strategies = options.strategies.split(",")
    sums = Sums()
    slice_number = 0
    while sums.rays < wanted:
        as_it_is = see_through and slice_number % 4 == 3
        strategy = strategies[slice_number % len(strategies)]
        frame = 11 + 89 * slice_number
        dump = oracle.render_dump(
            scene, work / "slice",
            "--camera", camera, "--frames", frame, "--size", options.size, "--depth", options.depth,
            "--cutoff", 0, "--strategy", strategy, *([] if as_it_is else ["--opaque"]),
        )  # fmt: skip
        if as_it_is:
            oracle.drop_shadows(dump)
        found = oracle.check_dump(dump, int(options.pairs))
        for item in found.listed:
            item |= {"scene": name, "strategy": strategy, "opaque": not as_it_is}
        sums.add(found)
        shutil.rmtree(work / "slice")
        slice_number += 1
        if found.rays < LEAST_SLICE:
            break
    return sums


COLUMNS = ("rays", "hits", *SETTLED, *FAILURES, "sampled")


def row(name: str, sums: Sums) -> str:
    counts = {"rays": sums.rays, "hits": sums.hits, "sampled": sums.sampled} | sums.verdicts
    cells = "".join(f"{counts.get(column, 0):>{max(11, len(column) + 1)},}" for column in COLUMNS)
    return f"{name:<18}{sums.triangles:>10,}{cells}{sums.worst_t:>9.3f}"


def heading() -> str:
    cells = "".join(f"{column.replace('_', ' '):>{max(11, len(column) + 1)}}" for column in COLUMNS)
    return f"{'scene':<18}{'triangles':>10}{cells}{'worst t':>9}"


def main() -> int:
    options = arguments()
    names = options.scenes.split(",") if options.scenes else list(known_scenes())
    if options.list:
        print("\n".join(names))
        return 0
    if oracle.oracle_program() is None:
        print("check_rays.py: sheaf_oracle is not built (it wants Embree); or name it by SHEAF_ORACLE", file=sys.stderr)
        return 2
    total, scenes, begun = Sums(), {}, time.monotonic()
    print(heading(), flush=True)
    with tempfile.TemporaryDirectory() as temporary:
        work = options.work or pathlib.Path(temporary)
        work.mkdir(parents=True, exist_ok=True)
        for index, name in enumerate(names):
            share = max(options.rays - total.rays, 1) / (len(names) - index)  # what is left, shared evenly
            sums = check_scene(name, share, options, work)
            print(row(name, sums), flush=True)
            scenes[name] = vars(sums)
            total.add(sums)
    print(row("all", total))
    print(f"{total.rays:,} rays, {total.failures} wrong; {time.monotonic() - begun:.0f} s")
    if options.json:
        options.json.write_text(json.dumps({"scenes": scenes, "all": vars(total)}, indent=1))
    return 1 if total.failures else 0


if __name__ == "__main__":
    sys.exit(main())
