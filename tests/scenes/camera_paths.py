# SPDX-License-Identifier: MIT
"""Example camera paths for whitted.glb, one for each form that `--camera` reads."""

from __future__ import annotations

import json
import math

import numpy as np
import numpy.typing as npt

from glb import numbers
from shapes import look_rotation
from whitted import AIM


def _text(value: object) -> bytes:
    return (json.dumps(value, indent=1) + "\n").encode()


def _on_circle(angle: float, radius: float = 7.2, height: float = 2.1) -> tuple[float, float, float]:
    return AIM[0] + radius * math.sin(angle), height, AIM[2] + radius * math.cos(angle)


def _camera_to_world(eye: npt.ArrayLike) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3, :3] = look_rotation(eye, AIM)
    matrix[:3, 3] = eye
    return matrix


def turntable() -> bytes:
    """Once round the spheres in 4 s; the last key is the first again."""
    keys = [
        {
            "time": number,
            "eye": numbers(_on_circle(2 * math.pi * k / 16)),
            "target": list(AIM),
            "up": [0, 1, 0],
            "fov_degrees": 39,
        }
        for k, number in enumerate(numbers(np.arange(17) / 4))
    ]
    keys[-1]["eye"] = keys[0]["eye"]
    return _text(
        {"version": 1, "fps": 24, "interpolation": "catmull-rom", "loop": True, "fov_axis": "vertical", "keys": keys}
    )


def look_at_keys() -> bytes:
    """A dolly from afar to the mirror sphere, the lens given as a photographer would."""
    lens = {"sensor_mm": [36, 20.25]}
    return _text(
        {
            "version": 1,
            "fps": "24000/1001",
            "interpolation": "linear",
            "fov_axis": "vertical",
            "keys": [
                {"time": 0, "eye": [-3, 2.5, 9], "target": list(AIM), "up": [0, 1, 0], "focal_mm": 35} | lens,
                {"time": 2, "eye": [0.5, 1.8, 6], "target": list(AIM), "up": [0, 1, 0], "focal_mm": 28} | lens,
                {"time": 4, "eye": [1.6, 1.4, 3.2], "target": [0.85, 0.955, -1.25], "up": [0, 1, 0], "focal_mm": 50}
                | lens,
            ],
        }
    )


def matrices() -> bytes:
    """Column-major matrices, cut hard from view to view, the field of view along the picture's width."""
    keys = [
        {"time": t, "matrix": numbers(_camera_to_world(_on_circle(a)).T), "fov_degrees": 64}
        for t, a in ((0, 0), (1, 0.4), (2, -0.4), (3, 0.8))
    ]
    return _text({"version": 1, "fps": 24, "interpolation": "step", "fov_axis": "horizontal", "keys": keys})


def plan() -> bytes:
    """An orthographic plan from above, drifting: positions and quaternions, with clipping planes."""
    down = [-0.707106781, 0, 0, 0.707106781]
    return _text(
        {
            "version": 1,
            "interpolation": "linear",
            "keys": [
                {"time": 0, "position": [-1, 10, 0], "rotation": down, "ortho_height": 6, "near": 0.5, "far": 20},
                {"time": 4, "position": [1, 10, 0], "rotation": down, "ortho_height": 6, "near": 0.5, "far": 20},
            ],
        }
    )


def nerfstudio() -> bytes:
    """As Nerfstudio's viewer exports it: a camera a frame, row-major matrices, vertical degrees."""
    frames, aspect = 48, 16 / 9
    path = [
        {
            "camera_to_world": numbers(_camera_to_world(_on_circle(2 * math.pi * k / frames))),
            "fov": 39,
            "aspect": numbers([aspect])[0],
        }
        for k in range(frames)
    ]
    keyframes = [
        {
            "matrix": json.dumps(frame["camera_to_world"]),
            "fov": 39,
            "aspect": frame["aspect"],
            "override_transition_enabled": False,
            "override_transition_sec": None,
        }
        for frame in path[:: frames // 4]
    ]
    return _text(
        {
            "default_fov": 39,
            "default_transition_sec": 0.5,
            "keyframes": keyframes,
            "camera_type": "perspective",
            "render_height": 360,
            "render_width": 640,
            "fps": 24,
            "seconds": 2,
            "is_cycle": True,
            "smoothness_value": 0,
            "camera_path": path,
        }
    )


PATHS = {
    "whitted_turntable": turntable,
    "whitted_look_at": look_at_keys,
    "whitted_matrices": matrices,
    "whitted_plan": plan,
    "whitted_nerfstudio": nerfstudio,
}
