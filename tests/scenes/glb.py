# SPDX-License-Identifier: MIT
"""Writes glTF 2.0 binary files: a thin layer over the JSON that keeps buffer views aligned, bounds exact and
extension lists complete. The same calls give the same bytes."""

from __future__ import annotations

import json
import struct
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from shapes import Shape

COMPONENTS = {
    "i8": (5120, np.int8),
    "u8": (5121, np.uint8),
    "i16": (5122, np.int16),
    "u16": (5123, np.uint16),
    "u32": (5125, np.uint32),
    "f32": (5126, np.float32),
}
SHAPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}
ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER = 34962, 34963
TRIANGLES, TRIANGLE_STRIP, TRIANGLE_FAN = 4, 5, 6
NEAREST, LINEAR, LINEAR_MIPMAP_LINEAR = 9728, 9729, 9987
CLAMP, MIRROR, REPEAT = 33071, 33648, 10497


def snap(values: npt.ArrayLike, step: float = 2.0**-20) -> np.ndarray:
    """Rounds to multiples of `step` (a power of two): sine and cosine differ in their last bit between
    machines, the files must not."""
    return np.round(np.asarray(values, dtype=np.float64) / step) * step


def number(value: Any) -> float:
    """A JSON number, rounded for the same reason; whole numbers keep no fraction."""
    rounded = float(f"{float(value):.9g}")
    return int(rounded) if rounded.is_integer() and abs(rounded) < 2**53 else rounded


def numbers(values: npt.ArrayLike) -> list:
    return [number(v) for v in np.asarray(values, dtype=np.float64).ravel()]


