# SPDX-License-Identifier: MIT
"""Animations on a cluster of two worker processes, with a fake engine that fails on demand."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from distributed import Client as DaskClient
from distributed import LocalCluster

import fake_sheaf
import sheaf
from sheaf import farm
from sheaf.cli import main
from sheaf.farm._render import _Run
from sheaf.farm._task import Order, Piece, Report, render_chunk
from sheaf.farm._workers import Workers

# Dask's own sockets and loops are not always closed when it says so.
pytestmark = pytest.mark.filterwarnings("default")

FAST = farm.FarmOptions(
    chunk_seconds=2.0,
    largest_chunk=4,
    least_late_seconds=8.0,
    late_factor=2.0,
    frame_seconds=120.0,
    least_timeout_seconds=20.0,
)


@pytest.fixture(scope="module")
def faults(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("faults")


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("bin") / "sheaf"
    path.write_text(f'#!/bin/sh\nexec "{sys.executable}" "{fake_sheaf.__file__}" "$@"\n')
    path.chmod(0o755)
    return str(path)


@pytest.fixture(scope="module")
def dask(faults: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[DaskClient]:
    os.environ["FAKE_SHEAF_FAULTS"] = str(faults)
    folder = str(tmp_path_factory.mktemp("workers"))
    options: dict[str, Any] = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None}
    try:
        with LocalCluster(local_directory=folder, **options) as cluster, DaskClient(cluster) as client:  # type: ignore[no-untyped-call]
            yield client
    finally:
        del os.environ["FAKE_SHEAF_FAULTS"]


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    (tmp_path / "box.bin").write_bytes(b"\0" * 12)
    path = tmp_path / "box.gltf"
    path.write_text('{"asset": {"version": "2.0"}, "buffers": [{"uri": "box.bin", "byteLength": 12}]}')
    return path


@pytest.fixture(autouse=True)
def _no_faults_are_left(faults: Path) -> Iterator[None]:
    yield
    left = [path.name for path in faults.iterdir()]
    for path in faults.iterdir():
        path.unlink()
    assert all(name.startswith("always-") for name in left), "a fault that never happened proves nothing"


def alone(scene: Path, folder: Path, frames: list[int]) -> dict[str, bytes]:
    """What one machine makes of it."""
    fake_sheaf.render(scene, folder, {"frames": ",".join(map(str, frames)), "spp": "3"})
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


class CountingCluster:
    """Counts how often it is asked for its workers."""

    def __init__(self) -> None:
        self.asked, self.workers = 0, {"tcp://a:1": 1}

    def nthreads(self) -> dict[str, int]:
        self.asked += 1
        return dict(self.workers)


def test_the_scheduler_is_asked_for_its_workers_once_a_second(monkeypatch: pytest.MonkeyPatch) -> None:
    cluster, now = CountingCluster(), 100.0
    monkeypatch.setattr("sheaf.farm._workers.time.monotonic", lambda: now)
    workers = Workers(cluster)  # type: ignore[arg-type]
    assert [len(workers) for _ in range(1000)] == [1] * 1000
    assert cluster.asked == 1
    cluster.workers = {}
    now += 1.0
    assert workers.addresses() == ()
    assert len(workers) == 1
    assert cluster.asked == 2


@pytest.mark.parametrize("shared", [False, True])
def test_the_same_bytes_as_one_machine(
    dask: DaskClient, program: str, scene: Path, tmp_path: Path, shared: bool
) -> None:
    told: list[int] = []
    seen: list[sheaf.Progress] = []
    result = farm.render(
        dask,
        scene,
        tmp_path / "out",
        range(12),
        shared=shared,
        program=program,
        options=FAST,
        progress=seen.append,
        on_file=lambda frame, _: told.append(frame),
        spp=3,
    )
    assert contents(tmp_path / "out") == alone(scene, tmp_path / "alone", list(range(12)))
    assert sorted(told) == sorted(result.files) == list(range(12))
    assert seen[-1] == sheaf.Progress("done", 12, 12, 1.0, 0.0)
    assert [progress.done for progress in seen] == sorted(progress.done for progress in seen)
    assert result.totals["frames"] == 12  # sums over all chunks
    assert result.worker_seconds > 0
    assert sum(result.frames_by_host.values()) == 12
    assert result.versions == {"sheaf 9.9.9"}
    left = dask.run(lambda dask_worker: [path.name for path in Path(dask_worker.local_directory).glob("sheaf-*")])
    assert set(map(tuple, left.values())) == {()}  # neither scene nor frames


def test_again_it_renders_only_what_is_missing(dask: DaskClient, program: str, scene: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    farm.render(dask, scene, out, "0-3", program=program, options=FAST)
    (out / "box.0002.exr").unlink()
    before = (out / "box.0001.exr").stat().st_mtime_ns
    result = farm.render(dask, scene, out, "0-3", program=program, options=FAST)
    assert result.skipped == 3
    assert result.totals["frames"] == 1
    assert (out / "box.0001.exr").stat().st_mtime_ns == before
    assert farm.render(dask, scene, out, "0-1", program=program, options=FAST, resume=False).skipped == 0


def test_a_killed_worker_costs_only_its_frames(
    dask: DaskClient, program: str, scene: Path, tmp_path: Path, faults: Path
) -> None:
    (faults / "kill-5").touch()
    result = farm.render(dask, scene, tmp_path / "out", range(10), program=program, options=FAST, spp=3)
    assert contents(tmp_path / "out") == alone(scene, tmp_path / "alone", list(range(10)))
    assert result.totals["frames"] <= 10 + FAST.largest_chunk


def test_a_frame_that_hangs_is_rendered_elsewhere(
    dask: DaskClient, program: str, scene: Path, tmp_path: Path, faults: Path
) -> None:
    (faults / "hang-6").touch()
    result = farm.render(dask, scene, tmp_path / "out", range(10), program=program, options=FAST, spp=3)
    assert contents(tmp_path / "out") == alone(scene, tmp_path / "alone", list(range(10)))
    assert result.copies + result.retried >= 1


def test_a_failure_that_passes_is_tried_again(
    dask: DaskClient, program: str, scene: Path, tmp_path: Path, faults: Path
) -> None:
    (faults / "fail-3-4").touch()
    (faults / "fail-0-6").touch()
    result = farm.render(dask, scene, tmp_path / "out", range(6), program=program, options=FAST, spp=3)
    assert contents(tmp_path / "out") == alone(scene, tmp_path / "alone", list(range(6)))
    assert result.retried + result.copies >= 2  # on a slow machine a copy may come first


def test_a_bad_frame_fails_with_its_reason_and_costs_no_other(
    dask: DaskClient, program: str, scene: Path, tmp_path: Path, faults: Path
) -> None:
    (faults / "always-fail-4-5").touch()
    with pytest.raises(sheaf.RenderError, match="frame 4: sheaf: frame 4: made to fail") as caught:
        farm.render(dask, scene, tmp_path / "out", range(6), program=program, options=FAST)
    assert caught.value.exit_code == 5
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == [f"box.{n:04d}.exr" for n in (0, 1, 2, 3, 5)]


def test_the_command(
    program: str, scene: Path, tmp_path: Path, dask: DaskClient, capsys: pytest.CaptureFixture[str]
) -> None:
    assert dask.scheduler
    out, stats = tmp_path / "out", tmp_path / "farm.json"
    command = ["farm", "render", str(scene), "--out", str(out), "--scheduler", str(dask.scheduler.address)]
    command += ["--frames", "0-4:2", "--sheaf", program, "--spp", "3", "--stats", str(stats), "--progress", "json"]
    assert main(command) == 0
    events = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert events[-1] == {"event": "done", "files": 3}
    assert contents(out) == alone(scene, tmp_path / "alone", [0, 2, 4])
    assert json.loads(stats.read_text())["totals"]["frames"] == 3
    assert main([*command, "--sheaf", str(tmp_path / "absent"), "--fresh", "--retries", "0"]) == 6
    assert main([*command, "--camera", "a.json", "--camera-node", "1"]) == 2
    assert main([*command[:2], str(tmp_path / "absent.glb"), *command[3:]]) == 3


def test_bytes_that_changed_on_the_way_are_refused(tmp_path: Path) -> None:
    run = _Run.__new__(_Run)
    run._folder = tmp_path
    for content in (b"other", None):
        with pytest.raises(ValueError, match="not those"):
            run._checked(Piece(1, "a.0001.exr", "0" * 64, 5, content))
    assert list(tmp_path.iterdir()) == []


def test_a_chunk_tells_which_frames_are_whole(
    program: str, scene: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("FAKE_SHEAF_FAULTS", str(tmp_path))
    (tmp_path / "fail-2-6").touch()
    order = Order(str(scene), None, (0, 1, 2, 3), {}, "a.##.exr", None, 60.0, program)
    report: Report = render_chunk(order, str(tmp_path))
    assert report.whole == (0, 1)
    assert report.exit_code == 6
    assert report.failure == "sheaf: frame 2: made to fail"
    assert [piece.name for piece in report.pieces] == ["a.00.exr", "a.01.exr"]
    (tmp_path / "hang-0").touch()
    order = Order(str(scene), None, (0,), {}, "a.##.exr", None, 3.0, program)
    report = render_chunk(order, str(tmp_path))
    assert report.exit_code is None
    assert "not done after" in str(report.failure)
