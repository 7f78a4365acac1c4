# SPDX-License-Identifier: MIT
"""What workers do to the service: end in every way, crash, hang, flood, lie."""

import os
import pathlib
import signal
import time
from collections.abc import Callable

import pytest

from conftest import Gate
from service import Service, check_problem, gltf


@pytest.mark.parametrize(
    ("code", "slug"),
    [
        (1, "worker-failed"),
        (2, "worker-usage"),
        (3, "bad-scene"),
        (4, "device"),
        (5, "limit-exceeded"),
        (6, "storage"),
        (130, "interrupted"),
        (143, "interrupted"),
        (99, "worker-failed"),
    ],
)
def test_exit_codes(sheafd: Service, code: int, slug: str) -> None:
    job = sheafd.accepted(gltf(exit={"code": code, "message": "scene.gltf: accessors[3]: count is 0"}), {"frames": 0})
    end = sheafd.wait(job)
    assert end["state"] == "failed"
    assert end["error"] == {
        "type": f"urn:sheaf:problem:{slug}",
        "code": slug,
        "title": end["error"]["title"],
        "message": "scene.gltf: accessors[3]: count is 0",
        "exit_code": code,
        "signal": None,
    }
    last = list(sheafd.events(job))[-1]
    assert last["data"]["error"] == end["error"]


@pytest.mark.parametrize("number", [signal.SIGSEGV, signal.SIGKILL, signal.SIGABRT])
def test_a_crash_fails_its_job_and_no_other(sheafd: Service, number: signal.Signals) -> None:
    crash = sheafd.accepted(gltf(signal=int(number), at=1), {"frames": "0-2"})
    after = sheafd.accepted(gltf(), {"frames": 0})
    end = sheafd.wait(crash)
    assert end["state"] == "failed"
    assert end["error"]["code"] == "worker-crashed"
    assert end["error"]["message"] == f"worker ended by signal {int(number)} ({number.name})"
    assert end["error"]["signal"] == number
    assert [f["state"] for f in end["frames"]] == ["done", "missing", "missing"]
    assert sheafd.wait(after)["state"] == "done"


def test_garbage_is_logged_and_harmless(sheafd: Service) -> None:
    lines = [
        "",
        "hello",
        "{",
        "[1]",
        '{"event":7}',
        '{"event":"frame"}',
        '{"event":"frame","frame":"x","file":"y"}',
        '{"event":"frame","frame":0,"file":"/etc/passwd"}',
        '{"event":"frame","frame":0,"file":"../stats.json"}',
        '{"event":"frame","frame":0,"file":".."}',
        '{"event":"frame","frame":77,"file":"scene.0000.exr"}',
        '{"event":"start","frames":-4}',
        "\u0000\u00ff" * 50,
        "x" * 200_000,
    ]
    job = sheafd.accepted(gltf(lines=lines), {"frames": "0-1"})
    end = sheafd.wait(job)
    assert end["state"] == "done"
    assert [f["frame"] for f in end["frames"]] == [0, 1]
    log = sheafd.http.get(f"/v1/jobs/{job}/log").text
    assert "not an event: hello" in log
    assert "passwd is missing" in log
    assert str(sheafd.data) not in log


def test_a_worker_that_lies_about_frames(sheafd: Service) -> None:
    job = sheafd.accepted(gltf(silent_frames=[1]), {"frames": "0-2"})
    end = sheafd.wait(job)
    assert end["state"] == "failed"
    assert end["error"]["code"] == "incomplete"
    assert end["error"]["exit_code"] == 0
    assert [f["state"] for f in end["frames"]] == ["done", "missing", "done"]
    check_problem(sheafd.http.get(f"/v1/jobs/{job}/frames/1.exr"), 404, "not-produced")
    nothing = sheafd.accepted(gltf(frames=0, no_start=True))
    assert sheafd.wait(nothing)["error"]["code"] == "incomplete"


def test_a_flood_is_cut(start: Callable[..., Service]) -> None:
    service = start("--max-log", "64")
    job = service.accepted(gltf(flood=20), {"frames": 0})
    assert service.wait(job)["state"] == "done"
    log = service.http.get(f"/v1/jobs/{job}/log").text
    assert 60_000 < len(log) < 70_000
    assert log.endswith("left out\n")


# The default is asked of nobody but the clock: a cancelled job ends within a second, and what a busy machine adds.
@pytest.mark.parametrize(("options", "least", "most"), [((), 0.4, 5.0), (("--cancel-grace", "1.5"), 1.4, 60.0)])
def test_a_cancelled_job_does_not_wait_for_its_frame(
    start: Callable[..., Service], gate: Gate, options: tuple[str, ...], least: float, most: float
) -> None:
    service = start("--grace", "1000", *options)
    job = service.accepted(gltf(gates={"1": gate.path}, stubborn=True), {"frames": "0-1"})
    service.wait_for_frame(job, 0)
    began = time.monotonic()
    assert service.http.delete(f"/v1/jobs/{job}").status_code == 202
    assert service.job(job)["state"] == "running"
    assert service.job(job)["cancel_requested"]
    end = service.wait(job)
    assert end["state"] == "cancelled"
    assert [frame["state"] for frame in end["frames"]] == ["done", "missing"]
    assert least < time.monotonic() - began < most


