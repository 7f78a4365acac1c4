# SPDX-License-Identifier: MIT
"""What `sheaf-client` says and exits with when something is wrong."""

from __future__ import annotations

import json
import os
import signal
from collections.abc import Callable
from pathlib import Path

import pytest

from fake_service import FakeJob, FakeService
from faults import problem


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        ("", "COMMAND"),
        ("render", "SCENE"),
        ("render box.gltf", "--out"),
        ("render box.gltf --out o --strategy fast", "--strategy"),
        ("render box.gltf --out o --depth deep", "--depth"),
        ("render box.gltf --out o --name box.exr", "--name 'box.exr'"),
        ("render box.gltf --out o --dump d", "--dump"),
        ("render box.gltf --out o --camera a.json --camera-node 0", "exclude"),
        ("render box.gltf --out o --server nowhere", "--server 'nowhere'"),
        ("status job --timeout 0", "--timeout"),
        ("status job --timeout nan", "--timeout"),
        ("status absent", "404"),
        ("download abc --out o --name x", "--name 'x'"),
    ],
)
def test_wrong_usage_is_2(
    run: Callable[..., int],
    arguments: str,
    reason: str,
    scene: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(scene.parent)
    assert run(*arguments.split()) == 2
    captured = capsys.readouterr()
    assert reason in captured.err
    assert captured.out == ""


def test_a_server_is_needed(
    run: Callable[..., int], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.delenv("SHEAF_SERVER")
    assert run("jobs") == 2
    assert capsys.readouterr().err == ("sheaf-client: --server URL is needed (or SHEAF_SERVER in the environment)\n")


@pytest.mark.parametrize(
    ("status", "code"), [(401, 2), (400, 3), (422, 3), (413, 5), (429, 6), (503, 6), (500, 6), (507, 6)]
)
def test_refusals_exit_by_their_kind(
    run: Callable[..., int],
    service: FakeService,
    scene: Path,
    tmp_path: Path,
    status: int,
    code: int,
    capsys: pytest.CaptureFixture[str],
) -> None:
    service.fault("POST", problem(status, "No", "because\nof this"), times=9)
    assert run("render", scene, "--out", tmp_path / "out") == code
    assert capsys.readouterr().err == f"sheaf-client: {status} No: because of this\n"
    assert not (tmp_path / "out").exists()


def test_bad_input_is_3_and_an_unreachable_service_6(
    run: Callable[..., int], service: FakeService, tmp_path: Path, scene: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert run("render", tmp_path / "absent.glb", "--out", tmp_path) == 3
    assert run("render", scene, "--camera", tmp_path / "absent.json", "--out", tmp_path) == 3
    assert run("render", scene, "--frames", "1-0", "--resume", "--out", tmp_path) == 3
    service.health = (200, {})
    monkeypatch.setenv("SHEAF_SERVER", "http://127.0.0.1:1")
    assert run("jobs") == 6


@pytest.mark.parametrize(("exit_code", "expected"), [(3, 3), (4, 4), (5, 5), (None, 6), (1, 6), (0, 6)])
def test_a_failed_job_exits_as_the_renderer_did_and_keeps_whole_frames(
    run: Callable[..., int],
    service: FakeService,
    scene: Path,
    tmp_path: Path,
    exr: bytes,
    exit_code: int | None,
    expected: int,
    capsys: pytest.CaptureFixture[str],
) -> None:
    def fail(job: FakeJob) -> None:
        job.state, job.frames, job.pending = "failed", {0: exr}, [1]
        job.error = {"code": "x", "message": "box.gltf: no", "exit_code": exit_code}

    service.new_job = fail
    assert run("render", scene, "--out", tmp_path / "out", "--progress", "json") == expected
    assert (tmp_path / "out" / "box.0000.exr").read_bytes() == exr
    captured = capsys.readouterr()
    last = json.loads(captured.out.splitlines()[-1])
    assert last == {"event": "error", "code": expected, "message": "job job1 failed (x): box.gltf: no"}
    assert captured.err == "sheaf-client: job job1 failed (x): box.gltf: no\n"


def test_a_job_cancelled_by_another_is_130(run: Callable[..., int], service: FakeService, tmp_path: Path) -> None:
    service.add(FakeJob("off", "cancelled"))
    assert run("download", "off", "--wait", "--out", tmp_path) == 130


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
@pytest.mark.parametrize("cancel", [False, True])
def test_an_interrupt_detaches_or_cancels(
    run: Callable[..., int],
    service: FakeService,
    scene: Path,
    tmp_path: Path,
    number: int,
    code: int,
    cancel: bool,
    capsys: pytest.CaptureFixture[str],
) -> None:
    service.new_job = lambda job: setattr(job, "state", "running")
    service.fault("GET .*/events", lambda handler: os.kill(os.getpid(), number))
    options = ["--cancel-on-interrupt"] if cancel else []
    assert run("render", scene, "--out", tmp_path / "out", *options) == code
    assert service.jobs["job1"].state == ("cancelled" if cancel else "running")
    said = capsys.readouterr().err
    assert ("cancelled job job1" if cancel else "sheaf-client cancel job1") in said
    assert not (tmp_path / "out").exists()
