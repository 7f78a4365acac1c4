# SPDX-License-Identifier: MIT
"""Settings and frame lists on their way to the service."""

from __future__ import annotations

from collections.abc import Iterable

import pytest

from sheaf._frames import frame_list, parse_frames
from sheaf._settings import wire_settings


@pytest.mark.parametrize(
    ("frames", "text"),
    [
        (5, "5"),
        ("0-9:3,40", "0-9:3,40"),
        (range(10), "0-9"),
        (range(0, 10, 3), "0-9:3"),
        (range(3, 0, -1), "3,2,1"),
        ([7], "7"),
        ([3, 1, 4], "3,1,4"),
        ([2, 2], "2,2"),
        ((n for n in (-2, -1, 0)), "-2-0"),
    ],
)
def test_frame_list(frames: str | int | Iterable[int], text: str) -> None:
    assert frame_list(frames) == text


@pytest.mark.parametrize(
    ("text", "frames"),
    [("5", [5]), ("0-3", [0, 1, 2, 3]), ("0-7:3,1,3", [0, 3, 6, 1]), ("-5--3", [-5, -4, -3]), ("-1-1", [-1, 0, 1])],
)
def test_parse_frames(text: str, frames: list[int]) -> None:
    assert parse_frames(text) == frames


@pytest.mark.parametrize("text", ["", "a", "1,", "3-1", "1-5:0", "1:2", "1-2-3", "٣", "0-1000000", "1 - 2"])
def test_parse_frames_refuses(text: str) -> None:
    with pytest.raises(ValueError, match="frames"):
        parse_frames(text)


def test_numbers_given_as_text_travel_as_numbers() -> None:
    wire = wire_settings({"fps": "24", "spp": "16", "animation": "0"})
    assert wire == {"fps": 24, "spp": 16, "animation": "0"}
    wire = wire_settings({"fps": "24000/1001", "spp": "adaptive:0.01"})
    assert wire == {"fps": "24000/1001", "spp": "adaptive:0.01"}
    assert wire_settings({"fps": "29.97", "size": "64x36", "camera_node": None}) == {"fps": 29.97, "size": "64x36"}
    assert wire_settings({"environment": (0.5, 1, 2), "aov": ["Z"]}) == {"environment": "0.5,1,2", "aov": "Z"}
    with pytest.raises(ValueError, match="environment must be finite"):
        wire_settings({"environment": (0.5, 1, float("inf"))})
    with pytest.raises(TypeError, match="aov cannot be a int"):
        wire_settings({"aov": 5})
    with pytest.raises(ValueError, match="fps must be finite"):
        wire_settings({"fps": "nan"})
