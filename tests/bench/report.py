# SPDX-License-Identifier: MIT
"""The table: every figure that is aimed at, beside its target."""

from __future__ import annotations

import operator
import statistics
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from typing import Any

from counts import fewer, triangles_a_ray

COMPARE: dict[str, Callable[[float, float], bool]] = {"≥": operator.ge, "≤": operator.le, "<": operator.lt}
GIB = 1024.0


@dataclass
class Line:
    """A figure and its target."""

    what: str
    where: str
    value: float
    sign: str
    target: float
    by_cpu: float | None = None  # the same of CPU time, where it was read
    disturbed: bool = False  # others took too much of the machine for times to mean much: CPU time decides

    @property
    def holds(self) -> bool:
        """Whether the target is reached."""
        value = self.by_cpu if self.disturbed and self.by_cpu is not None else self.value
        return COMPARE[self.sign](value, self.target)

    def as_json(self) -> dict[str, Any]:
        """With the verdict."""
        return asdict(self) | {"pass": self.holds}


DISTURBED = 0.1  # of the machine, taken by others in the median sample
Of = Callable[[str], float]  # a figure by "wall_ms" or "cpu_ms"


def disturbed(*parts: dict[str, Any]) -> bool:
    """Whether other programs took part in the times of any of these contenders."""
    return any(statistics.median(part["others"]) > DISTURBED for part in parts)


def of(result: dict[str, Any], strategy: str, what: str) -> float:
    """Milliseconds of a whole frame: wall_ms or cpu_ms."""
    return result["engine"][strategy][what]["median"]


def ratio(what: str, where: str, sign: str, target: float, value: Of, *parts: dict[str, Any]) -> Line:
    """`parts`: whom the figure is of."""
    has_cpu = all(part.get("cpu_ms") for part in parts)
    return Line(what, where, value("wall_ms"), sign, target, value("cpu_ms") if has_cpu else None, disturbed(*parts))


def frame_lines(where: str, result: dict[str, Any], shines: bool) -> Iterator[Line]:
    """Of one scene and depth."""
    engine = result["engine"]
    if "auto" not in engine:
        return
    auto = engine["auto"]
    if "embree" in result:
        embree, aim = result["embree"], 1.5 if shines else 1.0
        yield ratio("Embree's hits / auto's whole frame", where, "≥", aim,
                    lambda w: embree_of(embree, w) / of(result, "auto", w), auto, embree)  # fmt: skip
        yield ratio("Embree in the tracer's place / auto", where, "≥", aim,
                    lambda w: in_place(result, w) / of(result, "auto", w), auto, embree)  # fmt: skip
    if "rayquery" in engine:
        yield ratio("rayquery / auto", where, "≥", 8,
                    lambda w: of(result, "rayquery", w) / of(result, "auto", w), auto, engine["rayquery"])  # fmt: skip
    fixed = [s for s in engine if s != "auto"]
    if fixed:
        by = "cpu_ms" if disturbed(*engine.values()) and auto.get("cpu_ms") else "wall_ms"
        best = min(fixed, key=lambda s: of(result, s, by))
        yield ratio(f"auto ({auto['chosen']}) / best fixed ({best})", where, "≤", 1.1,
                    lambda w: of(result, "auto", w) / of(result, best, w), auto, engine[best])  # fmt: skip


def embree_of(embree: dict[str, Any], what: str) -> float:
    return embree["whole_ms" if what == "wall_ms" else what]["median"]


def in_place(result: dict[str, Any], what: str) -> float:
    """The same frame with Embree finding the hits: our own shading, animation and sums, at what they take here."""
    return untraced(result, what) + embree_of(result["embree"], what)


def untraced(result: dict[str, Any], what: str) -> float:
    """What auto's frame takes beside its hits."""
    auto = result["engine"]["auto"]
    rest = 1 - auto["tracing_ms"]["median"] / auto["wall_ms"]["median"]
    return of(result, "auto", what) * rest


def one_ray_a_call(result: dict[str, Any]) -> str:
    """Embree without packets: no target, but what a program that calls it for each ray waits for."""
    embree = result["embree"]
    single = embree["update_ms"]["median"] + sum(batch["single_ms"] for batch in embree["batches"].values())
    if "auto" not in result["engine"]:
        return f"{single:8.1f}"
    place = (untraced(result, "wall_ms") + single) / of(result, "auto", "wall_ms")
    return f"{single:8.1f}; in the tracer's place / auto {place:.2f}"


def count_lines(where: str, counted: dict[str, Any], meshes: int) -> Iterator[Line]:
    """Of one scene and depth."""
    for kind, aim in (("shadow", 0.5), ("reflection", 0.25)):
        saved = fewer(counted, "crsh", "rsh", kind)
        if saved is not None and meshes > 1:
            yield Line(f"crsh fewer than rsh, {kind}", where, saved, "≥", aim)
    saved = fewer(counted, "hybrid", "rsh")
    if saved is not None:
        yield Line("hybrid fewer than rsh, all tests", where, saved, "≥", 0.99)
    a_ray = triangles_a_ray(counted, "hybrid")
    if a_ray is not None:
        yield Line("ray-triangle tests per ray, hybrid", where, a_ray, "<", 12)


