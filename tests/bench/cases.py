# SPDX-License-Identifier: MIT
"""The scenes that are measured: how each is made, seen and animated."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import city_scene
import crowd_scene
import field_scene
import sponza

ROOT = Path(__file__).resolve().parents[2]
SCENES = ROOT / "tests/scenes"
ASSETS = Path(os.environ.get("SHEAF_ASSETS", ROOT.parent / "shared/assets"))
View = tuple[tuple[float, ...], tuple[float, ...], float]  # eye, target, degrees from top to bottom


@dataclass(frozen=True)
class Case:
    """`view`: none where the file's own camera moves. `shines`: the rasteriser and shadow bundles have it easy here."""

    name: str
    make: Callable[[Path], Path]
    view: View | None
    moves: bool = False
    shines: bool = False
    options: tuple[str, ...] = ()

    @property
    def opaque(self) -> bool:
        """Rendered without alpha masks and glass, as other tracers can follow."""
        return "--opaque" in self.options


def written(name: str, build: Callable[[], bytes]) -> Callable[[Path], Path]:
    """Made once for a cache folder. Change a generator, and the cache is to be removed."""

    def make(cache: Path) -> Path:
        path = cache / f"{name}.glb"
        if not path.is_file():
            path.with_suffix(".part").write_bytes(build())
            path.with_suffix(".part").rename(path)
        return path

    return make


def committed(name: str) -> Callable[[Path], Path]:
    """A scene of tests/scenes."""
    return lambda cache: SCENES / f"{name}.glb"


def sponza_of_assets(cache: Path) -> Path:
    """With a mirror for a floor and a lamp."""
    return sponza.make(ASSETS / "Sponza/Sponza.gltf", cache / "sponza")


def city(size: str, triangles: int, instanced: bool = False) -> Case:
    """Of one footprint, seen from one place."""
    name = f"city {size}{' instanced' if instanced else ''}"
    build = written(name.replace(" ", "_"), lambda: city_scene.city(triangles, instanced))
    return Case(name, build, (city_scene.EYE, city_scene.TARGET, city_scene.FOV))


FIELD = (field_scene.EYE, field_scene.TARGET, field_scene.FOV)
CROWD = (crowd_scene.EYE, crowd_scene.TARGET, crowd_scene.FOV)
CASES = [
    Case(
        "sponza",
        sponza_of_assets,
        (sponza.EYE, sponza.TARGET, math.degrees(1.0)),
        shines=True,
        options=("--opaque",),  # its plants have alpha masks
    ),
    Case("cornell", committed("cornell"), ((0.0, 1.0, 3.4), (0.0, 1.0, 0.0), 40.0)),
    Case("whitted", committed("whitted"), None, moves=True),
    Case("spheres", written("spheres", field_scene.field), FIELD, moves=True, shines=True),
    Case("spheres at rest", written("spheres_at_rest", lambda: field_scene.field(still=True)), FIELD),
    Case("crowd", written("crowd", crowd_scene.crowd), CROWD, moves=True),
    Case("crowd at rest", written("crowd_at_rest", lambda: crowd_scene.crowd(still=True)), CROWD),
    city("10K", 10_000),
    city("100K", 100_000),
    city("1M", 1_000_000),
    city("1M", 1_000_000, instanced=True),
    city("10M", 10_000_000),
    city("10M", 10_000_000, instanced=True),
]


def camera_path(case: Case, cache: Path) -> list[str]:
    """Options for a camera that creeps by 10 nm a frame: no frame may stand for the next, and all see the same."""
    if case.view is None:
        return []
    eye, target, fov = case.view
    keys = [
        {"time": t, "eye": [eye[0] + 240e-9 * t, *eye[1:]], "target": target, "up": [0, 1, 0], "fov_degrees": fov,
         "near": 0.05, "far": 1000}
        for t in (0, 1000)
    ]  # fmt: skip
    path = cache / f"{case.name.replace(' ', '_')}_camera.json"
    path.write_text(json.dumps({"version": 1, "keys": keys}))
    return ["--camera", str(path)]
