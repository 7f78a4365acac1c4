# SPDX-License-Identifier: MIT
"""Against the real service and renderer: what comes over HTTP is what `sheaf render` writes.

The programs are looked for below $SHEAF_BUILD, else below ../../build. Without them these tests are skipped, unless
SHEAF_BUILD is set: then their absence is a failure.
"""

from __future__ import annotations

import json
import os
import queue
import re
import subprocess
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import pytest

import sheaf
from built import program, triangle_glb
from sheaf.cli import main

pytestmark = pytest.mark.filterwarnings("default:::distributed", "default:::tornado")

START_SECONDS = 60  # a first start may compile shaders
CAMERA = sheaf.CameraPath.look_at_keys([(0, (0, 0, 4), (0, 0, 0))])
SETTINGS: sheaf.RenderSettings = {"frames": "0,6-12:6", "fps": 24, "size": (48, 32), "aov": "Z,N,id", "depth": 1}
OPTIONS = "--frames 0,6-12:6 --fps 24 --size 48x32 --aov Z,N,id --depth 1 --progress none"  # the same


@pytest.fixture(scope="module")
def url(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """A service on a port that the system chose; it says which when it starts."""
    data = tmp_path_factory.mktemp("data")
    environment = os.environ | {"PATH": f"{program('sheaf').parent}{os.pathsep}{os.environ['PATH']}"}
    process = subprocess.Popen(
        [program("sheafd"), "--listen", "127.0.0.1:0", "--data", data],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        env=environment,
    )
    lines: queue.SimpleQueue[str | None] = queue.SimpleQueue()

    def read() -> None:
        assert process.stdout
        for line in process.stdout:
            lines.put(line)
        lines.put(None)

    reader = threading.Thread(target=read)
    reader.start()
    try:
        yield _address(lines)
    finally:
        process.terminate()
        process.wait(START_SECONDS)
        reader.join()
        if process.stdout:
            process.stdout.close()


def _address(lines: queue.SimpleQueue[str | None]) -> str:
    said = []
    while (line := lines.get(timeout=START_SECONDS)) is not None:
        said.append(line)
        if match := re.search(r"127\.0\.0\.1:([1-9]\d*)", line):
            return f"http://{match.group()}"
    pytest.fail("sheafd ended without saying where it listens: " + "".join(said))


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("scene") / "triangle.glb"
    path.write_bytes(triangle_glb())
    return path


@pytest.fixture(scope="module")
def direct(scene: Path) -> Path:
    """The folder that `sheaf render` fills with the same job."""
    out = scene.parent / "direct"
    CAMERA.save(scene.parent / "camera.json")
    command: list[str | Path] = [
        program("sheaf"),
        "render",
        scene,
        "--out",
        out,
        "--camera",
        scene.parent / "camera.json",
    ]
    subprocess.run([*command, *OPTIONS.split()], check=True, timeout=10 * START_SECONDS)
    return out


@pytest.fixture(scope="module")
def done(url: str, scene: Path) -> Iterator[sheaf.Job]:
    with sheaf.Client(url) as client:
        yield client.submit(scene, CAMERA, **SETTINGS).wait(timeout=10 * START_SECONDS)


def test_the_job_is_done_and_says_so(done: sheaf.Job) -> None:
    assert done.state == "done"
    assert done.progress == sheaf.Progress("done", 3, 3, 1.0, None)
    assert done.info.rendered == [0, 6, 12]
    assert done.info.settings["size"] == "48x32"


def test_frames_equal_those_of_sheaf_render(done: sheaf.Job, direct: Path) -> None:
    frames = list(done.frames())
    assert [frame.number for frame in frames] == [0, 6, 12]
    for frame in frames:
        own = sheaf.read_exr(direct / f"triangle.{frame.number:04d}.exr")
        assert frame.size == (48, 32)
        assert set(frame.layers) == set(own.layers) >= {"RGBA", "Z", "N", "id.object"}
        for name, pixels in own.layers.items():
            assert pixels.dtype == frame.layers[name].dtype
            np.testing.assert_array_equal(frame.layers[name], pixels, err_msg=name)


def test_the_picture_is_the_triangle(done: sheaf.Job) -> None:
    first, last = done.frame(0), done.frame(12)
    assert first.rgba[16, 24, 3] == 1.0  # the middle is covered, the corners are not
    assert first.rgba[0, 0, 3] == 0.0
    assert np.all(np.isfinite(first.rgba))
    np.testing.assert_allclose(first.layers["Z"][16, 24], 4.0, rtol=1e-5)
    columns = [np.argwhere(frame.rgba[..., 3] > 0.5)[:, 1].mean() for frame in (first, last)]
    # Half a metre to the right, 4 m away, 45 degrees high over 32 rows.
    assert columns[1] - columns[0] == pytest.approx(0.5 / (8 * np.tan(np.pi / 8)) * 32, abs=0.5)


def test_stats_log_events_and_preview(done: sheaf.Job) -> None:
    stats = done.stats()
    assert stats["schema"] == 1
    assert stats["scene"]["triangles"] == 1
    assert [frame["frame"] for frame in stats["frames"]] == [0, 6, 12]
    assert stats["frames"][0]["rays"]["primary"] > 0
    assert isinstance(done.log(), str)
    events = list(done.events())
    assert [event.data["frame"] for event in events if event.type == "frame"] == [0, 6, 12]
    assert events[-1].data["state"] == "done"
    assert list(done.events(after=events[-2].id)) == events[-1:]
    assert done.preview(6).startswith(b"\x89PNG\r\n\x1a\n")


def test_download_gives_the_files_of_sheaf_render(done: sheaf.Job, tmp_path: Path) -> None:
    paths = done.download(tmp_path, previews=True)
    names = [f"triangle.{number:04d}.{kind}" for number in (0, 6, 12) for kind in ("exr", "png")]
    assert [path.name for path in paths] == names
    times = [path.stat().st_mtime_ns for path in paths]
    assert done.download(tmp_path, previews=True) == paths
    assert [path.stat().st_mtime_ns for path in paths] == times


def test_the_command(url: str, scene: Path, direct: Path, tmp_path: Path) -> None:
    command = ["render", str(scene), "--server", url, "--camera", str(scene.parent / "camera.json")]
    stats = tmp_path / "stats.json"
    assert main([*command, *OPTIONS.split(), "--out", str(tmp_path / "out"), "--stats", str(stats)]) == 0
    assert json.loads(stats.read_text())["schema"] == 1
    for path in sorted(direct.glob("*.exr")):
        own, other = sheaf.read_exr(path), sheaf.read_exr(tmp_path / "out" / path.name)
        np.testing.assert_array_equal(own.rgba, other.rgba)


def test_the_notebook_runs(url: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    notebook = json.loads((Path(__file__).parents[1] / "examples" / "render_and_plot.ipynb").read_text())
    monkeypatch.setenv("SHEAF_SERVER", url)
    monkeypatch.delenv("SHEAF_SCENE", raising=False)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    names: dict[str, Any] = {}
    matplotlib.use("Agg")
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code":
            text = "".join(cell["source"]).replace("480x270", "48x27")
            exec(compile(text, cell["id"], "exec"), names)
    assert [frame.number for frame in names["frames"]] == [0, 16, 32, 48]
    assert len(list(names["folder"].iterdir())) == 8
    assert names["figure"].axes[1].patches
    names["plt"].close("all")
    names["client"].close()


def test_a_farm_gives_the_files_of_sheaf_render(scene: Path, direct: Path, tmp_path: Path) -> None:
    command = ["farm", "render", str(scene), "--local", "2", "--sheaf", str(program("sheaf")), "--out", str(tmp_path)]
    assert main([*command, "--camera", str(scene.parent / "camera.json"), *OPTIONS.split()]) == 0
    theirs = sorted(direct.glob("*.exr"))
    assert [path.name for path in sorted(tmp_path.glob("*.exr"))] == [path.name for path in theirs]
    for path in theirs:
        own, other = sheaf.read_exr(path), sheaf.read_exr(tmp_path / path.name)
        for name, pixels in own.layers.items():
            np.testing.assert_array_equal(other.layers[name], pixels, err_msg=f"{path.name} {name}")


def test_bad_scenes_and_settings_are_told_apart(url: str) -> None:
    with sheaf.Client(url) as client:
        with pytest.raises(sheaf.InvalidRequest, match="size"):
            client.submit(triangle_glb(), size="0x0")
        with pytest.raises(sheaf.NotFound):
            client.job("a" * 26)
        broken = triangle_glb().replace(b'"count": 3', b'"count": 9')
        with pytest.raises((sheaf.JobFailed, sheaf.InvalidRequest), match="accessors"):
            client.submit(broken, frames=0).wait(timeout=10 * START_SECONDS)


def test_list_cancel_and_delete(url: str) -> None:
    with sheaf.Client(url) as client:
        job = client.submit(triangle_glb(), frames="0-9999", size=(512, 512), spp=64)
        assert job.id in [listed.id for listed in client.jobs()]
        job.cancel()
        with pytest.raises(sheaf.JobCancelled):
            job.wait(timeout=START_SECONDS)
        job.delete()
        with pytest.raises(sheaf.NotFound):
            job.refresh()
        assert client.health()
