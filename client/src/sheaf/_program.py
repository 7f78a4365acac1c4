# SPDX-License-Identifier: MIT
"""The engine's command line, `sheaf`, run on this machine: found, given settings, watched, and ended in time."""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ._errors import RenderError, SheafError

PROBE_SECONDS = 30.0
"""What `--version` and `options` may take; they touch no device."""

_LAST_LINES = 5


@dataclass(frozen=True)
class Outcome:
    """How a run of the program ended.

    Attributes:
        exit_code: the program's; negative where a signal ended it.
        seconds: wall-clock time of the whole process.
        said: the last lines on standard error.
        timed_out: whether it was ended because its time was over.
    """

    exit_code: int
    seconds: float
    said: str = ""
    timed_out: bool = False

    @property
    def reason(self) -> str:
        """Why it did not do what it was asked to, in a line."""
        if self.timed_out:
            return f"not done after {self.seconds:.0f} s"
        return self.said or (
            f"ended by signal {-self.exit_code}" if self.exit_code < 0 else f"exit code {self.exit_code}"
        )


@dataclass(frozen=True)
class Program:
    """A `sheaf` that is there.

    Attributes:
        path: of the program.
        version: what `--version` says.
        strategies: those that its `--strategy` names.
        options: the long options of `sheaf render`, without the dashes.
        qualities: those that its `--quality` names.
    """

    path: Path
    version: str
    strategies: tuple[str, ...]
    options: frozenset[str]
    qualities: tuple[str, ...] = ()

    def render(
        self,
        scene: str | os.PathLike[str],
        out: Path,
        settings: Mapping[str, object],
        *,
        timeout: float | None = None,
        environment: Mapping[str, str] | None = None,
    ) -> Outcome:
        """Runs `sheaf render`; what it leaves in `out` is whole, however it ends."""
        command = [str(self.path), "render", os.fspath(scene), "--out", str(out), *option_list(settings)]
        return run(command, timeout=timeout, environment=environment)

    def list_inputs(
        self, scene: str | os.PathLike[str], out: Path, settings: Mapping[str, object]
    ) -> list[dict[str, Any]]:
        """What decides each frame that `render` would make, in the order of the frames; nothing is rendered.

        Raises:
            RenderError: the program refuses the scene or a setting.
        """
        command = [str(self.path), "render", os.fspath(scene), "--out", str(out), "--list-inputs"]
        told = subprocess.run(  # noqa: S603 - no shell, and the program is the one that the user named
            [*command, *option_list(settings)], stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False
        )
        if told.returncode != 0:
            raise RenderError(told.stderr.strip(), told.returncode if told.returncode > 0 else None)
        return [json.loads(line) for line in told.stdout.splitlines()]


def find_program(given: str | os.PathLike[str] | None = None) -> Program:
    """The program `sheaf`: the one given, else the one beside this command, else the one on PATH.

    Raises:
        SheafError: there is none, or it does not run.
    """
    path = Path(given) if given is not None else _installed()
    if path is None:
        raise SheafError("no program `sheaf` beside this one nor on PATH: name it with --sheaf")
    said = []
    for arguments in (["--version"], ["options", "--json"]):
        try:
            told = subprocess.run(  # noqa: S603 - the program that the user named
                [path, *arguments], capture_output=True, text=True, timeout=PROBE_SECONDS, check=True
            )
        except (OSError, subprocess.SubprocessError) as error:
            raise SheafError(f"{path}: it is no `sheaf` that runs here ({error})") from error
        said.append(told.stdout)
    version, table = said
    try:
        choices = {setting["name"]: tuple(setting["choices"] or ()) for setting in json.loads(table)}
    except (ValueError, TypeError, KeyError) as error:
        raise SheafError(f"{path}: what its options are is no table of settings ({error!r})") from error
    return Program(path, version.strip(), choices.get("strategy", ()), frozenset(choices), choices.get("quality", ()))


def option_list(settings: Mapping[str, object]) -> list[str]:
    """Settings as arguments; True is a switch, None and False are left out."""
    arguments = []
    for name, value in settings.items():
        if value is None or value is False:
            continue
        option = f"--{name.replace('_', '-')}"
        # One argument each, so that a value that begins with a dash is no option.
        arguments.append(option if value is True else f"{option}={value}")
    return arguments


def run(
    command: Sequence[str], *, timeout: float | None = None, environment: Mapping[str, str] | None = None
) -> Outcome:
    """Runs a command in a process group of its own, which is gone when this returns or raises."""
    begun = time.monotonic()
    with subprocess.Popen(  # noqa: S603 - no shell, and the program is the one that the user named
        command,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        errors="replace",
        env=None if environment is None else {**os.environ, **environment},
        start_new_session=True,
    ) as process:
        timed_out = False
        try:
            _, said = process.communicate(timeout=timeout)
        except subprocess.TimeoutExpired:
            timed_out = True
            _end_group(process)
            _, said = process.communicate()
        finally:
            _end_group(process)
    lines = " ".join(said.strip().splitlines()[-_LAST_LINES:])
    return Outcome(process.returncode, time.monotonic() - begun, lines, timed_out)


def checked(outcome: Outcome) -> Outcome:
    """The outcome, where it is a good one.

    Raises:
        RenderError: it is not.
    """
    if outcome.exit_code != 0 or outcome.timed_out:
        raise RenderError(outcome.reason, None if outcome.exit_code < 0 else outcome.exit_code)
    return outcome


def _installed() -> Path | None:
    for folder in {Path(sys.argv[0]).resolve().parent: None, Path(sys.executable).parent: None}:
        beside = folder / "sheaf"
        if beside.is_file() and os.access(beside, os.X_OK):
            return beside
    found = shutil.which("sheaf")
    return Path(found) if found else None


def _end_group(process: subprocess.Popen[str]) -> None:
    if process.poll() is None:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
