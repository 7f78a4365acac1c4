# SPDX-License-Identifier: MIT
"""What is left after the service, its workers, the machine or the disk have failed."""

import os
import pathlib
import random
import resource
import shutil
import signal
import sqlite3
import subprocess
import time
from collections.abc import Callable, Iterable, Iterator

import pytest
from conftest import Gate
from service import FAKE, PATIENCE, Service, check_problem, gltf, program

# How often the service or a worker is killed, in all. SHEAF_KILLS=5000 for a long run.
KILLS = int(os.environ.get("SHEAF_KILLS", "200"))


@pytest.fixture
def restart(tmp_path: pathlib.Path) -> Iterator[Callable[..., Service]]:
    """Starts the service on one data folder again and again; what was started before is gone by then."""
    running: list[Service] = []

    def begin(*options: str, **kwargs: object) -> Service:
        running.append(Service(tmp_path / "data", "--grace", "1", *options, **kwargs))  # type: ignore[arg-type]
        return running[-1]

    yield begin
    for service in running:
        service.stop()


def workers_of(data: pathlib.Path) -> list[int]:
    """Living processes that render for the service whose data this is."""
    found = []
    for place in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
        try:
            words = place.read_bytes().split(b"\0")
            if b"render" in words and any(w.startswith(str(data).encode()) for w in words):
                if ") Z" not in place.with_name("stat").read_text():
                    found.append(int(place.parent.name))
        except OSError:
            continue
    return found


def begun(service: Service, job: str) -> list[int]:
    """Frames that workers began, in order, as the fake one notes them down."""
    return [int(line) for line in (service.data / "jobs" / job / "ledger").read_text().split()]


def check_frames(service: Service, job: dict) -> None:
    """Every frame that the job says it has can be fetched, is whole, and is there once."""
    for frame in job["frames"]:
        if frame["state"] != "done":
            continue
        data = service.http.get(frame["exr"]).content
        assert data.startswith(b"v/1\x01") and len(data) == frame["bytes"]
    numbers = [frame["frame"] for frame in job["frames"]]
    assert numbers == sorted(set(numbers))
    assert job["progress"]["done"] == sum(frame["state"] == "done" for frame in job["frames"])


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
    assert end["state"] == "done" and end["starts"] == 2
    assert service.wait(waiting)["state"] == "done"
    check_frames(service, end)
    rendered = begun(service, job)
    assert sorted(set(rendered)) == [0, 1, 2, 3] and rendered.count(0) == rendered.count(1) == 1
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
    assert end["state"] == "done" and end["starts"] >= 2
    hopeless = sheafd.wait(sheafd.accepted(gltf(signal=int(signal.SIGKILL), at=1), {"frames": "0-2"}))
    assert hopeless["state"] == "failed" and hopeless["error"]["code"] == "worker-crashed"
    assert hopeless["starts"] == 4  # three without a new frame
    assert [f["state"] for f in hopeless["frames"]] == ["done", "missing", "missing"]
    crash = sheafd.wait(sheafd.accepted(gltf(signal=int(signal.SIGSEGV), at=1), {"frames": "0-2"}))
    assert crash["state"] == "failed" and crash["starts"] == 1


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
    assert end["state"] == "failed" and end["error"]["code"] == "interrupted" and "3 times" in end["error"]["message"]


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
    assert [f["state"] for f in end["frames"]] == ["done"] * 3 and all(f["png_sha256"] for f in end["frames"])
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
    assert not stranger.exists() and not upload.exists() and (service.data / "jobs" / job).exists()


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


class Ledger:
    """What clients were told, against what is there in the end."""

    def __init__(self) -> None:
        self.accepted: dict[str, int] = {}  # jobs, and how many frames each has
        self.reported: dict[str, set[int]] = {}

    def unfinished(self) -> list[str]:
        return [job for job, frames in self.accepted.items() if len(self.reported[job]) < frames]

    def look(self, service: Service, jobs: Iterable[str]) -> None:
        for job in jobs:
            frames = self.accepted[job]
            info = service.job(job)
            assert info["state"] in ("queued", "running", "done"), info
            assert len(info["frames"]) == frames
            done = {frame["frame"] for frame in info["frames"] if frame["state"] == "done"}
            lost = self.reported[job] - done
            assert not lost, f"job {job}: frames {lost} were there and are not any more"
            self.reported[job] = done
            check_frames(service, info)


