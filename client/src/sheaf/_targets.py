# SPDX-License-Identifier: MIT
"""What a path to write to leads to: a file that a rename can replace, or something that takes bytes as they come."""

from __future__ import annotations

import os
import re
import stat
from dataclasses import dataclass
from pathlib import Path

_MOST_LINKS = 40


@dataclass(frozen=True)
class WriteTarget:
    """The end of a path's symbolic links.

    Attributes:
        path: what a rename replaces; it may not exist yet.
        is_stream: whether it is a FIFO, a device or an open descriptor, which is written and never replaced.
        descriptor: of this process, where the path names one (/dev/stdout, /dev/fd/N).
    """

    path: Path
    is_stream: bool
    descriptor: int | None = None

    def send(self, data: bytes) -> None:
        """Writes to the stream; waits for a FIFO's reader."""
        if self.descriptor is None:
            opened = os.open(self.path, os.O_WRONLY | getattr(os, "O_NOCTTY", 0))
        else:
            opened = os.dup(self.descriptor)  # opened anew, a regular file would be written from its start
        with os.fdopen(opened, "wb") as file:
            file.write(data)


def find_write_target(path: Path) -> WriteTarget:
    """Follows symbolic links; a path that cannot be followed is its own target."""
    at = path
    for _ in range(_MOST_LINKS + 1):
        folder = os.path.realpath(at.parent)
        match = re.fullmatch(rf"/proc/{os.getpid()}/fd/(\d+)", f"{folder}/{at.name}")
        if match:
            return WriteTarget(path, True, int(match[1]))
        if not at.is_symlink():
            return WriteTarget(at, _takes_a_stream(at))
        at = Path(folder) / at.readlink()
    return WriteTarget(path, _takes_a_stream(path))


def _takes_a_stream(path: Path) -> bool:
    try:
        mode = path.stat().st_mode
    except OSError:
        return False
    return not stat.S_ISREG(mode) and not stat.S_ISDIR(mode)
