# SPDX-License-Identifier: MIT
"""The command line where something is wrong: exit codes and error lines."""

import json

import pytest

from rendering import SCENES

TINY = {"size": "16x9"}


def one_line(run) -> str:
    """The error: a single line that says who speaks."""
    lines = [line for line in run.stderr.splitlines() if line]
    assert len(lines) == 1, run.stderr
    assert lines[0].startswith("sheaf: ")
    return lines[0]


# ---- exit codes ----
WRONG_USAGE = {
    "no command": [],
    "unknown command": ["paint"],
    "no scene": ["render", "--out", "OUT"],
    "no folder": ["render", "SCENE"],
    "unknown option": ["render", "SCENE", "--out", "OUT", "--colour", "red"],
    "size": ["render", "SCENE", "--out", "OUT", "--size", "64by36"],
    "size without height": ["render", "SCENE", "--out", "OUT", "--size", "64x"],
    "strategy": ["render", "SCENE", "--out", "OUT", "--strategy", "magic"],
    "sort": ["render", "SCENE", "--out", "OUT", "--sort", "maybe"],
    "primary": ["render", "SCENE", "--out", "OUT", "--primary", "both"],
    "layers": ["render", "SCENE", "--out", "OUT", "--aov", "Z,Q"],
    "compression": ["render", "SCENE", "--out", "OUT", "--compression", "lzma"],
    "compression with layers": ["render", "SCENE", "--out", "OUT", "--compression", "dwaa", "--aov", "N"],
    "frames": ["render", "SCENE", "--out", "OUT", "--frames", "1..5"],
    "frames backwards": ["render", "SCENE", "--out", "OUT", "--frames", "5-1"],
    "frames step": ["render", "SCENE", "--out", "OUT", "--frames", "1-5:0"],
    "frames without end": ["render", "SCENE", "--out", "OUT", "--frames", "0-9999999999"],
    "name": ["render", "SCENE", "--out", "OUT", "--name", "frame.exr"],
    "name with folder": ["render", "SCENE", "--out", "OUT", "--name", "../f.####.exr"],
    "two cameras": ["render", "SCENE", "--out", "OUT", "--camera", "SCENE", "--camera-node", "0"],
    "progress": ["render", "SCENE", "--out", "OUT", "--progress", "loud"],
    "depth": ["render", "SCENE", "--out", "OUT", "--depth", "deep"],
}


@pytest.mark.parametrize("case", WRONG_USAGE)
def test_wrong_usage_is_2(sheaf, tmp_path, case):
    places = {"SCENE": str(SCENES / "unlit.glb"), "OUT": str(tmp_path / "out")}
    one_line(sheaf(*(places.get(word, word) for word in WRONG_USAGE[case]), code=2))
    assert not (tmp_path / "out").exists()


BAD_SETTINGS = {
    "size": ("0x10", "width"),
    "spp": ("0", "spp"),
    "depth": ("99999", "depth"),
    "cutoff": ("2", "cutoff"),
    "memory": ("1", "memory"),
    "fps": ("0", "fps"),
    "environment": ("-1,0,0", "environment"),
    "animation": ("walk", "walk"),
    "camera-node": ("nobody", "nobody"),
    "scene-name": ("nowhere", "nowhere"),
}


@pytest.mark.parametrize("option", BAD_SETTINGS)
def test_bad_settings_are_3_and_named(sheaf, tmp_path, option):
    value, named = BAD_SETTINGS[option]
    run = sheaf("render", SCENES / "interpolation.glb", "--out", tmp_path / "out", f"--{option}", value, code=3)
    assert named in one_line(run)
    assert not list(tmp_path.glob("out/*"))


def glb(document: object, binary: bytes = b"") -> bytes:
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = len(text).to_bytes(4, "little") + b"JSON" + text
    if binary:
        chunks += len(binary).to_bytes(4, "little") + b"BIN\0" + binary
    return b"glTF" + (2).to_bytes(4, "little") + (12 + len(chunks)).to_bytes(4, "little") + chunks


