# SPDX-License-Identifier: MIT
"""`sheaf-client report`: error against run time, stability and test counts of the engine on this machine."""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from .._errors import SceneError, SheafError
from .._models import Progress
from .._program import find_program
from ._exit import UsageError
from ._report import MODES, Report

T = TypeVar("T")

_COMMON = ("camera", "camera-node", "animation", "scene-name", "variant", "environment", "device")


def add(commands: Any) -> None:
    """Adds the command."""
    parser = commands.add_parser(
        "report",
        help="measure error against run time, stability and test counts here",
        description="Renders scenes with `sheaf` over the settings that trade error for time, and holds them against "
        "--strategy reference. Writes report.html, report.json, tables as CSV and plots as PNG. "
        "Times are worth what the machine's quiet is worth: let nothing else run.",
    )
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help="default: a small scene that is made for it")
    parser.add_argument("--out", required=True, metavar="DIR", help="folder for the report, made where it is missing")
    parser.add_argument("--sheaf", metavar="PROGRAM", help="default: the one beside this program, else on PATH")
    parser.add_argument("--extreme", nargs="+", default=[], metavar="SCENE", help="looked at for stability alone")
    parser.add_argument("--progress", choices=MODES, default="auto")
    how = parser.add_argument_group("how large")
    how.add_argument("--size", help="of the pictures (default 192x108)")
    how.add_argument("--frame", type=int, help="which frame (default 0)")
    how.add_argument("--fps", type=float, help="frames per second (default 24)")
    how.add_argument("--minutes", type=float, help="when to stop beginning new measurements (default 10)")
    how.add_argument(
        "--repeats", type=int, help="timed runs of a point, beside a first that does not count (default 3)"
    )
    how.add_argument("--point-seconds", type=float, help="when to end a run that takes too long (default 60)")
    how.add_argument("--reference-spp", type=int, help="samples per pixel of the reference (default 64)")
    how.add_argument("--reference-depth", type=int, help="generations of the reference (default 16)")
    knobs = parser.add_argument_group("what to try, each a list with commas")
    knobs.add_argument("--spp", type=_list(int), help="samples per pixel (default 1,2,4,8,16)")
    knobs.add_argument("--depth", type=_list(int), help="generations (default 1,2,4,8)")
    knobs.add_argument("--cutoff", type=_list(float), help="least weights (default 0,0.002,0.02,0.1)")
    knobs.add_argument("--memory", type=_list(int), help="budgets, MiB (default 16)")
    knobs.add_argument("--strategies", type=_list(str), help="default: all but auto, brute and reference")
    knobs.add_argument(
        "--knob", type=_knob, action="append", default=[], metavar="OPTION=A,B", help="another option of `sheaf render`"
    )
    common = parser.add_argument_group("passed on to every render")
    for name in _COMMON:
        common.add_argument(f"--{name}")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace, report: Report) -> None:
    """Measures, and writes the report."""
    try:
        from ..report import StudyOptions, study, write_report, write_sample  # noqa: PLC0415 - an extra
    except ImportError as error:
        raise UsageError(f"report wants more packages: pip install 'sheaf[report]' ({error})") from error

    names: tuple[str, ...] = (
        "size",
        "frame",
        "fps",
        "minutes",
        "repeats",
        "point_seconds",
        "reference_spp",
        "reference_depth",
    )
    names += ("spp", "depth", "cutoff", "memory", "strategies")
    given = {name: value for name in names if (value := getattr(arguments, name)) is not None}
    common = {name: value for name in _COMMON if (value := getattr(arguments, name.replace("-", "_"))) is not None}
    options = StudyOptions(**given, knobs=dict(arguments.knob), common=common)
    _check(options)
    program = find_program(arguments.sheaf)
    scenes, extremes = ([_scene(path) for path in paths] for paths in (arguments.scenes, arguments.extreme))
    out = Path(arguments.out)
    out.mkdir(parents=True, exist_ok=True)

    def follow(text: str, share: float) -> None:
        report.step(text, Progress("running", 0, 0, share))

    with tempfile.TemporaryDirectory(prefix="sheaf-report-") as folder:
        if not scenes and not extremes:
            scenes = [write_sample(Path(folder, "sample.glb"))]
        result = study(program, scenes, extremes, options, follow)
    for path in write_report(result, out):
        report.file(options.frame, path)
    failed = [scene for scene in result.scenes if scene.failure]
    if failed and len(failed) == len(result.scenes):
        raise SheafError("; ".join(f"{scene.path}: {scene.failure}" for scene in failed))
    report.finish(f"{out / 'report.html'}")


def _scene(name: str) -> Path:
    path = Path(name)
    if not path.is_file():
        raise SceneError(f"{path}: no such file")
    return path


def _check(options: Any) -> None:
    for name in ("fps", "minutes", "repeats", "point_seconds", "reference_spp"):
        if not getattr(options, name) > 0:
            raise UsageError(f"--{name.replace('_', '-')} must be positive")
    if not (options.spp and options.depth):
        raise UsageError("--spp and --depth need at least one value")


def _list(kind: Callable[[str], T]) -> Callable[[str], tuple[T, ...]]:
    def read(text: str) -> tuple[T, ...]:
        try:
            return tuple(kind(item) for item in text.split(",") if item)
        except ValueError as error:
            raise argparse.ArgumentTypeError(f"{text!r}: {error}") from error

    return read


def _knob(text: str) -> tuple[str, tuple[str, ...]]:
    name, separator, values = text.partition("=")
    if not (name and separator and values):
        raise argparse.ArgumentTypeError(f"{text!r} is not OPTION=A,B")
    return name.removeprefix("--"), tuple(values.split(","))
