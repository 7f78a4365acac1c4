# SPDX-License-Identifier: MIT
"""A whole study: every scene's reference, strategies, knobs and stability, within the time that there is."""

from __future__ import annotations

import math
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from .._errors import SheafError, Timeout
from .._program import Program
from ._errors import compare, pareto
from ._evaluation import Saving, savings
from ._machine import describe_machine, describe_versions, now
from ._measure import Bench, Trial
from ._plan import Point, StudyOptions, error_points, memory_points, strategy_points
from ._stability import Stability, stability

EXTREME_SHARE = 0.1
"""Time of a scene that is looked at for stability alone, as a share of a whole one's."""

Progress = Callable[[str, float], object]
"""Called with what is done next, and with the share of the time or of the work that is over, 0 … 1."""


@dataclass
class SceneStudy:
    """What was found about a scene.

    Attributes:
        path: of its file.
        name: its stem; those of all scenes of a study differ.
        reference: in double precision, with many samples; None where it failed.
        strategies: the same picture in different ways.
        budgets: the same picture within less memory.
        knobs: other pictures: what trades error for time.
        savings: what parts of the algorithm save.
        skipped: labels of what there was no time for.
        failure: why there is nothing.
    """

    path: Path
    name: str
    reference: Trial | None = None
    strategies: list[Trial] = field(default_factory=list)
    budgets: list[Trial] = field(default_factory=list)
    knobs: list[Trial] = field(default_factory=list)
    savings: list[Saving] = field(default_factory=list)
    skipped: list[str] = field(default_factory=list)
    failure: str | None = None

    @property
    def timed(self) -> list[Trial]:
        """All trials that have both times and errors."""
        return [trial for trial in [*self.strategies, *self.budgets, *self.knobs] if trial.wall_ms and trial.errors]

    @property
    def fastest(self) -> Trial | None:
        """The fastest of the strategies with the camera rays rasterised."""
        usual = [trial for trial in self.strategies if trial.wall_ms and "primary" not in trial.point.settings]
        return min(usual, key=lambda trial: trial.median_ms or 0.0, default=None)

    def front(self, cost: str = "time") -> list[Trial]:
        """The trials that none beats in both RMSE and cost, "time" or "tests", the cheapest first."""
        trials = [trial for trial in self.timed if cost == "time" or trial.all_tests]
        costs = [trial.median_ms or 0.0 if cost == "time" else float(trial.all_tests) for trial in trials]
        errors = [trial.errors.rmse if trial.errors else 0.0 for trial in trials]
        on = pareto(list(zip(costs, errors, strict=True)))
        return [trials[i] for i in sorted(range(len(trials)), key=costs.__getitem__) if on[i]]


@dataclass
class Study:
    """All that was found, and where."""

    options: StudyOptions
    machine: dict[str, str | int]
    versions: dict[str, str]
    made: str
    scenes: list[SceneStudy] = field(default_factory=list)
    stability: list[Stability] = field(default_factory=list)
    device: dict[str, str] = field(default_factory=dict)
    seconds: float = 0.0


def study(
    program: Program,
    scenes: Sequence[Path],
    extremes: Sequence[Path] = (),
    options: StudyOptions | None = None,
    progress: Progress = lambda text, share: None,
) -> Study:
    """Measures scenes; `extremes` are looked at for stability alone. A scene that fails says so and costs no other."""
    options = options or StudyOptions()
    begun = time.monotonic()
    end = begun + options.minutes * 60
    result = Study(options, describe_machine(), describe_versions(program), now())
    names = _names([*scenes, *extremes])
    with tempfile.TemporaryDirectory(prefix="sheaf-report-") as folder:
        for index, path in enumerate(scenes):
            left = len(scenes) - index + min(1.0, EXTREME_SHARE * len(extremes))
            deadline = time.monotonic() + max(0.0, end - time.monotonic()) / left
            bench = Bench(program, path, options, Path(folder), deadline)
            done = index / (len(scenes) + len(extremes))
            scene = SceneStudy(path, names[path])
            result.scenes.append(scene)
            _Follower(bench, scene, result, progress, done, 1 / (len(scenes) + len(extremes))).follow(program, options)
        for index, path in enumerate(extremes):
            progress(f"{names[path]}: stability", (len(scenes) + index) / (len(scenes) + len(extremes)))
            bench = Bench(program, path, options, Path(folder), end)
            try:
                exact = bench.counted(Point({"strategy": "reference"}))
                trials = [bench.counted(point) for point in strategy_points(program, options)]
            except Timeout as error:
                result.stability.append(Stability(names[path], "all", str(error)))
                continue
            result.stability += stability(names[path], trials, None if exact.failure else exact)
    result.seconds = time.monotonic() - begun
    return result


