# SPDX-License-Identifier: MIT
"""What is left after the service, its workers or the machine have failed; chance is in test_service_kills.py."""

import pathlib
import shutil
import signal
import sqlite3
from collections.abc import Callable

import pytest

from conftest import Gate
from durable import begun, check_frames, workers_of
from service import Service, check_problem, gltf


def test_everything_is_there_after_a_restart(restart: Callable[..., Service]) -> None:
    service = restart()
    key = {"Idempotency-Key": "k"}
    done = service.submit(gltf(warnings=["dim"]), {"frames": "0-2", "spp": 4}, headers=key).json()["id"]
    failed = service.accepted(gltf(exit={"code": 3, "message": "bad"}), {"frames": 0})
    cancelled = service.accepted(gltf(), {"frames": "0-9"})
    service.http.post(f"/v1/jobs/{cancelled}/cancel")
    removed = service.accepted(gltf(), {"frames": 0})
    service.wait(removed)
    service.http.delete(f"/v1/jobs/{removed}")
    before = {job: (service.wait(job), list(service.events(job))) for job in (done, failed, cancelled)}
    listed = service.http.get("/v1/jobs").json()
    service.process.kill()
    service.stop()

    service = restart()
    for job, seen in before.items():
        assert (service.job(job), list(service.events(job))) == seen
    assert service.http.get("/v1/jobs").json() == listed
    check_problem(service.http.get(f"/v1/jobs/{removed}"), 410, "job-removed")
    assert service.submit(gltf(warnings=["dim"]), {"frames": "0-2", "spp": 4}, headers=key).json()["id"] == done
    check_problem(service.submit(gltf(), headers=key), 422, "idempotency-mismatch")
    check_frames(service, service.job(done))


def test_a_killed_service_takes_its_jobs_up_and_renders_nothing_twice(
    restart: Callable[..., Service], gate: Gate
) -> None:
    service = restart()
    job = service.accepted(gltf(gates={"2": gate.path}), {"frames": "0-3"})
    waiting = service.accepted(gltf(), {"frames": 0})
    service.wait_for_frame(job, 1)
    service.process.kill()
    service.process.wait()
    while workers_of(service.data):  # they go with the service
        pass
    service.stop()

    service = restart()
    assert service.wait(job, "running")["frames"][1]["state"] == "done"
    gate.open()
    end = service.wait(job)
    assert end["state"] == "done"
    assert end["starts"] == 2
    assert service.wait(waiting)["state"] == "done"
    check_frames(service, end)
    rendered = begun(service, job)
    assert sorted(set(rendered)) == [0, 1, 2, 3]
    assert rendered.count(0) == rendered.count(1) == 1
    ids = [event["id"] for event in service.events(job)]
    assert ids == list(range(1, len(ids) + 1))


def test_a_service_that_is_stopped_goes_on_with_its_jobs_later(restart: Callable[..., Service], gate: Gate) -> None:
    service = restart()
    for _ in range(5):  # more often than a worker may fail
        if "job" not in locals():
            job = service.accepted(gltf(gates={"1": gate.path}), {"frames": "0-1"})
        service.wait(job, "running")
        service.wait_for_frame(job, 0)
        assert service.stop() == 0
        service = restart()
    service.wait(job, "running")
    gate.open()
    assert service.wait(job)["state"] == "done"


def test_a_killed_worker_is_started_again_and_not_for_ever(sheafd: Service, tmp_path: pathlib.Path) -> None:
    trouble = tmp_path / "trouble"
    trouble.touch()
    job = sheafd.accepted(gltf(signal=int(signal.SIGKILL), at=1, until=str(trouble)), {"frames": "0-2"})
    for event in sheafd.events(job):
        if event["event"] == "warning":
            assert "SIGKILL" in event["data"]["message"]
            trouble.unlink()
            break
    end = sheafd.wait(job)
    assert end["state"] == "done"
    assert end["starts"] >= 2
    hopeless = sheafd.wait(sheafd.accepted(gltf(signal=int(signal.SIGKILL), at=1), {"frames": "0-2"}))
    assert hopeless["state"] == "failed"
    assert hopeless["error"]["code"] == "worker-crashed"
    assert hopeless["starts"] == 4  # three without a new frame
    assert [f["state"] for f in hopeless["frames"]] == ["done", "missing", "missing"]
    crash = sheafd.wait(sheafd.accepted(gltf(signal=int(signal.SIGSEGV), at=1), {"frames": "0-2"}))
    assert crash["state"] == "failed"
    assert crash["starts"] == 1


def test_a_job_that_takes_the_service_down_is_given_up(restart: Callable[..., Service], gate: Gate) -> None:
    job = None
    for start in range(1, 4):
        service = restart("--attempts", "3")
        job = job or service.accepted(gltf(gates={"0": gate.path}), {"frames": 0})
        service.wait(job, "running")
        assert service.job(job)["starts"] == start
        service.process.kill()
        service.stop()
    end = restart("--attempts", "3").wait(job or "")
    assert end["state"] == "failed"
    assert end["error"]["code"] == "interrupted"
    assert "3 times" in end["error"]["message"]


