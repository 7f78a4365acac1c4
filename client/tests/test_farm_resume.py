# SPDX-License-Identifier: MIT
"""`farm render` once more, with the real program on one worker: only what is missing, not whole, or of other inputs is
rendered."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from distributed import Client as DaskClient
from distributed import LocalCluster

from built import program, triangle_glb
from sheaf.cli import main

# Dask's own sockets and loops are not always closed when it says so.
pytestmark = pytest.mark.filterwarnings("default")

FRAMES = 4


@pytest.fixture(scope="module")
def scheduler(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """A cluster of one worker in this process, which rests while its program works."""
    folder = str(tmp_path_factory.mktemp("worker"))
    options: dict[str, Any] = {"n_workers": 1, "threads_per_worker": 1, "processes": False, "dashboard_address": None}
    with LocalCluster(local_directory=folder, **options) as cluster, DaskClient(cluster):  # type: ignore[no-untyped-call]
        yield cluster.scheduler_address


@dataclass
class Farm:
    """The command with one scene and one folder, and its last events."""

    scheduler: str
    folder: Path
    output: pytest.CaptureFixture[str]
    said: str = ""

    @property
    def scene(self) -> Path:
        return self.folder / "moving.glb"

    def frame(self, number: int) -> Path:
        return self.folder / "out" / f"moving.{number:04d}.exr"

    def render(self, spp: int = 1) -> tuple[int, int, int]:
        """How many frames were left alone, outdated, and rendered."""
        stats = self.folder / "stats.json"
        command = ["farm", "render", self.scene, "--out", self.folder / "out", "--frames", f"0-{FRAMES - 1}"]
        command += ["--scheduler", self.scheduler, "--sheaf", program("sheaf"), "--stats", stats]
        command += ["--size", "32x18", "--strategy", "reference", "--spp", spp, "--progress", "json"]
        code = main([str(word) for word in command])
        self.said = self.output.readouterr().out
        assert code == 0, self.said
        told = json.loads(stats.read_text())
        assert told["frames"] == FRAMES
        return told["skipped"], told["outdated"], told["totals"].get("frames", 0)

    def times(self) -> list[int]:
        return [self.frame(number).stat().st_mtime_ns for number in range(FRAMES)]

    def contents(self) -> list[bytes]:
        return [self.frame(number).read_bytes() for number in range(FRAMES)]


@pytest.fixture
def rendered(scheduler: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Farm:
    """All frames are there."""
    farm = Farm(scheduler, tmp_path, capsys)
    farm.scene.write_bytes(triangle_glb())
    assert farm.render() == (0, 0, FRAMES)
    return farm


def test_what_is_there_is_left_alone(rendered: Farm) -> None:
    before = rendered.times()
    assert rendered.render() == (FRAMES, 0, 0)
    assert rendered.times() == before
    assert "rendered again" not in rendered.said


def test_frames_of_other_settings_or_another_scene_are_rendered_again(rendered: Farm) -> None:
    first = rendered.contents()
    assert rendered.render(spp=4) == (0, FRAMES, FRAMES)
    assert "frames that were there and were rendered again: 4, of another scene" in rendered.said
    finer = rendered.contents()
    assert all(a != b for a, b in zip(first, finer, strict=True))
    rendered.scene.write_bytes(triangle_glb(top=0.5))
    assert rendered.render(spp=4)[1:] == (FRAMES, FRAMES)
    assert "rendered again: 4" in rendered.said


@pytest.mark.parametrize("cut", ["deleted", "its last byte", "half", "emptied"])
def test_only_what_is_missing_or_not_whole_is_rendered_again(rendered: Farm, cut: str) -> None:
    before, times = rendered.contents(), rendered.times()
    path, whole = rendered.frame(2), before[2]
    if cut == "deleted":
        path.unlink()
    else:
        path.write_bytes(whole[: {"its last byte": len(whole) - 1, "half": len(whole) // 2, "emptied": 0}[cut]])
    assert rendered.render() == (FRAMES - 1, cut != "deleted", 1)
    assert rendered.contents() == before
    assert [a == b for a, b in zip(rendered.times(), times, strict=True)] == [True, True, False, True]
    assert ("rendered again: 1" in rendered.said) == (cut != "deleted")
