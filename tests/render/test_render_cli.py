# SPDX-License-Identifier: MIT
"""The command line: frame numbers and names, --resume, progress, the other commands. Errors: test_render_errors.py."""

import json
import re
import shutil
import zlib

import numpy as np
import pytest

from rendering import SCENES, read_exr

TINY = {"size": "16x9"}


# ---- frames and names ----
@pytest.mark.parametrize(
    ("frames", "wanted"),
    [
        ("3", [3]),
        ("2-5", [2, 3, 4, 5]),
        ("0-9:4", [0, 4, 8]),
        ("7,1,7", [1, 7]),
        ("1,4-6,10-12:2", [1, 4, 5, 6, 10, 12]),
        ("-2-1", [-2, -1, 0, 1]),
    ],
)
def test_frame_numbers(sheaf, frames, wanted):
    run = sheaf.render("hierarchy", f"--frames={frames}", **TINY)
    assert sorted(run.files) == wanted


def test_file_names(sheaf):
    run = sheaf.render("hierarchy", "--frames", "7,12345", "--name", "shot_a.v2.######.exr", **TINY)
    assert sorted(p.name for p in run.out.iterdir()) == ["shot_a.v2.000007.exr", "shot_a.v2.012345.exr"]
    run = sheaf.render("hierarchy", "--frames", "7,12345", **TINY)
    assert sorted(p.name for p in run.out.iterdir()) == ["hierarchy.0007.exr", "hierarchy.12345.exr"]


def test_negative_numbers_are_padded_as_printf_does(sheaf):
    run = sheaf.render("hierarchy", "--frames=-12--10,-2,3,-12345", "--preview", **TINY)
    assert {p.name for p in run.out.iterdir()} == {
        f"hierarchy.{n:04d}.{kind}" for n in (-12, -11, -10, -2, 3, -12345) for kind in ("exr", "png")
    }


def test_time_is_frame_by_fps(sheaf):
    """Frame 12 at 24 a second is frame 24 at 48: half a second, wherever it stands."""
    a = sheaf.render("interpolation", "--frames", "12", size="32x16").frame()
    b = sheaf.render("interpolation", "--frames", "24", "--fps", 48, size="32x16").frame()
    assert np.array_equal(a.rgba, b.rgba)
    assert a.header["sheaf:time"] == b.header["sheaf:time"] == 0.5
    assert (a.header["sheaf:frame"], b.header["sheaf:frame"]) == (12, 24)


def test_resume_leaves_whole_frames_alone(sheaf):
    run = sheaf.render("interpolation", "--frames", "0-4", **TINY)
    bytes_before = {number: path.read_bytes() for number, path in run.files.items()}
    run.files[1].write_bytes(bytes_before[1][:-20])  # its chunk table is whole, a line is not
    run.files[2].unlink()
    whole = {n: run.files[n].stat() for n in (0, 3, 4)}
    again = sheaf.render("interpolation", "--frames", "0-4", "--resume", "--progress", "json", out=run.out, **TINY)
    assert [e["frame"] for e in again.events() if e["event"] == "frame"] == [1, 2]
    assert {n: p.read_bytes() for n, p in run.files.items()} == bytes_before
    for number, before in whole.items():
        after = run.files[number].stat()
        assert (after.st_mtime_ns, after.st_ino) == (before.st_mtime_ns, before.st_ino)
    nothing = sheaf.render("interpolation", "--frames", "0-4", "--resume", "--progress", "json", out=run.out, **TINY)
    assert [e["event"] for e in nothing.events()] == ["start", "done"]


def test_resume_renders_another_size_anew(sheaf):
    run = sheaf.render("unlit", size="16x9")
    sheaf.render("unlit", "--resume", size="32x18", out=run.out)
    assert run.frame().alpha.shape == (18, 32)


def test_preview(sheaf):
    """A PNG beside each frame, its picture recognisable: the square is not the background."""
    run = sheaf.render("unlit", "--preview", "--frames", "3", size="32x16")
    assert sorted(p.name for p in run.out.iterdir()) == ["unlit.0003.exr", "unlit.0003.png"]
    data = (run.out / "unlit.0003.png").read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    assert (int.from_bytes(data[16:20], "big"), int.from_bytes(data[20:24], "big")) == (32, 16)
    idat, at = b"", 8
    while at < len(data):
        length, kind = int.from_bytes(data[at : at + 4], "big"), data[at + 4 : at + 8]
        assert int.from_bytes(data[at + 8 + length : at + 12 + length], "big") == zlib.crc32(
            data[at + 4 : at + 8 + length]
        )
        idat += data[at + 8 : at + 8 + length] if kind == b"IDAT" else b""
        at += 12 + length
    assert len(zlib.decompress(idat)) > 16 * 32


