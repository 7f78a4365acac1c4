# SPDX-License-Identifier: MIT
"""Camera paths: keys over time, as `--camera` reads them.

glTF's frame: right-handed, +Y up, the camera looks along -Z; metres, seconds, degrees.
"""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from itertools import pairwise
from pathlib import Path
from typing import Any, Literal, get_args

from ._files import write_whole

Interpolation = Literal["step", "linear", "catmull-rom"]
Vector = Sequence[float]

_SIZES = {"position": 3, "rotation": 4, "eye": 3, "target": 3, "up": 3, "matrix": 16, "sensor_mm": 2}
_POSES = (("position", "rotation"), ("eye", "target"), ("matrix",))
_LENSES = ("fov_degrees", "focal_mm", "ortho_height")


@dataclass(frozen=True)
class CameraKey:
    """Where the camera is at one time: exactly one pose and at most one lens.

    The pose is `position` and `rotation` (a quaternion x, y, z, w), or `eye`, `target` and `up` (default +Y), or
    `matrix` (16 numbers, column-major, camera to world). The lens is `fov_degrees`, or `focal_mm` with `sensor_mm`,
    or `ortho_height` (the view's height, metres). `near` and `far` cut along the view axis, metres.

    Raises:
        ValueError: a number is missing, not finite or impossible, or the camera looks nowhere.
    """

    time: float
    position: Vector | None = None
    rotation: Vector | None = None
    eye: Vector | None = None
    target: Vector | None = None
    up: Vector | None = None
    matrix: Vector | None = None
    fov_degrees: float | None = None
    focal_mm: float | None = None
    sensor_mm: Vector | None = None
    ortho_height: float | None = None
    near: float | None = None
    far: float | None = None

    def __post_init__(self) -> None:
        for item in fields(self):
            value = getattr(self, item.name)
            if value is not None:
                object.__setattr__(self, item.name, _numbers(item.name, value))
        self._check_pose()
        self._check_lens()

    def _check_pose(self) -> None:
        given = [pose for pose in _POSES if any(getattr(self, name) is not None for name in pose)]
        if len(given) != 1 or any(getattr(self, name) is None for name in given[0]):
            raise ValueError("a key needs position and rotation, or eye and target, or matrix")
        if self.rotation is not None and not any(self.rotation):
            raise ValueError("rotation: the quaternion is zero")
        if self.eye is None or self.target is None:
            if self.up is not None:
                raise ValueError("up goes with eye and target only")
            return
        if not any(_cross(_difference(self.target, self.eye), self.up or (0.0, 1.0, 0.0))):
            raise ValueError("eye and target are the same point, or up is along the view: the camera has no direction")

    def _check_lens(self) -> None:
        given = [name for name in _LENSES if getattr(self, name) is not None]
        if len(given) > 1:
            raise ValueError(f"a key has one lens: {' or '.join(given)}")
        if self.fov_degrees is not None and not 0 < self.fov_degrees < 180:
            raise ValueError(f"fov_degrees lies between 0 and 180: {self.fov_degrees}")
        if (self.focal_mm is None) != (self.sensor_mm is None):
            raise ValueError("focal_mm and sensor_mm go together")
        positive = {"focal_mm": self.focal_mm, "ortho_height": self.ortho_height}
        positive |= {f"sensor_mm[{axis}]": side for axis, side in enumerate(self.sensor_mm or ())}
        for name, value in positive.items():
            if value is not None and value <= 0:
                raise ValueError(f"{name} must be positive: {value}")
        if self.near is not None and self.near < 0:
            raise ValueError(f"near must not be negative: {self.near}")
        if self.far is not None and self.far <= (self.near or 0.0):
            raise ValueError(f"far must lie beyond near: {self.far}")

    def to_dict(self) -> dict[str, Any]:
        """The key as the file has it: what is not given is absent."""
        values = {item.name: getattr(self, item.name) for item in fields(self)}
        return {
            name: list(value) if isinstance(value, tuple) else value
            for name, value in values.items()
            if value is not None
        }


