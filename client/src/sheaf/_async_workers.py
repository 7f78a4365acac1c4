# SPDX-License-Identifier: MIT
"""Waiting, and working on several things at once, for asyncio. `_workers` has the same functions for threads."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncGenerator, Awaitable, Callable, Sequence
from typing import ParamSpec, TypeVar

P = ParamSpec("P")
T = TypeVar("T")


async def sleep(seconds: float) -> None:
    """Lets time pass."""
    await asyncio.sleep(seconds)


async def aside(function: Callable[P, T], *arguments: P.args, **named: P.kwargs) -> T:
    """What the function returns; it may block, so it runs in a thread."""
    return await asyncio.to_thread(function, *arguments, **named)


async def in_order(
    action: Callable[[T], Awaitable[object]], items: Sequence[T], at_once: int
) -> AsyncGenerator[T, None]:
    """Does something with every item, with several at once; gives each once that is done, in the order given.

    The first failure ends it: what is not done by then is cancelled.
    """
    room = asyncio.Semaphore(max(1, at_once))

    async def act(item: T) -> None:
        async with room:
            await action(item)

    coming = [asyncio.ensure_future(act(item)) for item in items]
    try:
        for item, task in zip(items, coming, strict=True):
            await task
            yield item
    finally:
        for task in coming:
            task.cancel()
        await asyncio.gather(*coming, return_exceptions=True)
