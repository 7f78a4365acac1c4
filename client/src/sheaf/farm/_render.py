# SPDX-License-Identifier: MIT
"""Renders an animation on a Dask cluster."""

from __future__ import annotations

import contextlib
import hashlib
import os
import queue
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any

from distributed import Client as DaskClient
from distributed import Future, KilledWorker

from .._errors import RenderError
from .._files import file_sha256, write_whole_bytes
from .._frames import frame_list, parse_frames
from .._models import Progress
from .._names import FrameNames, default_pattern
from .._settings import wire_settings
from ._ledger import Chunk, FarmOptions, Ledger
from ._result import FarmResult, add_sums
from ._scene import Bundle, ScenePlugin, bundle, plugin_name
from ._stock import Inputs, is_current, wanted_inputs
from ._task import Order, Piece, Report, render_chunk
from ._workers import Workers

TICK_SECONDS = 1.0
"""How often lateness is looked at where nothing happens."""


def render(
    dask: DaskClient,
    scene: str | os.PathLike[str],
    out: str | os.PathLike[str],
    frames: str | int | Iterable[int] = 0,
    *,
    camera: str | os.PathLike[str] | None = None,
    name: str | None = None,
    preview: bool = False,
    shared: bool = False,
    scene_is_shared: bool = False,
    program: str | None = None,
    resume: bool = True,
    options: FarmOptions | None = None,
    progress: Callable[[Progress], object] = lambda _: None,
    on_file: Callable[[int, Path], object] = lambda frame, path: None,
    **settings: Any,
) -> FarmResult:
    """Renders frames on all workers of a cluster, and returns when all are there.

    Each worker needs this package and the program `sheaf`, and had best run one task at a time (`--nthreads 1`): the
    program uses all cores or the whole device.

    Args:
        dask: the cluster; workers may come and go.
        scene: a .glb or .gltf, sent to each worker once with all that it needs.
        out: folder for the frames.
        frames: absolute numbers, as `--frames` takes them.
        camera: camera path.
        name: pattern of the file names; the scene's with the number in four digits where not given.
        preview: a tone-mapped PNG beside each frame.
        shared: whether all machines see `out` under this very path; then workers write there themselves. Else frames
            are sent back and written here, each checked against its checksum.
        scene_is_shared: whether all machines see `scene` under this very path; then it is not sent.
        program: what workers run; None finds `sheaf` beside their Python or on their PATH.
        resume: leave frames alone that are there already, of the same scene, camera, settings and version; all
            others are rendered again.
        options: how frames are shared out.
        progress: called with every change.
        on_file: called with frame and path as each file is there.
        settings: further ones of `RenderSettings`.

    Raises:
        RenderError: frames are missing in the end; `exit_code` is that of the first. All others are there.
        SceneError: the scene cannot be sent.
        OSError: a frame cannot be written here.
        TypeError: a setting has an unknown name.
    """
    numbers = parse_frames(frame_list(frames))
    pattern = name or default_pattern(os.fspath(scene))
    folder = Path(out).resolve() if shared else Path(out)
    folder.mkdir(parents=True, exist_ok=True)
    content = None if scene_is_shared else bundle(scene, camera)
    order = Order(
        scene=str(Path(scene).resolve()) if content is None else content.name,
        digest=None if content is None else content.digest,
        frames=(),
        settings=wire_settings(settings),
        name=pattern,
        out=str(folder) if shared else None,
        timeout=0.0,
        program=program,
        camera=content.camera if content else None if camera is None else str(Path(camera).resolve()),
        preview=preview,
    )
    run = _Run(dask, order, Ledger(numbers, options or FarmOptions()), folder, progress, on_file)
    with _sent(dask, content):
        run.take_stock(FrameNames(pattern), resume)
        return run.go()


@contextlib.contextmanager
def _sent(dask: DaskClient, content: Bundle | None) -> Iterator[None]:
    """The scene is with the workers as long as this lasts."""
    if content is None:
        yield
        return
    dask.register_plugin(ScenePlugin(content))
    try:
        yield
    finally:
        with contextlib.suppress(Exception):  # the cluster may be gone, and nothing hangs on it
            dask.unregister_worker_plugin(plugin_name(content.digest))  # type: ignore[no-untyped-call]


