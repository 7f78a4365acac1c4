# SPDX-License-Identifier: MIT
"""What a fake service can be told to do wrong."""

from __future__ import annotations

from typing import Any

from fake_service import Fault, Handler


def problem(status: int, title: str = "No", detail: str = "", **extra: Any) -> Fault:
    """A fault: a refusal."""
    return lambda handler: handler.problem(status, title, detail, **extra)


def hang_up(handler: Handler) -> None:
    """A fault: the connection is closed without an answer."""
    handler.close_connection = True


def cut_short(body: bytes) -> Fault:
    """A fault: an answer of which only the first half arrives."""
    return lambda handler: handler.send(200, body[: len(body) // 2], {}, announced=len(body))
