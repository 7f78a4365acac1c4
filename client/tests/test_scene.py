# SPDX-License-Identifier: MIT
"""What is collected for a scene, and what never is."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any

import pytest

import sheaf
from sheaf._scene import collect_scene


def gltf(folder: Path, document: dict[str, Any] | None = None, **more: Any) -> Path:
    path = folder / "box.gltf"
    path.write_text(json.dumps({"asset": {"version": "2.0"}, **(document or {}), **more}))
    return path


def glb(**document: Any) -> bytes:
    text = json.dumps({"asset": {"version": "2.0"}, **document}).encode()
    text += b" " * (-len(text) % 4)
    return struct.pack("<4sII", b"glTF", 2, 20 + len(text)) + struct.pack("<I4s", len(text), b"JSON") + text


def test_collects_buffers_and_images_once_with_decoded_names(tmp_path: Path) -> None:
    (tmp_path / "tex").mkdir()
    for name in ("a.bin", "tex/my wood.png", "not-mentioned.png"):
        (tmp_path / name).write_bytes(name.encode())
    scene = gltf(
        tmp_path,
        buffers=[{"uri": "a.bin"}, {"uri": "data:application/octet-stream;base64,AA=="}, {"uri": "./a.bin"}, {}],
        images=[{"uri": "tex/my%20wood.png"}, {"bufferView": 0}],
    )
    files = collect_scene(scene)
    assert files.name == "box.gltf"
    assert files.beside == {"a.bin": tmp_path / "a.bin", "tex/my wood.png": tmp_path / "tex/my wood.png"}
    assert [(part.field, part.filename) for part in files.parts()] == [
        ("scene", "box.gltf"),
        ("file", "a.bin"),
        ("file", "tex/my wood.png"),
    ]


@pytest.mark.parametrize(
    ("kind", "uri"),
    [
        ("buffers", "../a.bin"),
        ("images", "tex/../../a.png"),
        ("images", "%2e%2e/a.png"),
        ("images", "..%2fa.png"),
        ("buffers", "/etc/passwd"),
        ("buffers", "file:///etc/passwd"),
        ("images", "http://example.org/a.png"),
        ("images", "C:/a.png"),
        ("images", "..\\a.png"),
        ("images", "\\\\host\\a.png"),
        ("images", "a\u0000.png"),
        ("images", ""),
        ("images", "."),
        ("images", 5),
    ],
)
def test_refuses_uris_that_leave_the_folder(tmp_path: Path, kind: str, uri: Any) -> None:
    folder = tmp_path / "scene"
    folder.mkdir()
    (tmp_path / "a.bin").touch()
    (tmp_path / "a.png").touch()
    scene = gltf(folder, document={kind: [{"uri": uri}]})
    with pytest.raises(sheaf.SceneError, match=rf"box.gltf: {kind}\[0\]"):
        collect_scene(scene)


def test_refuses_links_out_of_the_folder(tmp_path: Path) -> None:
    folder = tmp_path / "scene"
    folder.mkdir()
    (tmp_path / "secret").write_text("x")
    (folder / "a.bin").symlink_to(tmp_path / "secret")
    (folder / "up").symlink_to(tmp_path)
    for uri in ("a.bin", "up/secret"):
        with pytest.raises(sheaf.SceneError, match="link out of"):
            collect_scene(gltf(folder, buffers=[{"uri": uri}]))


def test_names_the_missing_file(tmp_path: Path) -> None:
    used = {"bufferViews": [{"buffer": 0}], "textures": [{"source": 0}]}
    with pytest.raises(sheaf.SceneError, match=r"buffers\[0\].*'gone.bin' is missing"):
        collect_scene(gltf(tmp_path, document=used | {"buffers": [{"uri": "gone.bin"}]}))
    with pytest.raises(sheaf.SceneError, match=r"images\[0\].*'gone.png' is missing"):
        collect_scene(gltf(tmp_path, document=used | {"images": [{"uri": "gone.png"}]}))


def test_what_nothing_refers_to_may_be_missing(tmp_path: Path) -> None:
    (tmp_path / "a.png").touch()
    scene = gltf(tmp_path, buffers=[{"uri": "gone.bin"}], images=[{"uri": "a.png"}, {"uri": "gone.png"}])
    assert collect_scene(scene).beside == {"a.png": tmp_path / "a.png"}


def test_steps_up_inside_the_folder(tmp_path: Path) -> None:
    (tmp_path / "a.png").touch()
    for uri in ("tex/../a.png", "tex/%2e%2e/a.png", "./x/y/../../a.png"):
        assert collect_scene(gltf(tmp_path, images=[{"uri": uri}])).beside == {"a.png": tmp_path / "a.png"}


@pytest.mark.parametrize("text", ["", "[]", "{", "\udc80", "[" * 100_000])
def test_refuses_what_is_no_gltf(tmp_path: Path, text: str) -> None:
    path = tmp_path / "bad.gltf"
    path.write_text(text, errors="surrogateescape")
    with pytest.raises(sheaf.SceneError, match="not glTF JSON"):
        collect_scene(path)


def test_binary_scenes_may_have_files_beside_them_too(tmp_path: Path) -> None:
    path = tmp_path / "box.GLB"
    path.write_bytes(glb(images=[{"uri": "a.png"}], textures=[{"source": 0}]) + b"binary chunk")
    with pytest.raises(sheaf.SceneError, match=r"a.png' is missing"):
        collect_scene(path)
    (tmp_path / "a.png").touch()
    files = collect_scene(path)
    assert files.name == "box.glb"
    assert list(files.beside) == ["a.png"]


def test_odd_lists_are_left_to_the_renderer(tmp_path: Path) -> None:
    assert collect_scene(gltf(tmp_path, buffers=5, images=[7, {"uri": None}])).beside == {}


def test_a_file_that_goes_away_before_it_is_sent(tmp_path: Path) -> None:
    (tmp_path / "a.bin").touch()
    files = collect_scene(gltf(tmp_path, buffers=[{"uri": "a.bin"}]))
    (tmp_path / "a.bin").unlink()
    with pytest.raises(sheaf.SceneError, match=r"a\.bin: No such file"):
        files.parts()[1].open()


def test_bytes_are_told_apart(tmp_path: Path) -> None:
    assert collect_scene(glb()).name == "scene.glb"
    assert collect_scene(b'{"asset": {"version": "2.0"}}').name == "scene.gltf"
    assert collect_scene(b"PK\x03\x04 ...").name == "scene.zip"
    with pytest.raises(sheaf.SceneError, match="bytes have no folder"):
        collect_scene(glb(buffers=[{"uri": "a.bin"}]))


@pytest.mark.parametrize("data", [b"", b"glTF", b"nonsense", glb()[:30], glb()[:12] + b"\xff" * 8])
def test_broken_bytes_are_refused(data: bytes, tmp_path: Path) -> None:
    with pytest.raises(sheaf.SceneError):
        collect_scene(data)
    path = tmp_path / "bad.glb"
    path.write_bytes(data)
    with pytest.raises(sheaf.SceneError, match=r"bad\.glb"):
        collect_scene(path)


def test_refuses_other_files(tmp_path: Path) -> None:
    (tmp_path / "a.obj").touch()
    with pytest.raises(sheaf.SceneError, match=r"\.glb, \.gltf or \.zip"):
        collect_scene(tmp_path / "a.obj")
    with pytest.raises(sheaf.SceneError, match="no such file"):
        collect_scene(tmp_path / "absent.glb")
    with pytest.raises(ValueError, match="no such file"):  # a SceneError is one
        collect_scene(tmp_path / "absent.zip")