@pytest.mark.parametrize("known", [True, False])
def test_frames_that_were_not_reported_are_kept(sheafd: Service, tmp_path: pathlib.Path, known: bool) -> None:
    trouble = tmp_path / "trouble"
    trouble.touch()
    fake = {"signal": int(signal.SIGKILL), "at": 2, "mute": [1], "until": str(trouble)}
    job = sheafd.accepted(gltf(**fake), {"frames": "0-2"} if known else None)
    for event in sheafd.events(job):
        if event["event"] == "warning":
            trouble.unlink()
            break
    end = sheafd.wait(job)
    assert end["state"] == "done"
    assert [f["state"] for f in end["frames"]] == ["done"] * 3
    assert all(f["png_sha256"] for f in end["frames"])
    check_frames(sheafd, end)
    assert begun(sheafd, job).count(0) == begun(sheafd, job).count(1) == 1


def test_frames_that_a_power_cut_damaged_are_rendered_again(
    restart: Callable[..., Service], gate: Gate, tmp_path: pathlib.Path
) -> None:
    service = restart()
    job = service.accepted(
        gltf(gates={"4": gate.path}, padding=5000),
        {"frames": "0-4"},
    )
    service.wait_for_frame(job, 3)
    service.process.kill()
    service.stop()
    frames = service.data / "jobs" / job / "frames"
    whole = (frames / "scene.0002.exr").read_bytes()
    (frames / "scene.0000.exr").write_bytes(b"")
    (frames / "scene.0001.exr").unlink()
    (frames / "scene.0002.exr").write_bytes(whole[:100] + b"\0" * (len(whole) - 100))
    (frames / "scene.0003.png").unlink()
    (frames / ".scene.0004.exr.part").write_bytes(b"half")

    service = restart()
    gate.open()
    end = service.wait(job)
    assert end["state"] == "done"
    check_frames(service, end)
    assert [begun(service, job).count(frame) for frame in range(4)] == [2, 2, 2, 2]
    for frame in end["frames"]:
        assert service.http.get(frame["png"]).status_code == 200


def test_a_job_whose_files_are_lost_fails_and_says_so(restart: Callable[..., Service], gate: Gate) -> None:
    service = restart()
    job = service.accepted(gltf(gates={"0": gate.path}), {"frames": 0})
    other = service.accepted(gltf(), {"frames": 0})
    service.wait(job, "running")
    service.process.kill()
    service.stop()
    shutil.rmtree(service.data / "jobs" / job)
    service = restart()
    assert service.wait(job)["error"]["code"] == "storage"
    assert service.wait(other)["state"] == "done"


def test_folders_of_no_job_are_removed(restart: Callable[..., Service]) -> None:
    service = restart()
    job = service.accepted(gltf(), {"frames": 0})
    service.wait(job)
    service.process.kill()
    service.stop()
    stranger, upload = (
        service.data / "jobs" / ("a" * 26),
        service.data / "incoming" / ("b" * 26),
    )
    for folder in (stranger, upload):
        (folder / "scene").mkdir(parents=True)
    restart()
    assert not stranger.exists()
    assert not upload.exists()
    assert (service.data / "jobs" / job).exists()


def test_without_its_database_no_folder_is_touched(
    restart: Callable[..., Service],
) -> None:
    service = restart()
    job = service.accepted(gltf(), {"frames": 0})
    service.wait(job)
    service.stop()
    for file in service.data.glob("jobs.db*"):
        file.unlink()
    check_problem(restart().http.get(f"/v1/jobs/{job}"), 404, "unknown-job")
    assert (service.data / "jobs" / job / "frames" / "scene.0000.exr").exists()


def test_a_damaged_or_newer_database_is_refused(
    restart: Callable[..., Service],
) -> None:
    service = restart()
    service.stop()
    place = service.data / "jobs.db"
    with sqlite3.connect(place) as database:
        database.execute("PRAGMA user_version = 99")
    database.close()
    with pytest.raises(AssertionError, match="newer sheafd"):
        restart()
    place.write_bytes(b"this is no database" * 1000)
    with pytest.raises(AssertionError, match="not a database"):
        restart()


def test_old_jobs_make_room_for_new_ones(start: Callable[..., Service]) -> None:
    service = start("--max-kept", "1")
    scene = gltf() + b" " * 400_000
    jobs = []
    for _ in range(4):
        jobs.append(service.accepted(scene, {"frames": 0}))
        service.wait(jobs[-1])
    while service.http.get(f"/v1/jobs/{jobs[1]}").status_code == 200:
        pass
    problem = check_problem(service.http.get(f"/v1/jobs/{jobs[0]}"), 410, "job-removed")
    assert "room" in problem["detail"]
    assert service.job(jobs[2])["state"] == service.job(jobs[3])["state"] == "done"
    assert not (service.data / "jobs" / jobs[0]).exists()
