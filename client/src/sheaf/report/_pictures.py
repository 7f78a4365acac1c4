# SPDX-License-Identifier: MIT
"""The pictures themselves, small, and where they differ from the reference."""

from __future__ import annotations

import io
from dataclasses import dataclass

import matplotlib.image
import numpy as np
import numpy.typing as npt
from matplotlib import colormaps

from ._errors import Picture, flip_map
from ._measure import Trial
from ._study import SceneStudy


@dataclass(frozen=True)
class Shown:
    """A picture with its caption, as PNG; `difference` maps FLIP, or the absolute error without that package."""

    caption: str
    picture: bytes
    difference: bytes | None = None


def pictures(scene: SceneStudy) -> list[Shown]:
    """The reference, and each named setting beside its difference."""
    reference = scene.reference
    if reference is None or reference.picture is None:
        return []
    settings = reference.point.settings
    shown = [Shown(f"reference: double precision, {settings['spp']} spp", _png(_display(reference.picture)))]
    for trial in scene.knobs:
        if trial.point.name and trial.picture is not None:
            difference = _png(_heat(trial.picture, reference.picture))
            shown.append(Shown(_caption(trial), _png(_display(trial.picture)), difference))
    return shown


def _caption(trial: Trial) -> str:
    parts = [str(trial.point.name)]
    if trial.median_ms is not None:
        parts.append(f"{trial.median_ms:.0f} ms")
    if trial.errors:
        parts.append(f"RMSE {trial.errors.rmse:.2g}")
    return ", ".join(parts)


def _display(picture: Picture) -> npt.NDArray[np.uint8]:
    """Linear light as sRGB, cut off at 1."""
    light = np.clip(np.nan_to_num(picture), 0.0, 1.0)
    curve = np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    return np.asarray(np.round(curve * 255), dtype=np.uint8)


def _heat(picture: Picture, reference: Picture) -> npt.NDArray[np.uint8]:
    seen = flip_map(picture, reference)
    if seen is None:
        seen = np.abs(picture - reference).max(axis=2)
    return np.asarray(colormaps["magma"](np.clip(seen, 0.0, 1.0))[..., :3] * 255, dtype=np.uint8)


def _png(pixels: npt.NDArray[np.uint8]) -> bytes:
    out = io.BytesIO()
    matplotlib.image.imsave(out, pixels, format="png")
    return out.getvalue()
