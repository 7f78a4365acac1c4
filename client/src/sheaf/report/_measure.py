# SPDX-License-Identifier: MIT
"""Renders a point and says what it cost: counts in one run, times in others, so that neither disturbs the other.

A scene that moves is timed over frames that lie a microsecond apart, in one process, whose first frame does not count.
Of a scene that stands still the engine renders one frame and writes it again; it is timed by a process per run, the
first of which does not count.
"""

from __future__ import annotations

import json
import shutil
import statistics
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from .._errors import RenderError, SheafError, Timeout
from .._exr import Frame, read_exr
from .._program import Program, checked
from .._stats import FrameStats
from ._errors import Errors, Picture
from ._plan import Point, StudyOptions

KINDS = ("primary", "shadow", "reflection", "refraction")
MOMENTS_A_SECOND = 1_000_000
"""Frames per second while timing: neighbours show the same, yet each is rendered."""

REPEAT_SECONDS = 20.0
"""About what the repeats of a point may take: a slow one is timed less often, but at least once."""

_NAME = "study.#.exr"


@dataclass
class Trial:
    """A point, once it has been measured.

    Attributes:
        point: what was rendered.
        wall_ms: of every frame that counts.
        rays: by kind.
        tests: by kind: nodes against objects, rays against boxes, rays against triangles.
        tests_by_level: nodes against objects by kind, from the roots of the rays' hierarchy to the rays.
        brute_force: rays times triangles.
        stages: device time by stage, ms, of the last frame that counts.
        scene: what the engine says of the scene.
        device: what it rendered on.
        picture: what was rendered.
        hits: depth and object of every pixel.
        same_again: whether all runs gave the same bytes; None where there was but one.
        errors: distance from the reference.
        failure: why there is nothing of all that.
    """

    point: Point
    wall_ms: list[float] = field(default_factory=list)
    rays: dict[str, int] = field(default_factory=dict)
    tests: dict[str, int] = field(default_factory=dict)
    tests_by_level: dict[str, list[int]] = field(default_factory=dict)
    brute_force: int = 0
    stages: dict[str, float] = field(default_factory=dict)
    scene: dict[str, Any] = field(default_factory=dict)
    device: dict[str, Any] = field(default_factory=dict)
    picture: Picture | None = None
    hits: dict[str, Any] = field(default_factory=dict)
    same_again: bool | None = None
    errors: Errors | None = None
    failure: str | None = None

    @property
    def median_ms(self) -> float | None:
        """Of the wall-clock times."""
        return statistics.median(self.wall_ms) if self.wall_ms else None

    @property
    def rays_per_second(self) -> float | None:
        """Of all kinds, over wall-clock time."""
        return sum(self.rays.values()) / self.median_ms * 1000 if self.median_ms else None

    @property
    def all_tests(self) -> int:
        """Of all kinds."""
        return sum(self.tests.values())


