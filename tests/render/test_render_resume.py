# SPDX-License-Identifier: MIT
"""`--resume` keeps a frame that would come out the same, and renders every other again and says why."""

import json
import os
import pathlib
import shutil

import pytest

from rendering import SCENES, Run, Sheaf

TINY = {"size": "16x9"}
FRAMES = ("--frames", "0-2")
PATH = {"version": 1, "keys": [{"time": 0, "eye": [0, 1, 6], "target": [0, 0, 0], "up": [0, 1, 0], "fov_degrees": 45}]}


def as_gltf(folder: pathlib.Path) -> pathlib.Path:
    """interpolation.glb with its buffer beside it."""
    data = (SCENES / "interpolation.glb").read_bytes()
    length = int.from_bytes(data[12:16], "little")
    document = json.loads(data[20 : 20 + length])
    folder.mkdir()
    (folder / "data.bin").write_bytes(data[28 + length :])
    document["buffers"][0]["uri"] = "data.bin"
    (folder / "scene.gltf").write_text(json.dumps(document))
    return folder / "scene.gltf"


def rendered(run: Run) -> list[int]:
    return [event["frame"] for event in run.events() if event["event"] == "frame"]


def warnings(run: Run) -> list[str]:
    return [
        event["message"] for event in run.events() if event["event"] == "warning" and "--resume" in event["message"]
    ]


def again(sheaf: Sheaf, scene, out: pathlib.Path, *options: object, **settings) -> Run:
    return sheaf.render(scene, *FRAMES, "--resume", "--progress", "json", *options, out=out, **{**TINY, **settings})


def test_another_scene_of_the_same_name_is_rendered(sheaf, tmp_path):
    scene = tmp_path / "scene.glb"
    shutil.copy(SCENES / "interpolation.glb", scene)
    run = sheaf.render(scene, *FRAMES, **TINY)
    assert rendered(again(sheaf, scene, run.out)) == []
    shutil.copy(SCENES / "hierarchy.glb", scene)
    second = again(sheaf, scene, run.out)
    assert rendered(second) == [0, 1, 2]
    assert warnings(second) == ["--resume: 3 frames that are there will be rendered again: another scene"]
    fresh = sheaf.render(scene, *FRAMES, **TINY)
    assert {n: p.read_bytes() for n, p in run.files.items()} == {n: p.read_bytes() for n, p in fresh.files.items()}
    assert rendered(again(sheaf, scene, run.out)) == []


def test_a_buffer_beside_the_scene_counts(sheaf, tmp_path):
    scene = as_gltf(tmp_path / "scene")
    run = sheaf.render(scene, *FRAMES, **TINY)
    data = bytearray((scene.parent / "data.bin").read_bytes())
    data[3] ^= 1  # one bit of a float
    stamp = (scene.parent / "data.bin").stat()
    (scene.parent / "data.bin").write_bytes(data)
    os.utime(scene.parent / "data.bin", ns=(stamp.st_atime_ns, stamp.st_mtime_ns))
    second = again(sheaf, scene, run.out)
    assert rendered(second) == [0, 1, 2]
    assert "another scene" in warnings(second)[0]


@pytest.mark.parametrize(
    ("options", "named"),
    [
        (["--spp", "2"], "spp"),
        (["--depth", "1"], "depth"),
        (["--cutoff", "0.1"], "cutoff"),
        (["--fps", "25"], "fps"),
        (["--opaque"], "opaque"),
        (["--environment", "1,0,0"], "environment"),
        (["--aov", "Z"], "aov"),
        (["--compression", "piz"], "compression"),
        (["--preview"], "no preview"),
        (["--filter", "box"], "filter"),
    ],
)
def test_other_settings_are_named(sheaf, options, named):
    run = sheaf.render("interpolation", *FRAMES, **TINY)
    second = again(sheaf, "interpolation", run.out, *options)
    assert rendered(second) == [0, 1, 2]
    (line,) = warnings(second)
    assert named in line
    assert rendered(again(sheaf, "interpolation", run.out, *options)) == []


def test_the_camera_path_counts_by_its_numbers(sheaf, tmp_path):
    path = tmp_path / "camera.json"
    path.write_text(json.dumps(PATH))
    run = sheaf.render("interpolation", *FRAMES, "--camera", path, **TINY)
    path.write_text(json.dumps(PATH, indent=4))
    assert rendered(again(sheaf, "interpolation", run.out, "--camera", path)) == []
    path.write_text(json.dumps(PATH).replace("[0, 1, 6]", "[0, 1, 7]"))
    second = again(sheaf, "interpolation", run.out, "--camera", path)
    assert rendered(second) == [0, 1, 2]
    assert "other settings: camera" in warnings(second)[0]


def test_what_does_not_decide_the_picture_keeps_it(sheaf):
    run = sheaf.render("interpolation", *FRAMES, **TINY)
    second = again(
        sheaf, "interpolation", run.out, "--memory", 64, "--instances", "shared", "--sort", "on", strategy="hybrid"
    )
    assert rendered(second) == []
    assert warnings(second) == []


def test_layer_tests_hangs_on_the_strategy(sheaf):
    run = sheaf.render("interpolation", *FRAMES, "--aov", "tests", **TINY)
    assert rendered(again(sheaf, "interpolation", run.out, "--aov", "tests")) == []
    assert rendered(again(sheaf, "interpolation", run.out, "--aov", "tests", strategy="brute")) == [0, 1, 2]


def test_frames_under_each_others_names_are_rendered(sheaf):
    run = sheaf.render("interpolation", *FRAMES, **TINY)
    shutil.copy(run.files[0], run.files[2])
    second = again(sheaf, "interpolation", run.out)
    assert rendered(second) == [2]
    assert warnings(second) == ["--resume: 1 frame that is there will be rendered again: another frame's number"]


def test_inputs_are_listed_as_the_files_have_them(sheaf, tmp_path):
    listed = sheaf(
        "render", SCENES / "interpolation.glb", "--out", tmp_path / "none", *FRAMES, "--size", "16x9", "--list-inputs"
    )
    assert not (tmp_path / "none").exists()
    run = sheaf.render("interpolation", *FRAMES, **TINY)
    for line, (number, path) in zip(map(json.loads, listed.stdout.splitlines()), run.files.items(), strict=True):
        header = run.frame(number).header
        assert (line["frame"], line["file"]) == (number, path.name)
        assert "Sheaf " + line["version"] == header["software"]
        assert (line["scene"], line["settings"]) == (header["sheaf:sceneHash"], header["sheaf:settings"])
        assert line["time"] == header["sheaf:time"]
