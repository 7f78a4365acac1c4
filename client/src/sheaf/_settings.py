# SPDX-License-Identifier: MIT
"""Render settings: the long names of `sheaf render`, with `_` for `-`, and how they travel."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Iterable, Mapping
from typing import Any

from ._frames import frame_list
from ._render_settings import SETTINGS, RenderSettings

__all__ = ["RenderSettings", "Wire", "wire_settings"]

_NAMES = frozenset(name.replace("-", "_") for name in SETTINGS)
_LISTS = {"color": ",", "layers": ",", "size": "x"}

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
    kind = SETTINGS[name.replace("_", "-")].kind
    if kind == "frames":
        return frame_list(value)
    if kind == "size" and not isinstance(value, str):
        return _size(value)
    if kind in _LISTS and isinstance(value, Iterable) and not isinstance(value, str):
        return _LISTS[kind].join(str(_finite(name, item)) for item in value)
    if kind in ("rate", "samples") and isinstance(value, str):
        value = _number(value)
    if isinstance(value, str) or (isinstance(value, (int, float)) and kind not in _LISTS):
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
