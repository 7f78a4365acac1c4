# SPDX-License-Identifier: MIT
"""Signals for the programs that tests start. A shell starts what runs in its background (`nohup pytest … &`) with
SIGINT ignored, children inherit that, and a test that interrupts one which keeps to it would wait for ever. What this
process handles itself is at its default in its children."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from typing import Any

import pytest

_HANDLERS: dict[signal.Signals, Any] = {signal.SIGINT: signal.default_int_handler, signal.SIGTERM: signal.SIG_DFL}


@pytest.fixture(scope="session", autouse=True)
def default_signals() -> Iterator[None]:
    """SIGINT and SIGTERM end programs, however pytest was started."""
    before = {number: signal.getsignal(number) for number in _HANDLERS}
    for number, handler in _HANDLERS.items():
        if before[number] == signal.SIG_IGN:
            signal.signal(number, handler)
    yield
    for number, handler in before.items():
        signal.signal(number, handler)
