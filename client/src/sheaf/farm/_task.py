# SPDX-License-Identifier: MIT
"""What a worker does: renders a chunk of frames, and says which of them are whole.

Done twice it gives the same: frames are the same bytes on every machine, and appear under their name only when whole.
"""

from __future__ import annotations

import functools
import hashlib
import json
import socket
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from .._files import file_sha256
from .._frames import frame_list
from .._names import FrameNames
from .._program import Program, find_program
from ._scene import scene_folder


@dataclass(frozen=True)
class Order:
    """What a worker is to render.

    Attributes:
        scene: file name within the worker's own copy, or the path that all machines see.
        digest: of the bundle that the copy is of; None where `scene` is a path.
        frames: numbers.
        settings: options of `sheaf render`.
        name: pattern of the file names.
        out: folder that all machines see; None: the frames are sent back.
        timeout: seconds after which the program is ended.
        program: what to run; None finds it beside Python or on PATH.
        camera: as `scene`.
        preview: whether there are PNG files, too.
    """

    scene: str
    digest: str | None
    frames: tuple[int, ...]
    settings: Mapping[str, object]
    name: str
    out: str | None
    timeout: float
    program: str | None = None
    camera: str | None = None
    preview: bool = False


@dataclass(frozen=True)
class Piece:
    """A whole file: its name, checksum and length, and its bytes where they are sent back."""

    frame: int
    name: str
    sha256: str
    length: int
    content: bytes | None = field(default=None, repr=False)


@dataclass(frozen=True)
class Report:
    """What became of an order.

    Attributes:
        pieces: whole files, in the order of the frames.
        whole: frames of which all files are there.
        seconds: that the program ran.
        totals: the engine's sums, where it got to the end.
        version: the program's.
        host: the machine.
        failure: why a frame is missing; None where none is.
        exit_code: the program's, where it ended by itself.
    """

    pieces: Sequence[Piece]
    whole: tuple[int, ...]
    seconds: float
    totals: Mapping[str, Any]
    version: str
    host: str
    failure: str | None = None
    exit_code: int | None = None


def render_chunk(order: Order, home: str | None = None) -> Report:
    """Renders an order on this machine.

    Args:
        order: what.
        home: the worker's own folder; None asks the Dask worker that this runs in.
    """
    home = home if home is not None else own_folder()
    program = engine(order.program)
    with tempfile.TemporaryDirectory(prefix="sheaf-chunk-", dir=home) as folder:
        out = Path(order.out) if order.out is not None else Path(folder, "frames")
        stats = Path(folder, "stats.json")
        settings = {
            **order.settings,
            "frames": frame_list(order.frames),
            "name": order.name,
            "stats": stats,
            "camera": located(order.camera, order.digest, home),
            "preview": order.preview,
            "resume": True,
            "progress": "none",
        }
        scene = located(order.scene, order.digest, home)
        outcome = program.render(scene or order.scene, out, settings, timeout=order.timeout)
        pieces, whole = _pieces(order, out)
        missing = len(order.frames) - len(whole)
        bad = outcome.exit_code != 0 or outcome.timed_out
        failure = outcome.reason if bad else "it ended well, but without all its frames" if missing else None
        ended = None if outcome.exit_code < 0 or outcome.timed_out else outcome.exit_code
        return Report(
            pieces,
            whole,
            outcome.seconds,
            _totals(stats),
            program.version,
            socket.gethostname(),
            failure,
            ended,
        )


def _pieces(order: Order, out: Path) -> tuple[list[Piece], tuple[int, ...]]:
    names = FrameNames(order.name)
    pieces: list[Piece] = []
    whole = []
    for frame in order.frames:
        wanted = [names.frame(frame), *([names.preview(frame)] if order.preview else [])]
        if all((out / name).is_file() for name in wanted):
            pieces += [_piece(frame, out / name, order.out is None) for name in wanted]
            whole.append(frame)
    return pieces, tuple(whole)


def _piece(frame: int, path: Path, is_sent: bool) -> Piece:
    if not is_sent:
        return Piece(frame, path.name, file_sha256(path), path.stat().st_size)
    content = path.read_bytes()
    return Piece(frame, path.name, hashlib.sha256(content).hexdigest(), len(content), content)


def _totals(stats: Path) -> Mapping[str, Any]:
    try:
        totals = json.loads(stats.read_text()).get("totals", {})
    except (OSError, ValueError):
        return {}
    return totals if isinstance(totals, dict) else {}


@functools.cache
def engine(name: str | None) -> Program:
    """The program of this machine, found once."""
    return find_program(name)


def located(name: str | None, digest: str | None, home: str) -> str | None:
    """Where a file of the order lies on this machine."""
    if name is None or digest is None:
        return name
    return str(scene_folder(home, digest) / name)


def own_folder() -> str:
    """The folder of the Dask worker that this runs in."""
    from distributed import get_worker  # noqa: PLC0415 - only where there is one

    return str(get_worker().local_directory)
