# SPDX-License-Identifier: MIT
"""A disk that is full, that fails, or that cannot be written."""

import pathlib
import resource
import subprocess
from collections.abc import Callable, Iterator

import pytest

from conftest import Gate
from durable import begun, check_frames
from service import FAKE, PATIENCE, Service, check_problem, gltf, program


class SmallDisk:
    """A disk of 3 MiB at `data`, in a mount namespace that a process of its own keeps, for services come and go."""

    def __init__(self, data: pathlib.Path):
        data.mkdir()
        self.data = data
        mount = 'mount -t tmpfs -o size=3m tmpfs "$1" && echo mounted && exec cat'
        self._keeper = subprocess.Popen(
            ["unshare", "-Urm", "sh", "-c", mount, "sh", str(data)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        assert self._keeper.stdout
        self.there = self._keeper.stdout.readline() == "mounted\n"
        enter = ["nsenter", "-t", str(self._keeper.pid), "-U", "-m", "--preserve-credentials"]
        self.prefix = [*enter, "sh", "-c", 'cd / && exec "$@"', "sh"]

    def run(self, command: str) -> None:
        subprocess.run([*self.prefix, "sh", "-c", command], check=True, timeout=PATIENCE)

    def fill(self) -> None:
        self.run(f"dd if=/dev/zero of={self.data}/ballast bs=64k 2>/dev/null; true")

    def empty(self) -> None:
        self.run(f"rm {self.data}/ballast")

    def forbid_writing(self) -> None:
        """A file system with files open for writing is not remounted, so a read-only view of it takes its place: what
        is opened by name from now on fails as on a disk that the kernel has given up."""
        self.run(f"mount --bind {self.data} {self.data} && mount -o remount,bind,ro {self.data}")

    def allow_writing(self) -> None:
        self.run(f"umount {self.data}")

    def close(self) -> None:
        self._keeper.communicate(timeout=PATIENCE)


@pytest.fixture
def disk(tmp_path: pathlib.Path) -> Iterator[SmallDisk]:
    small = SmallDisk(tmp_path / "data")
    if not small.there:
        small.close()
        pytest.skip("no user namespaces to mount a small disk in")
    yield small
    small.close()


def limit_files_of(service: Service, size: int) -> None:
    """Files that are open, the database among them, cannot grow past `size`."""
    resource.prlimit(service.process.pid, resource.RLIMIT_FSIZE, (size, resource.RLIM_INFINITY))


def wait_until_well(service: Service) -> None:
    while service.http.get("/readyz").status_code != 200:
        pass


def wait_until_held_up(service: Service, job: str) -> None:
    """Until the job's worker has found that it cannot write."""
    for event in service.events(job):
        if event["event"] == "warning" and "when the disk can be written" in event["data"]["message"]:
            return
    raise AssertionError(service.job(job))


def test_a_full_disk_and_one_that_fails(start: Callable[..., Service], disk: SmallDisk, gate: Gate) -> None:
    service = start(data=disk.data, prefix=disk.prefix)
    service.wait_until_ready()
    good = service.accepted(gltf(padding=10_000), {"frames": "0-2"})
    before = service.wait(good)
    held = service.accepted(gltf(gates={"1": gate.path}, padding=400_000), {"frames": "0-2"})
    service.wait_for_frame(held, 0)

    disk.fill()
    check_problem(service.submit(gltf(), {"frames": 0}), 503, "storage")
    assert service.http.get("/healthz").status_code == 200
    assert service.job(good) == before
    gate.open()  # its frames cannot be written
    wait_until_held_up(service, held)
    assert service.job(held)["state"] == "queued"
    check_frames(service, service.job(held))
    check_problem(service.http.get("/readyz"), 503, "not-ready")

    disk.empty()
    gate.open()
    end = service.wait(held)
    assert end["state"] == "done"
    assert end["starts"] == 2
    check_frames(service, end)
    assert service.wait(service.accepted(gltf(), {"frames": 0}))["state"] == "done"
    wait_until_well(service)

    limit_files_of(service, 0)
    reply = service.submit(gltf(), {"frames": 0})
    check_problem(reply, 503, "storage")
    assert int(reply.headers["Retry-After"]) > 0
    check_problem(service.http.delete(f"/v1/jobs/{good}"), 503, "storage")
    assert check_problem(service.http.get("/readyz"), 503, "not-ready")["checks"]["disk"] != "ok"
    assert service.job(good) == before
    assert service.http.get(before["frames"][0]["exr"]).content
    limit_files_of(service, resource.RLIM_INFINITY)
    wait_until_well(service)
    assert service.wait(service.accepted(gltf(), {"frames": 0}))["state"] == "done"
    assert service.job(held) == end


def test_a_disk_that_turns_read_only(start: Callable[..., Service], disk: SmallDisk, gate: Gate) -> None:
    service = start(data=disk.data, prefix=disk.prefix)
    service.wait_until_ready()
    good = service.accepted(gltf(), {"frames": "0-2"})
    before = service.wait(good)
    disk.forbid_writing()
    assert "Read-only" in check_problem(service.http.get("/readyz"), 503, "not-ready")["checks"]["disk"]
    check_problem(service.submit(gltf(), {"frames": 0}), 503, "storage")
    limit_files_of(service, 0)
    check_problem(service.submit(gltf(), {"frames": 0}), 503, "storage")
    check_problem(service.http.delete(f"/v1/jobs/{good}"), 503, "storage")
    assert service.http.get("/healthz").status_code == 200
    assert service.job(good) == before
    check_frames(service, before)
    limit_files_of(service, resource.RLIM_INFINITY)
    disk.allow_writing()
    wait_until_well(service)
    assert service.job(good) == before
    assert service.wait(service.accepted(gltf(), {"frames": 0}))["state"] == "done"


@pytest.mark.parametrize("killed", [False, True], ids=["goes on", "killed, and started with a good disk"])
def test_jobs_outlive_a_disk_that_cannot_be_written(
    restart: Callable[..., Service], disk: SmallDisk, gate: Gate, killed: bool
) -> None:
    service = restart(prefix=disk.prefix)
    job = service.accepted(gltf(gates={"2": gate.path}), {"frames": "0-3"})
    waiting = service.accepted(gltf(), {"frames": "0-1"})
    service.wait_for_frame(job, 1)
    disk.forbid_writing()
    gate.open()
    wait_until_held_up(service, job)
    seen = service.job(job)
    assert seen["state"] == "queued"
    assert seen["progress"]["done"] == 2
    if killed:
        service.process.kill()
        service.stop()
    disk.allow_writing()
    if killed:
        service = restart(prefix=disk.prefix)
    gate.open()
    end = service.wait(job)
    assert end["state"] == "done"
    assert end["starts"] == 2
    check_frames(service, end)
    assert service.wait(waiting)["state"] == "done"


def test_a_job_that_waits_for_the_disk_can_be_cancelled(
    start: Callable[..., Service], disk: SmallDisk, gate: Gate
) -> None:
    service = start(data=disk.data, prefix=disk.prefix)
    job = service.accepted(gltf(gates={"0": gate.path}), {"frames": "0-3"})
    service.wait(job, "running")
    disk.forbid_writing()
    gate.open()
    wait_until_held_up(service, job)
    assert service.http.post(f"/v1/jobs/{job}/cancel").json()["state"] == "cancelled"
    disk.allow_writing()
    assert service.wait(service.accepted(gltf(), {"frames": 0}))["state"] == "done"
    assert service.job(job)["state"] == "cancelled"
    assert service.job(job)["starts"] == 1


def test_a_worker_that_cannot_write_to_a_good_disk_is_not_tried_for_ever(sheafd: Service) -> None:
    job = sheafd.accepted(gltf(exit={"code": 6, "message": "cannot write"}, at=1), {"frames": "0-2"})
    end = sheafd.wait(job)
    assert (end["state"], end["error"]["code"], end["starts"]) == ("failed", "storage", 4)
    assert begun(sheafd, job) == [0, 1, 1, 1, 1]


def test_a_read_only_data_folder_is_refused_at_the_start(disk: SmallDisk) -> None:
    disk.forbid_writing()
    options = ["--data", str(disk.data), "--listen", "127.0.0.1:0", "--sheaf", str(FAKE)]
    ended = subprocess.run(
        [*disk.prefix, str(program("sheafd")), *options], capture_output=True, text=True, timeout=PATIENCE, check=False
    )
    assert ended.returncode == 6
    assert "Read-only" in ended.stderr
