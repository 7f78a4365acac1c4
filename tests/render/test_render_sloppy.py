# SPDX-License-Identifier: MIT
"""Files that break a rule of form and have one meaning: drawn in the colour that is written, and the place is named."""

import base64
import copy
import json
import struct
import zlib

import numpy as np
import pytest

COLOUR = (1.0, 0.5, 0.25)
SQUARE = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], "<f4").tobytes()
TRIANGLES = np.array([0, 1, 2, 0, 2, 3], "<u2").tobytes()
UVS = np.full((4, 2), 0.5, "<f4").tobytes()
DATA = SQUARE + TRIANGLES + UVS
CAMERA = {"keys": [{"time": 0, "position": [0, 0, 3], "rotation": [0, 0, 0, 1], "ortho_height": 2}]}


def png(red: int, green: int, blue: int) -> bytes:
    def chunk(name: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", struct.pack(">IIBBBBB", 1, 1, 8, 2, 0, 0, 0))
        + chunk(b"IDAT", zlib.compress(bytes([0, red, green, blue])))
        + chunk(b"IEND", b"")
    )


def data_uri(data: bytes = DATA, media: str = "application/octet-stream;base64") -> str:
    return f"data:{media}," + base64.b64encode(data).decode()


def document() -> dict:
    return {
        "asset": {"version": "2.0"},
        "extensionsUsed": ["KHR_materials_unlit"],
        "materials": [
            {"pbrMetallicRoughness": {"baseColorFactor": [*COLOUR, 1]}, "extensions": {"KHR_materials_unlit": {}}}
        ],
        "buffers": [{"byteLength": len(DATA), "uri": data_uri()}],
        "bufferViews": [
            {"buffer": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 12},
            {"buffer": 0, "byteOffset": 60, "byteLength": 32},
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
            {"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC2"},
        ],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 2}, "indices": 1, "material": 0}]}],
        "nodes": [{"mesh": 0}],
        "scenes": [{"nodes": [0]}],
        "scene": 0,
    }


def textured(uri: str) -> dict:
    doc = document()
    doc["images"], doc["textures"] = [{"uri": uri}], [{"source": 0}]
    doc["materials"][0]["pbrMetallicRoughness"] = {"baseColorTexture": {"index": 0}}
    return doc


def glb(doc: dict, *chunks: tuple[bytes, bytes]) -> bytes:
    text = json.dumps(doc).encode()
    body = b"".join(
        struct.pack("<I", len(data)) + kind + data
        for kind, data in ((b"JSON", text + b" " * (-len(text) % 4)), *chunks)
    )
    return b"glTF" + struct.pack("<II", 2, 12 + len(body)) + body


def changed(path: str, value) -> dict:
    doc = copy.deepcopy(document())
    *parents, last = [int(p) if p.isdigit() else p for p in path.split("/")]
    owner = doc
    for name in parents:
        owner = owner[name]
    if isinstance(owner, list):
        owner.append(value)
    else:
        owner[last] = value
    return doc


# What the file is, and what a warning says; "" for none.
DRAWN = {
    "stride 0": (changed("bufferViews/0/byteStride", 0), "bufferViews[0].byteStride"),
    "data longer": (changed("buffers/0/uri", data_uri(DATA + b"abc")), "buffers[0]"),
    "parameters": (
        changed("buffers/0/uri", data_uri(media="application/octet-stream;charset=utf-8;base64")),
        "buffers[0].uri",
    ),
    "matrix": (
        changed("nodes/0/matrix", [1, 0, 0, 1e-9, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0.9999999]),
        "nodes[0].matrix",
    ),
    "empty BIN": (glb(document(), (b"BIN\0", b"")), ""),
    "unknown chunk": (glb(document(), (b"TEST", b"12345678")), ""),
    "missing image": (changed("images", [{"uri": "gone.png"}]), "images[0].uri"),
    "bad camera": (changed("cameras", [{"type": "perspective", "perspective": {"yfov": 0, "znear": 1}}]), "cameras[0]"),
    "bad accessor": (changed("accessors/3", {"componentType": 5126, "count": 0, "type": "VEC3"}), "accessors[3].count"),
    "missing file": (changed("buffers/1", {"byteLength": 4, "uri": "gone.bin"}), "buffers[1].uri"),
}


def picture(sheaf, tmp_path, scene, name="scene"):
    path = tmp_path / name
    path.write_bytes(scene if isinstance(scene, bytes) else json.dumps(scene).encode())
    camera = tmp_path / "camera.json"
    camera.write_text(json.dumps(CAMERA))
    return sheaf.render(path, "--camera", camera, size="8x8")


@pytest.mark.parametrize("case", DRAWN)
def test_it_is_drawn_and_the_place_is_named(sheaf, tmp_path, case):
    scene, place = DRAWN[case]
    run = picture(sheaf, tmp_path, scene)
    assert np.allclose(run.frame().rgb, COLOUR, atol=1e-3)
    warnings = [line for line in run.stderr.splitlines() if "warning" in line]
    assert (len(warnings) == 1 and place in warnings[0]) if place else not warnings, run.stderr


@pytest.mark.parametrize(
    "uri", ["sub/../t.png", "sub/%2E./t.png", "data:image/jpg;base64,", "data:;base64,", "data:IMAGE/PNG;base64,"]
)
def test_the_bytes_of_an_image_decide(sheaf, tmp_path, uri):
    (tmp_path / "t.png").write_bytes(png(255, 0, 255))
    if uri.startswith("data:"):
        uri += base64.b64encode(png(255, 0, 255)).decode()
    run = picture(sheaf, tmp_path, textured(uri))
    assert np.allclose(run.frame().rgb, (1, 0, 1), atol=1e-3)
    assert "images[0].uri" in run.stderr