class Bench:
    """Renders points of one scene, in a folder of its own.

    Attributes:
        deadline: on `time.monotonic`'s clock; no run begins after it.
    """

    def __init__(self, program: Program, scene: Path, options: StudyOptions, folder: Path, deadline: float) -> None:
        self._program = program
        self._scene = scene
        self._options = options
        self._folder = folder
        self.deadline = deadline

    @property
    def is_over(self) -> bool:
        """Whether there is no time left to begin anything."""
        return time.monotonic() >= self.deadline

    def reference(self) -> Trial:
        """The picture as it should be: double precision, many samples.

        Raises:
            RenderError: it was not rendered.
        """
        settings = {"spp": self._options.reference_spp, "depth": self._options.reference_depth, "cutoff": 0}
        trial = Trial(Point({"strategy": "reference", **settings}))
        stats, frame = self._run(trial.point, {"count": "off"}, 1, timeout=None)[:2]
        trial.wall_ms = [entry["wall_ms"] for entry in stats["frames"]]
        trial.picture = np.asarray(frame.rgba[..., :3])
        return trial

    def counted(self, point: Point) -> Trial:
        """Counts, picture and hits of a point, but no times; a failure is the trial's, not ours.

        Raises:
            Timeout: the time was over before it began.
        """
        trial = Trial(point)
        try:
            stats, frame = self._run(point, {"count": "on", "aov": "Z,id"}, 1)
        except Timeout:
            raise
        except (SheafError, OSError, KeyError, ValueError) as error:
            trial.failure = str(error) or type(error).__name__
            return trial
        counts: FrameStats = stats["frames"][0]
        trial.scene, trial.device = stats.get("scene", {}), stats.get("device", {})
        trial.rays = {kind: counts["rays"].get(kind, 0) for kind in KINDS}
        trial.tests = tests_by_kind(counts)
        told = counts.get("tests", {})
        trial.tests_by_level = {kind: list(levels) for kind, levels in told.get("node_object_by_level", {}).items()}
        trial.brute_force = told.get("brute_force", 0)
        trial.picture = np.asarray(frame.rgba[..., :3])
        trial.hits = {name: frame.layers[name] for name in ("Z", "id.object") if name in frame.layers}
        return trial

    def measured(self, point: Point) -> Trial:
        """All of a point: the counted run warms caches up, then come those that are timed.

        Raises:
            Timeout: the time was over before the end.
        """
        begun = time.monotonic()
        trial = self.counted(point)
        if trial.failure:
            return trial
        took = time.monotonic() - begun
        try:
            self._time(trial, max(1, min(self._options.repeats, int(REPEAT_SECONDS / took))))
        except Timeout:
            raise
        except (SheafError, OSError, KeyError, ValueError) as error:
            trial.failure = str(error) or type(error).__name__
        return trial

    def _time(self, trial: Trial, repeats: int) -> None:
        stats, frame = self._run(trial.point, {"count": "off"}, repeats + 1)
        frames: list[FrameStats] = stats["frames"]
        stands_still = any(entry.get("repeated") for entry in frames)
        kept = frames[:0] if stands_still else frames[1:]
        pictures = [np.asarray(frame.rgba[..., :3])]
        while stands_still and len(kept) < repeats:
            stats, frame = self._run(trial.point, {"count": "off"}, 1)
            kept.append(stats["frames"][0])
            pictures.append(np.asarray(frame.rgba[..., :3]))
        trial.wall_ms = [entry["wall_ms"] for entry in kept]
        trial.stages = dict(kept[-1].get("stages", {}))
        counted = b"" if trial.picture is None else trial.picture.tobytes()
        trial.same_again = all(picture.tobytes() == counted for picture in pictures)

    def _run(self, point: Point, more: Mapping[str, object], frames: int, **limits: Any) -> tuple[Any, Frame]:
        """Renders frames beginning with the study's; the stats, and the first frame.

        Raises:
            Timeout: the study's time is over.
            RenderError: the program failed or took too long.
        """
        if self.is_over:
            raise Timeout("the study's time was over")
        options = self._options
        first = round(options.frame / options.fps * MOMENTS_A_SECOND)
        stats, out = self._folder / "stats.json", self._folder / "frames"
        numbers = f"{first}-{first + frames - 1}" if frames > 1 else str(first)
        settings: dict[str, object] = {
            **options.common,
            "size": options.size,
            **point.settings,
            **more,
            "frames": numbers,
            "fps": MOMENTS_A_SECOND,
            "name": _NAME,
            "stats": stats,
            "progress": "none",
        }
        environment = {name: str(value) for name, value in point.environment.items()}
        limit = limits.get("timeout", options.point_seconds)
        try:
            checked(self._program.render(self._scene, out, settings, timeout=limit, environment=environment))
            return json.loads(stats.read_text()), read_exr(out / f"study.{first}.exr", first)
        except RenderError as error:
            raise RenderError(str(error).replace(f"{self._folder}/", ""), error.exit_code) from error
        finally:
            shutil.rmtree(out, ignore_errors=True)
            stats.unlink(missing_ok=True)


def tests_by_kind(counts: FrameStats) -> dict[str, int]:
    """Tests of all sorts, by kind of ray."""
    told: Mapping[str, Any] = counts.get("tests", {})
    sorts = [told.get(name, {}) for name in ("node_object", "ray_box", "ray_triangle")]
    return {kind: sum(int(by_kind.get(kind, 0)) for by_kind in sorts) for kind in KINDS}
