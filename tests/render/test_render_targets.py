# SPDX-License-Identifier: MIT
"""Output files that are no plain files: links, FIFOs, devices and descriptors are written through, never replaced."""

import json
import os
import pathlib
import stat
import subprocess
import threading

import numpy as np
import pytest

from rendering import PATIENCE, program, read_exr, scene_path

TINY = {"size": "16x9"}


class Reader(threading.Thread):
    """Reads a FIFO to its end, once."""

    def __init__(self, path: pathlib.Path):
        super().__init__(daemon=True)
        self.path, self.data = path, b""
        self.start()

    def run(self) -> None:
        self.data = self.path.read_bytes()

    def all(self) -> bytes:
        self.join(PATIENCE)
        assert not self.is_alive(), f"{self.path}: nothing was written"
        return self.data


def fifo(path: pathlib.Path) -> Reader:
    os.mkfifo(path)
    return Reader(path)


@pytest.fixture
def wanted(sheaf) -> dict[str, bytes]:
    """What is written where nothing stands in the way."""
    run = sheaf.render("unlit", "--preview", "--dump", sheaf.folder / "dump", **TINY)
    return {path.name: path.read_bytes() for path in [*run.out.iterdir(), *(sheaf.folder / "dump").iterdir()]}


def test_stats_go_into_a_fifo_once(sheaf, tmp_path):
    """One document, however many frames there are and however long they take."""
    reader = fifo(tmp_path / "stats")
    sheaf.render("interpolation", "--frames", "0-5", "--stats", tmp_path / "stats", **TINY)
    assert len(json.loads(reader.all())["frames"]) == 6
    assert stat.S_ISFIFO((tmp_path / "stats").lstat().st_mode)


def test_frames_previews_and_dumps_go_into_fifos(sheaf, tmp_path, wanted):
    out, dump = tmp_path / "frames", tmp_path / "rays"
    out.mkdir()
    dump.mkdir()
    readers = [fifo(out / "unlit.0000.exr"), fifo(out / "unlit.0000.png"), fifo(dump / "f0000_triangles.npy")]
    sheaf.render("unlit", "--preview", "--dump", dump, "--resume", out=out, **TINY)
    for reader in readers:
        assert reader.all() == wanted[reader.path.name], reader.path
        assert stat.S_ISFIFO(reader.path.lstat().st_mode)


def test_links_stay_and_their_ends_are_written(sheaf, tmp_path, wanted):
    out, far = tmp_path / "frames", tmp_path / "far"
    out.mkdir()
    far.mkdir()
    (far / "frame").write_bytes(b"old")
    (out / "unlit.0000.exr").symlink_to("../far/frame")
    (out / "unlit.0000.png").symlink_to(far / "later")  # dangling
    (tmp_path / "stats").symlink_to("far/stats")
    sheaf.render("unlit", "--preview", "--stats", tmp_path / "stats", "--count", "off", out=out, **TINY)
    assert sorted(path.name for path in far.iterdir()) == ["frame", "later", "stats"]
    assert sorted(path.name for path in out.iterdir()) == ["unlit.0000.exr", "unlit.0000.png"]
    assert all(path.is_symlink() for path in [*out.iterdir(), tmp_path / "stats"])
    assert np.array_equal(read_exr(far / "frame").rgba, read_exr(out / "unlit.0000.exr").rgba)
    assert (far / "frame").read_bytes() == wanted["unlit.0000.exr"]
    assert (far / "later").read_bytes() == wanted["unlit.0000.png"]
    assert len(json.loads((far / "stats").read_text())["frames"]) == 1


@pytest.mark.parametrize("name", ["/dev/stdout", "/dev/fd/1", "/proc/self/fd/1", "link"])
def test_standard_output_takes_stats(tmp_path, name):
    """By a link of the test's own, or by names that a program without rights to replace them leaves whole anyway."""
    if os.geteuid() == 0 and name == "/dev/stdout":
        pytest.skip("as root a mistake would replace /dev/stdout")
    target = tmp_path / name
    if name == "link":
        target.symlink_to("/dev/fd/1")
    log = tmp_path / "log"
    with log.open("wb") as file:
        file.write(b"before\n")
        file.flush()
        subprocess.run(
            [
                program(),
                "render",
                scene_path("unlit"),
                "--out",
                tmp_path / "out",
                "--size", "16x9", "--strategy", "bvh", "--stats", target, ], stdout=file, timeout=PATIENCE,
                check=True,
        )  # fmt: skip
        file.write(b"after\n")
    first, *document, last = log.read_text().splitlines()
    assert (first, last) == ("before", "after")
    assert json.loads("\n".join(document))["schema"] == 1


def test_a_device_takes_stats(sheaf, tmp_path):
    (tmp_path / "null").symlink_to("/dev/null")
    sheaf.render("unlit", "--stats", tmp_path / "null", **TINY)
    assert (tmp_path / "null").is_symlink()
    assert stat.S_ISCHR(pathlib.Path("/dev/null").stat().st_mode)


def test_a_pipe_whose_reader_is_gone_is_an_error(tmp_path):
    ours, theirs = os.pipe()
    os.close(ours)
    done = subprocess.run(
        [
            program(),
            "render",
            scene_path("unlit"),
            "--out",
            tmp_path / "out",
            "--size", "16x9", "--strategy", "bvh", "--stats", f"/dev/fd/{theirs}", ], pass_fds=[theirs],
            capture_output=True, text=True, timeout=PATIENCE, check=False,
    )  # fmt: skip
    os.close(theirs)
    assert done.returncode == 6
    assert done.stderr == f"sheaf: /dev/fd/{theirs}: cannot write: Broken pipe\n"
