# SPDX-License-Identifier: MIT
"""Takes a scene to the workers: once to each, those that come later included."""

from __future__ import annotations

import hashlib
import os
import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from distributed import WorkerPlugin

from .._errors import SceneError
from .._files import write_whole_bytes
from .._scene import collect_scene


@dataclass(frozen=True)
class Bundle:
    """A scene with all that it needs, as bytes.

    Attributes:
        name: of the scene's own file.
        files: contents by relative path, `/` between steps; the scene and the camera path among them.
        digest: SHA-256 over all of it.
        camera: name of the camera path in `files`.
    """

    name: str
    files: Mapping[str, bytes]
    digest: str
    camera: str | None = None


def bundle(scene: str | os.PathLike[str], camera: str | os.PathLike[str] | None = None) -> Bundle:
    """Collects a scene's files.

    Raises:
        SceneError: one is missing, or it is no .glb or .gltf.
    """
    found = collect_scene(scene)
    if found.name.endswith(".zip"):
        raise SceneError(f"{os.fspath(scene)}: a farm wants a .glb or .gltf")
    paths = {found.name: Path(scene), **found.beside}
    camera_name = None
    if camera is not None:
        camera_name = "camera.path.json"
        paths[camera_name] = Path(camera)
    try:
        files = {name: path.read_bytes() for name, path in paths.items()}
    except OSError as error:
        raise SceneError(f"{error.filename}: {error.strerror or error}") from error
    digest = hashlib.sha256()
    for name, content in sorted(files.items()):
        digest.update(f"{len(name)} {name} {len(content)}\n".encode() + content)
    return Bundle(found.name, files, digest.hexdigest(), camera_name)


def unpack(content: Bundle, folder: Path) -> None:
    """Writes a bundle's files, whole or not at all."""
    for name, data in content.files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole_bytes(path, data)


class ScenePlugin(WorkerPlugin):
    """Puts a bundle into every worker's own folder, and takes it away with the worker."""

    def __init__(self, content: Bundle) -> None:
        self.name = plugin_name(content.digest)
        self._content = content

    def setup(self, worker: Any) -> None:
        """Called on each worker, also on those that join later."""
        unpack(self._content, scene_folder(worker.local_directory, self._content.digest))

    def teardown(self, worker: Any) -> None:
        """Called when the job is over or the worker ends."""
        shutil.rmtree(scene_folder(worker.local_directory, self._content.digest), ignore_errors=True)


def plugin_name(digest: str) -> str:
    """The name under which the plugin is known to the cluster."""
    return f"sheaf-scene-{digest[:16]}"


def scene_folder(local_directory: str, digest: str) -> Path:
    """Where a worker has the scene."""
    return Path(local_directory) / plugin_name(digest)
