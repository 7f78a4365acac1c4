# SPDX-License-Identifier: MIT
"""Render settings: the long names of `sheaf render`, with `_` for `-`, and how they travel."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Literal, TypedDict

from ._frames import frame_list


class RenderSettings(TypedDict, total=False):
    """What `Client.submit` takes beside scene and camera; what is not given is the service's default.

    `None` counts as not given. The service checks all values and answers `InvalidRequest` with the reason.
    """

    frames: str | int | Iterable[int]
    """Absolute frame numbers: `"0-99"`, `"0-99:2,200"`, `17`, `range(100)`; frame f shows f / fps seconds."""
    fps: float | str
    """Frames a second, or a fraction such as "24000/1001"."""
    animation: str | int
    """The animation's name or index, or "all"."""
    camera_node: str | int
    """A camera of the scene by node name or index; not together with a camera path."""
    size: str | tuple[int, int]
    """Width and height in pixels: `"640x360"` or `(640, 360)`."""
    spp: int | str
    """Samples a pixel."""
    depth: int
    """Generations of reflected and refracted rays."""
    cutoff: float
    """Rays whose weight is below this are not followed."""
    strategy: Literal["auto", "hybrid", "crsh", "rsh", "frustum", "classify", "bvh", "brute", "rayquery", "reference"]
    """How rays find triangles; never changes a pixel."""
    sort: Literal["auto", "on", "off"]
    """Whether rays are sorted by hash."""
    primary: Literal["raster", "trace"]
    """How primary hits are found."""
    aov: str | Sequence[str]
    """Extra layers: Z, N, P, albedo, UV, motion, id, tests, ..."""
    compression: Literal["none", "rle", "zips", "zip", "piz", "dwaa"]
    """EXR compression."""
    memory: int
    """Device memory budget, MiB."""
    device: str | int
    """Device by name or index, where the service lets callers choose."""
    opaque: bool
    """Every surface opaque and two-sided."""
    preview: bool
    """A tone-mapped PNG beside each frame."""


_NAMES = frozenset(RenderSettings.__annotations__)

Wire = str | int | float | bool
"""A setting's value in the request's JSON."""


def wire_settings(settings: Mapping[str, Any]) -> dict[str, Wire]:
    """The settings as the request carries them: the command line's long names, values as it would take them.

    Raises:
        TypeError: a name is unknown, or a value is of a type that its setting never has.
        ValueError: frames or size are not what they must be, or a number is not finite.
    """
    unknown = sorted(set(settings) - _NAMES)
    if unknown:
        raise TypeError(f"unknown setting {', '.join(unknown)}; there are {', '.join(sorted(_NAMES))}")
    return {name.replace("_", "-"): _wire(name, value) for name, value in settings.items() if value is not None}


def _wire(name: str, value: Any) -> Wire:
    if name == "frames":
        return frame_list(value)
    if name == "size" and not isinstance(value, str):
        return _size(value)
    if name == "aov" and not isinstance(value, str):
        return ",".join(str(layer) for layer in value)
    if isinstance(value, float) and not math.isfinite(value):
        raise ValueError(f"{name} must be finite, not {value}")
    if isinstance(value, (str, int, float)):
        return value
    raise TypeError(f"{name} cannot be a {type(value).__name__}")


def _size(value: Any) -> str:
    try:
        width, height = (int(side) for side in value)
    except (TypeError, ValueError) as error:
        raise ValueError(f"size must be WIDTHxHEIGHT or (width, height), not {value!r}") from error
    return f"{width}x{height}"
