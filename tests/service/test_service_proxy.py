# SPDX-License-Identifier: MIT
"""The proxy of docker/compose.yaml, Debian's nginx with docker/proxy.conf, before a real service."""

import os
import pathlib
import shutil
import socket
import ssl
import subprocess
import time
from collections.abc import Callable, Iterator

import httpx
import pytest

from conftest import Gate
from service import PATIENCE, Service, check_problem, gltf

CONF = pathlib.Path(__file__).resolve().parent / "../../docker/proxy.conf"


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@pytest.fixture
def proxied(start: Callable[..., Service], tmp_path: pathlib.Path) -> Iterator[tuple[Service, httpx.Client]]:
    """A service, and a client that reaches it through the proxy alone."""
    nginx = shutil.which("nginx", path=os.environ["PATH"] + ":/usr/sbin")
    if not nginx and os.environ.get("SHEAF_REQUIRE_TOOLS") == "1":
        pytest.fail("no nginx")
    if not nginx:
        pytest.skip("no nginx")
    service = start()
    tls = tmp_path / "tls"
    tls.mkdir()
    made = ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-subj", "/CN=localhost", "-days", "2"]
    made += ["-addext", "subjectAltName=IP:127.0.0.1", "-keyout", f"{tls}/key.pem", "-out", f"{tls}/cert.pem"]
    subprocess.run(made, check=True, capture_output=True, timeout=PATIENCE)
    port = free_port()
    text = CONF.read_text().replace("/tmp/", f"{tmp_path}/").replace("/etc/nginx/tls", str(tls))
    text = text.replace("server sheafd:8080", f"server {service.address}")
    text = text.replace("listen 8443", f"listen 127.0.0.1:{port}")
    (tmp_path / "proxy.conf").write_text(text)
    process = subprocess.Popen([nginx, "-c", tmp_path / "proxy.conf", "-p", tmp_path, "-g", "daemon off;"])
    trust = ssl.create_default_context(cafile=str(tls / "cert.pem"))
    with httpx.Client(base_url=f"https://127.0.0.1:{port}", verify=trust, timeout=PATIENCE) as client:
        deadline = time.monotonic() + PATIENCE
        while True:
            try:
                client.get("/healthz")
                break
            except httpx.ConnectError:
                assert process.poll() is None
                assert time.monotonic() < deadline
        yield service, client
    process.terminate()
    assert process.wait(PATIENCE) == 0


def test_a_job_goes_through_and_its_events_are_not_held_back(proxied: tuple[Service, httpx.Client], gate: Gate) -> None:
    service, client = proxied
    scene = gltf(gates={"1": gate.path})
    reply = client.post("/v1/jobs", files=[("scene", ("s.gltf", scene)), ("settings", (None, '{"frames": "0-1"}'))])
    assert reply.status_code == 202
    assert "Strict-Transport-Security" in reply.headers
    job = reply.json()["id"]
    with client.stream("GET", f"/v1/jobs/{job}/events") as events:
        seen = []
        for line in events.iter_lines():
            seen.append(line)
            if line == "event: frame" and seen.count(line) == 1:
                gate.open()  # the first frame's event is here while the second is not rendered yet
    assert seen.count("event: frame") == 2
    assert service.job(job)["state"] == "done"
    assert client.get(f"/v1/jobs/{job}/frames/1.exr").content.startswith(b"v/1\x01")


def test_an_upload_that_is_too_large_is_refused_by_the_service_itself(start: Callable[..., Service], proxied) -> None:
    _, client = proxied
    parts = [("scene", ("s.gltf", gltf())), ("settings", (None, b" " * (2 << 20)))]
    check_problem(client.post("/v1/jobs", files=parts), 413, "too-large")


def test_who_asks_too_often_is_told_to_wait(proxied: tuple[Service, httpx.Client]) -> None:
    _, client = proxied
    statuses = [client.get("/healthz").status_code for _ in range(400)]
    assert statuses[0] == 200
    assert set(statuses) == {200, 429}
    sent = [client.post("/v1/jobs").status_code for _ in range(40)]
    assert 429 in sent