class _Run:
    """One rendering, from the first chunk to the last."""

    def __init__(
        self,
        dask: DaskClient,
        order: Order,
        ledger: Ledger,
        folder: Path,
        progress: Callable[[Progress], object],
        on_file: Callable[[int, Path], object],
    ) -> None:
        self._dask, self._order, self._ledger, self._folder = dask, order, ledger, folder
        self._progress, self._on_file = progress, on_file
        self._workers = Workers(dask)
        self._result = FarmResult()
        self._ended: queue.SimpleQueue[tuple[Chunk, Future[Report]]] = queue.SimpleQueue()
        self._flying: dict[int, Future[Report]] = {}

    def take_stock(self, names: FrameNames, resume: bool) -> None:
        """Finds the frames that are there already, or removes them."""
        there: dict[int, list[Path]] = {}
        for frame in self._ledger.frames:
            paths = [self._folder / names.frame(frame)]
            paths += [self._folder / names.preview(frame)] if self._order.preview else []
            if resume and all(path.is_file() for path in paths):
                there[frame] = paths
            elif not resume:
                _remove(paths)
        for frame in self._outdated(there):
            _remove(there.pop(frame))  # or a worker that writes here would take it for its own
            self._result.outdated += 1
        self._result.files.update(there)
        self._ledger.already_there(list(there))
        self._result.skipped = len(there)

    def _outdated(self, there: Mapping[int, list[Path]]) -> list[int]:
        """Frames that would not be rendered as they are now."""
        if not there:
            return []
        order = Order(**{**vars(self._order), "frames": tuple(there)})
        asked: Future[dict[int, Inputs] | None] = self._dask.submit(wanted_inputs, order, pure=False)
        wanted = asked.result()
        return [] if wanted is None else [n for n, paths in there.items() if not is_current(paths[0], wanted[n])]

    def go(self) -> FarmResult:
        begun = time.monotonic()
        self._tell()
        try:
            while not self._ledger.is_over:
                self._hand_out()
                with contextlib.suppress(queue.Empty):
                    self._take_in(*self._ended.get(timeout=TICK_SECONDS))
        finally:
            self._dask.cancel(list(self._flying.values()))  # type: ignore[no-untyped-call]
        result, ledger = self._result, self._ledger
        result.seconds = time.monotonic() - begun
        result.retried, result.copies = ledger.retried, ledger.copies
        if ledger.failed:
            frame, (reason, exit_code) = min(ledger.failed.items())
            more = f", and {len(ledger.failed) - 1} more" if len(ledger.failed) > 1 else ""
            raise RenderError(f"frame {frame}: {reason}{more}", exit_code)
        self._tell()
        return result

    def _hand_out(self) -> None:
        """Keeps every worker busy with one chunk, and one more in hand."""
        workers = len(self._workers)
        now = time.monotonic()
        while len(self._flying) < 2 * workers and (chunk := self._ledger.next_chunk(now, workers)):
            self._submit(chunk)
        # Every place may be taken by chunks of a worker that is lost without the cluster having noticed yet.
        if chunk := self._ledger.late_chunk(now):
            self._submit(chunk)

    def _submit(self, chunk: Chunk) -> None:
        order = Order(**{**vars(self._order), "frames": chunk.frames, "timeout": chunk.timeout})
        key = f"sheaf-{id(self):x}-{chunk.id}"
        away = self._holders(chunk) if chunk.is_copy else []
        others = [address for address in self._workers.addresses() if address not in away] if away else []
        # A wish, no condition: a task that may only run where nobody is left would wait for ever.
        wish = {"workers": others, "allow_other_workers": True} if others else {}
        future: Future[Report] = self._dask.submit(render_chunk, order, key=key, pure=False, retries=0, **wish)
        self._flying[chunk.id] = future
        future.add_done_callback(partial(self._note_end, chunk))  # type: ignore[no-untyped-call]

    def _note_end(self, chunk: Chunk, future: Future[Report]) -> None:
        self._ended.put((chunk, future))

    def _holders(self, chunk: Chunk) -> list[str]:
        """Workers that are at the frames of a copy already."""
        running: Mapping[str, Iterable[str]] = self._dask.processing()  # type: ignore[no-untyped-call]
        own = {future.key for future in self._flying.values()}
        return [address for address, keys in running.items() if own & {str(key) for key in keys}]

    def _take_in(self, chunk: Chunk, future: Future[Report]) -> None:
        self._flying.pop(chunk.id, None)
        try:
            report: Report = future.result()
        except KilledWorker as error:
            self._ledger.broke(chunk, f"workers died of it ({error.last_worker})", None, knows_frame=False)
            return
        except Exception as error:  # whatever a worker far away raises costs no more than its frames
            self._ledger.broke(chunk, f"{type(error).__name__}: {error}", None, knows_frame=False)
            return
        try:
            self._keep(chunk, report)
        except ValueError as error:
            self._ledger.broke(chunk, str(error), None, knows_frame=False)
        self._tell()

    def _keep(self, chunk: Chunk, report: Report) -> None:
        """Takes over what is whole.

        Raises:
            ValueError: bytes are not those of their checksum.
        """
        paths: dict[int, list[Path]] = {}
        for piece in report.pieces:
            paths.setdefault(piece.frame, []).append(self._checked(piece))
        new = self._ledger.finished(chunk, report.whole, report.seconds)
        result = self._result
        result.worker_seconds += report.seconds
        result.versions.add(report.version)
        result.frames_by_host[report.host] += len(new)
        add_sums(result.totals, report.totals)
        for frame in new:
            result.files[frame] = paths[frame]
            for path in paths[frame]:
                self._on_file(frame, path)
        if report.failure is not None:
            self._ledger.broke(chunk, report.failure, report.exit_code)

    def _checked(self, piece: Piece) -> Path:
        path = self._folder / Path(piece.name).name
        content = piece.content
        if content is not None and hashlib.sha256(content).hexdigest() == piece.sha256:
            write_whole_bytes(path, content)
        elif content is not None or not path.is_file() or file_sha256(path) != piece.sha256:
            raise ValueError(f"{piece.name}: the bytes here are not those that the worker wrote")
        return path

    def _tell(self) -> None:
        total, done = len(set(self._ledger.frames)), self._ledger.done
        state: Any = "done" if done == total else "running"
        self._progress(Progress(state, done, total, done / total, self._ledger.eta(len(self._workers))))


def _remove(paths: Iterable[Path]) -> None:
    for path in paths:
        path.unlink(missing_ok=True)