class Glb:
    """One file being put together. Every method appends an object and gives back its index."""

    def __init__(self) -> None:
        self.json: dict[str, Any] = {"asset": {"version": "2.0", "generator": "tests/scenes/make_scenes.py"}}
        self.binary = bytearray()

    def add(self, collection: str, item: dict) -> int:
        self.json.setdefault(collection, []).append(item)
        return len(self.json[collection]) - 1

    def uses(self, extension: str, required: bool = False) -> str:
        for key in ["extensionsUsed"] + (["extensionsRequired"] if required else []):
            names = self.json.setdefault(key, [])
            if extension not in names:
                names.append(extension)
        return extension

    # ---- buffers ----
    def view(self, data: bytes, target: int | None = None, stride: int | None = None) -> int:
        while len(self.binary) % 4:
            self.binary.append(0)
        item: dict[str, Any] = {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(data)}
        if stride:
            item["byteStride"] = stride
        if target:
            item["target"] = target
        self.binary += data
        return self.add("bufferViews", item)

    def accessor(
        self,
        values: npt.ArrayLike,
        kind: str = "f32",
        normalized: bool = False,
        target: int | None = None,
        bounds: bool = False,
    ) -> int:
        """`values` already in the stored type's units: 0..255 for a normalised byte."""
        code, dtype = COMPONENTS[kind]
        array = np.ascontiguousarray(np.asarray(values), dtype=dtype)
        if array.ndim == 1:
            array = array[:, None]
        array = array.reshape(len(array), -1)
        stored, stride = array, None
        row = array.dtype.itemsize * array.shape[1]
        if target == ARRAY_BUFFER and row % 4:  # vertex attributes start on multiples of 4
            stride = row + 4 - row % 4
            stored = np.zeros((len(array), stride // array.dtype.itemsize), dtype)
            stored[:, : array.shape[1]] = array
        item = {
            "bufferView": self.view(stored.tobytes(), target, stride),
            "componentType": code,
            "count": len(array),
            "type": SHAPES[array.shape[1]],
        }
        if normalized:
            item["normalized"] = True
        if bounds:
            item |= bounds_of(array)
        return self.add("accessors", item)

    def attribute(
        self, values: npt.ArrayLike, kind: str = "f32", normalized: bool = False, bounds: bool = False
    ) -> int:
        return self.accessor(values, kind, normalized, ARRAY_BUFFER, bounds)

    def indices(self, triangles: npt.ArrayLike) -> int:
        flat = np.asarray(triangles).ravel()
        kind = "u16" if flat.max() < 0xFFFF else "u32"
        return self.accessor(flat, kind, target=ELEMENT_ARRAY_BUFFER)

    # ---- meshes ----
    def primitive(self, shape: Shape, material: int | None = None, **attributes: int) -> dict:
        """A primitive of a shapes.Shape; further attributes are accessor indices by their glTF names."""
        found = {"POSITION": self.attribute(shape.positions, bounds=True)}
        if shape.normals is shape.positions:  # a unit sphere: one array is both
            found["NORMAL"] = found["POSITION"]
        elif shape.normals is not None:
            found["NORMAL"] = self.attribute(shape.normals)
        if shape.uvs is not None:
            found["TEXCOORD_0"] = self.attribute(shape.uvs)
        item = {"attributes": found | attributes, "indices": self.indices(shape.triangles)}
        if material is not None:
            item["material"] = material
        return item

    def mesh(self, primitives: Any, name: str | None = None, **more: Any) -> int:
        primitives = [primitives] if isinstance(primitives, dict) else primitives
        return self.add("meshes", ({"name": name} if name else {}) | {"primitives": primitives} | more)

    # ---- materials ----
    def material(
        self,
        name: str,
        base: Sequence[float] = (1, 1, 1, 1),
        metallic: float = 0.0,
        roughness: float = 1.0,
        extensions: dict[str, Any] | None = None,
        texture: Any = None,
        **more: Any,
    ) -> int:
        pbr: dict[str, Any] = {
            "baseColorFactor": numbers(tuple(base) + (1,) * (4 - len(base))),
            "metallicFactor": number(metallic),
            "roughnessFactor": number(roughness),
        }
        if texture is not None:
            pbr["baseColorTexture"] = texture if isinstance(texture, dict) else {"index": texture}
        item = {"name": name, "pbrMetallicRoughness": pbr} | more
        if extensions:
            item["extensions"] = {self.uses(key): value for key, value in extensions.items()}
        return self.add("materials", item)

    def unlit(self, name: str, base: Sequence[float], **more: Any) -> int:
        return self.material(name, base, extensions={"KHR_materials_unlit": {}}, **more)

    def glass(
        self,
        name: str,
        ior: float = 1.5,
        thickness: float = 1.0,
        base: Sequence[float] = (1, 1, 1, 1),
        colour: Sequence[float] | None = None,
        distance: float | None = None,
    ) -> int:
        """Smooth clear glass: closed and refracting where thickness > 0, else thin-walled."""
        extensions = {
            "KHR_materials_transmission": {"transmissionFactor": 1},
            "KHR_materials_ior": {"ior": number(ior)},
        }
        if thickness > 0:
            volume: dict[str, Any] = {"thicknessFactor": number(thickness)}
            if colour is not None:
                volume |= {"attenuationColor": numbers(colour), "attenuationDistance": number(distance)}
            extensions["KHR_materials_volume"] = volume
        return self.material(name, base, 0, 0, extensions)

    def mirror(self, name: str, base: Sequence[float] = (1, 1, 1)) -> int:
        return self.material(name, base, metallic=1, roughness=0)

    def texture(
        self, png: bytes, filters: tuple[int, int] = (NEAREST, NEAREST), wrap: tuple[int, int] = (REPEAT, REPEAT)
    ) -> int:
        image = self.add("images", {"bufferView": self.view(png), "mimeType": "image/png"})
        sampler = self.add(
            "samplers", {"magFilter": filters[0], "minFilter": filters[1], "wrapS": wrap[0], "wrapT": wrap[1]}
        )
        return self.add("textures", {"source": image, "sampler": sampler})

    # ---- nodes ----
    def node(
        self,
        name: str,
        translation: npt.ArrayLike | None = None,
        rotation: npt.ArrayLike | None = None,
        scale: npt.ArrayLike | None = None,
        **more: Any,
    ) -> int:
        placed = {"translation": translation, "rotation": rotation, "scale": scale}
        item = {"name": name} | {k: numbers(v) for k, v in placed.items() if v is not None}
        return self.add("nodes", item | more)

    def perspective(
        self, name: str, yfov: float, aspect: float | None = None, near: float | None = 0.1, far: float | None = None
    ) -> int:
        lens: dict[str, Any] = {"yfov": number(yfov), "znear": number(near)}
        lens |= {"aspectRatio": number(aspect)} if aspect else {}
        lens |= {"zfar": number(far)} if far else {}
        return self.add("cameras", {"name": name, "type": "perspective", "perspective": lens})

    def orthographic(self, name: str, xmag: float, ymag: float, near: float | None = 0.01, far: float = 100.0) -> int:
        lens = dict(zip(("xmag", "ymag", "znear", "zfar"), map(number, (xmag, ymag, near, far)), strict=True))
        return self.add("cameras", {"name": name, "type": "orthographic", "orthographic": lens})

    def light(
        self,
        name: str,
        kind: str,
        intensity: float,
        color: npt.ArrayLike = (1, 1, 1),
        placed: dict[str, Any] | None = None,
        **more: Any,
    ) -> int:
        """A light and its node; gives the node. `placed` holds the node's translation and rotation."""
        extension = self.uses("KHR_lights_punctual")
        lights = self.json.setdefault("extensions", {}).setdefault(extension, {"lights": []})["lights"]
        lights.append({"name": name, "type": kind, "color": numbers(color), "intensity": number(intensity)} | more)
        return self.node(name, **(placed or {}), extensions={extension: {"light": len(lights) - 1}})

    def scene(self, nodes: Iterable[int], name: str | None = None) -> int:
        return self.add("scenes", ({"name": name} if name else {}) | {"nodes": list(nodes)})

    # ---- animation ----
    def animation(self, name: str, channels: Iterable[tuple[Any, ...]]) -> int:
        """`channels`: (node, path, times, values, interpolation); CUBICSPLINE values as (keys, 3, width)."""
        samplers, targets, inputs = [], [], {}
        for node, path, times, values, interpolation in channels:
            key = tuple(times)
            if key not in inputs:
                inputs[key] = self.accessor(times, bounds=True)
            width = 1 if path == "weights" else np.asarray(values).shape[-1]
            output = self.accessor(np.asarray(values, dtype=np.float64).reshape(-1, width))
            samplers.append({"input": inputs[key], "output": output, "interpolation": interpolation})
            targets.append({"sampler": len(samplers) - 1, "target": {"node": node, "path": path}})
        return self.add("animations", {"name": name, "channels": targets, "samplers": samplers})

    def skin(self, joints: Iterable[int], inverse_bind: npt.ArrayLike, name: str | None = None) -> int:
        """`inverse_bind`: (joints, 4, 4) matrices as written on paper; glTF stores columns."""
        columns = np.swapaxes(np.asarray(inverse_bind, dtype=np.float64), 1, 2).reshape(-1, 16)
        return self.add(
            "skins",
            ({"name": name} if name else {}) | {"joints": list(joints), "inverseBindMatrices": self.accessor(columns)},
        )

    # ---- file ----
    def bytes(self) -> bytes:
        if "scenes" in self.json:
            self.json.setdefault("scene", 0)
        if self.binary:
            self.json["buffers"] = [{"byteLength": len(self.binary)}]
        text = json.dumps(self.json, separators=(",", ":"), allow_nan=False).encode()
        chunks = [(b"JSON", text + b" " * (-len(text) % 4))]
        if self.binary:
            chunks.append((b"BIN\0", bytes(self.binary) + b"\0" * (-len(self.binary) % 4)))
        body = b"".join(struct.pack("<I", len(data)) + kind + data for kind, data in chunks)
        return b"glTF" + struct.pack("<II", 2, 12 + len(body)) + body


def bounds_of(array: np.ndarray) -> dict:
    """The exact stored values, which glTF asks for."""
    return {"min": [v.item() for v in array.min(axis=0)], "max": [v.item() for v in array.max(axis=0)]}