def test_an_attenuation_distance_of_0_absorbs_nothing(sheaf, tmp_path):
    """A thin pane before an unlit square: what is behind it in its own colour, as with no distance at all."""
    seen = []
    for distance in (0, None, "absent"):
        doc = document()
        volume = {"thicknessFactor": 1, "attenuationColor": [0, 0, 0], "attenuationDistance": distance}
        if distance == "absent":
            del volume["attenuationDistance"]
        doc["materials"].append(
            {
                "pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0},
                "extensions": {
                    "KHR_materials_transmission": {"transmissionFactor": 1},
                    "KHR_materials_ior": {"ior": 1},
                    "KHR_materials_volume": volume,
                },
            }
        )
        doc["meshes"].append({"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 1}]})
        doc["nodes"].append({"mesh": 1, "translation": [0, 0, 1]})
        doc["scenes"][0]["nodes"] = [0, 1]
        run = picture(sheaf, tmp_path, doc, f"scene{distance}")
        assert ("attenuationDistance" in run.stderr) == (distance != "absent")
        seen.append(run.frame().rgb)
    assert np.array_equal(seen[0], seen[2])
    assert np.array_equal(seen[1], seen[2])
    assert np.allclose(seen[0][4, 4], COLOUR, atol=2e-3)


def test_a_range_of_0_reaches_everywhere(sheaf, tmp_path):
    """A point light 2 above a Lambertian square: 10 candela over 4, and over pi for the surface; the dielectric's
    reflection takes its share alike."""
    lit: list[np.ndarray] = []
    for light in ({"range": 0}, {}):
        doc = document()
        doc["materials"][0] = {"pbrMetallicRoughness": {"metallicFactor": 0}}
        doc["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 10, **light}]}}
        doc["extensionsUsed"] = ["KHR_lights_punctual"]
        doc["nodes"].append({"translation": [0, 0, 2], "extensions": {"KHR_lights_punctual": {"light": 0}}})
        doc["scenes"][0]["nodes"] = [0, 1]
        run = picture(sheaf, tmp_path, doc, f"scene{len(lit)}")
        assert ("lights[0].range" in run.stderr) == bool(light)
        lit.append(run.frame().rgb)
    assert np.array_equal(lit[0], lit[1])
    assert lit[0][4, 4, 0] == pytest.approx(10 / 4 / np.pi, rel=0.1)


OTHERS = {
    "m.fbx": (b"Kaydara FBX Binary  \0", "a binary FBX file"),
    "m.obj": (b"# cube\nv 0 0 0\n", "an OBJ file"),
    "m.glb": (b"\x1f\x8b\x08\0", "a gzip file"),
    "m.zip": (b"PK\x03\x04" + bytes(30), "a ZIP archive"),
    "old.gltf": (b'{"asset": {"version": "1.0"}}', "only 2.x is: convert"),
}


@pytest.mark.parametrize("name", OTHERS)
def test_other_files_are_named(sheaf, tmp_path, name):
    data, kind = OTHERS[name]
    (tmp_path / name).write_bytes(data)
    run = sheaf("render", tmp_path / name, "--out", tmp_path / "out", code=3)
    assert kind in run.stderr
    assert len(run.stderr.splitlines()) == 1


@pytest.mark.parametrize(
    "option", ["--strategy", "--frames", "--animation", "--camera-node", "--size", "--depth", "--aov"]
)
@pytest.mark.parametrize("text", ["x" * 5000, "x y " * 2000, "ü" * 3000], ids=["word", "words", "letters"])
def test_a_long_option_is_cut_in_the_error(sheaf, tmp_path, option, text):
    scene = tmp_path / "s.gltf"
    scene.write_text(json.dumps(document()))
    run = sheaf("render", scene, "--out", tmp_path / "out", option, text, code=(2, 3))
    assert len(run.stderr.splitlines()) == 1
    assert text[:150] in run.stderr
    assert text[:201] not in run.stderr


# ---- camera paths of Nerfstudio ----
def nerfstudio(tmp_path, **more) -> str:
    camera = {"camera_to_world": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 2, 0, 0, 0, 1]} | more.pop("camera", {})
    path = tmp_path / "nerf.json"
    path.write_text(json.dumps({"camera_path": [camera], "fps": 24} | more))
    return str(path)


@pytest.mark.parametrize(
    ("more", "height"),
    [
        ({"default_fov": 90}, 50),
        ({"default_fov": 90, "camera": {"fov": None}}, 50),
        ({"default_fov": 20, "camera": {"fov": 90}}, 50),
        ({"camera": {"fov": 90, "camera_to_world": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 2], [0, 0, 0, 1]]}}, 50),
        ({"camera": {"fov": 90, "camera_to_world": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 2]]}}, 50),
        ({"camera": {"fov": 90, "camera_to_world": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 2, 0, 1e-9, 0, 0.9999999]}}, 50),
    ],
)
def test_nerfstudio(sheaf, tmp_path, more, height):
    """A square of 2 at a distance of 2: at 90 degrees 4 fill the picture's height of 100."""
    scene = tmp_path / "scene.gltf"
    scene.write_text(json.dumps(document()))
    run = sheaf.render(scene, "--camera", nerfstudio(tmp_path, **dict(more)), size="200x100")
    column = run.frame().alpha[:, 100]
    assert abs(int((column > 0.5).sum()) - height) <= 1
