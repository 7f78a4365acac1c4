# SPDX-License-Identifier: MIT
"""`sheaf-client` against the fake service: what it sends, writes, prints and exits with."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

import sheaf
from conftest import colour, exr_bytes
from fake_service import FakeJob, FakeService
from sheaf.cli import main


def test_render_sends_settings_and_brings_frames(
    run: Callable[..., int], service: FakeService, scene: Path, tmp_path: Path, exr: bytes
) -> None:
    out, stats = tmp_path / "out", tmp_path / "stats.json"
    options = (
        "--frames 0-1 --fps 24 --size 64x36 --spp 4 --depth 3 --cutoff 0.01 --strategy bvh --sort off --primary trace"
    )
    more = "--aov Z,N --compression piz --memory 512 --animation all --camera-node 0 --opaque --preview"
    assert run("render", scene, "--out", out, "--stats", stats, *options.split(), *more.split()) == 0
    assert sorted(path.name for path in out.iterdir()) == [
        "box.0000.exr",
        "box.0000.png",
        "box.0001.exr",
        "box.0001.png",
    ]
    assert (out / "box.0000.exr").read_bytes() == exr
    assert json.loads(stats.read_text())["schema"] == 1
    assert service.jobs["job1"].settings == {
        "frames": "0-1",
        "fps": 24,
        "size": "64x36",
        "spp": 4,
        "depth": 3,
        "cutoff": 0.01,
        "strategy": "bvh",
        "sort": "off",
        "primary": "trace",
        "aov": "Z,N",
        "compression": "piz",
        "memory": 512,
        "animation": "all",
        "camera-node": "0",
        "opaque": True,
        "preview": True,
        "name": "box.####.exr",
    }


def test_render_takes_all_options_of_sheaf_render(run: Callable[..., int], capsys: pytest.CaptureFixture[str]) -> None:
    assert run("render", "--help") == 0
    text = capsys.readouterr().out
    listed = """--out --camera --camera-node --frames --fps --animation --size --quality --spp --filter --depth --cutoff
        --strategy --sort --primary --aov --compression --name --stats --device --memory --progress --resume
        --opaque --preview"""
    for option in listed.split():
        assert option in text


def test_json_progress(
    run: Callable[..., int], scene: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("render", scene, "--out", tmp_path / "out", "--progress", "json", "--name", "a.#.exr") == 0
    captured = capsys.readouterr()
    events = [json.loads(line) for line in captured.out.splitlines()]
    assert events[0] == {"event": "start", "job": "job1"}
    assert {"event": "frame", "frame": 1, "file": str(tmp_path / "out" / "a.1.exr")} in events
    assert {event["done"] for event in events if event["event"] == "progress"} == {2}
    assert {"event": "warning", "message": "box.gltf: no light"} in events
    assert events[-1] == {"event": "done", "files": 2}
    assert captured.err == ""


def test_bar_and_silence(
    run: Callable[..., int], scene: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("render", scene, "--out", tmp_path / "out", "--progress", "bar") == 0
    captured = capsys.readouterr()
    assert captured.out == ""
    assert "2/2 frames" in captured.err
    assert "warning: box.gltf: no light" in captured.err
    assert f"2 files in {tmp_path / 'out'}" in captured.err
    assert run("render", scene, "--out", tmp_path / "out") == 0  # auto, and not a terminal
    captured = capsys.readouterr()
    assert captured.out + captured.err == ""


def test_resume_asks_only_for_what_is_not_whole(
    run: Callable[..., int], service: FakeService, scene: Path, tmp_path: Path, exr: bytes
) -> None:
    out = tmp_path / "out"
    out.mkdir()
    other = exr_bytes(tmp_path, colour(2, 2))
    (out / "box.0000.exr").write_bytes(other)
    (out / "box.0001.exr").write_bytes(exr[:-9])
    assert run("render", scene, "--out", out, "--frames", "0-1", "--resume") == 0
    assert service.jobs["job1"].settings["frames"] == "1"
    assert (out / "box.0001.exr").read_bytes() == exr
    service.requests.clear()
    assert run("render", scene, "--out", out, "--frames", "0-1", "--resume") == 0
    assert service.requests == []


def test_the_job_commands(
    run: Callable[..., int], service: FakeService, done_job: FakeJob, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    service.add(FakeJob("bad", "failed", error={"message": "why"}))
    service.add(FakeJob("run", "running", pending=[1]))
    assert run("jobs") == 0
    assert [line.split()[:2] for line in capsys.readouterr().out.splitlines()] == [
        ["abc", "done"],
        ["bad", "failed"],
        ["run", "running"],
    ]
    assert run("jobs", "--limit", "1", "--state", "failed", "--json") == 0
    assert json.loads(capsys.readouterr().out)["id"] == "bad"
    assert run("status", "bad", "--log") == 0
    printed = capsys.readouterr().out
    assert "why" in printed
    assert "rendered two frames" in printed
    assert run("status", "abc", "--json") == 0
    assert json.loads(capsys.readouterr().out)["state"] == "done"
    assert run("cancel", "run") == 0
    assert service.jobs["run"].state == "cancelled"
    assert run("cancel", "--delete", "run", "bad") == 0
    assert list(service.jobs) == ["abc"]
    assert run("download", "abc", "--out", tmp_path / "out") == 0
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["box.0003.exr", "box.0004.exr"]


def test_the_token_comes_from_option_or_environment(
    run: Callable[..., int], service: FakeService, monkeypatch: pytest.MonkeyPatch
) -> None:
    service.token = "secret"
    assert run("jobs") == 2
    assert run("jobs", "--token", "secret") == 0
    monkeypatch.setenv("SHEAF_TOKEN", "secret")
    assert run("jobs") == 0


def test_camera_paths(run: Callable[..., int], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "path.json"
    command = "camera turntable --center 0 -1 0 --radius 2 --height 1 --seconds 1 --fps 4 --revolutions -2 --fov 30"
    assert run(*command.split(), "--out", file) == 0
    expected = sheaf.CameraPath.turntable((0, -1, 0), 2, 1, 1, 4, 30, revolutions=-2)
    assert sheaf.CameraPath.load(file) == expected
    keys = "camera look-at --key 0 0 0 5 0 0 0 --key 1 5 0 0 0 0 0 --interpolation linear"
    assert run(*keys.split()) == 0
    assert [key["time"] for key in json.loads(capsys.readouterr().out)["keys"]] == [0, 1]
    assert run(*keys.replace("--key 1", "--key 0").split()) == 3
    assert run("camera", "turntable", "--radius", "0") == 3
    assert run("camera", "turntable", "--radius", "1", "--out", tmp_path / "absent" / "path.json") == 6


def test_one_command_line_entry(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["--version"])
    assert capsys.readouterr().out == f"sheaf-client {sheaf.__version__}\n"
