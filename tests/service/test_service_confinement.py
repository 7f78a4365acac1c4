# SPDX-License-Identifier: MIT
"""What a worker may do, told by workers that try."""

import json
import os
import pathlib
import sys
from collections.abc import Callable

import pytest

from service import Service, gltf

PROBE = f"""#!{sys.executable}
import ctypes, json, os, pathlib, resource, socket, sys
scene = pathlib.Path(sys.argv[2])
wanted = json.loads(scene.read_text())["extras"]["fake"]
tried = {{}}
def attempt(name, action):
    try:
        action()
        tried[name] = "done"
    except OSError as error:
        tried[name] = error.strerror
for path in wanted["read"]:
    attempt("read " + path, lambda: open(path, "rb").read(1))
for path in wanted["write"]:
    attempt("write " + path, lambda: open(path, "wb"))
attempt("own", lambda: open(scene.parent.parent / "frames" / "note", "wb"))
attempt("inet", lambda: socket.socket(socket.AF_INET))
attempt("unix", lambda: socket.socket(socket.AF_UNIX))
libc = ctypes.CDLL(None, use_errno=True)
def call(result):
    if result != 0:
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))
attempt("unshare", lambda: call(libc.unshare(0x10000000)))
attempt("signal", lambda: os.kill(os.getppid(), 0))
tried["core"] = resource.getrlimit(resource.RLIMIT_CORE)[1]
tried["data"] = resource.getrlimit(resource.RLIMIT_DATA)[1]
tried["privileges"] = "NoNewPrivs:\\t1" in pathlib.Path("/proc/self/status").read_text()
print(json.dumps(tried), file=sys.stderr)
sys.exit(3)
"""


def tried(service: Service, **wanted: list[str]) -> dict:
    job = service.accepted(gltf(**{"read": [], "write": [], **wanted}))
    assert service.wait(job)["state"] == "failed"
    return json.loads(service.http.get(f"/v1/jobs/{job}/log").text.splitlines()[-1])


@pytest.fixture
def probe(tmp_path: pathlib.Path) -> pathlib.Path:
    place = tmp_path / "bin" / "probe"
    place.parent.mkdir()
    place.write_text(PROBE)
    place.chmod(0o755)
    return place


def active(service: Service) -> set[str]:
    said = next(entry for entry in service.log if entry["message"] == "worker confinement")
    assert set(said["active"]) <= set(said["known"]) == {"rlimits", "no_new_privs", "landlock", "seccomp"}
    return set(said["active"])


def test_a_worker_has_its_job_and_nothing_else(
    start: Callable[..., Service], probe: pathlib.Path, tmp_path: pathlib.Path
) -> None:
    data = tmp_path / "place" / "data"
    data.parent.mkdir()
    service = start("--worker-memory", "3000", data=data, sheaf=probe, readable=[sys.base_prefix, sys.prefix])
    (tmp_path / "secret").write_text("s")
    other = service.accepted(gltf(read=[], write=[]))
    service.wait(other)
    foreign = str(data / "jobs" / other / "scene" / "scene.gltf")
    database, secret = str(data / "jobs.db"), str(tmp_path / "secret")
    found = tried(service, read=[foreign, database, secret, "/proc/self/status"], write=[foreign, secret, "/usr/x"])
    held = active(service)
    assert "rlimits" in held
    assert found["core"] == 0
    assert found["data"] == 3000 << 20
    assert found["own"] == "done"
    assert found["read /proc/self/status"] == "done"
    if "no_new_privs" in held:
        assert found["privileges"] is True
    if "seccomp" in held:
        assert found["inet"] == found["unix"] == found["unshare"] == "Operation not permitted"
    if "landlock" in held:
        for path in (foreign, database, secret):
            assert found["read " + path] == "Permission denied"
        for path in (foreign, secret, "/usr/x"):
            assert found["write " + path] == "Permission denied"
    assert "sheaf_worker_confinement" in service.http.get("/metrics").text


def test_confinement_can_be_left_out(
    start: Callable[..., Service], probe: pathlib.Path, tmp_path: pathlib.Path
) -> None:
    service = start("--no-confinement", sheaf=probe)
    (tmp_path / "secret").write_text("s")
    found = tried(service, read=[str(tmp_path / "secret")])
    assert found["inet"] == "done"
    assert found["read " + str(tmp_path / "secret")] == "done"
    assert active(service) == {"rlimits"}
    assert found["core"] == 0


@pytest.mark.parametrize(
    ("options", "worker", "said"),
    [
        (["--max-wall", "1"], "#!/bin/sh\n[ $1 = render ] && exec sleep 1000\n", "--max-wall"),
        (["--max-cpu", "1"], "#!/bin/sh\nwhile [ $1 = render ]; do :; done\n", "--max-cpu"),
    ],
)
def test_time_is_limited(
    start: Callable[..., Service], tmp_path: pathlib.Path, options: list[str], worker: str, said: str
) -> None:
    place = tmp_path / "worker"
    place.write_text(worker)
    place.chmod(0o755)
    service = start("--grace", "1", *options, sheaf=place)
    end = service.wait(service.accepted(gltf(), {"frames": 0}))
    assert end["state"] == "failed"
    assert end["error"]["code"] == "limit-exceeded"
    assert said in end["error"]["message"]
    assert "1 s" in end["error"]["message"]
    assert end["starts"] == 1


@pytest.mark.parametrize(("options", "more"), [([], 10), (["--worker-nice", "3"], 3), (["--worker-nice", "0"], 0)])
def test_workers_give_way_to_the_service(
    start: Callable[..., Service], tmp_path: pathlib.Path, options: list[str], more: int
) -> None:
    place = tmp_path / "worker"
    place.write_text("#!/bin/sh\nread -r line < /proc/self/stat\necho $line >&2\nexit 3\n")
    place.chmod(0o755)
    service = start(*options, sheaf=place)
    job = service.accepted(gltf(), {"frames": 0})
    service.wait(job)
    niceness = int(service.http.get(f"/v1/jobs/{job}/log").text.split(") ")[1].split()[16])  # proc(5), field 19
    assert niceness == min(19, os.nice(0) + more)
