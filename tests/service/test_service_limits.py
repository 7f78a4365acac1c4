# SPDX-License-Identifier: MIT
"""What one request or job may ask for: each limit by its name, with what it allows and what came."""

import io
import json
import pathlib
import random
import socket
import struct
import subprocess
import zipfile
import zlib
from collections.abc import Callable
from typing import Any

import pytest

from conftest import Gate
from service import PATIENCE, Service, check_problem, glb, gltf, program

CORNELL = (pathlib.Path(__file__).parent / "../scenes/cornell.glb").read_bytes()


def zipped(entries: dict[str, bytes], method: int = zipfile.ZIP_DEFLATED) -> bytes:
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", method) as archive:
        for name, data in entries.items():
            archive.writestr(name, data)
    return out.getvalue()


SMALL = {
    "--max-upload": "1",
    "--max-parts": "8",
    "--max-unpacked": "2",
    "--max-zip-entries": "5",
    "--max-zip-ratio": "50",
    "--max-frames": "10",
    "--max-pixels": "10000",
    "--max-spp": "8",
    "--max-depth": "3",
    "--max-memory": "256",
    "--max-triangles": "1000",
    "--max-textures": "1",
}

# What is submitted, and the limit that it passes with the value that is told.
CASES: dict[str, tuple[int, dict[str, Any], int, int | None]] = {
    "max-upload": (413, {"scene": gltf() + b" " * (2 << 20)}, 1 << 20, None),
    "max-parts": (413, {"scene": gltf(), "parts": [("file", (str(i), b"")) for i in range(8)]}, 8, 9),
    "max-unpacked": (
        413,
        {"scene": zipped({"a.gltf": random.Random(1).randbytes(200_000) + b" " * 2_200_000}), "name": "s.zip"},
        2 << 20,
        None,
    ),
    "max-zip-entries": (413, {"scene": zipped({str(i): b"" for i in range(6)}), "name": "s.zip"}, 5, 6),
    "max-zip-ratio": (413, {"scene": zipped({"a.gltf": b" " * 1_900_000}), "name": "s.zip"}, 50, None),
    "max-frames": (422, {"scene": gltf(), "settings": {"frames": "0-10"}}, 10, 11),
    "max-pixels": (422, {"scene": gltf(), "settings": {"size": "101x100"}}, 10_000, 10_100),
    "max-spp": (422, {"scene": gltf(), "settings": {"spp": 9}}, 8, 9),
    "max-depth": (422, {"scene": gltf(), "settings": {"depth": 4}}, 3, 4),
    "max-memory": (422, {"scene": gltf(), "settings": {"memory": 257}}, 256, 257),
    "max-triangles": (422, {"scene": gltf(holds={"triangles": 1001})}, 1000, 1001),
    "max-textures": (422, {"scene": glb(holds={"texture_bytes": 1048577}), "name": "s.glb"}, 1 << 20, 1048577),
}


@pytest.fixture
def small(start: Callable[..., Service]) -> Service:
    return start(*[word for pair in SMALL.items() for word in pair])


@pytest.mark.parametrize("name", list(CASES))
def test_each_limit_answers_with_its_name_the_limit_and_the_value(small: Service, name: str) -> None:
    status, given, limit, value = CASES[name]
    problem = check_problem(small.submit(**given), status, "too-large" if status == 413 else "limit-exceeded")
    assert problem["limit_name"] == name
    assert problem["limit"] == limit
    assert problem["value"] == value if value else problem["value"] >= limit
    told = small.http.get("/openapi.json").json()["x-limits"][name]
    assert told["limit"] == limit
    assert told["answer"].startswith(str(status))
    assert not list((small.data / "incoming").iterdir())
    assert not list((small.data / "jobs").iterdir())


def test_what_keeps_every_limit_is_taken(small: Service) -> None:
    settings = {"frames": "0-9", "size": "100x100", "spp": 8, "depth": 3, "memory": 256}
    scene = gltf(holds={"triangles": 1000, "texture_bytes": 1 << 20})
    assert small.wait(small.accepted(scene, settings))["state"] == "done"


def test_settings_and_cameras_are_bounded(sheafd: Service) -> None:
    limits = sheafd.http.get("/openapi.json").json()["x-limits"]
    for part in ("settings", "camera"):
        reply = sheafd.submit(gltf(), parts=[(part, (None, b" " * (limits[part]["limit"] + 1)))])
        problem = check_problem(reply, 413, "too-large")
        assert problem["limit_name"] == part
        assert problem["limit"] == limits[part]["limit"] < problem["value"]


def test_the_contract_and_the_help_name_every_limit(sheafd: Service) -> None:
    text = subprocess.run([program("sheafd"), "--help"], capture_output=True, text=True, check=True).stdout
    limits = sheafd.http.get("/openapi.json").json()["x-limits"]
    for name in SMALL:
        assert f"{name} " in text
        assert name.removeprefix("--") in limits
    for name, told in limits.items():
        assert name in ("settings", "camera") or f"--{name} " in text, name
        assert told["limit"] > 0 or name == "min-free"


def test_the_engines_own_limits_count_too(sheafd: Service) -> None:
    problem = check_problem(sheafd.submit(gltf(inspect_exit=5)), 422, "limit-exceeded")
    assert "scene.gltf" in problem["detail"]
    assert str(sheafd.data) not in problem["detail"]