ASSET = {"asset": {"version": "2.0"}}
BAD_SCENES = {
    "empty": (b"", ""),
    "noise": (bytes(range(256)) * 4, ""),
    "cut short": ((SCENES / "whitted.glb").read_bytes()[:5000], ""),
    "version": (glb({"asset": {"version": "3.0"}}), "3.0"),
    "required": (
        glb(ASSET | {"extensionsUsed": ["EXT_made_up"], "extensionsRequired": ["EXT_made_up"]}),
        "EXT_made_up",
    ),
    "mesh index": (glb(ASSET | {"nodes": [{"mesh": 7}], "scenes": [{"nodes": [0]}], "scene": 0}), "mesh"),
    "cycle": (glb(ASSET | {"nodes": [{"children": [1]}, {"children": [0]}], "scenes": [{"nodes": [0]}]}), "node"),
    "outside": (
        glb(
            ASSET
            | {
                "buffers": [{"byteLength": 36, "uri": "../../../etc/hostname"}],
                "bufferViews": [{"buffer": 0, "byteLength": 36}],
                "accessors": [
                    {
                        "bufferView": 0,
                        "componentType": 5126,
                        "count": 3,
                        "type": "VEC3",
                        "min": [0, 0, 0],
                        "max": [1, 1, 0],
                    }
                ],
                "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
                "nodes": [{"mesh": 0}],
                "scenes": [{"nodes": [0]}],
                "scene": 0,
            }
        ),
        "buffer",
    ),
}


@pytest.mark.parametrize("case", BAD_SCENES)
def test_bad_scenes_are_3_and_named(sheaf, tmp_path, case):
    data, named = BAD_SCENES[case]
    path = tmp_path / "bad scene.glb"
    path.write_bytes(data)
    for command in (["render", path, "--out", tmp_path / "out", "--size", "16x9"], ["inspect", path]):
        line = one_line(sheaf(*command, code=3))
        assert "bad scene.glb" in line
        assert named in line
    assert not list(tmp_path.glob("out/*"))


BAD_CAMERAS = {
    "not json": ("{", ""),
    "unknown key": ({"version": 1, "keys": [], "colour": 1}, "colour"),
    "unknown key of a key": (
        {"version": 1, "keys": [{"time": 0, "eye": [0, 0, 1], "target": [0, 0, 0], "zoom": 2}]},
        "zoom",
    ),
    "no keys": ({"version": 1, "keys": []}, "keys"),
    "version": ({"version": 2, "keys": []}, "version"),
    "time backwards": (
        {
            "version": 1,
            "keys": [{"time": t, "position": [0, 0, 1], "rotation": [0, 0, 0, 1], "fov_degrees": 40} for t in (1, 0)],
        },
        "time",
    ),
}


@pytest.mark.parametrize("case", BAD_CAMERAS)
def test_bad_camera_paths_are_3_and_named(sheaf, tmp_path, case):
    content, named = BAD_CAMERAS[case]
    path = tmp_path / "path.json"
    path.write_text(content if isinstance(content, str) else json.dumps(content))
    line = one_line(sheaf.render("unlit", "--camera", path, code=3, **TINY))
    assert "path.json" in line
    assert named in line


def test_missing_files_are_named(sheaf, tmp_path):
    run = sheaf("render", tmp_path / "nothing.glb", "--out", tmp_path / "out", code=[3, 6])
    assert "nothing.glb" in one_line(run)
    run = sheaf(
        "render", SCENES / "unlit.glb", "--out", tmp_path / "out", "--camera", tmp_path / "none.json", code=[3, 6]
    )
    assert "none.json" in one_line(run)


def test_a_folder_that_cannot_be_is_6(sheaf, tmp_path):
    """Permissions do not stop root; a file in the way stops everybody."""
    taken = tmp_path / "taken"
    taken.write_text("here first")
    for out in (taken, taken / "below"):
        run = sheaf("render", SCENES / "unlit.glb", "--out", out, "--size", "16x9", code=6)
        assert "taken" in one_line(run)
    assert taken.read_text() == "here first"


def test_a_name_taken_by_a_folder_is_6(sheaf, tmp_path):
    out = tmp_path / "out"
    (out / "unlit.0000.exr").mkdir(parents=True)
    run = sheaf.render("unlit", out=out, code=6, **TINY)
    assert "unlit.0000.exr" in one_line(run)
    assert [p.name for p in out.iterdir()] == ["unlit.0000.exr"]


def test_unknown_device_is_4(sheaf):
    line = one_line(sheaf.render("unlit", "--device", "no such card", code=4, **TINY))
    assert "no such card" in line or "device" in line.lower()


def test_no_driver_at_all_is_4(sheaf, tmp_path):
    nowhere = {
        "VK_ICD_FILENAMES": str(tmp_path / "none.json"),
        "VK_DRIVER_FILES": str(tmp_path / "none.json"),
        "SHEAF_VALIDATION": "0",
    }
    for command in (["devices"], ["render", SCENES / "unlit.glb", "--out", tmp_path / "out"]):
        run = sheaf(*command, code=4, env=nowhere)
        assert [line for line in run.stderr.splitlines() if line.startswith("sheaf: ") and "ulkan" in line]
