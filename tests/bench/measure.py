# SPDX-License-Identifier: MIT
"""One scene by every contender in turn: what is left out, what is checked, and the samples that count."""

from __future__ import annotations

import shutil
import statistics
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from cases import Case, camera_path
from embree_contender import METHODS, Embree, Round
from engine import Engine, Run, TookTooLongError
from passes import passing_triangles

PROBE_SIZE = (160, 90)
ALWAYS = ("auto", "hybrid", "bvh", "rayquery")  # measured however long they take


@dataclass(frozen=True)
class Settings:
    """What a whole run is measured with. `patience`: the most seconds of one frame, else a strategy is left out."""

    size: tuple[int, int]
    rounds: int
    patience: float
    strategies: tuple[str, ...]
    frames: int = 3  # of a run that count; one more warms up


def size_text(size: tuple[int, int]) -> str:
    return f"{size[0]}x{size[1]}"


def spread(values: Iterable[float]) -> dict[str, float]:
    """Median, least and most."""
    listed = sorted(values)
    return {"median": statistics.median(listed), "least": listed[0], "most": listed[-1]}


def calmest(samples: list[Any], count: int) -> list[Any]:
    """Those in which other programs took least of the machine."""
    return sorted(samples, key=lambda s: s.others)[:count]


@dataclass
class Scene:
    """A case made ready: its file, and the options that every strategy shares."""

    case: Case
    path: Path
    options: list[object] = field(default_factory=list)


def prepare(case: Case, cache: Path, depth: int) -> Scene:
    """The file is made on first use."""
    cache.mkdir(parents=True, exist_ok=True)
    path = case.make(cache)
    return Scene(case, path, [*camera_path(case, cache), "--depth", depth, "--compression", "none", *case.options])


def probe(engine: Engine, scene: Scene, strategy: str, settings: Settings, load_seconds: float) -> str | None:
    """Why a strategy is left out: its frame, predicted from a small one, would take longer than patience allows.

    A strategy whose packets are few and wide in a small picture is predicted too long a frame: a larger one decides,
    while it takes no longer than a quarter of that.
    """
    width, height = PROBE_SIZE
    while True:
        options = [*scene.options, "--size", size_text((width, height)), "--strategy", strategy, "--count", "off"]
        try:
            run = engine.render(scene.path, options, "0-1", 2 * settings.patience + 3 * load_seconds)
        except TookTooLongError:
            return f"two frames of {size_text((width, height))} take over {2 * settings.patience:g} s"
        seconds = run.frames[0].wall / 1000
        predicted = seconds * settings.size[0] * settings.size[1] / (width * height)
        if predicted <= settings.patience:
            return None
        larger = (2 * width, 2 * height)
        if 4 * seconds > settings.patience or larger[0] > settings.size[0] or larger[1] > settings.size[1]:
            return f"a frame would take about {predicted:.0f} s, over {settings.patience:g} s"
        width, height = larger


def dump_frames(engine: Engine, scene: Scene, settings: Settings, work: Path) -> tuple[Path, Run]:
    """Every ray of one frame, of two where the scene moves. Traced from the camera on: exact hits, as a check needs."""
    folder = work / "dump"
    shutil.rmtree(folder, ignore_errors=True)
    options = [
        *scene.options,
        "--size",
        size_text(settings.size),
        "--strategy",
        "bvh",
        "--primary",
        "trace",
        "--dump",
        folder,
    ]
    run = engine.render(scene.path, options, "1,2" if scene.case.moves else "1")
    return folder, run


def start_embree(program: Path, scene: Scene, dump: Path) -> Embree:
    """Checked when this returns."""
    if scene.case.opaque:
        return Embree(program, dump, None)
    passes = dump / "passes"
    passes.write_bytes(passing_triangles(scene.path))
    return Embree(program, dump, passes)


