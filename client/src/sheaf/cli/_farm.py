# SPDX-License-Identifier: MIT
"""`sheaf-client farm render`: an animation on a Dask cluster."""

from __future__ import annotations

import argparse
import contextlib
import json
from collections.abc import Iterator
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .._files import write_whole
from ._connect import checked_name
from ._exit import UsageError
from ._render import add_settings, settings_of
from ._report import MODES, Report

if TYPE_CHECKING:
    from distributed import Client as DaskClient

_SHARING = {
    "chunk_seconds": (float, "about how long a chunk takes a worker (default 60)"),
    "largest_chunk": (int, "frames of a chunk at most (default 1000)"),
    "retries": (int, "further tries of a frame that failed for a reason that may pass (default 3)"),
    "late_factor": (float, "a chunk this many times as late as its like gets a copy (default 3)"),
    "least_late_seconds": (float, "no chunk is late before (default 60)"),
    "frame_seconds": (float, "what the first frame may take (default 3600)"),
    "timeout_factor": (float, "what a chunk may take, as a multiple of its like (default 20)"),
    "least_timeout_seconds": (float, "no program is ended before (default 300)"),
}


def add(commands: Any) -> None:
    """Adds the commands."""
    farm = commands.add_parser("farm", help="render on a Dask cluster")
    kinds = farm.add_subparsers(title="commands", metavar="COMMAND", required=True)
    parser = kinds.add_parser(
        "render",
        help="share an animation's frames out",
        description="Each worker needs this package with its extra `farm` and the program `sheaf`. "
        "Frames are the same bytes as one machine's. Again with the same --out, it goes on where it stopped.",
    )
    parser.add_argument("scene", metavar="SCENE", help=".glb or .gltf, sent to each worker once")
    parser.add_argument("--out", required=True, metavar="DIR", help="folder for the frames, made where it is missing")
    parser.add_argument("--name", metavar="PATTERN", help="file names, with #### for the frame number")
    parser.add_argument("--preview", action="store_true", help="a tone-mapped PNG beside each frame")
    parser.add_argument("--stats", metavar="FILE", help="where to write sums over all workers, as JSON")
    parser.add_argument("--progress", choices=MODES, default="auto")
    parser.add_argument("--fresh", action="store_true", help="render frames again that are there already")
    where = parser.add_argument_group("cluster, one of").add_mutually_exclusive_group(required=True)
    where.add_argument("--scheduler", metavar="ADDRESS", help="such as tcp://host:8786")
    where.add_argument("--scheduler-file", metavar="FILE", help="as `dask scheduler --scheduler-file` writes it")
    where.add_argument("--local", type=int, metavar="N", help="a cluster of N workers on this machine")
    how = parser.add_argument_group("sharing")
    how.add_argument("--shared", action="store_true", help="workers see DIR under this path and write there themselves")
    how.add_argument("--shared-scene", action="store_true", help="workers see SCENE under this path: it is not sent")
    how.add_argument("--sheaf", metavar="PROGRAM", help="on the workers; default: beside their Python, else on PATH")
    for name, (kind, text) in _SHARING.items():
        how.add_argument(f"--{name.replace('_', '-')}", type=kind, metavar="N", help=text)
    add_settings(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace, report: Report) -> None:
    """Renders."""
    try:
        from ..farm import FarmOptions, render  # noqa: PLC0415 - an extra
    except ImportError as error:
        raise UsageError(f"farm wants more packages: pip install 'sheaf[farm]' ({error})") from error
    if arguments.name:
        checked_name(arguments.name)
    known = {field.name for field in fields(FarmOptions)}
    sharing = {name: value for name in _SHARING if name in known and (value := getattr(arguments, name)) is not None}
    with _cluster(arguments) as dask:
        result = render(
            dask,
            arguments.scene,
            arguments.out,
            arguments.frames or 0,
            camera=arguments.camera,
            name=arguments.name,
            preview=arguments.preview,
            shared=arguments.shared,
            scene_is_shared=arguments.shared_scene,
            program=arguments.sheaf,
            resume=not arguments.fresh,
            options=FarmOptions(**sharing),
            progress=report.progress,
            on_file=report.file,
            **settings_of(arguments),
        )
    if len(result.versions) > 1:
        report.warning(f"workers have different versions: {', '.join(sorted(result.versions))}")
    if result.outdated:
        report.warning(
            f"frames that were there and were rendered again: {result.outdated}, "
            "of another scene, camera, setting or version, or not whole"
        )
    if arguments.stats:
        write_whole(Path(arguments.stats), json.dumps(_sums(result), indent=1) + "\n")
    report.finish(
        f"{len(result.files)} frames in {arguments.out}: {result.seconds:.0f} s, "
        f"{result.worker_seconds:.0f} s of workers, {result.retried} tried again"
    )


def _sums(result: Any) -> dict[str, Any]:
    return {
        "schema": 1,
        "frames": len(result.files),
        "skipped": result.skipped,
        "outdated": result.outdated,
        "seconds": result.seconds,
        "worker_seconds": result.worker_seconds,
        "retried": result.retried,
        "copies": result.copies,
        "versions": sorted(result.versions),
        "frames_by_host": dict(result.frames_by_host),
        "totals": result.totals,
    }


@contextlib.contextmanager
def _cluster(arguments: argparse.Namespace) -> Iterator[DaskClient]:
    from distributed import Client, LocalCluster  # noqa: PLC0415 - an extra

    if arguments.local is not None:
        if arguments.local < 1:
            raise UsageError(f"--local must be positive: {arguments.local}")
        with (
            LocalCluster(  # type: ignore[no-untyped-call]
                n_workers=arguments.local, threads_per_worker=1, dashboard_address=None
            ) as cluster,
            Client(cluster) as client,  # type: ignore[no-untyped-call]
        ):
            yield client
        return
    where = {"scheduler_file": arguments.scheduler_file} if arguments.scheduler_file else {}
    with Client(arguments.scheduler, **where) as client:  # type: ignore[no-untyped-call]
        yield client
