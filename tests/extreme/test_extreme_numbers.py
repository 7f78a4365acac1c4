# SPDX-License-Identifier: MIT
"""NaN, infinity, denormals and the largest floats, in every float of a file: refused by name, or harmless."""

from __future__ import annotations

import json
import pathlib
import re
import struct

import numpy as np
import pytest

from case import sane
from rendering import SCENES

FLOAT, SIZES = 5126, {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
DENORMAL, LARGEST = 1e-42, 3e38
# A file's other numbers are counts, indices, enumerations and offsets.
JSON_FLOATS = {
    "translation", "rotation", "scale", "yfov", "znear", "zfar", "intensity", "color", "baseColorFactor",
    "metallicFactor", "roughnessFactor",
}  # fmt: skip


class File:
    """A .glb taken apart, to be spoilt and put together again."""

    def __init__(self, name: str):
        data = (SCENES / f"{name}.glb").read_bytes()
        length = int.from_bytes(data[12:16], "little")
        self.json = json.loads(data[20 : 20 + length])
        self.binary = bytearray(data[28 + length :])

    def float_accessors(self) -> list[int]:
        return [k for k, a in enumerate(self.json["accessors"]) if a["componentType"] == FLOAT and "bufferView" in a]

    def values(self, accessor: int) -> np.ndarray:
        """Writable; tightly packed accessors only."""
        item = self.json["accessors"][accessor]
        view = self.json["bufferViews"][item["bufferView"]]
        assert "byteStride" not in view
        start = view.get("byteOffset", 0) + item.get("byteOffset", 0)
        return np.frombuffer(self.binary, "<f4", item["count"] * SIZES[item["type"]], start)

    def write(self, path: pathlib.Path, text: str | None = None) -> pathlib.Path:
        body = (text or json.dumps(self.json)).encode()
        body += b" " * (-len(body) % 4)
        parts = (
            struct.pack("<I4s", len(body), b"JSON")
            + body
            + struct.pack("<I4s", len(self.binary), b"BIN\0")
            + self.binary
        )
        path.write_bytes(b"glTF" + struct.pack("<II", 2, 12 + len(parts)) + parts)
        return path


def the_error(run) -> str:
    (line,) = [line for line in run.stderr.splitlines() if line]
    assert line.startswith("sheaf: ")
    return line


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_a_value_that_is_not_finite_is_refused_by_name(sheaf, tmp_path, value):
    """In the last element of every accessor of floats: positions, normals, UVs, weights, targets, matrices, keys."""
    accessors = File("whitted").float_accessors()
    assert len(accessors) > 20
    for accessor in accessors:
        file = File("whitted")
        file.values(accessor)[-1] = value
        run = sheaf("inspect", file.write(tmp_path / "bad.glb"), code=3)
        assert f"accessors[{accessor}]" in the_error(run)


def leaves(item: object, path: tuple = ()):
    children = item.items() if isinstance(item, dict) else enumerate(item) if isinstance(item, list) else ()
    for key, child in children:
        yield from leaves(child, (*path, key))
    if isinstance(item, int | float) and [p for p in path if isinstance(p, str)][-1] in JSON_FLOATS:
        yield path


def with_number(file: File, path: tuple, text: str) -> str:
    """The file's JSON with `text` at a place, as it is: what no JSON writer would write."""
    item = file.json
    for key in path[:-1]:
        item = item[key]
    item[path[-1]] = "HERE"
    return json.dumps(file.json).replace('"HERE"', text)


@pytest.mark.parametrize("text", ["1e39", "-1e39", "1e300", "1e400", "NaN", "Infinity"])
def test_a_number_past_floats_is_refused(sheaf, tmp_path, text):
    places = list(leaves(File("still_life").json))
    assert {path[0] for path in places} >= {"materials", "nodes", "cameras", "extensions"}
    for path in places:
        file = File("still_life")
        run = sheaf("inspect", file.write(tmp_path / "bad.glb", with_number(file, path, text)), code=3)
        line = the_error(run)
        assert "JSON" in line or re.search(
            rf"{path[-2] if isinstance(path[-1], int) else path[-1]}.*out of range", line
        ), line


def corner_far_off(file: File) -> None:
    position = file.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"]
    file.values(position)[0] = LARGEST
    file.json["accessors"][position]["max"][0] = LARGEST


def node_far_off(file: File) -> None:
    next(node for node in file.json["nodes"] if "mesh" in node)["translation"] = [LARGEST, -LARGEST, LARGEST]


def lamp_too_bright(file: File) -> None:
    light = file.json["extensions"]["KHR_lights_punctual"]["lights"][0]
    light["intensity"], light["color"] = LARGEST, [LARGEST] * 3


def lens_too_narrow(file: File) -> None:
    file.json["cameras"][0]["perspective"]["yfov"] = DENORMAL


@pytest.mark.parametrize("spoil", [corner_far_off, node_far_off, lamp_too_bright, lens_too_narrow])
def test_the_largest_and_the_least_are_harmless(sheaf, device_strategies, tmp_path, spoil):
    """No known answer, but numbers, and the same from every strategy."""
    file = File("still_life")
    spoil(file)
    scene = file.write(tmp_path / "extreme.glb")
    runs = sheaf.all(
        {"scene": scene, "strategy": s, "size": "16x9", "env": {"LP_NUM_THREADS": "1", "SHEAF_VALIDATION": "0"}}
        for s in (*device_strategies, "reference")
    )
    pictures = [run.frame() for run in runs]
    for strategy, picture in zip(device_strategies, pictures[:-1], strict=True):
        sane(picture)
        assert np.array_equal(picture.rgba.view(np.uint16), pictures[0].rgba.view(np.uint16)), strategy
    sane(pictures[-1])


def test_denormals_are_as_good_as_zero(sheaf, device_strategies, tmp_path):
    """Every 0 of every float accessor and of every node a denormal instead: the same picture."""
    file = File("still_life")
    for accessor in file.float_accessors():
        values = file.values(accessor)
        values[values == 0] = DENORMAL
    for node in file.json["nodes"]:
        for name in ("translation", "rotation"):
            if name in node:
                node[name] = [value or DENORMAL for value in node[name]]
    scene = file.write(tmp_path / "denormal.glb")
    plain = sheaf.render("still_life", size="32x18").frame()
    for strategy in device_strategies:
        picture = sheaf.render(scene, size="32x18", strategy=strategy, env={"SHEAF_VALIDATION": "0"}).frame()
        assert np.array_equal(picture.rgba.view(np.uint16), plain.rgba.view(np.uint16)), strategy