def test_a_second_delete_kills_at_once(start: Callable[..., Service], gate: Gate) -> None:
    service = start("--grace", "1000", "--cancel-grace", "1000")
    job = service.accepted(gltf(gates={"0": gate.path}, stubborn=True), {"frames": 0})
    for event in service.events(job):
        if event["event"] == "start":
            break
    assert service.http.delete(f"/v1/jobs/{job}").status_code == 202
    assert service.http.delete(f"/v1/jobs/{job}").status_code == 204
    check_problem(service.http.get(f"/v1/jobs/{job}"), 410, "job-removed")
    after = service.accepted(gltf(), {"frames": 0})  # the worker's place is free again
    assert service.wait(after)["state"] == "done"
    assert not (service.data / "jobs" / job).exists()


def processes_of(job: str) -> list[str]:
    """Living processes whose command line names the job."""
    found = []
    for place in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
        try:
            if job.encode() in place.read_bytes() and ") Z" not in place.with_name("stat").read_text():
                found.append(place.parent.name)
        except OSError:
            continue
    return found


def test_children_left_behind_go_too(sheafd: Service, gate: Gate) -> None:
    job = sheafd.accepted(gltf(child=True, gates={"0": gate.path}), {"frames": 0})
    for event in sheafd.events(job):
        if event["event"] == "start":
            break
    assert len(processes_of(job)) == 2
    gate.open()
    assert sheafd.wait(job)["state"] == "done"
    while processes_of(job):
        pass


def test_workers_get_none_of_the_services_descriptors(start: Callable[..., Service], tmp_path: pathlib.Path) -> None:
    worker = tmp_path / "worker"
    worker.write_text("#!/bin/sh\nls -l /proc/$$/fd >&2; exit 3\n")
    worker.chmod(0o755)
    service = start(sheaf=worker)
    job = service.accepted(gltf(), {"frames": 0})
    assert service.wait(job)["state"] == "failed"
    log = service.http.get(f"/v1/jobs/{job}/log").text
    assert "/dev/null" in log
    assert "socket" not in log
    assert "eventfd" not in log
    assert "eventpoll" not in log


def test_a_worker_that_cannot_start(start: Callable[..., Service], tmp_path: pathlib.Path) -> None:
    service = start(sheaf=tmp_path / "missing")
    end = service.wait(service.accepted(gltf(), {"frames": 0}))
    assert end["state"] == "failed"
    assert end["error"]["code"] == "worker-missing"
    assert "missing" in end["error"]["message"]


def test_jobs_run_side_by_side(start: Callable[..., Service], tmp_path: pathlib.Path) -> None:
    service = start("--jobs", "2")
    gates = [Gate(tmp_path / f"g{i}") for i in range(2)]
    jobs = [service.accepted(gltf(gates={"0": g.path}), {"frames": 0}) for g in gates]
    third = service.accepted(gltf(), {"frames": 0})
    for job in jobs:
        service.wait(job, "running")
    assert service.job(third)["state"] == "queued"
    for g in reversed(gates):
        g.open()
    assert [service.wait(job)["state"] for job in [*jobs, third]] == ["done"] * 3


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_stopping_ends_workers_and_keeps_whole_frames(
    start: Callable[..., Service], gate: Gate, number: signal.Signals
) -> None:
    service = start("--grace", "1")
    job = service.accepted(gltf(gates={"1": gate.path}, stubborn=True), {"frames": "0-1"})
    service.wait_for_frame(job, 0)
    began = time.monotonic()
    os.kill(service.process.pid, number)
    assert service.process.wait(60) == 0
    assert time.monotonic() - began < 10
    assert [p.name for p in (service.data / "jobs" / job / "frames").iterdir() if p.suffix == ".exr"] == [
        "scene.0000.exr"
    ]


def test_readiness_follows_the_device(start: Callable[..., Service]) -> None:
    service = start(env={"FAKE_DEVICES_EXIT": "4"})
    while "still being looked for" in (reply := service.http.get("/readyz")).text:
        pass
    problem = check_problem(reply, 503, "not-ready")
    assert problem["checks"]["device"] != "ok"
    assert problem["checks"]["queue"] == "ok"
    good = start()
    while "still being looked for" in (reply := good.http.get("/readyz")).text:
        pass
    assert reply.json() == {"status": "ready", "checks": {"device": "ok", "disk": "ok", "queue": "ok"}}


def test_a_lost_device_ends_readiness(start: Callable[..., Service], tmp_path: pathlib.Path) -> None:
    gone = tmp_path / "gone"
    service = start("--attempts", "1", env={"FAKE_DEVICES_GONE": str(gone)})
    service.wait_until_ready()
    assert service.http.get("/readyz").status_code == 200
    lost = gltf(exit={"code": 4, "message": "the device was lost"})
    assert service.wait(service.accepted(lost, {"frames": 0}))["error"]["code"] == "device"
    service.wait_until_ready()
    assert service.http.get("/readyz").status_code == 200  # it has come back meanwhile
    gone.touch()
    assert service.wait(service.accepted(lost, {"frames": 0}))["state"] == "failed"
    service.wait_until_ready()
    assert check_problem(service.http.get("/readyz"), 503, "not-ready")["checks"]["device"] != "ok"
    # Two starts each: the first has rendered the frame, so that it was not in vain.
    assert "sheaf_workers_without_device_total 4\n" in service.http.get("/metrics").text


def test_one_service_a_data_folder(start: Callable[..., Service]) -> None:
    service = start()
    with pytest.raises(AssertionError, match="did not start"):
        Service(service.data)
