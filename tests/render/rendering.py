# SPDX-License-Identifier: MIT
"""Runs `sheaf` and reads what it wrote."""

from __future__ import annotations

import json
import os
import pathlib
import subprocess
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field

import numpy as np
import OpenEXR

HERE = pathlib.Path(__file__).resolve().parent
SCENES = HERE.parent / "scenes"
BUILD = pathlib.Path(os.environ.get("SHEAF_BUILD", HERE / "../../build")).resolve()
ASSETS = pathlib.Path(os.environ.get("SHEAF_ASSETS", HERE / "../../../shared/assets")).resolve()
PATIENCE = 300  # seconds until a test gives up; nothing takes this long when all is well
PARALLEL = 2  # processes at a time: small pictures cannot keep several cores busy

SCENE_NAMES = sorted(path.stem for path in SCENES.glob("*.glb"))


def program() -> pathlib.Path:
    for place in (BUILD / "sheaf", BUILD / "engine" / "sheaf"):
        if place.is_file():
            return place
    raise AssertionError(f"sheaf is not built: looked in {BUILD} (set SHEAF_BUILD)")


def scene_path(scene: str | pathlib.Path) -> pathlib.Path:
    """A path as it is; a name means a committed scene."""
    return scene if isinstance(scene, pathlib.Path) else SCENES / f"{scene}.glb"


@dataclass
class Picture:
    """One EXR file: channels by name, as stored."""

    path: pathlib.Path
    channels: dict[str, np.ndarray]
    header: dict
    types: dict[str, str] = field(default_factory=dict)

    @property
    def rgba(self) -> np.ndarray:
        return np.stack([self.channels[c] for c in "RGBA"], axis=-1)

    @property
    def rgb(self) -> np.ndarray:
        return self.rgba[..., :3].astype(np.float64)

    @property
    def alpha(self) -> np.ndarray:
        return self.channels["A"].astype(np.float64)

    def layer(self, name: str) -> np.ndarray:
        """`N` gives the three of N.X, N.Y, N.Z in double precision; `Z` one."""
        for parts in ("", ".X .Y .Z", ".R .G .B", ".X .Y"):
            names = [name + part for part in parts.split()] or [name]
            if all(n in self.channels for n in names):
                found = [self.channels[n].astype(np.float64) for n in names]
                return found[0] if len(found) == 1 else np.stack(found, axis=-1)
        raise AssertionError(f"{self.path}: no layer {name} among {sorted(self.channels)}")


def read_exr(path: pathlib.Path) -> Picture:
    with OpenEXR.File(str(path), separate_channels=True) as file:
        channels = {name: np.array(channel.pixels) for name, channel in file.channels().items()}
        return Picture(path, channels, dict(file.header()), {n: str(a.dtype) for n, a in channels.items()})


@dataclass
class Run:
    """What a finished `sheaf` left behind."""

    code: int
    stdout: str
    stderr: str
    out: pathlib.Path

    @property
    def files(self) -> dict[int, pathlib.Path]:
        """By frame number; the file names end in .NUMBER.exr."""
        return {int(path.name.split(".")[-2]): path for path in sorted(self.out.glob("*.exr"))}

    def frame(self, number: int | None = None) -> Picture:
        files = self.files
        return read_exr(files[number] if number is not None else next(iter(files.values())))

    def stats(self) -> dict:
        return json.loads((self.out / "stats.json").read_text())

    def events(self) -> list[dict]:
        """`--progress json`: every line must be an object."""
        events = [json.loads(line) for line in self.stdout.splitlines()]
        assert all(isinstance(event, dict) for event in events), self.stdout
        return events


class Sheaf:
    """Runs the program; every run gets a folder of its own."""

    def __init__(self, folder: pathlib.Path) -> None:
        self.folder = folder
        self.runs = 0

    def new_folder(self) -> pathlib.Path:
        self.runs += 1
        return self.folder / f"run{self.runs}"

    def __call__(
        self,
        *arguments: object,
        code: int | Sequence[int] = 0,
        env: dict[str, str] | None = None,
        out: pathlib.Path | None = None,
    ) -> Run:
        """Any command. Fails on another exit code and on any word of the validation layer."""
        environment = {"SHEAF_VALIDATION": "1"} | (env or {})
        done = subprocess.run(
            [program(), *map(str, arguments)],
            capture_output=True,
            text=True,
            check=False,
            timeout=PATIENCE,
            env={**os.environ, **environment},
            stdin=subprocess.DEVNULL,
        )
        told = f"{' '.join(map(str, arguments))}\nexit {done.returncode}\n{done.stdout[-2000:]}\n{done.stderr[-4000:]}"
        assert "vulkan validation" not in done.stderr.lower(), told
        assert done.returncode in ((code,) if isinstance(code, int) else code), told
        return Run(done.returncode, done.stdout, done.stderr, out or self.folder)

    def render(
        self,
        scene: str | pathlib.Path,
        *options: object,
        size: str = "64x36",
        strategy: str = "bvh",
        stats: bool = False,
        out: pathlib.Path | None = None,
        code: int = 0,
        env: dict[str, str] | None = None,
    ) -> Run:
        """`bvh` unless told otherwise: it has the fewest pipelines, so it is there soonest."""
        out = out or self.new_folder()
        more = ["--stats", out / "stats.json"] if stats else []
        return self(
            "render", scene_path(scene), "--out", out, "--size", size, "--strategy", strategy, *more, *options,
            code=code, env=env, out=out,
        )  # fmt: skip

    def all(self, calls: Iterable[dict]) -> list[Run]:
        """Several renders side by side, each a dict of `scene`, `options` and what render() takes by name."""

        def one(call: dict) -> Run:
            call = dict(call)
            return self.render(call.pop("scene"), *call.pop("options", ()), **call)

        prepared = [{"out": self.new_folder(), "env": {"LP_NUM_THREADS": "1"}} | call for call in calls]
        with ThreadPoolExecutor(PARALLEL) as pool:
            return list(pool.map(one, prepared))


def half_steps(a: np.ndarray, b: np.ndarray) -> int:
    """Largest difference in steps of half precision, for arrays of halves."""

    def ordered(values: np.ndarray) -> np.ndarray:
        bits = values.astype(np.float16).view(np.int16).astype(np.int32)
        return np.where(bits < 0, -(bits & 0x7FFF), bits)

    return int(np.abs(ordered(a) - ordered(b)).max())