def test_kills_at_random_moments_lose_nothing(restart: Callable[..., Service]) -> None:
    """The service or a worker, whichever chance takes, is killed while jobs are submitted and rendered."""
    seed = random.randrange(1 << 32)
    chance = random.Random(seed)
    print("seed", seed)  # of a run that fails
    ledger = Ledger()
    kills = {"service": 0, "worker": 0}
    options = ("--attempts", "1000000", "--jobs", "2")
    service = restart(*options)
    while sum(kills.values()) < KILLS:
        while len(ledger.unfinished()) < 2:
            count = chance.randrange(1, 12)
            fake = gltf(pace=chance.choice([0, 0.001, 0.01]), padding=chance.randrange(30_000))
            job = service.accepted(fake, {"frames": f"0-{count - 1}"})
            ledger.accepted[job], ledger.reported[job] = count, set()
        ledger.look(service, {*ledger.unfinished(), chance.choice(list(ledger.accepted))})
        time.sleep(chance.random() * 0.12)
        if chance.random() < 0.5:
            workers = workers_of(service.data)
            if workers:
                os.kill(chance.choice(workers), signal.SIGKILL)
                kills["worker"] += 1
            continue
        service.process.kill()
        kills["service"] += 1
        service.stop()
        service = restart(*options)
    for job in ledger.accepted:
        assert service.wait(job)["state"] == "done"
    ledger.look(service, ledger.accepted)
    listed = service.http.get("/v1/jobs", params={"limit": 200}).json()["jobs"]
    assert len({job["id"] for job in listed}) == len(listed) == min(200, len(ledger.accepted))
    wanted = sum(ledger.accepted.values())
    count = sum(len(begun(service, job)) for job in ledger.accepted)
    # A kill costs each of the two workers at most the frame it was at.
    assert wanted <= count <= wanted + kills["worker"] + 2 * kills["service"], (wanted, count, kills)
    assert not list((service.data / "incoming").iterdir())
    print(f"{kills} kills, {len(ledger.accepted)} jobs, {wanted} frames, {count - wanted} begun anew; lost: 0")


SMALL_DISK = """
mount -t tmpfs -o size=3m tmpfs "$1" && cd / && shift && exec "$@"
"""


def on_small_disk(data: pathlib.Path) -> list[str]:
    """Runs a command with a disk of 3 MiB mounted at `data`, in a mount namespace of its own."""
    return ["unshare", "-Urm", "sh", "-c", SMALL_DISK, "sh", str(data)]


def has_namespaces(tmp_path: pathlib.Path) -> bool:
    place = tmp_path / "probe"
    place.mkdir()
    return subprocess.run([*on_small_disk(place), "true"], capture_output=True, check=False).returncode == 0


def inside(service: Service, command: str) -> None:
    subprocess.run(
        [
            "nsenter",
            "-t",
            str(service.process.pid),
            "-U",
            "-m",
            "--preserve-credentials",
            "sh",
            "-c",
            command,
        ],
        check=True,
        timeout=PATIENCE,
    )


def test_a_full_disk_and_one_that_fails(start: Callable[..., Service], tmp_path: pathlib.Path, gate: Gate) -> None:
    if not has_namespaces(tmp_path):
        pytest.skip("no user namespaces to mount a small disk in")
    data = tmp_path / "disk"
    data.mkdir()
    service = start(data=data, prefix=on_small_disk(data))
    service.wait_until_ready()
    good = service.accepted(gltf(padding=10_000), {"frames": "0-2"})
    before = service.wait(good)
    held = service.accepted(gltf(gates={"0": gate.path}, padding=400_000), {"frames": "0-19"})
    service.wait(held, "running")

    inside(service, f"dd if=/dev/zero of={data}/ballast bs=64k 2>/dev/null; true")
    check_problem(service.submit(gltf(), {"frames": 0}), 503, "storage")
    assert service.http.get("/healthz").status_code == 200
    assert service.job(good) == before
    gate.open()  # its frames cannot be written
    end = service.wait(held)
    assert end["state"] == "failed"
    check_frames(service, end)

    inside(service, f"rm {data}/ballast")
    again = service.accepted(gltf(), {"frames": 0})
    assert service.wait(again)["state"] == "done"
    while service.http.get("/readyz").status_code != 200:
        pass

    resource.prlimit(service.process.pid, resource.RLIMIT_FSIZE, (0, resource.RLIM_INFINITY))  # no write succeeds
    reply = service.submit(gltf(), {"frames": 0})
    check_problem(reply, 503, "storage")
    assert int(reply.headers["Retry-After"]) > 0
    check_problem(service.http.delete(f"/v1/jobs/{again}"), 503, "storage")
    assert check_problem(service.http.get("/readyz"), 503, "not-ready")["checks"]["disk"] != "ok"
    assert service.job(again)["state"] == "done" and service.http.get(service.job(again)["frames"][0]["exr"]).content
    resource.prlimit(service.process.pid, resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
    while service.http.get("/readyz").status_code != 200:
        pass
    assert service.wait(service.accepted(gltf(), {"frames": 0}))["state"] == "done"
    assert service.job(held) == end


def test_a_read_only_data_folder_is_refused_at_the_start(
    tmp_path: pathlib.Path,
) -> None:
    if not has_namespaces(tmp_path):
        pytest.skip("no user namespaces to mount a read-only disk in")
    data = tmp_path / "disk"
    data.mkdir()
    prefix = on_small_disk(data)
    prefix[4] = prefix[4].replace("size=3m", "size=3m,ro")
    ended = subprocess.run(
        [
            *prefix,
            str(program("sheafd")),
            "--data",
            str(data),
            "--listen",
            "127.0.0.1:0",
            "--sheaf",
            str(FAKE),
        ],
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        check=False,
    )
    assert ended.returncode == 6 and "Read-only" in ended.stderr
