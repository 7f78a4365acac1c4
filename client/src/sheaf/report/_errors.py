# SPDX-License-Identifier: MIT
"""How far a picture is from the one it should be."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

Picture = npt.NDArray[np.float32]
"""(H, W, 3), linear Rec.709."""

DARK = 1e-2
"""Added to the squared reference in the relative error, so that a pixel that is all but black does not decide it."""


@dataclass(frozen=True)
class Errors:
    """Distances between a picture and its reference; 0 where they are the same.

    Attributes:
        rmse: root of the mean squared difference over pixels and channels, linear light.
        relative_mse: mean of (difference² / (reference² + 0.01)).
        flip: mean of HDR-FLIP, 0 … 1: how much a viewer who flips between the two sees; None without the package.
        worst: largest difference of a channel.
        worst_at: column and row of the pixel that has it.
    """

    rmse: float
    relative_mse: float
    flip: float | None
    worst: float
    worst_at: tuple[int, int]


def compare(picture: Picture, reference: Picture) -> Errors:
    """All distances.

    Raises:
        ValueError: the pictures differ in size.
    """
    if picture.shape != reference.shape:
        raise ValueError(f"a picture of {picture.shape} cannot be compared with one of {reference.shape}")
    difference = np.abs(picture.astype(np.float64) - reference)
    difference = np.where(np.isfinite(difference), difference, np.inf)  # NaN is as wrong as can be
    square = difference**2
    largest = difference.max(axis=2)
    row, column = (int(index) for index in np.unravel_index(int(largest.argmax()), largest.shape))
    seen = flip_map(picture, reference)
    return Errors(
        rmse=float(np.sqrt(square.mean())),
        relative_mse=float((square / (reference.astype(np.float64) ** 2 + DARK)).mean()),
        flip=None if seen is None else float(seen.mean()),
        worst=float(largest.max()),
        worst_at=(column, row),
    )


def flip_map(picture: Picture, reference: Picture) -> npt.NDArray[np.float32] | None:
    """HDR-FLIP of every pixel (H, W); None where the package `flip-evaluator` is not installed."""
    try:
        import flip_evaluator  # noqa: PLC0415 - an extra
    except ImportError:
        return None
    both = [np.ascontiguousarray(np.clip(np.nan_to_num(image), 0.0, None)) for image in (reference, picture)]
    if not both[0].any():  # FLIP chooses its exposures by the reference's brightness, and black has none
        return np.asarray(both[1].any(axis=2), dtype=np.float32)
    result: Any = flip_evaluator.evaluate(*both, "HDR", inputsRGB=False, applyMagma=False)
    return np.asarray(result[0], dtype=np.float32).reshape(reference.shape[0], reference.shape[1])


def pareto(points: list[tuple[float, float]]) -> list[bool]:
    """Which points (cost, error) no other one beats: none is as good in both and better in one."""
    front = []
    for cost, error in points:
        beaten = any(c <= cost and e <= error and (c < cost or e < error) for c, e in points)
        front.append(not beaten)
    return front