@dataclass(frozen=True)
class CameraPath:
    """Keys over time, with strictly increasing times.

    Attributes:
        keys: at least one.
        fps: frames per second, or a fraction such as "24000/1001"; None leaves it to the render settings.
        interpolation: between keys.
        loop: whether the path begins again after its last key.
        fov_axis: which side of the image `fov_degrees` spans.

    Raises:
        ValueError: there is no key, or times do not increase.
    """

    keys: Sequence[CameraKey]
    fps: float | str | None = None
    interpolation: Interpolation = "linear"
    loop: bool = False
    fov_axis: Literal["vertical", "horizontal"] = "vertical"

    def __post_init__(self) -> None:
        object.__setattr__(self, "keys", tuple(self.keys))
        if not self.keys:
            raise ValueError("a camera path needs at least one key")
        for index, (before, after) in enumerate(pairwise(self.keys), start=1):
            if not before.time < after.time:
                raise ValueError(f"keys[{index}]: its time {after.time} does not come after {before.time}")
        if self.interpolation not in get_args(Interpolation):
            raise ValueError(f"interpolation is one of {', '.join(get_args(Interpolation))}: {self.interpolation!r}")
        if self.fov_axis not in ("vertical", "horizontal"):
            raise ValueError(f"fov_axis is vertical or horizontal: {self.fov_axis!r}")
        if isinstance(self.fps, (int, float)) and not 0 < self.fps < math.inf:
            raise ValueError(f"fps must be positive: {self.fps}")

    @classmethod
    def turntable(
        cls,
        center: Vector,
        radius: float,
        height: float = 0.0,
        seconds: float = 4.0,
        fps: float = 24.0,
        fov_degrees: float = 45.0,
        *,
        revolutions: float = 1.0,
        start_degrees: float = 0.0,
    ) -> CameraPath:
        """Circles around a point at even speed, looking at it.

        One key a frame, so that every frame lies on the circle, not on a chord of it. At time 0 and `start_degrees` 0
        the camera is on the +Z side; positive revolutions go counterclockwise seen from above. Frames
        0 ... seconds * fps - 1 loop without a repeated one.

        Args:
            center: the point looked at, metres.
            radius: of the circle, metres.
            height: of the camera above the point, metres.
            seconds: length; rounded to whole frames.
            fps: frames per second.
            fov_degrees: field of view, vertical.
            revolutions: turns in all; may be a fraction or negative.
            start_degrees: angle at time 0.

        Raises:
            ValueError: radius, seconds or fps is not positive.
        """
        for name, value in {"radius": radius, "seconds": seconds, "fps": fps}.items():
            if not 0 < value < math.inf:
                raise ValueError(f"{name} must be positive: {value}")
        x, y, z = _numbers("center", center, 3)
        frames = max(1, round(seconds * fps))
        keys = []
        for frame in range(frames + 1):
            angle = math.radians(start_degrees + 360.0 * revolutions * frame / frames)
            eye = (x + radius * math.sin(angle), y + height, z + radius * math.cos(angle))
            keys.append(CameraKey(frame / fps, eye=eye, target=(x, y, z), fov_degrees=fov_degrees))
        return cls(keys, fps=fps)

    @classmethod
    def look_at_keys(
        cls,
        keys: Iterable[tuple[float, Vector, Vector]],
        *,
        fps: float | str | None = None,
        fov_degrees: float = 45.0,
        up: Vector = (0.0, 1.0, 0.0),
        interpolation: Interpolation = "catmull-rom",
        loop: bool = False,
    ) -> CameraPath:
        """A path through `(time in seconds, eye, target)` keys, with one field of view (vertical).

        Raises:
            ValueError: times do not increase, or a key looks nowhere.
        """
        made = [CameraKey(time, eye=eye, target=target, up=up, fov_degrees=fov_degrees) for time, eye, target in keys]
        return cls(made, fps=fps, interpolation=interpolation, loop=loop)

    @classmethod
    def from_dict(cls, document: Mapping[str, Any]) -> CameraPath:
        """The path that a version 1 document describes.

        Raises:
            ValueError: the document is of another version, holds a key that is not known, or is wrong elsewhere.
        """
        values = dict(document)
        if values.pop("version", None) != 1:
            raise ValueError("version: camera paths of version 1 are read here")
        entries = values.pop("keys", None)
        if not isinstance(entries, Sequence) or isinstance(entries, str):
            raise ValueError("keys: missing, or not a list")
        _refuse_unknown("", values, {item.name for item in fields(cls)})
        return cls([_key(index, entry) for index, entry in enumerate(entries)], **values)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> CameraPath:
        """Reads a version 1 file.

        Other files that `sheaf` reads, such as Nerfstudio's, go to `submit` by their path, as they are.

        Raises:
            ValueError: not a camera path; the text names the file and the place.
            OSError: the file cannot be read.
        """
        try:
            document = json.loads(Path(path).read_text(encoding="utf-8"))
            if not isinstance(document, dict):
                raise ValueError("not a JSON object")
            return cls.from_dict(document)
        except ValueError as error:
            raise ValueError(f"{os.fspath(path)}: {error}") from error

    def to_dict(self) -> dict[str, Any]:
        """The version 1 document."""
        document: dict[str, Any] = {"version": 1}
        if self.fps is not None:
            document["fps"] = self.fps
        document |= {"interpolation": self.interpolation, "loop": self.loop, "fov_axis": self.fov_axis}
        return document | {"keys": [key.to_dict() for key in self.keys]}

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the version 1 file, whole or not at all."""
        write_whole(Path(path), json.dumps(self.to_dict(), indent=1, allow_nan=False) + "\n")


def _key(index: int, entry: Any) -> CameraKey:
    place = f"keys[{index}]"
    if not isinstance(entry, Mapping):
        raise ValueError(f"{place}: not an object")
    _refuse_unknown(f"{place}.", entry, {item.name for item in fields(CameraKey)})
    if "time" not in entry:
        raise ValueError(f"{place}.time: missing")
    try:
        return CameraKey(**entry)
    except ValueError as error:
        raise ValueError(f"{place}: {error}") from error


def _refuse_unknown(place: str, values: Mapping[str, Any], known: set[str]) -> None:
    unknown = sorted(set(values) - known)
    if unknown:
        raise ValueError(f"{place}{unknown[0]}: not known; there are {', '.join(sorted(known))}")


def _numbers(name: str, value: Any, size: int | None = None) -> Any:
    """A finite number, or as many of them as the name (or `size`) asks for."""
    size = size or _SIZES.get(name)
    values = (value,) if size is None else tuple(value) if isinstance(value, Iterable) else ()
    if len(values) != (size or 1) or any(isinstance(number, (str, bool)) for number in values):
        raise ValueError(f"{name}: {size or 1} numbers are needed" if size else f"{name}: not a number")
    try:
        numbers = tuple(float(number) for number in values)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name}: not a number") from error
    if not all(map(math.isfinite, numbers)):
        raise ValueError(f"{name}: not finite")
    return numbers[0] if size is None else numbers


def _difference(a: Vector, b: Vector) -> tuple[float, float, float]:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def _cross(a: Vector, b: Vector) -> tuple[float, float, float]:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
