# SPDX-License-Identifier: MIT
"""Frame numbers as `--frames` takes them, read and written."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterable

MAX_FRAMES = 1_000_000
_ITEM = re.compile(r"(-?\d+)(?:-(-?\d+)(?::(\d+))?)?", re.ASCII)


def frame_list(frames: str | int | Iterable[int]) -> str:
    """Frame numbers in the form that `--frames` takes; text is passed on as it is.

    >>> frame_list(range(0, 100, 2)), frame_list([3, 1, 4])
    ('0-98:2', '3,1,4')

    Raises:
        ValueError: there is no frame.
    """
    if isinstance(frames, str):
        return frames
    numbers = [frames] if isinstance(frames, int) else [int(frame) for frame in frames]
    if not numbers:
        raise ValueError("frames must name at least one frame")
    steps = {after - before for before, after in itertools.pairwise(numbers)}
    step = steps.pop() if len(steps) == 1 else 0
    if step <= 0:
        return ",".join(str(number) for number in numbers)
    span = f"{numbers[0]}-{numbers[-1]}"
    return span if step == 1 else f"{span}:{step}"


def parse_frames(text: str) -> list[int]:
    """The numbers that a list of `N`, `A-B` and `A-B:STEP` names, in order, without repeats.

    Raises:
        ValueError: an item is none of these, or there are more than a million frames.
    """
    numbers: dict[int, None] = {}
    listed = 0
    for item in text.split(","):
        match = _ITEM.fullmatch(item)
        first, last, step = match.groups() if match else (None, None, None)
        span = range(int(first or 0), int(last or first or 0) + 1, int(step or 1) or 1)
        if not match or not span or (step and not int(step)):
            raise ValueError(
                f"frames {item!r}: expected N, A-B or A-B:STEP with B not before A and a step of at least 1"
            )
        listed += len(span)
        if listed > MAX_FRAMES:
            raise ValueError(f"frames {item!r}: more than {MAX_FRAMES} frames in all")
        numbers |= dict.fromkeys(span)
    return list(numbers)
