# SPDX-License-Identifier: MIT
"""Parses the command line, runs the command, and turns every failure into one line and an exit code."""

from __future__ import annotations

import argparse
import signal
import sys
from collections.abc import Sequence
from types import FrameType
from typing import NoReturn

from .._errors import SheafError
from .._version import __version__
from . import _camera, _farm, _jobs, _render, _study
from ._exit import Terminated, UsageError, exit_code
from ._report import Report

# Each command is a module with `add(subparsers)`, which sets `run(arguments, report)` as its parsers' default.
_COMMANDS = (_render, _jobs, _camera, _farm, _study)


def main(argv: Sequence[str] | None = None) -> int:
    """Runs `sheaf-client`; returns the exit code."""
    arguments = _parser().parse_args(argv)
    report = Report(getattr(arguments, "progress", "auto"))
    previous = signal.signal(signal.SIGTERM, _terminate)
    try:
        arguments.run(arguments, report)
    except KeyboardInterrupt as interrupt:
        return 143 if isinstance(interrupt, Terminated) else 130
    except BrokenPipeError:
        sys.stderr.close()  # nobody reads; and the interpreter must not complain about it while it ends
        return 6
    except (SheafError, UsageError, OSError, ValueError, TypeError) as error:
        code = exit_code(error)
        report.error(code, " ".join(str(error).split()) or type(error).__name__)
        return code
    finally:
        report.close()
        signal.signal(signal.SIGTERM, previous)
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="sheaf-client",
        description="Renders glTF animations on a Sheaf service, and measures the engine here.",
        epilog="Exit codes: 0 done; 2 wrong usage; 3 bad scene, camera path or settings; 4 no usable device; "
        "5 a limit was exceeded; 6 reading, writing or the network failed; 130, 143 interrupted.",
    )
    parser.add_argument("--version", action="version", version=f"sheaf-client {__version__}")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)
    for command in _COMMANDS:
        command.add(commands)
    return parser


def _terminate(number: int, frame: FrameType | None) -> NoReturn:
    raise Terminated
