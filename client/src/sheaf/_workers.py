# SPDX-License-Identifier: MIT
"""Waiting, and working on several things at once, with threads. `_async_workers` has the same functions for asyncio."""

from __future__ import annotations

import time
from collections.abc import Callable, Generator, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import ParamSpec, TypeVar

P = ParamSpec("P")
T = TypeVar("T")


def sleep(seconds: float) -> None:
    """Lets time pass."""
    time.sleep(seconds)


def aside(function: Callable[P, T], *arguments: P.args, **named: P.kwargs) -> T:
    """What the function returns; whoever calls this blocks anyway, so it runs at once."""
    return function(*arguments, **named)


def in_order(action: Callable[[T], object], items: Sequence[T], at_once: int) -> Generator[T, None, None]:
    """Does something with every item, with several at once; gives each once that is done, in the order given.

    The first failure ends it: what is not begun by then is not begun any more.
    """
    with ThreadPoolExecutor(max(1, at_once), "sheaf-download") as pool:
        coming = [pool.submit(action, item) for item in items]
        try:
            for item, future in zip(items, coming, strict=True):
                future.result()
                yield item
        finally:
            pool.shutdown(wait=True, cancel_futures=True)
