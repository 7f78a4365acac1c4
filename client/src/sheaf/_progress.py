# SPDX-License-Identifier: MIT
"""A progress bar for terminals, and its words for those who want only them."""

from __future__ import annotations

import shutil
import sys
from typing import TextIO

from ._models import Progress


class ProgressBar:
    """Draws one line anew with every change; on what is not a terminal, one line for every tenth.

    Args:
        stream: where to; standard error where not given.
        width: columns; the terminal's where not given.
    """

    def __init__(self, stream: TextIO | None = None, width: int | None = None) -> None:
        self._stream = stream if stream is not None else sys.stderr
        self._live = self._stream.isatty()
        self._width = width
        self._tenth = -1
        self._drawn = False

    def update(self, progress: Progress) -> None:
        """Shows a state."""
        if self._live:
            width = self._width or shutil.get_terminal_size().columns
            self._write("\r\x1b[K" + bar_line(progress, width - 1))
            self._drawn = True
            return
        tenth = int(progress.fraction * 10)
        if tenth != self._tenth:
            self._tenth = tenth
            self._write(words(progress) + "\n")

    def say(self, text: str, fraction: float) -> None:
        """Shows words and a share, for work that has no frames to count."""
        line = f"{fraction:4.0%}  {text}"
        if self._live:
            width = self._width or shutil.get_terminal_size().columns
            self._write("\r\x1b[K" + line[: width - 1])
            self._drawn = True
        else:
            self._write(line + "\n")

    def close(self) -> None:
        """Ends the line."""
        if self._drawn:
            self._write("\n")
            self._drawn = False

    def _write(self, text: str) -> None:
        self._stream.write(text)
        self._stream.flush()


def words(progress: Progress) -> str:
    """A state in words: percent, frames and time left."""
    if progress.state == "queued":
        return "queued"
    parts = [f"{progress.fraction:4.0%}", f"{progress.done}/{progress.total} frames"]
    if progress.state != "running":
        parts.append(progress.state)
    elif progress.eta_s is not None:
        parts.append(f"{duration(progress.eta_s)} left")
    return "  ".join(parts)


def bar_line(progress: Progress, width: int) -> str:
    """Words with a bar before them as wide as there is room for."""
    text = words(progress)
    room = min(40, width - len(text) - 4)
    if room < 8:
        return text[:width]
    full = round(progress.fraction * room)
    return f"[{'#' * full}{'-' * (room - full)}] {text}"


def duration(seconds: float) -> str:
    """Minutes and seconds, with hours where there are some."""
    minutes, rest = divmod(max(0, round(seconds)), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{rest:02d}" if hours else f"{minutes}:{rest:02d}"
