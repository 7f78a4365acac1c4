# SPDX-License-Identifier: MIT
"""How a farm on this machine gets faster with workers, and what a frame costs whoever hands it out.

    tests/farm/scaling.py --sheaf build/sheaf --workers 1,2,3,4 --frames 24          the engine, one core a worker
    tests/farm/scaling.py --sheaf build/sheaf --workers 1,2 --frames 24 --all-cores  the engine, all cores each
    tests/farm/scaling.py --pace 0.5 --workers 1,4,16,32 --frames 4 --bytes 8000000  a worker that only waits, as for a
                                                                                     device; frames are a worker's share

Prints a table; `ms per frame` is the processor time of scheduler and client, which are one process here.
"""

from __future__ import annotations

import argparse
import os
import pathlib
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from distributed import Client, LocalCluster

from sheaf import farm

# Moves in each of its 96 frames: the engine renders one that equals the last only once.
SCENE = pathlib.Path(__file__).resolve().parent / "../scenes/whitted.glb"

# Stands in for `sheaf`: waits for each frame, then writes so many bytes. `-I -S`: its own start must cost little.
WAITING = """#!{python} -IS
import json, pathlib, sys, time
if sys.argv[1] == "--version": print("sheaf 0.0.0"); raise SystemExit
if sys.argv[1] == "options": print("[]"); raise SystemExit
given = dict(word[2:].split("=", 1) for word in sys.argv if word.startswith("--") and "=" in word)
given |= {{a[2:]: b for a, b in zip(sys.argv, sys.argv[1:]) if a.startswith("--") and "=" not in a}}
out = pathlib.Path(given["out"]); out.mkdir(parents=True, exist_ok=True)
for piece in given["frames"].split(","):
    first, _, last = piece.partition("-")
    for frame in range(int(first), int(last or first) + 1):
        time.sleep({pace})
        (out / given["name"].replace("####", f"{{frame:04}}")).write_bytes(bytes({bytes}))
"""


@dataclass
class Row:
    workers: int
    frames: int
    seconds: float
    frame_ms: float


@contextmanager
def cluster(workers: int, folder: str) -> Iterator[Client]:
    options = {
        "n_workers": workers,
        "threads_per_worker": 1,
        "processes": True,
        "dashboard_address": None,
    }
    with (
        LocalCluster(local_directory=folder, **options) as local,
        Client(local) as client,
    ):
        client.wait_for_workers(workers, timeout=600)
        yield client


def measure(given: argparse.Namespace, workers: int, program: str, folder: str) -> Row:
    frames = given.frames * (workers if given.pace else 1)
    options = farm.FarmOptions(largest_chunk=1 if given.pace else 1000, chunk_seconds=given.chunk_seconds)
    settings = {} if given.pace else {"size": given.size, "strategy": given.strategy, "spp": given.spp}
    with cluster(workers, folder) as client:
        for step in (
            (0, workers),
            (0, frames),
        ):  # the first warms up: program, shader cache, scene
            out = tempfile.mkdtemp(dir=folder)
            taken = time.process_time()
            result = farm.render(
                client,
                SCENE,
                out,
                range(*step),
                program=program,
                options=options,
                **settings,
            )
            taken = time.process_time() - taken
    return Row(workers, frames, result.seconds, 1000 * taken / frames)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sheaf", type=pathlib.Path, help="the engine")
    parser.add_argument(
        "--pace",
        type=float,
        default=0.0,
        help="seconds a frame of a worker that only waits",
    )
    parser.add_argument("--bytes", type=int, default=1_000_000, help="of its frames")
    parser.add_argument("--workers", default="1,2")
    parser.add_argument("--frames", type=int, default=24)
    parser.add_argument("--size", default="320x180")
    parser.add_argument("--spp", type=int, default=4)
    parser.add_argument("--strategy", default="bvh")
    parser.add_argument("--chunk-seconds", type=float, default=10.0)
    parser.add_argument(
        "--all-cores",
        action="store_true",
        help="each worker uses all cores, as it does by itself",
    )
    given = parser.parse_args()
    if not given.all_cores:
        os.environ["LP_NUM_THREADS"] = "1"
    with tempfile.TemporaryDirectory(prefix="sheaf-scaling-") as folder:
        program = str(given.sheaf.resolve()) if given.sheaf else f"{folder}/sheaf"
        if not given.sheaf:
            pathlib.Path(program).write_text(WAITING.format(python=sys.executable, pace=given.pace, bytes=given.bytes))
            pathlib.Path(program).chmod(0o755)
        first: Row | None = None
        print("| workers | frames | seconds | frames per second | of one worker's, times | ms per frame |")
        print("| --- | --- | --- | --- | --- | --- |")
        for workers in map(int, given.workers.split(",")):
            row = measure(given, workers, program, folder)
            first = first or row
            rate, alone = (
                row.frames / row.seconds,
                first.frames / first.seconds / first.workers,
            )
            cells = (
                workers,
                row.frames,
                f"{row.seconds:.1f}",
                f"{rate:.2f}",
                f"{rate / alone:.2f}",
                f"{row.frame_ms:.1f}",
            )
            print("|", " | ".join(map(str, cells)), "|")
    print(f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f} at the end")


if __name__ == "__main__":
    main()
