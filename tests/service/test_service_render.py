# SPDX-License-Identifier: MIT
"""The service with the real `sheaf`: a scene goes in over HTTP, frames come out. Never skipped: without the engine, or
without a device for it, these fail."""

import base64
import json
import pathlib
import struct
import subprocess
from collections.abc import Callable

import pytest

from service import Service, check_problem, program


def triangle(indices: tuple[int, int, int] = (0, 1, 2)) -> dict:
    """An unlit orange triangle that moves to the right, and a camera that looks at it."""
    positions = struct.pack("<9f", -1, -1, 0, 1, -1, 0, 0, 1, 0)
    order = struct.pack("<3H", *indices) + b"\0\0"
    times, places = struct.pack("<2f", 0, 1), struct.pack("<6f", 0, 0, 0, 2, 0, 0)
    buffer = positions + order + times + places
    views, offset = [], 0
    for part in (positions, order, times, places):
        views.append({"buffer": 0, "byteOffset": offset, "byteLength": len(part)})
        offset += len(part)
    return {
        "asset": {"version": "2.0"},
        "extensionsUsed": ["KHR_materials_unlit"],
        "buffers": [{"byteLength": len(buffer), "uri": "triangle.bin"}],
        "bufferViews": views,
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [-1, -1, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"},
            {"bufferView": 2, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [1]},
            {"bufferView": 3, "componentType": 5126, "count": 2, "type": "VEC3"},
        ],
        "materials": [
            {"pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 0, 1]}, "extensions": {"KHR_materials_unlit": {}}}
        ],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.9, "znear": 0.1}}],
        "nodes": [{"mesh": 0}, {"camera": 0, "translation": [0, 0, 4]}],
        "animations": [
            {
                "samplers": [{"input": 2, "output": 3}],
                "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
            }
        ],
        "scenes": [{"nodes": [0, 1]}],
        "scene": 0,
        "extras": {"bin": base64.b64encode(buffer).decode()},
    }


def parts(scene: dict) -> tuple[bytes, list]:
    return json.dumps(scene).encode(), [("file", ("triangle.bin", base64.b64decode(scene["extras"]["bin"])))]


@pytest.fixture
def real(start: Callable[..., Service]) -> Service:
    return start(sheaf=program("sheaf"))


def test_frames_over_http_are_those_of_the_command_line(real: Service, tmp_path: pathlib.Path) -> None:
    scene, files = parts(triangle())
    job = real.accepted(scene, {"frames": "0,12,24", "size": "48x32", "fps": 24}, name="triangle.gltf", parts=files)
    end = real.wait(job)
    assert end["state"] == "done", (end["error"], real.http.get(f"/v1/jobs/{job}/log").text)
    assert [(f["frame"], f["state"]) for f in end["frames"]] == [(0, "done"), (12, "done"), (24, "done")]

    (tmp_path / "triangle.gltf").write_bytes(scene)
    (tmp_path / "triangle.bin").write_bytes(files[0][1][1])
    out = tmp_path / "out"
    subprocess.run(
        [
            program("sheaf"),
            "render",
            tmp_path / "triangle.gltf",
            "--out",
            out,
            "--frames=0,12,24",
            "--size=48x32",
            "--fps=24",
            "--preview",
            "--progress=none",
        ],
        check=True,
        timeout=300,
    )
    frames = {}
    for frame in end["frames"]:
        exr, png = (real.http.get(frame[kind]) for kind in ("exr", "png"))
        assert exr.content[:4] == b"\x76\x2f\x31\x01"
        assert struct.unpack(">II", png.content[16:24]) == (48, 32)
        frames[frame["frame"]] = png.content
        assert png.content == (out / frame["name"]).with_suffix(".png").read_bytes()
        assert len(exr.content) == (out / frame["name"]).stat().st_size
    assert len(set(frames.values())) == 3  # it moves

    stats = real.http.get(f"/v1/jobs/{job}/stats.json").json()
    assert stats["schema"] == 1
    assert [f["frame"] for f in stats["frames"]] == [0, 12, 24]
    assert len(real.http.get(f"/v1/jobs/{job}/stats.csv").text.splitlines()) == 4


def test_a_bad_scene_fails_with_the_engines_reason(real: Service) -> None:
    scene, files = parts(triangle(indices=(0, 1, 7)))
    end = real.wait(real.accepted(scene, {"frames": 0, "size": "8x8"}, parts=files))
    assert end["state"] == "failed"
    assert end["error"]["code"] == "bad-scene"
    assert end["error"]["exit_code"] == 3
    assert "scene.gltf" in end["error"]["message"]
    assert str(real.data) not in end["error"]["message"]


def test_every_setting_is_one_of_the_engine(real: Service) -> None:
    camera = {"version": 1, "keys": [{"time": 0, "eye": [0, 0, 4], "target": [0, 0, 0]}]}
    scene, files = parts(triangle())
    settings = {
        "frames": [0],
        "fps": "24000/1001",
        "animation": 0,
        "size": [16, 8],
        "spp": 2,
        "depth": 2,
        "cutoff": 0.001,
        "strategy": "auto",
        "sort": "auto",
        "primary": "trace",
        "aov": ["Z", "N"],
        "compression": "rle",
        "name": "f.##.exr",
        "memory": 64,
        "device": 0,
        "scene-name": 0,
        "environment": [0, 0, 0.5],
        "count": "on",
        "opaque": True,
        "preview": True,
    }
    files.append(("camera", ("c.json", json.dumps(camera).encode())))
    end = real.wait(real.accepted(scene, settings, parts=files))
    assert end["state"] == "done", end["error"]
    assert end["frames"][0]["name"] == "f.00.exr"


def test_cancelling_a_long_render(real: Service) -> None:
    scene, files = parts(triangle())
    job = real.accepted(scene, {"frames": "0-9999", "size": "64x36"}, parts=files)
    real.wait_for_frame(job, 0)
    assert real.http.delete(f"/v1/jobs/{job}").status_code == 202
    end = real.wait(job)
    assert end["state"] == "cancelled"
    assert 1 <= end["progress"]["done"] < 10000
    done = [f for f in end["frames"] if f["state"] == "done"]
    assert real.http.get(done[-1]["exr"]).status_code == 200
    assert not [p for p in (real.data / "jobs" / job / "frames").iterdir() if p.name.endswith(".part")]
    assert real.http.delete(f"/v1/jobs/{job}").status_code == 204
    check_problem(real.http.get(f"/v1/jobs/{job}"), 410, "job-removed")


def test_ready_with_a_device(real: Service) -> None:
    while "still being looked for" in (reply := real.http.get("/readyz")).text:
        pass
    assert reply.status_code == 200, reply.text
