# SPDX-License-Identifier: MIT
"""Frames as NumPy arrays, one a layer."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import OpenEXR

from ._errors import FrameError

Layer = npt.NDArray[np.float32] | npt.NDArray[np.uint32]

# Component orders that make one array of several channels; any other channel is a layer of its own.
_ORDERS = ("RGBA", "RGB", "XYZ", "XY", "UV")
# Attributes that describe the file, not the picture.
_FILE_ATTRIBUTES = frozenset({"channels", "chunkCount", "lineOrder", "type", "name", "version"})


@dataclass(frozen=True, eq=False)
class Frame:
    """One frame.

    Attributes:
        layers: arrays by layer name, rows from the top. "RGBA" (H, W, 4): linear Rec.709, premultiplied;
            and as asked for by `aov`: "Z" (H, W), "N" and "P" (H, W, 3), "albedo" (H, W, 3), "UV" (H, W, 2),
            "tests" (H, W), "id.object" and "id.material" (H, W) uint32. All others are float32: halves
            are widened, which is exact, because half arithmetic overflows at 65504.
        attributes: the EXR header's attributes, matrices as arrays.
        number: absolute frame number; None where the file does not say.
    """

    layers: Mapping[str, Layer]
    attributes: Mapping[str, Any]
    number: int | None = None

    @property
    def rgba(self) -> npt.NDArray[np.float32]:
        """Colour and coverage, (H, W, 4) float32.

        Raises:
            KeyError: the file has no colour.
        """
        return np.asarray(self.layers["RGBA"], dtype=np.float32)

    @property
    def size(self) -> tuple[int, int]:
        """Width and height, pixels."""
        height, width = next(iter(self.layers.values())).shape[:2]
        return width, height

    def __repr__(self) -> str:
        width, height = self.size
        return f"Frame({self.number}, {width}x{height}, {', '.join(self.layers)})"


def read_exr(source: str | os.PathLike[str] | bytes, number: int | None = None) -> Frame:
    """Reads a single-part scanline EXR file.

    Args:
        source: path, or the file's bytes.
        number: the frame's number; read from the file's `sheaf:frame` where not given.

    Raises:
        FrameError: not an EXR file, a damaged or truncated one, or one without pixels.
        OSError: the file cannot be read.
    """
    if isinstance(source, bytes):
        # The wheel reads streams only from 3.5 on; a file serves every version.
        with tempfile.TemporaryDirectory(prefix="sheaf-") as folder:
            path = Path(folder, "frame.exr")
            path.write_bytes(source)
            return _read(path, "EXR bytes", number)
    with Path(source).open("rb"):  # absent or forbidden: the system's own error, not the library's
        pass
    return _read(Path(source), os.fspath(source), number)


def _read(path: Path, name: str, number: int | None) -> Frame:
    if not OpenEXR.isOpenExrFile(str(path)):
        raise FrameError(f"{name}: not an EXR file")
    try:
        file = OpenEXR.File(str(path), separate_channels=True)
        # Where the pixels are damaged the library prints a warning and leaves the part out.
        part = file.parts[0] if file.parts else None
    except (RuntimeError, ValueError) as error:
        raise FrameError(f"{name}: {error}") from error
    if part is None or not part.channels:
        raise FrameError(f"{name}: damaged or truncated")
    channels = {key: np.asarray(channel.pixels) for key, channel in part.channels.items()}
    attributes = {key: value for key, value in part.header.items() if key not in _FILE_ATTRIBUTES}
    if number is None:
        number = _frame_number(attributes)
    return Frame(group_layers(channels), attributes, number)


def _frame_number(attributes: Mapping[str, Any]) -> int | None:
    try:
        return int(attributes["sheaf:frame"])
    except (KeyError, TypeError, ValueError):
        return None


def group_layers(channels: Mapping[str, npt.NDArray[Any]]) -> dict[str, Layer]:
    """Joins channels that are components of one quantity, by the last part of their names.

    `R G B A` becomes "RGBA" (or "RGB"), `N.X N.Y N.Z` becomes "N"; where a group is not exactly one of the known
    orders, as with `id.object id.material`, each channel keeps its full name.
    """
    groups: dict[str, dict[str, str]] = {}
    for name in channels:
        stem, _, component = name.rpartition(".")
        group = groups.setdefault(stem, {})
        # Two that differ in case alone cannot both be the component: the second stays a layer of its own.
        group[name if component.upper() in group else component.upper()] = name
    layers: dict[str, Layer] = {}
    for stem, components in groups.items():
        colour = next((order for order in _ORDERS[:2] if not stem and set(order) <= set(components)), None)
        order = colour or next((order for order in _ORDERS if set(order) == set(components)), None)
        names = [components[component] for component in order] if order else []
        if names:
            joined = np.stack([_widened(channels[name]) for name in names], axis=-1)
            layers[stem or str(order)] = _widened(joined)
        for name in components.values():
            if name not in names:
                layers[name] = _widened(channels[name])
    return layers


def _widened(pixels: npt.NDArray[Any]) -> Layer:
    if pixels.dtype == np.uint32:
        return pixels
    return pixels.astype(np.float32, copy=False)
