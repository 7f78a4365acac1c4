# SPDX-License-Identifier: MIT
"""Who may use the service."""

import pathlib
import subprocess
from collections.abc import Callable

import pytest

from service import PATIENCE, Service, check_problem, gltf, program


def new_token(wanted: str) -> tuple[str, str]:
    """A token, and its line of the token file."""
    made = subprocess.run(
        [program("sheafd"), "--new-token", wanted], capture_output=True, text=True, timeout=PATIENCE, check=True
    )
    return made.stderr.rsplit(" ", 1)[1].strip(), made.stdout


@pytest.fixture
def guarded(start: Callable[..., Service], tmp_path: pathlib.Path) -> tuple[Service, str, str]:
    """A service with a token that reads and one that does both."""
    reader, first = new_token("reader=read")
    owner, second = new_token("owner=read,submit")
    (tmp_path / "tokens").write_text(first + second)
    assert reader not in first
    assert len(reader) > 40
    return start("--token-file", str(tmp_path / "tokens")), reader, owner


def bearer(token: str) -> dict[str, str]:
    return {"Authorization": "Bearer " + token}


def test_nothing_without_a_token(guarded: tuple[Service, str, str]) -> None:
    service, _, _ = guarded
    some_job = "/v1/jobs/" + "a" * 26
    for method, path in (
        ("GET", "/v1/jobs"),
        ("POST", "/v1/jobs"),
        ("GET", some_job),
        ("DELETE", some_job),
        ("POST", some_job + "/cancel"),
        ("GET", some_job + "/events"),
        ("GET", some_job + "/frames/0.exr"),
        ("GET", some_job + "/log"),
        ("GET", "/metrics"),
        ("GET", "/nope"),
    ):
        reply = service.http.request(method, path)
        check_problem(reply, 401, "unauthorized")
        assert reply.headers["WWW-Authenticate"].startswith("Bearer")
    for header in ("Bearer", "Bearer nonsense", "Basic eDp5", "Bearer " + "a" * 1000):
        check_problem(service.http.get("/v1/jobs", headers={"Authorization": header}), 401, "unauthorized")
    for path in ("/healthz", "/openapi.json", "/"):
        assert service.http.get(path).status_code == 200
    assert service.http.options("/v1/jobs").status_code == 204


def test_scopes(guarded: tuple[Service, str, str]) -> None:
    service, reader, owner = guarded
    check_problem(service.submit(gltf(), headers=bearer(reader)), 403, "insufficient-scope")
    reply = service.submit(gltf(), {"frames": 0}, headers=bearer(owner))
    assert reply.status_code == 202
    job = f"/v1/jobs/{reply.json()['id']}"
    assert service.http.get(job, headers=bearer(reader)).status_code == 200
    assert service.http.get("/metrics", headers=bearer(reader)).status_code == 200
    for method, path in (("DELETE", job), ("POST", job + "/cancel")):
        check_problem(service.http.request(method, path, headers=bearer(reader)), 403, "insufficient-scope")
    assert service.http.post(job + "/cancel", headers=bearer(owner)).status_code in (200, 202)
    taken: list[dict] = []
    while not taken:  # the log's line comes after the answer
        entries = [entry for entry in service.log if entry.get("path") == job + "/cancel"]
        taken = [entry for entry in entries if entry["status"] < 300]
    assert [entry["client"] for entry in taken] == ["owner"]
    assert not any(owner in str(entry) or reader in str(entry) for entry in service.log)


def run(*options: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([program("sheafd"), *options], capture_output=True, text=True, timeout=PATIENCE, check=False)


def test_it_does_not_listen_to_the_world_by_mistake(start: Callable[..., Service], tmp_path: pathlib.Path) -> None:
    ended = run("--listen", "0.0.0.0:0", "--data", str(tmp_path / "d"))
    assert ended.returncode == 2
    assert "--token-file" in ended.stderr.splitlines()[-1]
    service = start("--listen", "0.0.0.0:0", "--allow-anonymous")  # the last --listen counts
    assert service.address.startswith("0.0.0.0:")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "holds no token"),
        ("a read\n", "line 1"),
        ("# x\na read sha256:abc\n", "line 2"),
        ("a all sha256:" + "0" * 64 + "\n", "'all'"),
    ],
)
def test_bad_token_files(tmp_path: pathlib.Path, text: str, said: str) -> None:
    (tmp_path / "tokens").write_text(text)
    ended = run("--token-file", str(tmp_path / "tokens"), "--data", str(tmp_path / "d"), "--listen", "127.0.0.1:0")
    assert ended.returncode == 3
    assert said in ended.stderr
    assert ended.stderr.count("\n") == 1


def test_token_files_that_cannot_be_trusted(tmp_path: pathlib.Path) -> None:
    assert run("--token-file", str(tmp_path / "missing")).returncode == 6
    (tmp_path / "tokens").write_text(new_token("a=read")[1])
    (tmp_path / "tokens").chmod(0o666)
    ended = run("--token-file", str(tmp_path / "tokens"), "--data", str(tmp_path / "d"))
    assert ended.returncode == 3
    assert "chmod" in ended.stderr
    for wanted in ("a", "a=everything", "=read"):
        assert run("--new-token", wanted).returncode == 2


def test_tokens_come_and_go_without_a_restart(guarded: tuple[Service, str, str], tmp_path: pathlib.Path) -> None:
    service, reader, owner = guarded
    file = tmp_path / "tokens"
    first, second = file.read_text().splitlines(keepends=True)

    def status(token: str) -> int:
        return service.http.get("/v1/jobs", headers=bearer(token)).status_code

    assert status(reader) == status(owner) == 200
    file.write_text(second)  # in place
    assert (status(reader), status(owner)) == (401, 200)
    fresh, third = new_token("fresh=read")
    (tmp_path / "tokens.new").write_text(first + third)  # by another file in its place
    (tmp_path / "tokens.new").rename(file)
    assert (status(reader), status(owner), status(fresh)) == (200, 401, 200)

    file.write_text("nonsense\n")  # a slip of an editor locks nobody out, and lets nobody in
    assert (status(reader), status(owner), status(fresh)) == (200, 401, 200)
    file.unlink()
    assert (status(reader), status(owner)) == (200, 401)
    told = [entry for entry in service.log if entry["message"].startswith("token file is bad")]
    assert len(told) == 2
    assert "line 1" in told[0]["reason"]
    file.write_text(second)
    assert (status(reader), status(owner)) == (401, 200)
