# SPDX-License-Identifier: MIT
"""Collects what a scene consists of: the file, and the buffers and images it refers to beside it.

The scene may come from anywhere, so its URIs are not trusted: nothing outside its own folder is ever read,
neither by `..`, an absolute path or a URL, nor through a symbolic link.
"""

from __future__ import annotations

import json
import os
import re
import struct
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any
from urllib.parse import unquote

from ._errors import SceneError
from ._http import Part

_CONTENT_TYPES = {".glb": "model/gltf-binary", ".gltf": "model/gltf+json", ".zip": "application/zip"}
_GLB_MAGIC = b"glTF"
_GLB_JSON = 0x4E4F534A  # chunk type, "JSON"


@dataclass(frozen=True)
class SceneFiles:
    """A scene ready to be sent.

    Attributes:
        name: file name of the scene itself.
        content: the file, or the bytes given.
        beside: files it refers to, by their path relative to the scene's folder, with `/`.
    """

    name: str
    content: Path | bytes
    beside: dict[str, Path] = field(default_factory=dict)

    def parts(self) -> list[Part]:
        """The multipart parts: `scene`, and a `file` for each file beside it."""
        kind = _CONTENT_TYPES[Path(self.name).suffix]
        parts = [Part("scene", self.name, kind, _opener(self.content))]
        for uri, path in self.beside.items():
            parts.append(Part("file", uri, "application/octet-stream", _opener(path)))
        return parts


def collect_scene(scene: str | os.PathLike[str] | bytes) -> SceneFiles:
    """Finds all files of a scene.

    Args:
        scene: a .glb, .gltf or .zip file, or the bytes of one; bytes must hold all that the scene needs.

    Raises:
        SceneError: a file is missing, unreadable or of another kind, or a URI leaves the scene's folder.
    """
    if isinstance(scene, (bytes, bytearray, memoryview)):
        return _from_bytes(bytes(scene))
    path = Path(scene)
    suffix = path.suffix.lower()
    if suffix not in _CONTENT_TYPES:
        raise SceneError(f"{path}: a scene is a .glb, .gltf or .zip file")
    if not path.is_file():
        raise SceneError(f"{path}: no such file")
    name = path.stem + suffix
    if suffix == ".zip":
        return SceneFiles(name, path)
    document = _document(str(path), _json_text(path))
    beside = {}
    for place, uri in _external_uris(str(path), document):
        if _is_used(document, place) or (path.parent / uri).is_file():
            beside[uri] = _beside(path, place, uri)
    return SceneFiles(name, path, beside)


def _from_bytes(data: bytes) -> SceneFiles:
    if data.startswith(b"PK\x03\x04"):
        return SceneFiles("scene.zip", data)
    binary = data.startswith(_GLB_MAGIC)
    name = "scene.glb" if binary else "scene.gltf"
    document = _document(name, _glb_json(name, data) if binary else data)
    for place, uri in _external_uris(name, document):
        raise SceneError(f"{name}: {place} refers to {uri!r}, and bytes have no folder: give the path or a .zip")
    return SceneFiles(name, data)


def _json_text(path: Path) -> bytes:
    try:
        if path.suffix.lower() == ".gltf":
            return path.read_bytes()
        with path.open("rb") as file:  # the JSON chunk alone: the binary one may be large
            head = file.read(20)
            length = struct.unpack_from("<I", head, 12)[0] if len(head) == 20 else 0
            return _glb_json(str(path), head + file.read(min(length, path.stat().st_size)))
    except OSError as error:
        raise SceneError(f"{path}: {error.strerror or error}") from error


def _glb_json(name: str, data: bytes) -> bytes:
    if len(data) < 20 or not data.startswith(_GLB_MAGIC):
        raise SceneError(f"{name}: not a binary glTF file")
    length, kind = struct.unpack_from("<II", data, 12)
    if kind != _GLB_JSON or len(data) < 20 + length:
        raise SceneError(f"{name}: its JSON chunk is missing or cut short")
    return data[20 : 20 + length].rstrip(b"\0")


def _document(name: str, text: bytes) -> dict[str, Any]:
    try:
        document = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise SceneError(f"{name}: not glTF JSON ({error})") from error
    if not isinstance(document, dict):
        raise SceneError(f"{name}: not glTF JSON (no object at the top)")
    return document


def _external_uris(name: str, document: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """Place and decoded relative path of everything that is not inside the file, each path once."""
    seen = set()
    for kind in ("buffers", "images"):
        entries = document.get(kind, [])
        for index, entry in enumerate(entries if isinstance(entries, list) else []):
            uri = entry.get("uri") if isinstance(entry, dict) else None
            place = f"{kind}[{index}]"
            if uri is None or (isinstance(uri, str) and uri[:5].lower() == "data:"):
                continue
            relative = _relative(name, place, uri)
            if relative not in seen:
                seen.add(relative)
                yield place, relative


def _is_used(document: dict[str, Any], place: str) -> bool:
    """Whether anything refers to `buffers[3]` or `images[3]`. What nothing refers to may be missing."""
    kind, index = place.rstrip("]").split("[")
    owners, key = ("bufferViews", "buffer") if kind == "buffers" else ("textures", "source")
    entries = document.get(owners)
    return any(
        isinstance(entry, dict) and entry.get(key) == int(index)
        for entry in (entries if isinstance(entries, list) else [])
    )


def _relative(name: str, place: str, uri: Any) -> str:
    """The URI as a path below the scene's folder, normalised."""
    if not isinstance(uri, str):
        raise SceneError(f"{name}: {place}: the uri is not text")
    path = unquote(uri)
    if re.match(r"[A-Za-z][A-Za-z0-9+.-]*:", path) or path.startswith(("/", "\\")):
        raise SceneError(f"{name}: {place}: {uri!r} is not relative to the scene's folder")
    steps: list[str] = []
    climbs = False
    for step in path.split("/"):
        if step == "..":
            climbs = climbs or not steps
            steps = steps[:-1]
        elif step not in ("", "."):
            steps.append(step)
    if not steps or climbs or "\\" in path or any(ord(character) < 32 for character in path):
        raise SceneError(f"{name}: {place}: {uri!r} does not stay in the scene's folder")
    return "/".join(steps)


def _beside(scene: Path, place: str, relative: str) -> Path:
    folder = scene.parent.resolve()
    path = (folder / relative).resolve()
    if not path.is_relative_to(folder):
        raise SceneError(f"{scene}: {place}: {relative!r} is a link out of the scene's folder")
    if not path.is_file():
        raise SceneError(f"{scene}: {place}: {relative!r} is missing beside the scene")
    return path


def _opener(content: Path | bytes) -> Any:
    return partial(_open, content)


def _open(content: Path | bytes) -> Any:
    if isinstance(content, bytes):
        return content
    try:
        return content.open("rb")
    except OSError as error:
        raise SceneError(f"{content}: {error.strerror or error}") from error
