# SPDX-License-Identifier: MIT
"""Exit codes, the same as `sheaf`'s."""

from __future__ import annotations

from .._errors import (
    Conflict,
    InvalidRequest,
    JobCancelled,
    JobFailed,
    NotFound,
    RenderError,
    SceneError,
    SheafError,
    TooLarge,
    Unauthorized,
)

USAGE, INPUT, DEVICE, LIMIT, IO, INTERRUPTED = 2, 3, 4, 5, 6, 130


class UsageError(Exception):
    """The command line is wrong in a way that argparse does not see."""


class Terminated(KeyboardInterrupt):
    """SIGTERM; ends waiting the way Ctrl-C does."""


# First match counts.
_CODES: tuple[tuple[tuple[type[BaseException], ...], int], ...] = (
    ((UsageError, NotFound, Conflict, Unauthorized), USAGE),
    ((JobCancelled,), INTERRUPTED),
    ((TooLarge,), LIMIT),
    ((SceneError, InvalidRequest), INPUT),
    ((OSError, SheafError), IO),
    ((ValueError, TypeError), INPUT),
)


def exit_code(error: BaseException) -> int:
    """The exit code of a failure; 6, reading, writing and the network, is the one worth another try."""
    if isinstance(error, (JobFailed, RenderError)):
        return error.exit_code if error.exit_code in (USAGE, INPUT, DEVICE, LIMIT, IO) else IO
    return next((code for types, code in _CODES if isinstance(error, types)), IO)
