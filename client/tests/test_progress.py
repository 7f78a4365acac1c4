# SPDX-License-Identifier: MIT
"""The bar, and its words."""

from __future__ import annotations

import io

import pytest

from sheaf import Progress, ProgressBar
from sheaf._progress import bar_line, duration


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


HALF = Progress("running", 6, 12, 0.5, 75.2)


def test_a_terminal_gets_one_line_drawn_anew() -> None:
    stream = Terminal()
    bar = ProgressBar(stream, width=60)
    bar.update(Progress("queued"))
    bar.update(HALF)
    bar.close()
    bar.close()
    assert stream.getvalue().split("\r\x1b[K") == [
        "",
        f"[{'-' * 40}] queued",
        f"[{'#' * 14}{'-' * 13}]  50%  6/12 frames  1:15 left\n",
    ]


def test_the_bar_fits_and_gives_way_to_the_words() -> None:
    for width in range(10, 100):
        assert len(bar_line(HALF, width)) <= width
    assert bar_line(HALF, 35) == " 50%  6/12 frames  1:15 left"
    assert bar_line(Progress("done", 2, 2, 1.0), 40) == "[##############] 100%  2/2 frames  done"


def test_elsewhere_a_line_for_every_tenth() -> None:
    stream = io.StringIO()
    bar = ProgressBar(stream)
    for done in range(101):
        bar.update(Progress("running", done, 100, done / 100))
    bar.close()
    assert len(stream.getvalue().splitlines()) == 11


@pytest.mark.parametrize(("seconds", "text"), [(-1, "0:00"), (59.6, "1:00"), (3599, "59:59"), (36061, "10:01:01")])
def test_duration(seconds: float, text: str) -> None:
    assert duration(seconds) == text