# ---- progress ----
def test_progress_json(sheaf):
    run = sheaf.render("interpolation", "--frames", "2-6:2", "--progress", "json", **TINY)
    events = run.events()
    assert [e["event"] for e in events] == ["start", "frame", "frame", "frame", "done"]
    assert events[0]["frames"] == events[-1]["frames"] == 3
    frames = events[1:-1]
    assert [e["frame"] for e in frames] == [2, 4, 6]
    assert [e["done"] for e in frames] == [1, 2, 3]
    assert all(e["total"] == 3 and e["wall_ms"] >= 0 and e["eta_s"] >= 0 for e in frames)
    assert frames[-1]["eta_s"] == 0
    assert [e["file"] for e in frames] == [str(run.files[n]) for n in (2, 4, 6)]


def test_progress_json_reports_errors_and_warnings(sheaf, tmp_path):
    run = sheaf.render("no_triangles", "--progress", "json", **TINY)
    assert "warning" in [e["event"] for e in run.events()]
    bad = tmp_path / "bad.glb"
    bad.write_bytes(b"not a scene")
    failed = sheaf.render(bad, "--progress", "json", code=3, **TINY)
    (error,) = [e for e in failed.events() if e["event"] == "error"]
    assert error["code"] == 3
    assert "bad.glb" in error["message"]


def test_progress_none_is_silent(sheaf):
    run = sheaf.render("interpolation", "--frames", "0-2", "--progress", "none", **TINY)
    assert run.stdout == run.stderr == ""


def test_progress_bar(sheaf):
    run = sheaf.render("interpolation", "--frames", "0-2", "--progress", "bar", **TINY)
    assert "100%" in run.stderr
    assert "3/3" in run.stderr


# ---- the other commands ----
def test_inspect_json(sheaf):
    told = json.loads(sheaf("inspect", SCENES / "whitted.glb", "--json").stdout)
    assert told["triangles"] == 13490
    assert told["meshes"] == 6
    assert [a["name"] for a in told["animations"]] == ["whitted"]
    assert told["animations"][0]["seconds"] == pytest.approx(4)
    assert {light["kind"] for light in told["lights"]} == {"point", "directional"}
    assert {"reflective", "transmissive", "volumes", "skins", "morphs", "moving camera", "moving lights"} <= set(
        told["features"]
    )
    assert re.fullmatch("[0-9a-f]{64}", told["sha256"])
    plain = json.loads(sheaf("inspect", SCENES / "unlit.glb", "--json").stdout)
    left = {item["stage"]: item["reason"] for item in plain["left_out"]}
    assert {"reflection", "refraction", "animate"} <= set(left)
    assert all(left.values())


def test_inspect_counts_instances(sheaf):
    told = json.loads(sheaf("inspect", SCENES / "instanced.glb", "--json").stdout)
    assert (told["triangles"], told["unique_triangles"], told["instances"]) == (18, 2, 9)


def test_inspect_in_words(sheaf):
    text = sheaf("inspect", SCENES / "whitted.glb").stdout
    for word in ("13490", "whitted", "camera"):
        assert word in text


def test_devices(sheaf):
    devices = json.loads(sheaf("devices", "--json").stdout)
    assert any(device["usable"] for device in devices)
    for device in devices:
        assert device["name"]
        assert device["driver"]
        assert device["usable"] == (not device["lacks"])
    words = sheaf("devices").stdout
    assert devices[0]["name"] in words
    named = sheaf.render("unlit", "--device", devices[0]["name"][:8], stats=True, **TINY)
    assert named.stats()["device"]["name"] == devices[0]["name"]


def test_version_and_help(sheaf):
    assert re.match(r"sheaf \d+\.\d+\.\d+\n", sheaf("--version").stdout)
    text = sheaf("render", "--help").stdout
    for option in (
        "--camera", "--camera-node", "--frames", "--fps", "--animation", "--size", "--spp", "--depth",
        "--cutoff", "--strategy", "--sort", "--primary", "--aov", "--compression", "--name", "--stats",
        "--dump", "--device", "--memory", "--progress", "--resume", "--opaque", "--preview",
    ):  # fmt: skip
        assert option in text


def test_a_gltf_with_its_buffers_beside_it(sheaf, tmp_path):
    """The same scene as .gltf and .bin, in a folder with spaces, gives the same picture."""
    data = (SCENES / "hierarchy.glb").read_bytes()
    length = int.from_bytes(data[12:16], "little")
    document = json.loads(data[20 : 20 + length])
    folder = tmp_path / "a scene"
    folder.mkdir()
    (folder / "the data.bin").write_bytes(data[28 + length :])
    document["buffers"][0]["uri"] = "the%20data.bin"
    (folder / "hierarchy.gltf").write_text(json.dumps(document))
    a = sheaf.render(folder / "hierarchy.gltf", size="96x48").frame()
    b = sheaf.render("hierarchy", size="96x48").frame()
    assert np.array_equal(a.rgba, b.rgba)
    shutil.rmtree(folder)


def test_nothing_but_frames_is_left(sheaf):
    run = sheaf.render("interpolation", "--frames", "0-2", **TINY)
    assert sorted(p.name for p in run.out.iterdir()) == [f"interpolation.{n:04}.exr" for n in range(3)]
    for path in run.out.iterdir():
        assert read_exr(path).rgba.shape == (9, 16, 4)
