# SPDX-License-Identifier: MIT
"""Render settings: the long names of `sheaf render`, with `_` for `-`, and how they travel."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Literal, TypedDict

from ._frames import frame_list

Strategy = Literal["auto", "hybrid", "crsh", "rsh", "frustum", "classify", "bvh", "brute", "rayquery", "reference"]
Switch = Literal["auto", "on", "off"]
Quality = Literal["draft", "production", "exact"]
Filter = Literal["box", "triangle", "gaussian"]
Primary = Literal["auto", "raster", "trace"]
Compression = Literal["none", "rle", "zips", "zip", "piz", "dwaa"]


class RenderSettings(TypedDict, total=False):
    """What `Client.submit` takes beside scene and camera; what is not given is the service's default.

    `None` counts as not given. The service checks all values and answers `InvalidRequest` with the reason.
    """

    frames: str | int | Iterable[int] | None
    """Absolute frame numbers: `"0-99"`, `"0-99:2,200"`, `17`, `range(100)`; frame f shows f / fps seconds."""
    fps: float | str | None
    """Frames a second, or a fraction such as "24000/1001"."""
    animation: str | int | None
    """The animation's name or index, or "all"."""
    scene_name: str | int | None
    """Which of the file's scenes, by name or index; the file's own default where not given."""
    camera_node: str | int | None
    """A camera of the scene by node name or index; not together with a camera path."""
    size: str | tuple[int, int] | None
    """Width and height in pixels: `"640x360"` or `(640, 360)`."""
    quality: Quality | None
    """Named settings for samples, depth and cutoff; what is given beside it counts."""
    spp: int | str | None
    """Samples a pixel, or `"adaptive:ERROR"` or `"adaptive:ERROR:MOST"`: more where the error is."""
    filter: Filter | None
    """How samples make up a pixel."""
    depth: int | None
    """Generations of reflected and refracted rays."""
    cutoff: float | None
    """Rays whose weight is below this are not followed."""
    strategy: Strategy | None
    """How rays find triangles; never changes a pixel."""
    sort: Switch | None
    """Whether rays are sorted by hash."""
    primary: Primary | None
    """How primary hits are found."""
    aov: str | Sequence[str] | None
    """Extra layers: Z, N, P, albedo, UV, motion, id, tests, ..."""
    compression: Compression | None
    """EXR compression."""
    memory: int | None
    """Device memory budget, MiB."""
    device: str | int | None
    """Device by name or index, where the service lets callers choose."""
    environment: str | tuple[float, float, float] | None
    """Radiance that rays see where they hit nothing: `"R,G,B"` or three numbers."""
    count: Switch | None
    """Whether intersection tests are counted."""
    opaque: bool | None
    """Every surface opaque and two-sided."""
    preview: bool | None
    """A tone-mapped PNG beside each frame; the service makes them unless told not to."""
    name: str | None
    """File names with #### for the frame number, in `Job.download` and in the service's zip."""


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
    if name in ("aov", "environment") and isinstance(value, Iterable) and not isinstance(value, str):
        return ",".join(str(_finite(name, item)) for item in value)
    if name in ("fps", "spp") and isinstance(value, str):
        value = _number(value)
    if isinstance(value, str) or (isinstance(value, (int, float)) and name not in ("aov", "environment")):
        return _finite(name, value)
    raise TypeError(f"{name} cannot be a {type(value).__name__}")


def _finite(name: str, value: Wire) -> Wire:
    if isinstance(value, float) and not math.isfinite(value):
        raise ValueError(f"{name} must be finite, not {value}")
    return value


def _number(text: str) -> Wire:
    """A number given as text, as a number; other text, such as "24000/1001", as it is."""
    for kind in (int, float):
        with contextlib.suppress(ValueError):
            return kind(text)
    return text


def _size(value: Any) -> str:
    try:
        width, height = (int(side) for side in value)
    except (TypeError, ValueError) as error:
        raise ValueError(f"size must be WIDTHxHEIGHT or (width, height), not {value!r}") from error
    return f"{width}x{height}"
