# SPDX-License-Identifier: MIT
"""The options that name the service, and those that say where frames go."""

from __future__ import annotations

import argparse
import os

from .._client import Client
from .._names import FrameNames
from ._exit import UsageError
from ._report import MODES


def add_server(parser: argparse.ArgumentParser) -> None:
    """Adds `--server`, `--token` and `--timeout`."""
    group = parser.add_argument_group("service")
    group.add_argument("--server", metavar="URL", help="address of sheafd (default: $SHEAF_SERVER)")
    group.add_argument(
        "--token", help="bearer token (default: $SHEAF_TOKEN, which other users of the machine cannot see)"
    )
    group.add_argument(
        "--timeout", type=float, default=30.0, metavar="S", help="seconds of silence to bear (default 30)"
    )


def add_output(parser: argparse.ArgumentParser) -> None:
    """Adds the options for downloaded frames."""
    parser.add_argument("--out", required=True, metavar="DIR", help="folder for the frames, made where it is missing")
    parser.add_argument("--name", metavar="PATTERN", help="file names, with #### for the frame number")
    parser.add_argument("--preview", action="store_true", help="a tone-mapped PNG beside each frame")
    parser.add_argument("--stats", metavar="FILE", help="where to write the stats, as JSON")
    parser.add_argument("--progress", choices=MODES, default="auto")


def connect(arguments: argparse.Namespace) -> Client:
    """The client that the options ask for."""
    url = arguments.server or os.environ.get("SHEAF_SERVER")
    if not url:
        raise UsageError("--server URL is needed (or SHEAF_SERVER in the environment)")
    if not arguments.timeout > 0:
        raise UsageError(f"--timeout must be positive: {arguments.timeout}")
    try:
        return Client(url, token=arguments.token or os.environ.get("SHEAF_TOKEN"), timeout=arguments.timeout)
    except ValueError as error:
        raise UsageError(f"--server {error}") from error


def checked_name(pattern: str) -> str:
    """The name pattern, once it is known to be one."""
    try:
        FrameNames(pattern)
    except ValueError as error:
        raise UsageError(f"--{error}") from error
    return pattern
