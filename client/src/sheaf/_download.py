# SPDX-License-Identifier: MIT
"""Which files a download brings."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from ._models import FrameState, JobInfo
from ._names import FrameNames


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


def _service_name(frame: FrameState) -> str:
    """The service's name for a frame's file where it is a plain one; it is not trusted to stay in the folder."""
    name = frame.name or ""
    is_plain = name.isprintable() and not name.startswith(".") and not set(name) & set("/\\:")
    return name if is_plain and name.endswith(".exr") else FrameNames("frame.####.exr").frame(frame.frame)
