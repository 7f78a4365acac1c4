# SPDX-License-Identifier: MIT
"""Renders frames with `--dump`, has sheaf_oracle check every ray of them, adds up what it says."""

from __future__ import annotations

import json
import os
import pathlib
import shutil
import subprocess
from dataclasses import dataclass, field

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
BUILD = pathlib.Path(os.environ.get("SHEAF_BUILD", ROOT / "build")).resolve()
FAILURES = ("missed", "false_hit", "wrong_t", "wrong_nearest", "bad_ray")
SETTLED = ("tie", "free", "embree")
PATIENCE = 1800  # seconds for one program


def sheaf_program() -> pathlib.Path:
    return BUILD / "sheaf"


def oracle_program() -> pathlib.Path | None:
    """Beside the build that is tested, else in the tree's own; none without Embree."""
    named = os.environ.get("SHEAF_ORACLE")
    places = [pathlib.Path(named)] if named else [b / "tests" / "sheaf_oracle" for b in (BUILD, ROOT / "build")]
    return next((place for place in places if place.is_file()), None)


@dataclass
class Sums:
    """What was found, over any number of batches."""

    triangles: int = 0
    rays: int = 0
    hits: int = 0
    sampled: int = 0
    worst_t: float = 0.0
    by_kind: dict[str, int] = field(default_factory=dict)
    verdicts: dict[str, int] = field(default_factory=dict)
    listed: list[dict] = field(default_factory=list)

    @property
    def failures(self) -> int:
        return sum(self.verdicts.get(name, 0) for name in FAILURES)

    def add_batch(self, batch: dict, where: dict) -> None:
        self.rays += batch["rays"]
        self.hits += batch["hits"]
        self.sampled += batch["sampled"]
        self.worst_t = max(self.worst_t, batch["worst_t"] or 0.0)
        self.by_kind[batch["kind"]] = self.by_kind.get(batch["kind"], 0) + batch["rays"]
        for name, count in batch["verdicts"].items():
            self.verdicts[name] = self.verdicts.get(name, 0) + count
        place = where | {"generation": batch["generation"], "kind": batch["kind"]}
        self.listed += [place | found for found in batch["disagreements"]]

    def add(self, other: Sums) -> None:
        self.triangles = max(self.triangles, other.triangles)
        self.rays += other.rays
        self.hits += other.hits
        self.sampled += other.sampled
        self.worst_t = max(self.worst_t, other.worst_t)
        for mine, theirs in ((self.by_kind, other.by_kind), (self.verdicts, other.verdicts)):
            for name, count in theirs.items():
                mine[name] = mine.get(name, 0) + count
        self.listed += other.listed


def render_dump(scene: pathlib.Path, out: pathlib.Path, *options: object) -> pathlib.Path:
    """Every ray of a render, in out/dump."""
    command = [
        sheaf_program(), "render", scene, "--out", out, "--dump", out / "dump", "--primary", "trace",
        "--back-faces", "show", *options,
    ]  # fmt: skip
    done = subprocess.run(
        [str(word) for word in command], capture_output=True, text=True, timeout=PATIENCE, check=False
    )
    if done.returncode:
        raise RuntimeError(f"{' '.join(map(str, command))}\nexit {done.returncode}\n{done.stderr[-2000:]}")
    return out / "dump"


def check_dump(dump: pathlib.Path, pairs: int, listed: int = 20) -> Sums:
    """The checker's verdicts; an engine that is wrong shows in `failures`, not as an exception."""
    command = [str(oracle_program()), "--pairs", str(pairs), "--list", str(listed), str(dump)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=False)
    if done.returncode not in (0, 1):
        raise RuntimeError(f"{' '.join(command)}\nexit {done.returncode}\n{done.stderr[-2000:]}")
    sums = Sums()
    for folder in json.loads(done.stdout)["dumps"]:
        for frame in folder["frames"]:
            sums.triangles = max(sums.triangles, frame["triangles"])
            for batch in frame["batches"]:
                sums.add_batch(batch, {"frame": frame["frame"]})
    assert (sums.failures > 0) == (done.returncode == 1), "exit code and counts disagree"
    return sums


def drop_shadows(dump: pathlib.Path) -> None:
    """Light passes some surfaces, so a miss of a shadow ray means something else there."""
    for path in dump.glob("*_shadow_*.npy"):
        path.unlink()


def has_alpha_mask(scene: pathlib.Path) -> bool:
    done = subprocess.run(
        [str(sheaf_program()), "inspect", str(scene), "--json"],
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        check=True,
    )
    return "alpha mask" in json.loads(done.stdout)["features"]


def bounds_of(scene: pathlib.Path, work: pathlib.Path) -> tuple[np.ndarray, np.ndarray]:
    """Of the first frame, in the world; the middle half of the triangles when a few are far away."""
    dump = render_dump(scene, work / "bounds", "--size", "8x8", "--depth", 0, "--strategy", "bvh", "--opaque")
    triangles = np.load(dump / "f0000_triangles.npy").astype(float) + np.load(dump / "f0000_origin.npy")
    shutil.rmtree(work / "bounds")
    points = triangles.reshape(-1, 3)
    return points.min(0), points.max(0)


def orbit(scene: pathlib.Path, work: pathlib.Path, seconds: float = 60.0) -> pathlib.Path:
    """A closed camera path round, over and into a scene: no two frames see the same rays."""
    lo, hi = bounds_of(scene, work)
    centre, extent = (lo + hi) / 2, (hi - lo) / 2
    radius = float(np.linalg.norm(extent)) or 1.0
    keys, count = [], 16
    for k in range(count + 1):
        turn = 2 * np.pi * 5 * (k % count) / count
        near = (1.7, 0.9, 0.35, 1.2)[k % 4]  # of the radius: outside, and among the triangles
        way = np.array((np.cos(turn), 0.4 * np.sin(3 * turn) + 0.15, np.sin(turn)))
        eye = centre + way / np.linalg.norm(way) * near * radius
        target = centre + 0.4 * extent * np.sin((k % count) * np.array((1.3, 2.1, 3.7)))
        keys.append(
            {
                "time": k * seconds / count,
                "eye": eye.tolist(),
                "target": target.tolist(),
                "up": [0, 1, 0],
                "fov_degrees": 60,
                "near": 1e-4 * radius,
                "far": 20 * radius,
            }
        )
    path = work / "orbit.json"
    path.write_text(json.dumps({"version": 1, "interpolation": "catmull-rom", "loop": True, "keys": keys}))
    return path
