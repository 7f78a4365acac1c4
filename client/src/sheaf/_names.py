# SPDX-License-Identifier: MIT
"""File names of frames, as `sheaf render --name` makes them."""

from __future__ import annotations

import re
from pathlib import PurePath

_PATTERN = re.compile(r"([^#/\\]*)(#+)([^#/\\]*)\.exr")


class FrameNames:
    """A name pattern: one run of `#` stands for the frame number, padded with zeros to the run's length.

    A sign counts: -12 in #### is -012, as printf's %04d writes it.

    Raises:
        ValueError: no run of `#` or several, a separator or control character, or another ending than .exr.
    """

    def __init__(self, pattern: str) -> None:
        match = _PATTERN.fullmatch(pattern)
        if match is None or not pattern.isprintable():
            raise ValueError(f"name {pattern!r}: it needs one run of '#' and the ending .exr, and no '/'")
        self._before, digits, self._after = match.groups()
        self._digits = len(digits)

    def frame(self, number: int) -> str:
        """The name of a frame, such as "box.0012.exr"."""
        return self._stem(number) + ".exr"

    def preview(self, number: int) -> str:
        """The name of its preview, such as "box.0012.png"."""
        return self._stem(number) + ".png"

    def _stem(self, number: int) -> str:
        return f"{self._before}{number:0{self._digits}d}{self._after}"


def default_pattern(scene: str) -> str:
    """The pattern for a scene's file: its stem, then the number in four digits."""
    stem = "".join("_" if character == "#" or ord(character) < 32 else character for character in PurePath(scene).stem)
    return f"{stem or 'frame'}.####.exr"