class _Follower:
    """Goes through one scene's points in order of what they tell."""

    def __init__(
        self, bench: Bench, scene: SceneStudy, result: Study, progress: Progress, done: float, share: float
    ) -> None:
        self._bench, self._scene, self._result = bench, scene, result
        self._progress, self._done, self._share = progress, done, share
        self._begun, self._deadline = time.monotonic(), bench.deadline

    def follow(self, program: Program, options: StudyOptions) -> None:
        scene = self._scene
        self._progress(f"{scene.name}: reference", self._done)
        try:
            scene.reference = self._bench.reference()
        except (SheafError, OSError) as error:
            scene.failure = str(error)
            return
        points = strategy_points(program, options)
        scene.strategies, left = self._all(points, 0.0, 0.4)
        fastest = scene.fastest
        if fastest is None:
            reasons = {trial.failure for trial in scene.strategies if trial.failure}
            scene.failure = "no strategy was measured" + (
                f": {'; '.join(sorted(map(str, reasons)))}" if reasons else ""
            )
            return
        strategy = str(fastest.point.settings["strategy"])
        self._result.device = dict(fastest.device)
        scene.budgets, over = self._all(memory_points(options, strategy), 0.4, 0.45)
        scene.knobs, more = self._all(error_points(program, options, strategy), 0.45, 0.95)
        again, left = self._all(left, 0.95, 1.0)
        scene.strategies = sorted([*scene.strategies, *again], key=lambda trial: points.index(trial.point))
        scene.savings = savings(scene.strategies)
        scene.skipped = [point.label for point in [*left, *over, *more]]
        self._stability(strategy, "llvmpipe" in str(fastest.device.get("name", "")))

    def _stability(self, strategy: str, has_threads: bool) -> None:
        self._bench.deadline = math.inf  # three small pictures, without which the others prove little
        same = [*self._scene.strategies, *self._scene.budgets]
        if has_threads:
            same.append(self._bench.counted(Point({"strategy": strategy}, environment={"LP_NUM_THREADS": 1})))
        exact = self._bench.counted(Point({"strategy": "reference"}))
        self._result.stability += stability(self._scene.name, same, None if exact.failure else exact)

    def _all(self, points: Sequence[Point], begin: float, end: float) -> tuple[list[Trial], list[Point]]:
        """Measures points within their share of the time; gives those that it was too short for, too."""
        trials: list[Trial] = []
        reference = self._scene.reference
        self._bench.deadline = self._begun + (self._deadline - self._begun) * end
        for index, point in enumerate(points):
            part = begin + (end - begin) * index / len(points)
            self._progress(f"{self._scene.name}: {point.label}", self._done + self._share * part)
            try:
                trial = self._bench.measured(point)
            except Timeout:
                return trials, list(points[index:])
            if trial.picture is not None and reference is not None and reference.picture is not None:
                trial.errors = compare(trial.picture, reference.picture)
            trials.append(trial)
        return trials, []


def _names(paths: Sequence[Path]) -> dict[Path, str]:
    """A name for each: the stem, with a number where it is taken."""
    names: dict[Path, str] = {}
    for path in paths:
        name, number = path.stem, 2
        while name in names.values():
            name, number = f"{path.stem}-{number}", number + 1
        names.setdefault(path, name)
    return names
