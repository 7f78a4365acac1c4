# SPDX-License-Identifier: MIT
"""SIGINT and SIGTERM in the middle of a run leave whole frames, no temporary files, and a run that can be resumed."""

import json
import os
import signal
import subprocess

import pytest

from rendering import PATIENCE, program, read_exr, scene_path


def start(out, *options: object, size: str = "48x24", strategy: str = "bvh") -> subprocess.Popen:
    command = [
        program(),
        "render",
        scene_path("interpolation"),
        "--out", out, "--size", size, "--strategy", strategy, "--frames", "0-99999", "--progress", "json",
        "--stats", out / "stats.json", *options,
    ]  # fmt: skip
    # A group of its own: a signal meant for it cannot reach the test.
    return subprocess.Popen(
        [str(part) for part in command],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def events_until(process: subprocess.Popen, frames: int) -> list[dict]:
    events = []
    assert process.stdout
    for line in process.stdout:
        events.append(json.loads(line))
        if sum(e["event"] == "frame" for e in events) == frames:
            return events
    raise AssertionError(f"ended early: {events} {process.stderr.read() if process.stderr else ''}")


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_interrupted(tmp_path, sheaf, number, code):
    out = tmp_path / "out"
    process = start(out)
    events = events_until(process, 3)
    os.kill(process.pid, number)
    assert process.stdout
    assert process.stderr
    events += [json.loads(line) for line in process.stdout]  # not communicate(): it passes by what was read ahead
    error = process.stderr.read()
    process.wait(PATIENCE)
    assert process.returncode == code
    assert "interrupted" in error
    assert events[-1]["event"] == "error"
    assert events[-1]["code"] == code
    done = [e["frame"] for e in events if e["event"] == "frame"]
    assert done == list(range(len(done)))
    assert len(done) < 1000  # it did stop
    names = sorted(p.name for p in out.iterdir())
    assert names == sorted([f"interpolation.{n:04}.exr" for n in done] + ["stats.json"])
    for name in names[:-1]:
        assert read_exr(out / name).rgba.shape == (24, 48, 4)
    stats = json.loads((out / "stats.json").read_text())
    assert [f["frame"] for f in stats["frames"]] == done

    last = done[-1]
    resumed = sheaf.render(
        "interpolation", "--frames", f"0-{last + 1}", "--resume", "--progress", "json", out=out, size="48x24"
    )
    assert [e["frame"] for e in resumed.events() if e["event"] == "frame"] == [last + 1]


@pytest.mark.parametrize("strategy", ["bvh", "reference"])
def test_interrupted_within_a_frame(tmp_path, strategy):
    """Of so many samples that a frame takes minutes: what was begun is given up, and nothing of it is left."""
    out = tmp_path / "out"
    process = start(out, "--spp", 65536, size="320x180", strategy=strategy)
    assert process.stdout
    begun = json.loads(process.stdout.readline())
    assert begun["event"] == "start"
    time_limit = 120  # seconds, for shaders that no cache holds; the frame would take more than five minutes
    os.kill(process.pid, signal.SIGTERM)
    _, error = process.communicate(timeout=time_limit)
    assert process.returncode == 143
    assert "interrupted" in error
    assert sorted(p.name for p in out.iterdir()) == ["stats.json"]


def test_killed_outright(tmp_path, sheaf):
    """SIGKILL can leave a temporary file, but nothing under a frame's name that is not whole; the next run tidies."""
    out = tmp_path / "out"
    process = start(out)
    events_until(process, 2)
    process.kill()
    process.communicate(timeout=PATIENCE)
    frames = sorted(out.glob("*.exr"))
    assert len(frames) >= 2
    for path in frames:
        assert read_exr(path).rgba.shape == (24, 48, 4)
    sheaf.render("interpolation", "--frames", "0", "--resume", out=out, size="48x24")
    assert not [p.name for p in out.iterdir() if p.name.endswith(".part")]
