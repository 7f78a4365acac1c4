# SPDX-License-Identifier: MIT
"""A running `sheafd` and the few things tests do with it over and over."""

from __future__ import annotations

import json
import os
import pathlib
import signal
import socket
import struct
import subprocess
import sys
import threading
from collections.abc import Iterator

import httpx

HERE = pathlib.Path(__file__).resolve().parent
BUILD = pathlib.Path(os.environ.get("SHEAF_BUILD", HERE / "../../build")).resolve()
FAKE = HERE / "fake_sheaf.py"
PATIENCE = 60  # seconds until a test gives up; nothing waits this long when all is well


def program(name: str) -> pathlib.Path:
    """A built program. A sanitizer's build folder may hold the service alone: the engine is then the usual build's."""
    places = [BUILD / name, (HERE / "../../build" / name).resolve()]
    for place in places:
        if place.is_file():
            return place
    raise AssertionError(f"{name} is not built: looked for {' and '.join(map(str, places))} (set SHEAF_BUILD)")


class Service:
    """`sheafd` on a port of the system's choice; its log is kept for a test that fails."""

    def __init__(
        self,
        data: pathlib.Path,
        *options: str,
        sheaf: pathlib.Path = FAKE,
        env: dict[str, str] | None = None,
        prefix: list[str] | None = None,
        readable: list[str] | None = None,
    ) -> None:
        self.data = data
        free = [] if "--min-free" in options else ["--min-free", "0"]  # whatever the machine's disk
        # The fake worker is a Python program, and keeps ledgers and gates beside the service's data.
        places: list[str | pathlib.Path] = [*readable] if readable else [sys.base_prefix, sys.prefix, HERE, data.parent]
        seen = [word for place in places for word in ("--worker-reads", str(place))]
        self.process = subprocess.Popen(
            [
                *(prefix or []),
                program("sheafd"),
                "--listen", "127.0.0.1:0", "--data", data, "--sheaf", sheaf, *free, *seen, *options, ],
                stderr=subprocess.PIPE, text=True,
            env={**os.environ, **(env or {})},
        )  # fmt: skip
        self.log: list[dict] = []
        self._listening = threading.Event()
        self._reader = threading.Thread(target=self._read_log, daemon=True)
        self._reader.start()
        assert self._listening.wait(PATIENCE), "sheafd did not start in time"
        addresses = [entry["address"] for entry in self.log if entry["message"] == "listening"]
        if not addresses:
            self._end()
            raise AssertionError(f"sheafd did not start: {self.log}")
        self.address = addresses[0]
        self.url = "http://" + self.address
        # There is no TLS here, and loading the system's certificates takes longer than the service takes to start.
        self.http = httpx.Client(base_url=self.url, timeout=PATIENCE, verify=False)

    def _read_log(self) -> None:
        assert self.process.stderr
        for line in self.process.stderr:
            self.log.append(json.loads(line) if line.startswith("{") else {"message": line})
            if self.log[-1]["message"] == "listening":
                self._listening.set()
        self._listening.set()

    def stop(self) -> int:
        """SIGTERM and its exit code."""
        self.http.close()
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
        return self._end()

    def _end(self) -> int:
        code = self.process.wait(PATIENCE)
        self._reader.join(PATIENCE)
        assert self.process.stderr
        self.process.stderr.close()
        return code

    def submit(
        self,
        scene: bytes,
        settings: dict | None = None,
        name: str = "scene.gltf",
        headers: dict | None = None,
        parts: list | None = None,
    ) -> httpx.Response:
        files = [("scene", (name, scene)), *(parts or [])]
        if settings is not None:
            files.append(("settings", (None, json.dumps(settings))))
        return self.http.post("/v1/jobs", files=files, headers=headers)

    def accepted(self, *args: object, **kwargs: object) -> str:
        """Submits and returns the job's id."""
        reply = self.submit(*args, **kwargs)  # type: ignore[arg-type]
        assert reply.status_code == 202, reply.text
        return reply.json()["id"]

    def job(self, job: str) -> dict:
        reply = self.http.get(f"/v1/jobs/{job}")
        assert reply.status_code == 200, reply.text
        return reply.json()

    def wait_until_ready(self) -> None:
        """Until the devices have been looked for."""
        while "still being looked for" in self.http.get("/readyz").text:
            pass

    def events(self, job: str) -> Iterator[dict]:
        """Events by long poll until the job has ended."""
        after, ended = 0, False
        while not ended:
            page = self.http.get(f"/v1/jobs/{job}/events", params={"wait": 30, "after": after}).json()
            yield from page["events"]
            after, ended = page["last"], page["ended"]

    def wait(self, job: str, state: str | None = None) -> dict:
        """The job once it has ended, or first comes to `state`."""
        for event in self.events(job):
            if event["event"] == "state" and event["data"]["state"] == state:
                break
        return self.job(job)

    def wait_for_frame(self, job: str, frame: int) -> None:
        for event in self.events(job):
            if event["event"] == "frame" and event["data"]["frame"] == frame:
                return
        raise AssertionError(f"job {job} ended without frame {frame}")

    def raw(self, request: bytes, *, half_close: bool = False) -> bytes:
        """What comes back for bytes sent as they are, until the service closes."""
        host, port = self.address.rsplit(":", 1)
        with socket.create_connection((host, int(port)), PATIENCE) as connection:
            connection.sendall(request)
            if half_close:
                connection.shutdown(socket.SHUT_WR)
            answer = b""
            while block := connection.recv(65536):
                answer += block
            return answer


def gltf(**fake: object) -> bytes:
    """A scene that tells the fake worker how to behave."""
    return json.dumps({"asset": {"version": "2.0"}, "extras": {"fake": fake}}).encode()


def glb(**fake: object) -> bytes:
    text = gltf(**fake)
    text += b" " * (-len(text) % 4)
    return struct.pack("<4sIIII", b"glTF", 2, 20 + len(text), len(text), 0x4E4F534A) + text


def arguments(service: Service, job: str, frame: int = 0) -> list[str]:
    """What the worker was started with, as the fake one writes it into its frames."""
    return json.loads(service.http.get(f"/v1/jobs/{job}/frames/{frame}.exr").content[4:])["arguments"]


def check_problem(reply: httpx.Response, status: int, slug: str) -> dict:
    """The reply is this problem, whole and well-formed; returns it."""
    assert reply.status_code == status, reply.text
    assert reply.headers["Content-Type"] == "application/problem+json"
    problem = reply.json()
    assert problem["type"] == "urn:sheaf:problem:" + slug, problem
    assert problem["status"] == status
    assert all(problem[member] for member in ("title", "detail", "instance"))
    return problem
