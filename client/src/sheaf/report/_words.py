# SPDX-License-Identifier: MIT
"""What a study found, in sentences."""

from __future__ import annotations

from ._canvas import short
from ._html import escaped
from ._study import SceneStudy, Study


def headlines(study: Study) -> list[str]:
    """The findings, each a line of HTML."""
    lines = []
    for scene in study.scenes:
        lines += _of_scene(scene)
    rows = study.stability
    if rows:
        bad = [row for row in rows if not row.is_good]
        said = "all the same bytes, all finite" if not bad else f"{len(bad)} of them not: see the table"
        lines.append(f"Stability: <strong>{len(rows)}</strong> renders of pictures that should be equal, {said}.")
    return lines


def _of_scene(scene: SceneStudy) -> list[str]:
    name = f"<strong>{escaped(scene.name)}</strong>"
    fastest = scene.fastest
    if fastest is None:
        return [f"{name}: {escaped(scene.failure or 'nothing was measured')}."]
    rate = short(fastest.rays_per_second or 0)
    lines = [
        f"{name}: <strong>{escaped(fastest.point.label)}</strong> is fastest, {fastest.median_ms:.0f} ms per frame, "
        f"{rate} rays per second."
    ]
    parts = []
    for saving in scene.savings:
        share = saving.tests.get("all")
        if share is not None:
            verb = "saves" if share >= 0 else "costs"
            parts.append(f"{escaped(saving.part)} {verb} {abs(share):.0%}")
    if parts:
        lines.append(f"{name}, intersection tests: {'; '.join(parts)}.")
    named = [trial for trial in scene.knobs if trial.point.name and trial.errors and trial.wall_ms]
    if named:
        front = scene.front()
        told = [
            f"{escaped(trial.point.name)} {trial.median_ms:.0f} ms at RMSE {trial.errors.rmse:.2g}"
            + ("" if any(trial is other for other in front) else " (beaten)")
            for trial in named
            if trial.errors
        ]
        lines.append(f"{name}, named settings: {'; '.join(told)}.")
    return lines


def method(study: Study) -> list[str]:
    """How it was measured, in lines of HTML."""
    options = study.options
    machine = study.machine
    memory = f", {int(machine['memory_mib']) / 1024:.0f} GiB" if "memory_mib" in machine else ""
    device = study.device
    return [
        f"Machine: {escaped(machine['processor'])}, {machine['cores']} cores{memory}; {escaped(machine['system'])}.",
        f"Device: {escaped(device.get('name', 'unknown'))}; driver {escaped(device.get('driver', 'unknown'))}.",
        "Versions: " + ", ".join(f"{escaped(name)} {escaped(text)}" for name, text in study.versions.items()) + ".",
        f"Pictures of {escaped(options.size)}, frame {options.frame} at {options.fps:g} frames per second. Reference: "
        f"<code>--strategy reference</code>, double precision, {options.reference_spp} samples per pixel, depth "
        f"{options.reference_depth}, cutoff 0. Colours are stored in half precision, so an RMSE near 10⁻⁴ of the "
        "brightness is as good as none.",
        f"Times: wall clock of a frame, the median of {options.repeats} after one that does not count; whiskers are "
        "the fastest and the slowest. Frames that move are timed a microsecond apart in one process, frames that stand "
        "still by a process each. Tests are counted in a run of their own, which is not timed.",
        "RMSE and relative MSE, (a-b)²/(b²+0.01), are over linear colour; FLIP is HDR-FLIP's mean. On the Pareto front "
        "is what nothing else beats in both error and cost.",
        f"{study.seconds / 60:.1f} minutes in all, made {escaped(study.made)}.",
    ]
