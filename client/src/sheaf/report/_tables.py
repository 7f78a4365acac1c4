# SPDX-License-Identifier: MIT
"""A study as data: one JSON document, and a CSV file for each of its tables."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from typing import Any

from ._measure import KINDS, Trial
from ._study import SceneStudy, Study

SCHEMA = 1


def document(study: Study) -> dict[str, Any]:
    """Everything that was found, ready for JSON; infinite numbers are texts, for JSON has none."""
    options = asdict(study.options)
    options["common"] = {name: str(value) for name, value in study.options.common.items()}
    return {
        "schema": SCHEMA,
        "made": study.made,
        "seconds": round(study.seconds, 1),
        "machine": study.machine,
        "device": study.device,
        "versions": study.versions,
        "options": options,
        "scenes": [_scene(scene) for scene in study.scenes],
        "stability": [{**asdict(row), "worst": _number(row.worst), "good": row.is_good} for row in study.stability],
    }


def json_text(study: Study) -> str:
    """The document as text."""
    return json.dumps(document(study), indent=1, allow_nan=False) + "\n"


def csv_tables(study: Study) -> dict[str, str]:
    """The tables by file name."""
    return {
        "trials.csv": _csv(_trial_rows(study)),
        "savings.csv": _csv(_saving_rows(study)),
        "levels.csv": _csv(_level_rows(study)),
        "stability.csv": _csv([{**asdict(row), "good": row.is_good} for row in study.stability]),
    }


def _scene(scene: SceneStudy) -> dict[str, Any]:
    reference = scene.reference
    return {
        "scene": scene.name,
        "file": scene.path.name,
        "holds": scene.fastest.scene if scene.fastest else {},
        "failure": scene.failure,
        "skipped": scene.skipped,
        "fastest": scene.fastest.point.label if scene.fastest else None,
        "reference": reference and {"settings": dict(reference.point.settings), "wall_ms": reference.wall_ms},
        "strategies": [_trial(scene, trial) for trial in scene.strategies],
        "memory": [_trial(scene, trial) for trial in scene.budgets],
        "knobs": [_trial(scene, trial) for trial in scene.knobs],
        "savings": [asdict(saving) for saving in scene.savings],
    }


def _trial(scene: SceneStudy, trial: Trial) -> dict[str, Any]:
    wall = trial.wall_ms
    errors = trial.errors and {name: _number(value) for name, value in asdict(trial.errors).items()}
    return {
        "label": trial.point.label,
        "name": trial.point.name,
        "settings": dict(trial.point.settings),
        "failure": trial.failure,
        "wall_ms": wall and {"median": trial.median_ms, "low": min(wall), "high": max(wall), "runs": wall},
        "rays": trial.rays,
        "rays_per_second": trial.rays_per_second,
        "tests": trial.tests,
        "node_object_by_level": trial.tests_by_level,
        "brute_force": trial.brute_force,
        "stages_ms": trial.stages,
        "error": errors,
        "pareto": {cost: any(trial is other for other in scene.front(cost)) for cost in ("time", "tests")},
    }


def _trial_rows(study: Study) -> Iterator[dict[str, Any]]:
    for scene in study.scenes:
        fronts = {cost: {id(trial) for trial in scene.front(cost)} for cost in ("time", "tests")}
        groups = (("strategy", scene.strategies), ("memory", scene.budgets), ("knob", scene.knobs))
        for group, trials in groups:
            for trial in trials:
                row = _trial_row(scene, group, trial)
                row |= {f"front_{cost}": int(id(trial) in front) for cost, front in fronts.items()}
                yield row


def _trial_row(scene: SceneStudy, group: str, trial: Trial) -> dict[str, Any]:
    wall, errors = trial.wall_ms, trial.errors
    total = sum(trial.rays.values())
    return {
        "scene": scene.name,
        "group": group,
        "name": trial.point.name or "",
        "label": trial.point.label,
        "failure": trial.failure or "",
        "wall_ms_median": trial.median_ms,
        "wall_ms_low": min(wall, default=None),
        "wall_ms_high": max(wall, default=None),
        "runs": len(wall),
        "rmse": errors and errors.rmse,
        "relative_mse": errors and errors.relative_mse,
        "flip": errors and errors.flip,
        "worst": errors and errors.worst,
        "worst_x": errors and errors.worst_at[0],
        "worst_y": errors and errors.worst_at[1],
        "rays": total,
        "rays_per_second": trial.rays_per_second,
        "tests": trial.all_tests,
        "tests_per_ray": trial.all_tests / total if total else None,
        "brute_force": trial.brute_force,
        **{f"rays_{kind}": trial.rays.get(kind, 0) for kind in KINDS},
        **{f"tests_{kind}": trial.tests.get(kind, 0) for kind in KINDS},
    }


def _saving_rows(study: Study) -> Iterator[dict[str, Any]]:
    for scene in study.scenes:
        for saving in scene.savings:
            told = {"scene": scene.name, "part": saving.part, "whole": saving.whole, "without": saving.without}
            yield {
                **told,
                **{f"saved_{kind}": share for kind, share in saving.tests.items()},
                "speedup": saving.speedup,
            }


def _level_rows(study: Study) -> Iterator[dict[str, Any]]:
    for scene in study.scenes:
        for saving in scene.savings:
            for kind, (whole, without) in saving.by_level.items():
                for level in range(max(len(whole), len(without))):
                    counts = [side[level] if level < len(side) else None for side in (whole, without)]
                    told = {"scene": scene.name, "part": saving.part, "kind": kind, "level": level}
                    yield {**told, "tests_whole": counts[0], "tests_without": counts[1]}


def _csv(rows: Iterator[dict[str, Any]] | Sequence[Mapping[str, Any]]) -> str:
    listed = list(rows)
    text = io.StringIO()
    if listed:
        writer = csv.DictWriter(text, list(listed[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(listed)
    return text.getvalue()


def _number(value: Any) -> Any:
    return str(value) if isinstance(value, float) and not math.isfinite(value) else value
