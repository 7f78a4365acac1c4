# SPDX-License-Identifier: MIT
"""Embree on the rays of a dump: a program that stays (embree/), checks once and is timed a round at a time."""

from __future__ import annotations

import json
import statistics
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from engine import Load, cpu_seconds

METHODS = ("single", "packet", "coherent_packet")
Key = tuple[int, str]
MAX_DIFFERENT = 1e-5  # of the rays compared, outside the bounds: Embree's own test is not watertight


class WrongHitsError(Exception):
    """Embree and the dump disagree: its times would be of other work."""


@dataclass
class Round:
    """Milliseconds of one frame: what the hierarchy took, and each batch (generation, kind) by every method.

    `cpu_…`: of CPU time, all cores together.
    """

    how: str
    update: float
    cpu_update: float
    batches: dict[Key, dict[str, float]]
    cpu_batches: dict[Key, dict[str, float]]
    others: float

    @property
    def whole(self) -> float:
        """A frame's hits, each batch by what was best in this round."""
        return self.update + sum(min(ms.values()) for ms in self.batches.values())


class Embree:
    """A context: the program runs inside it."""

    def __init__(self, program: Path, dump: Path, passes: Path | None) -> None:
        command = [str(program), str(dump), *([str(passes)] if passes else [])]
        self.child = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.checked = self._answer()
        share = self.checked["different"] / max(self.checked["compared"], 1)
        if share > MAX_DIFFERENT:
            self.close()
            raise WrongHitsError(f"{dump}: {self.checked['different']} of {self.checked['compared']} rays differ")

    def _answer(self) -> dict[str, Any]:
        assert self.child.stdout is not None
        line = self.child.stdout.readline()
        if not line:
            raise RuntimeError(f"{self.child.args!r}: exit {self.child.wait()}")
        return json.loads(line)

    def round(self) -> Round:
        """One frame's worth: the mean over the frames dumped."""
        load, before = Load(), cpu_seconds(self.child.pid)
        assert self.child.stdin is not None
        self.child.stdin.write("round\n")
        self.child.stdin.flush()
        answer = self._answer()
        others = load.share(cpu_seconds(self.child.pid) - before)
        frames = answer["frames"]

        def batches(what: str) -> dict[Key, dict[str, float]]:
            sums: dict[Key, dict[str, float]] = {}
            for batch in (b for frame in frames for b in frame["batches"]):
                ms = sums.setdefault((batch["generation"], batch["kind"]), dict.fromkeys(METHODS, 0.0))
                for method in METHODS:
                    ms[method] += batch[what][method] / len(frames)
            return sums

        update, cpu_update = (statistics.fmean(f[what] for f in frames) for what in ("update_ms", "cpu_update_ms"))
        return Round(answer["update"], update, cpu_update, batches("ms"), batches("cpu_ms"), others)

    def close(self) -> None:
        """Ends it with its input."""
        assert self.child.stdin is not None
        self.child.stdin.close()
        self.child.wait()

    def __enter__(self) -> Embree:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