def across_lines(depth: str, results: dict[str, Any]) -> Iterator[Line]:
    """Scenes against each other, at one depth, by `auto`."""

    def against(what: str, where: str, a: str, b: str, sign: str, target: float) -> Iterator[Line]:
        if a in results and b in results:
            parts = (results[name]["engine"]["auto"] for name in (a, b))
            value: Of = lambda w: of(results[a], "auto", w) / of(results[b], "auto", w)  # noqa: E731
            yield ratio(what, f"{where}, {depth}", sign, target, value, *parts)

    yield from against("frame, 10M / 10K triangles", "city", "city 10M", "city 10K", "<", 4)
    for name in ("spheres", "crowd"):
        yield from against("frame, moving / at rest", name, name, f"{name} at rest", "<", 1.3)
    if "city 10M" in results:
        auto = results["city 10M"]["engine"]["auto"]
        for what, key in (("process", "process_peak_mib"), ("device", "device_peak_mib")):
            yield Line(f"peak memory, {what}, GiB", f"city 10M, {depth}", auto[key] / GIB, "<", 4)
    for size in ("1M", "10M"):
        flat, instanced = f"city {size}", f"city {size} instanced"
        yield from against("frame, instanced / flat", flat, instanced, flat, "≤", 1.1)
    yield from memory_lines(depth, results)


def memory_lines(depth: str, results: dict[str, Any]) -> Iterator[Line]:
    """What the scene alone takes: beyond the city of 10 K, whose lists of rays are as large."""
    names = ("city 10K", "city 10M", "city 10M instanced")
    if all(name in results for name in names):
        small, flat, instanced = (results[name]["engine"]["auto"]["device_peak_mib"] for name in names)
        share = (instanced - small) / (flat - small)
        yield Line("scene on the device, instanced (1/16) / flat", f"city 10M, {depth}", share, "≤", 0.5)


def sweep_lines(sweeps: dict[str, Any]) -> Iterator[Line]:
    """Time per ray over nearly two decades of rays, and a job's wall time."""
    if "linearity" in sweeps:
        points = sweeps["linearity"]

        def extremes(what: str) -> float:
            a_ray = [p[what] / p["rays"] for p in points]
            return max(a_ray) / min(a_ray) if min(a_ray) > 0 else 0.0

        where = f"whitted, {points[0]['rays'] / 1e6:.2f} to {points[-1]['rays'] / 1e6:.1f} M rays"
        loud = any(p["others"] > DISTURBED for p in points)
        yield Line("most / least time per ray", where, extremes("wall_ms"), "≤", 1.15, extremes("cpu_ms") or None, loud)
    if "job" in sweeps:
        where = f"whitted 320x180, {sweeps['job']['frames']} frames"
        yield Line("wall time outside device stages", where, sweeps["job"]["outside"], "<", 0.05)


def lines_of(data: dict[str, Any], shining: set[str]) -> list[Line]:
    """All of them."""
    found: list[Line] = []
    for depth in data["settings"]["depths"]:
        by_scene = {name: of[str(depth)] for name, of in data["scenes"].items() if str(depth) in of}
        for name, result in by_scene.items():
            where = f"{name}, depth {depth}"
            found += frame_lines(where, result, name in shining and depth == 2)
            if "counts" in result:
                found += count_lines(where, result["counts"], result["scene"]["meshes"])
        found += across_lines(f"depth {depth}", by_scene)
    return found + list(sweep_lines(data.get("sweeps", {})))


def print_frames(data: dict[str, Any]) -> None:
    """Milliseconds by scene and contender."""
    print("\nms of a whole frame: median (least to most), CPU time of all cores, others' share; of the tracing stages")
    for name, depths in data["scenes"].items():
        for depth, result in depths.items():
            millions = sum(result["rays"].values()) / 1e6
            print(f"\n{name}, depth {depth}: {result['scene']['triangles']:,} triangles, {millions:.2f} M rays")
            if "embree" in result:
                e = result["embree"]
                update = f"update {e['update_ms']['median']:.0f} ({e['update']})"
                print(f"  {'embree, hits only':18} {numbers(e['whole_ms'], e)}; {update}")
                print(f"  {'  one ray a call':18} {one_ray_a_call(result)}")
            for strategy, r in result["engine"].items():
                label = f"auto ({r['chosen']})" if strategy == "auto" else strategy
                most = sorted(r["stages_ms"].items(), key=lambda s: -s[1])
                stages = ", ".join(f"{stage} {ms:.0f}" for stage, ms in most if stage != "write" and ms >= 1)
                print(f"  {label:18} {numbers(r['wall_ms'], r)}; tracing {r['tracing_ms']['median']:.0f}; {stages}")
            for strategy, reason in result["left_out"].items():
                print(f"  {strategy:18} left out: {reason}")


def numbers(ms: dict[str, float], part: dict[str, Any]) -> str:
    """Wall, CPU and how much others took."""
    cpu = f"CPU {part['cpu_ms']['median']:6.0f}" if part.get("cpu_ms") else ""
    shown = f"{ms['median']:8.1f} ({ms['least']:.0f} to {ms['most']:.0f})"
    return f"{shown:26} {cpu}; {statistics.median(part['others']):4.0%}"


def print_lines(lines: list[Line]) -> None:
    """Figures by what they are of."""
    print("\nfigures by wall time, by CPU time, and targets; *: disturbed by other programs, CPU time decides")
    for line in sorted(lines, key=lambda k: k.what.split(" (")[0]):
        verdict = ("pass" if line.holds else "FAIL") + ("*" if line.disturbed and line.by_cpu is not None else " ")
        cpu = f"{line.by_cpu:8.3f}" if line.by_cpu is not None else ""
        print(f"  {verdict} {line.what:46} {line.value:8.3f} {cpu:>8}  {line.sign} {line.target:<5g} {line.where}")
    print(f"\n{sum(line.holds for line in lines)} of {len(lines)} reached")
