# SPDX-License-Identifier: MIT
"""What a command says while it works: a bar or words on standard error, or JSON lines on standard output."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

from .._models import Progress
from .._progress import ProgressBar

MODES = ("auto", "bar", "json", "none")


class Report:
    """Follows `--progress`. "auto" draws a bar where standard error is a terminal, else says nothing but errors."""

    def __init__(self, mode: str = "auto") -> None:
        self._json = mode == "json"
        shown = mode == "bar" or (mode == "auto" and sys.stderr.isatty())
        self._bar = ProgressBar() if shown else None
        self._files = 0

    def submitted(self, job_id: str) -> None:
        """The service took the job."""
        self._emit(event="start", job=job_id)

    def progress(self, progress: Progress) -> None:
        """The job went on."""
        if self._bar:
            self._bar.update(progress)
        self._emit(
            event="progress",
            state=progress.state,
            done=progress.done,
            total=progress.total,
            fraction=progress.fraction,
            eta_s=progress.eta_s,
        )

    def step(self, text: str, progress: Progress) -> None:
        """The next of many steps, in words."""
        if self._bar:
            self._bar.say(text, progress.fraction)
        self._emit(event="progress", step=text, fraction=progress.fraction)

    def file(self, frame: int, path: Path) -> None:
        """A file is there."""
        self._files += 1
        self._emit(event="frame", frame=frame, file=str(path))

    def warning(self, message: str) -> None:
        """The renderer warned."""
        self._emit(event="warning", message=message)
        self.note(f"sheaf-client: warning: {message}")

    def finish(self, text: str) -> None:
        """The command is done."""
        self.note(text)
        self._emit(event="done", files=self._files)

    def note(self, text: str) -> None:
        """Something worth knowing, where a person watches."""
        if self._bar:
            self._bar.close()
            print(text, file=sys.stderr)

    def always(self, text: str) -> None:
        """Something that must be known in every mode."""
        self.close()
        print(f"sheaf-client: {text}", file=sys.stderr)

    def error(self, code: int, message: str) -> None:
        """The failure that ends the command."""
        self._emit(event="error", code=code, message=message)
        self.always(message)

    def close(self) -> None:
        """Ends the bar."""
        if self._bar:
            self._bar.close()

    def _emit(self, **event: Any) -> None:
        if self._json:
            print(json.dumps(event), flush=True)
