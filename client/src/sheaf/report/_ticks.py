# SPDX-License-Identifier: MIT
"""Ticks of logarithmic axes: as many as have room beside each other."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axis import Axis
from matplotlib.ticker import Locator, MaxNLocator, NullFormatter

from ._canvas import short

# Multiples of the powers of ten, with the least distance of two neighbours in decades; the densest first.
_STEPS = (((1, 2, 5), math.log10(2)), ((1, 3), math.log10(3)), ((1,), 1.0))
_CHARACTER = 0.65  # of the font's size: the width of a digit
_GAP = 0.8  # between two labels, likewise


def log_ticks(axis: Axis) -> None:
    """Ticks at round numbers, with short labels that never touch."""
    axis.set_major_locator(LogTicks())
    axis.set_major_formatter(lambda value, _: short(value))
    axis.set_minor_formatter(NullFormatter())


class LogTicks(Locator):
    """As 1, 2, 5, 10 where there is room, else fewer: down to a power of ten now and then."""

    def __call__(self) -> list[float]:
        return self.tick_values(*self.axis.get_view_interval())  # type: ignore[union-attr]

    def tick_values(self, vmin: float, vmax: float) -> list[float]:
        low, high = min(vmin, vmax), max(vmin, vmax)
        if not 0 < low < high:
            return []
        decades = math.log10(high / low)
        for multiples, apart in _STEPS:
            found = _multiples(low, high, multiples)
            if len(found) >= 2 and self._room() * apart / decades >= self._need(found):
                return found
        if decades < 2:  # too short for powers of ten: even steps
            count = max(1, int(self._room() / self._need([low, high]) / 2))
            steps = MaxNLocator(count, steps=[1, 2, 5, 10]).tick_values(low, high)
            return [float(value) for value in steps if low <= value <= high]
        powers = _multiples(low, high, (1,))
        stride = math.ceil(self._need(powers) * decades / self._room())
        return powers[::stride]

    def _room(self) -> float:
        """The axis's length in points."""
        axes = self.axis.axes  # type: ignore[union-attr]
        across, down = axes.bbox.width, axes.bbox.height
        return float((across if self._is_across() else down) * 72 / axes.figure.dpi)

    def _need(self, values: list[float]) -> float:
        """What a label takes along the axis with the gap to the next, in points."""
        size = self.axis.get_major_ticks(1)[0].label1.get_size()  # type: ignore[union-attr]
        width = _CHARACTER * max(len(short(value)) for value in values) if self._is_across() else 1.0
        return float(size * (width + _GAP))

    def _is_across(self) -> bool:
        return bool(self.axis.axis_name == "x")  # type: ignore[union-attr]


def _multiples(low: float, high: float, multiples: tuple[int, ...]) -> list[float]:
    powers = 10.0 ** np.arange(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    return [float(value) for power in powers for value in np.array(multiples) * power if low <= value <= high]
