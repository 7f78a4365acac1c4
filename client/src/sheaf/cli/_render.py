# SPDX-License-Identifier: MIT
"""`sheaf-client render`: submit, watch, download."""

from __future__ import annotations

import argparse
import contextlib
import json
from collections.abc import Iterator
from pathlib import Path
from shlex import quote
from typing import Any

from .._errors import FrameError, JobError
from .._exr import read_exr
from .._files import write_whole
from .._frames import frame_list, parse_frames
from .._job import Job
from .._names import FrameNames, default_pattern
from .._render_settings import SETTINGS, Setting
from ._connect import add_output, add_server, checked_name, connect
from ._exit import UsageError
from ._report import Report

# Of the settings, those that the command has options of its own for (see add_output).
_OWN = ("frames", "name", "preview")
_PLAIN = {name: setting for name, setting in SETTINGS.items() if name not in _OWN}
_NUMBERS = {"integer": int, "number": float}


def add(commands: Any) -> None:
    """Adds the command."""
    parser = commands.add_parser("render", help="submit a scene, watch it, download its frames")
    parser.add_argument("scene", metavar="SCENE", help=".glb, .gltf (with the files beside it) or .zip")
    add_output(parser)
    parser.add_argument("--resume", action="store_true", help="leave frames alone that are whole in DIR already")
    parser.add_argument("--dump", metavar="DIR", help=argparse.SUPPRESS)
    parser.add_argument("--idempotency-key", metavar="KEY", help="the same key and job again is the same job")
    parser.add_argument(
        "--cancel-on-interrupt", action="store_true", help="Ctrl-C cancels the job; else it goes on without us"
    )
    add_server(parser)
    add_settings(parser)
    parser.set_defaults(run=run)


def add_settings(parser: argparse.ArgumentParser) -> None:
    """Adds the settings of `sheaf render`, the camera path and the frames."""
    settings = parser.add_argument_group("settings, as of `sheaf render`; what is not given is the renderer's default")
    settings.add_argument("--camera", metavar="PATH.json", help="camera path")
    settings.add_argument("--frames", metavar=SETTINGS["frames"].syntax, help=SETTINGS["frames"].help)
    for name, setting in _PLAIN.items():
        _add_setting(settings, name, setting)


def _add_setting(group: Any, name: str, setting: Setting) -> None:
    text = setting.help.replace("%", "%%")
    if setting.kind == "flag":
        group.add_argument(f"--{name}", action="store_true", default=None, help=text)
    elif setting.kind == "choice":
        group.add_argument(f"--{name}", choices=setting.choices, help=text)
    else:
        listed = f": {', '.join(setting.choices)}" if setting.choices else ""
        kind = _NUMBERS.get(setting.kind, str)
        group.add_argument(f"--{name}", metavar=setting.syntax, type=kind, help=text + listed)


def settings_of(arguments: argparse.Namespace) -> dict[str, Any]:
    """What was given of them, the camera path and the frames apart."""
    if arguments.camera and arguments.camera_node:
        raise UsageError("--camera and --camera-node exclude each other")
    names = [name.replace("-", "_") for name in _PLAIN]
    return {name: getattr(arguments, name) for name in names}


def run(arguments: argparse.Namespace, report: Report) -> None:
    """Renders."""
    if arguments.dump:
        raise UsageError("--dump: a service does not hand out dumps; use `sheaf render` for it")
    chosen = settings_of(arguments)
    arguments.name = checked_name(arguments.name or default_pattern(arguments.scene))
    frames = missing_frames(arguments) if arguments.resume and arguments.frames else arguments.frames
    if frames == "":
        report.finish("all frames are there already")
        return
    with connect(arguments) as client:
        settings = chosen | {"name": arguments.name, "frames": frames, "preview": arguments.preview or None}
        job = client.submit(arguments.scene, arguments.camera, idempotency_key=arguments.idempotency_key, **settings)
        report.submitted(job.id)
        fetch(job, arguments, report, wait=True, overwrite=not arguments.resume)


def missing_frames(arguments: argparse.Namespace) -> str:
    """The frames of `--frames` that are not whole in the folder."""
    names = FrameNames(arguments.name)
    numbers = parse_frames(arguments.frames)
    missing = [number for number in numbers if not _is_whole(Path(arguments.out, names.frame(number)))]
    return frame_list(missing) if missing else ""


def _is_whole(path: Path) -> bool:
    try:
        read_exr(path)
    except (FrameError, OSError):
        return False
    return True


def fetch(job: Job, arguments: argparse.Namespace, report: Report, *, wait: bool, overwrite: bool) -> None:
    """Waits where asked to, and downloads; what is whole is fetched even where the job failed."""
    failure: JobError | None = None
    if wait:
        with detaching(job, arguments, report):
            try:
                job.wait(progress=report.progress)
            except JobError as error:
                failure = error
    for warning in job.info.warnings:
        report.warning(warning)
    paths = job.download(arguments.out, arguments.preview, overwrite, name=arguments.name, on_file=report.file)
    if failure:
        raise failure
    if arguments.stats:
        write_whole(Path(arguments.stats), json.dumps(job.stats(), indent=1) + "\n")
    report.finish(f"{len(paths)} files in {arguments.out}")


@contextlib.contextmanager
def detaching(job: Job, arguments: argparse.Namespace, report: Report) -> Iterator[None]:
    """On Ctrl-C or SIGTERM cancels the job where asked to, else leaves it and says how to come back."""
    try:
        yield
    except KeyboardInterrupt:
        if getattr(arguments, "cancel_on_interrupt", False):
            job.cancel()
            report.always(f"cancelled job {job.id}")
        else:
            report.always(
                f"job {job.id} goes on. Come back: sheaf-client download {job.id} --wait --out {quote(arguments.out)}; "
                f"stop it: sheaf-client cancel {job.id}"
            )
        raise