def test_a_scene_that_does_not_load_in_time_is_refused(start: Callable[..., Service], gate: Gate) -> None:
    service = start("--max-inspect", "1")
    problem = check_problem(service.submit(gltf(inspect_gate=gate.path)), 422, "limit-exceeded")
    assert problem["limit_name"] == "max-inspect"
    assert problem["limit"] == 1


def test_a_bad_scene_is_its_jobs_own_failure(sheafd: Service) -> None:
    bad = gltf(inspect_exit=3, exit={"code": 3, "message": "scene.gltf: nodes[0] is bad"})
    end = sheafd.wait(sheafd.accepted(bad, {"frames": 0}))
    assert end["state"] == "failed"
    assert end["error"]["code"] == "bad-scene"


def test_without_such_limits_nobody_looks(start: Callable[..., Service], gate: Gate) -> None:
    service = start("--max-triangles", "0", "--max-textures", "0")
    service.accepted(gltf(inspect_gate=gate.path, holds={"triangles": 10**12}), {"frames": 0})
    assert "max-triangles" not in service.http.get("/openapi.json").json()["x-limits"]


def test_a_service_that_stops_does_not_wait_for_a_scene(start: Callable[..., Service], gate: Gate) -> None:
    service = start()
    host, port = service.address.rsplit(":", 1)
    part = b'--b\r\nContent-Disposition: form-data; name="scene"; filename="s.gltf"\r\n\r\n'
    body = part + gltf(inspect_gate=gate.path) + b"\r\n--b--\r\n"
    head = b"POST /v1/jobs HTTP/1.1\r\nHost: a\r\nContent-Type: multipart/form-data; boundary=b\r\n"
    with socket.create_connection((host, int(port)), PATIENCE) as connection:
        connection.sendall(head + b"Content-Length: %d\r\n\r\n" % len(body) + body)
        with pathlib.Path(gate.path).open("wb"):  # once the inspection waits there
            assert service.stop() == 0


ASKING = (
    b"POST /v1/jobs HTTP/1.1\r\nHost: a\r\nContent-Type: multipart/form-data; boundary=b\r\nExpect: 100-continue\r\n"
)


def refusal_before_the_body(service: Service) -> dict:
    """The problem that answers a head whose body is never sent; a service that wants to read it says 100 first."""
    answer = service.raw(ASKING + b"Content-Length: 1000000\r\n\r\n")
    head, _, body = answer.partition(b"\r\n\r\n")
    assert head.startswith(b"HTTP/1.1 503 "), answer
    assert b"Retry-After: " in head, answer
    return json.loads(body)


def test_no_upload_is_read_in_vain(start: Callable[..., Service], gate: Gate) -> None:
    service = start("--http-threads", "2")  # so that one scene may be looked into
    host, port = service.address.rsplit(":", 1)
    body = b'--b\r\nContent-Disposition: form-data; name="scene"; filename="s.gltf"\r\n\r\n'
    body += gltf(inspect_gate=gate.path) + b"\r\n--b--\r\n"
    with socket.create_connection((host, int(port)), PATIENCE) as connection:
        head = ASKING.replace(b"Expect: 100-continue", b"Connection: close")
        connection.sendall(head + b"Content-Length: %d\r\n\r\n" % len(body) + body)
        with pathlib.Path(gate.path).open("wb"):  # once the inspection waits there
            assert refusal_before_the_body(service)["type"].endswith("busy")
            assert service.http.get("/v1/jobs").json()["jobs"] == []
        assert connection.recv(65536).startswith(b"HTTP/1.1 202 ")


def test_a_full_queue_reads_no_upload(start: Callable[..., Service], gate: Gate) -> None:
    service = start("--max-queue", "1")
    running = service.accepted(gltf(gates={"0": gate.path}))
    service.wait(running, "running")
    service.accepted(gltf())
    assert refusal_before_the_body(service)["type"].endswith("queue-full")
    gate.open()
    service.wait(running)


def textured(side: int) -> bytes:
    """A triangle with a picture of so many pixels along a side."""

    def chunk(kind: bytes, body: bytes) -> bytes:
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    header = struct.pack(">IIBBBBB", side, side, 8, 0, 0, 0, 0)
    rows = zlib.compress(bytes(side + 1) * side)
    png = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", rows) + chunk(b"IEND", b"")
    corners = struct.pack("<9f6f", -1, -1, 0, 1, -1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1)
    binary = corners + png + bytes(-len(png) % 4)
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        "textures": [{"source": 0}],
        "images": [{"bufferView": 2, "mimeType": "image/png"}],
        "buffers": [{"byteLength": len(binary)}],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 36},
            {"buffer": 0, "byteOffset": 36, "byteLength": 24},
            {"buffer": 0, "byteOffset": 60, "byteLength": len(png)},
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [-1, -1, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"},
        ],
    }
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


@pytest.mark.parametrize(
    ("option", "most", "fits", "passes", "value"),
    [
        ("max-triangles", "1", textured(8), CORNELL, 2504),
        ("max-textures", "1", textured(512), textured(513), 513**2 * 4),
    ],
)
def test_the_engine_knows_what_a_scene_holds(
    start: Callable[..., Service], option: str, most: str, fits: bytes, passes: bytes, value: int
) -> None:
    service = start("--" + option, most, sheaf=program("sheaf"))
    problem = check_problem(service.submit(passes, name="a.glb"), 422, "limit-exceeded")
    assert problem["limit_name"] == option
    assert problem["value"] == value > problem["limit"]
    assert service.submit(fits, name="a.glb").status_code == 202
