# SPDX-License-Identifier: MIT
"""Which files a download brings, and bringing them. `_async_job` brings the same ones without blocking."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from . import _calls
from ._files import file_sha256, whole_file
from ._models import FrameState, JobInfo
from ._names import FrameNames
from ._session import Session


@dataclass(frozen=True)
class Wanted:
    """A file to bring; `sha256` where the service told it beforehand."""

    number: int
    kind: Literal["exr", "png"]
    path: Path
    sha256: str | None = None


def plan(info: JobInfo, folder: Path, numbers: Iterable[int] | None, name: str | None, previews: bool) -> list[Wanted]:
    """The files of a download, in the order of the frames.

    Raises:
        ValueError: the name pattern is not one.
    """
    names = FrameNames(name) if name is not None else None
    known = {frame.frame: frame for frame in info.frames}
    wanted = []
    for number in info.rendered if numbers is None else numbers:
        frame = known.get(number, FrameState(number, "unknown"))
        path = folder / (names.frame(number) if names else _service_name(frame))
        wanted.append(Wanted(number, "exr", path, frame.sha256))
        if previews:
            wanted.append(Wanted(number, "png", path.with_suffix(".png")))
    return wanted


def fetch(session: Session, job_id: str, wanted: Wanted, overwrite: bool) -> None:
    """Brings one file, again where the session's policy says so; leaves it alone where it is there and the same.

    Raises:
        TransportError: it did not come whole, again and again.
    """
    have = file_sha256(wanted.path) if wanted.path.is_file() and not overwrite else None
    if have is None or have != wanted.sha256:
        session.patiently(lambda: _fetch_once(session, job_id, wanted, have))


def fetch_all(
    session: Session, job_id: str, files: Sequence[Wanted], overwrite: bool, connections: int
) -> Iterator[Wanted]:
    """Brings files, several at once; tells of each once it is there, in the order given.

    The first failure ends it: what is not begun by then is not fetched any more.
    """
    with ThreadPoolExecutor(max(1, connections), "sheaf-download") as pool:
        coming = [pool.submit(fetch, session, job_id, wanted, overwrite) for wanted in files]
        try:
            for wanted, future in zip(files, coming, strict=True):
                future.result()
                yield wanted
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


def _fetch_once(session: Session, job_id: str, wanted: Wanted, have: str | None) -> None:
    call = _calls.frame(job_id, wanted.number, wanted.kind, have)
    with session.stream(call) as response:
        if response.status_code == 304:
            return
        with whole_file(wanted.path) as file:
            for block in response.iter_bytes(1 << 20):
                file.write(block)
            file.finish(response, wanted.sha256)


def _service_name(frame: FrameState) -> str:
    """The service's name for a frame's file where it is a plain one; it is not trusted to stay in the folder."""
    name = frame.name or ""
    is_plain = name.isprintable() and not name.startswith(".") and not set(name) & set("/\\:")
    return name if is_plain and name.endswith(".exr") else FrameNames("frame.####.exr").frame(frame.frame)
