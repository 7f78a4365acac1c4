# SPDX-License-Identifier: MIT
"""A disk that is full, that fails, or that cannot be written."""

import pathlib
import resource
import subprocess
from collections.abc import Callable

import pytest
from conftest import Gate
from durable import check_frames
from service import FAKE, PATIENCE, Service, check_problem, gltf, program

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