def engine_result(runs: list[Run], count: int) -> dict[str, Any]:
    """Milliseconds over the calmest runs' frames."""
    frames = [frame for run in calmest(runs, count) for frame in run.frames]
    stages = sorted({stage for frame in frames for stage in frame.stages})
    return {
        "wall_ms": spread(frame.wall for frame in frames),
        "device_ms": spread(frame.device for frame in frames),
        "tracing_ms": spread(frame.tracing for frame in frames),
        "stages_ms": {stage: statistics.median(f.stages.get(stage, 0.0) for f in frames) for stage in stages},
        "process_peak_mib": max(run.peak_mib for run in runs),
        "device_peak_mib": max(run.stats["totals"]["peak_device_mib"] for run in runs),
        "process_s": statistics.median(run.seconds for run in runs),
        "cpu_ms": spread(run.cpu for run in runs if run.cpu is not None) if runs[0].cpu is not None else None,
        "others": [round(run.others, 3) for run in runs],
        "chosen": runs[-1].stats["strategy"],
        "because": runs[-1].stats["chosen_because"],
    }


def embree_result(embree: Embree, rounds: list[Round], count: int) -> dict[str, Any]:
    """The best method of each batch by its median, so that one lucky round does not decide."""
    calm = calmest(rounds, count)
    by_batch, kinds, cpu = {}, dict[str, float](), 0.0
    for key in calm[0].batches:
        medians = {m: statistics.median(r.batches[key][m] for r in calm) for m in METHODS}
        best = min(medians, key=lambda m: medians[m])
        by_batch[f"{key[0]} {key[1]}"] = {"method": best, "ms": medians[best], "single_ms": medians["single"]}
        kinds[key[1]] = kinds.get(key[1], 0.0) + medians[best]
        cpu += min(statistics.median(r.cpu_batches[key][m] for r in rounds) for m in METHODS)
    update = spread(r.update for r in calm)
    return {
        "whole_ms": {**spread(r.whole for r in calm), "median": update["median"] + sum(kinds.values())},
        "update_ms": update,
        "cpu_ms": {"median": cpu + statistics.median(r.cpu_update for r in rounds)},
        "update": rounds[0].how,
        "rays_ms": kinds,
        "batches": by_batch,
        "others": [round(r.others, 3) for r in rounds],
        "checked": {key: value for key, value in embree.checked.items() if key != "warm_up"},
    }


def measure(
    engine: Engine, embree_program: Path | None, scene: Scene, settings: Settings, work: Path
) -> dict[str, Any]:
    """Checked, probed, then measured in turn: each contender, and again; half as often more where others disturbed."""
    left_out: dict[str, str] = {}
    dump, dumped = work / "dump", None
    if embree_program:
        try:
            dump, dumped = dump_frames(engine, scene, settings, work)
        except RuntimeError as error:
            left_out["embree"] = f"no rays were dumped: {str(error).splitlines()[-1]}"
    load_seconds = dumped.seconds if dumped else settings.patience
    strategies = []
    for strategy in settings.strategies:
        reason = None if strategy in ALWAYS else probe(engine, scene, strategy, settings, load_seconds)
        if reason:
            left_out[strategy] = reason
        else:
            strategies.append(strategy)
    embree = start_embree(embree_program, scene, dump) if embree_program and dumped else None
    runs: dict[str, list[Run]] = {strategy: [] for strategy in strategies}
    rounds: list[Round] = []
    try:
        for _ in range(settings.rounds + settings.rounds // 2):
            if embree and needs_more(rounds, settings.rounds * settings.frames):
                rounds += [embree.round() for _ in range(settings.frames)]
            for strategy in strategies:
                if needs_more(runs[strategy], settings.rounds):
                    options = [
                        *scene.options,
                        "--size",
                        size_text(settings.size),
                        "--strategy",
                        strategy,
                        "--count",
                        "off",
                    ]
                    runs[strategy].append(engine.render(scene.path, options, f"0-{settings.frames}"))
        stats = (dumped or runs[strategies[0]][-1]).stats
        result: dict[str, Any] = {
            "scene": stats["scene"],
            "rays": stats["frames"][-1]["rays"],
            "left_out": left_out,
            "engine": {s: engine_result(runs[s], settings.rounds) for s in strategies},
        }
        if embree:
            result["embree"] = embree_result(embree, rounds, settings.rounds * settings.frames)
        return result
    finally:
        if embree:
            embree.close()
        shutil.rmtree(dump, ignore_errors=True)


def needs_more(samples: list[Any], count: int, quiet: float = 0.1) -> bool:
    """Whether fewer than wanted were taken while others took less than a tenth of the machine."""
    return sum(sample.others < quiet for sample in samples) < count
