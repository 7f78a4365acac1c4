# SPDX-License-Identifier: MIT
"""`sheaf-client camera turntable | look-at`: camera paths without writing JSON."""

from __future__ import annotations

import argparse
import json
from typing import Any

from .._camera import CameraPath
from ._report import Report


def add(commands: Any) -> None:
    """Adds the commands."""
    camera = commands.add_parser("camera", help="make a camera path")
    kinds = camera.add_subparsers(title="kinds", metavar="KIND", required=True)

    turntable = kinds.add_parser("turntable", help="a circle around a point")
    turntable.add_argument("--center", type=float, nargs=3, metavar=("X", "Y", "Z"), default=[0.0, 0.0, 0.0])
    turntable.add_argument("--radius", type=float, required=True, help="of the circle, metres")
    turntable.add_argument("--height", type=float, default=0.0, help="above the centre, metres")
    turntable.add_argument("--seconds", type=float, default=4.0)
    turntable.add_argument("--revolutions", type=float, default=1.0)
    turntable.set_defaults(run=run_turntable)

    look_at = kinds.add_parser("look-at", help="a path through eye and target points")
    look_at.add_argument(
        "--key",
        type=float,
        nargs=7,
        action="append",
        required=True,
        metavar=("T", "EX", "EY", "EZ", "TX", "TY", "TZ"),
        help="seconds, eye, target; once for every key",
    )
    look_at.add_argument("--interpolation", choices=("step", "linear", "catmull-rom"), default="catmull-rom")
    look_at.set_defaults(run=run_look_at)

    for parser in (turntable, look_at):
        parser.add_argument("--fps", type=float, default=24.0)
        parser.add_argument("--fov", type=float, default=45.0, help="field of view, degrees, vertical")
        parser.add_argument("--out", default="-", metavar="FILE", help="where to; - is standard output")


def run_turntable(arguments: argparse.Namespace, report: Report) -> None:
    """Writes a circle."""
    path = CameraPath.turntable(
        arguments.center,
        arguments.radius,
        arguments.height,
        arguments.seconds,
        arguments.fps,
        arguments.fov,
        revolutions=arguments.revolutions,
    )
    _write(path, arguments.out)


def run_look_at(arguments: argparse.Namespace, report: Report) -> None:
    """Writes a path through keys."""
    keys = [(key[0], key[1:4], key[4:7]) for key in arguments.key]
    path = CameraPath.look_at_keys(
        keys, fps=arguments.fps, fov_degrees=arguments.fov, interpolation=arguments.interpolation
    )
    _write(path, arguments.out)


def _write(path: CameraPath, out: str) -> None:
    if out == "-":
        print(json.dumps(path.to_dict(), indent=1))
    else:
        path.save(out)
