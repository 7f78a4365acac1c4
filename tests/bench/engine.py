# SPDX-License-Identifier: MIT
"""One run of `sheaf`, and what it took."""

from __future__ import annotations

import json
import os
import resource
import subprocess
import threading
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

# What finds hits, from the pixels' rays on, and what the hierarchy costs: the duty another tracer would take over.
TRACING = (
    "objects",
    "raster",
    "hash",
    "compress",
    "sort",
    "decompress",
    "rays_hierarchy",
    "traverse",
    "compact",
    "intersect",
)


class TookTooLongError(Exception):
    """A run that was stopped."""


@dataclass
class Frame:
    """Milliseconds of one frame that was really rendered."""

    wall: float
    stages: dict[str, float]

    @property
    def device(self) -> float:
        """All stages on the device."""
        return sum(ms for stage, ms in self.stages.items() if stage != "write")

    @property
    def tracing(self) -> float:
        """Those that find hits."""
        return sum(self.stages.get(stage, 0.0) for stage in TRACING)


@dataclass
class Run:
    """Frames after the first, which warms up; `stats` is the whole file."""

    stats: dict[str, Any]
    seconds: float
    peak_mib: float  # of the process; on a CPU device that includes what is on the device
    others: float  # share of the machine's time that other programs took meanwhile
    cpu: (
        float | None
    )  # ms of CPU time per frame, all cores together; None where the device is no CPU, or frames too few
    frames: list[Frame] = field(default_factory=list)


def busy_seconds() -> float:
    """CPU seconds that anybody has spent since the machine started; 0 where the system does not tell."""
    try:
        first = Path("/proc/stat").read_text().split("\n", 1)[0].split()
    except OSError:
        return 0.0
    user, nice, system, _idle, _wait, irq, soft, steal = (float(x) for x in first[1:9])
    return (user + nice + system + irq + soft + steal) / os.sysconf("SC_CLK_TCK")


class Load:
    """What others took of the machine between construction and `share`."""

    def __init__(self) -> None:
        self.begun, self.busy = time.monotonic(), busy_seconds()

    def share(self, own_seconds: float) -> float:
        """`own_seconds`: CPU time of our own meanwhile."""
        available = (time.monotonic() - self.begun) * (os.cpu_count() or 1)
        return max(0.0, (busy_seconds() - self.busy - own_seconds) / available) if available > 0 else 0.0


class Engine:
    """`sheaf` of one build, on one device."""

    def __init__(self, build: Path, work: Path, device: str | None) -> None:
        self.program, self.work, self.device = build / "sheaf", work, device
        self.on_cpu = self._kind() == "cpu"

    def _kind(self) -> str:
        """Of the device that will be used: cpu, or a kind of GPU."""
        done = subprocess.run([self.program, "devices", "--json"], capture_output=True, text=True, check=True)
        wanted = self.device
        for device in json.loads(done.stdout):
            if wanted is None or wanted == str(device["index"]) or wanted in device["name"]:
                return device["kind"]
        raise RuntimeError(f"no device {wanted}")

    def render(self, scene: Path, options: list[object], frames: str, seconds: float = 1800) -> Run:
        """The pictures are not kept."""
        stats, out = self.work / "stats.json", self.work / "out"
        command = [self.program, "render", scene, "--out", out, "--stats", stats, "--frames", frames, *options]
        command += ["--progress", "json", *(["--device", self.device] if self.device else [])]
        load, begun, told = Load(), time.monotonic(), self.work / "stderr"
        with (
            told.open("wb") as errors,
            subprocess.Popen(
                [str(word) for word in command], stdout=subprocess.PIPE, stderr=errors, text=True
            ) as child,
        ):
            cpu, usage, code = watch(child, seconds)
        taken = time.monotonic() - begun
        for path in out.glob("*.exr"):
            path.unlink()
        if code:
            raise RuntimeError(f"{' '.join(map(str, command))}\nexit {code}\n{told.read_text()[-2000:]}")
        others = load.share(usage.ru_utime + usage.ru_stime)
        run = Run(json.loads(stats.read_text()), taken, usage.ru_maxrss / 1024, others, cpu if self.on_cpu else None)
        rendered = [f for f in run.stats["frames"] if not f["repeated"]]
        run.frames = [Frame(f["wall_ms"], f["stages"]) for f in rendered[1:] or rendered]
        return run


def cpu_seconds(pid: int) -> float:
    """User and system time of a process that runs, by the system's ticks; 0 where it does not tell."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    except OSError:
        return 0.0
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def watch(child: subprocess.Popen[str], seconds: float) -> tuple[float | None, resource.struct_rusage, int]:
    """Waits for its end, or stops it when its time is over; gives the CPU time of a frame in milliseconds.

    It is read whenever a frame's file is whole: the next frame is then as far as writing takes, so all intervals but
    the last are alike, and the last is left out.
    """
    assert child.stdout is not None
    late = threading.Event()

    def stop() -> None:
        late.set()
        child.kill()

    timer = threading.Timer(seconds, stop)
    timer.start()
    readings = [cpu_seconds(child.pid) for line in child.stdout if '"event":"frame"' in line]
    _, status, usage = os.wait4(child.pid, 0)  # its own peak and times, which the standard module's wait does not give
    child.returncode = os.waitstatus_to_exitcode(status)
    timer.cancel()
    if late.is_set():
        raise TookTooLongError
    intervals = len(readings) - 2
    cpu = 1000 * (readings[-2] - readings[0]) / intervals if intervals > 0 and readings[0] > 0 else None
    return cpu, usage, child.returncode
