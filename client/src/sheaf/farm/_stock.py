# SPDX-License-Identifier: MIT
"""Which frames that are there are those that would be rendered now."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR

from .._frames import frame_list
from ._task import Order, engine, located, own_folder

Inputs = Mapping[str, Any]
"""What decides a frame: `version`, `scene` (its hash), `settings` (JSON), `frame` and `time`."""


def wanted_inputs(order: Order, home: str | None = None) -> dict[int, Inputs] | None:
    """On a worker: what decides each frame of an order; None where the program cannot tell.

    Args:
        order: what would be rendered.
        home: the worker's own folder; None asks the Dask worker that this runs in.
    """
    home = home if home is not None else own_folder()
    program = engine(order.program)
    if "list-inputs" not in program.options:
        return None
    settings = {
        **order.settings,
        "frames": frame_list(order.frames),
        "name": order.name,
        "camera": located(order.camera, order.digest, home),
        "preview": order.preview,
        "progress": "none",
    }
    lines = program.list_inputs(located(order.scene, order.digest, home) or order.scene, Path(home), settings)
    return {line["frame"]: line for line in lines}


def found_inputs(path: Path) -> Inputs | None:
    """What decided a frame, as its file's attributes tell; None where one is missing, or the file is not whole."""
    try:
        # With its pixels: the header of a file that was cut short is there.
        header = OpenEXR.File(str(path)).header()
        software = header["software"]
        if not software.startswith("Sheaf "):
            return None
        return {
            "version": software.removeprefix("Sheaf "),
            "scene": header["sheaf:sceneHash"],
            "settings": header["sheaf:settings"],
            "frame": int(header["sheaf:frame"]),
            "time": np.asarray(header["sheaf:time"], np.float64).item(),  # OpenEXR gives an array of one
        }
    except (RuntimeError, ValueError, KeyError, TypeError, AttributeError):
        return None


def is_current(path: Path, wanted: Inputs) -> bool:
    """Whether the file is of the very inputs."""
    found = found_inputs(path)
    return found is not None and all(found[name] == wanted[name] for name in found)
