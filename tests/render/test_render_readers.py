# SPDX-License-Identifier: MIT
"""Frames and previews in the hands of other programs: OpenImageIO and ffmpeg, where they are installed."""

import shutil
import subprocess

import numpy as np
import pytest

from rendering import PATIENCE, Picture

SIZE = "97x53"  # ends in the middle of every compression's chunk


def run(*command: object) -> subprocess.CompletedProcess:
    return subprocess.run([*map(str, command)], capture_output=True, timeout=PATIENCE, check=False)


def needs(program: str) -> None:
    if shutil.which(program) is None:
        pytest.skip(f"{program} is not installed")


def by_ffmpeg(path) -> np.ndarray:
    """R, G and B in 32 bits, as ffmpeg decodes them."""
    done = run("ffmpeg", "-v", "error", "-i", path, "-pix_fmt", "gbrpf32le", "-f", "rawvideo", "-")
    assert done.returncode == 0, done.stderr.decode()
    assert not done.stderr
    width, height = map(int, SIZE.split("x"))
    green, blue, red = np.frombuffer(done.stdout, "<f4").reshape(3, height, width)
    return np.stack([red, green, blue], -1)


def shown_by_ffmpeg(picture: Picture) -> np.ndarray:
    """What ffmpeg 5.1 makes of the colours: it decodes halves to 16 bits between 0 and 1."""
    return np.clip(picture.rgba[..., :3].astype(np.float32), 0, 1)


@pytest.mark.parametrize("compression", ["none", "rle", "zips", "zip", "piz"])
@pytest.mark.parametrize("layers", [(), ("--aov", "all")], ids=["colour", "all"])
def test_openimageio_reads_the_very_pixels(sheaf, tmp_path, compression, layers):
    needs("oiiotool")
    ours = sheaf.render("whitted", "--compression", compression, *layers, size=SIZE)
    copy = sheaf.render("whitted", "--compression", "none", *layers, size=SIZE)
    done = run("oiiotool", ours.files[0], copy.files[0], "--diff")
    assert done.returncode == 0, done.stdout.decode()
    told = run("oiiotool", "--info", "-v", ours.files[0]).stdout.decode()
    assert f'compression: "{compression}"' in told
    assert "sheaf:sceneHash" in told


@pytest.mark.parametrize("compression", ["none", "rle", "zips", "zip", "piz"])
@pytest.mark.parametrize("layers", [(), ("--aov", "Z,albedo,N")], ids=["colour", "layers"])
def test_ffmpeg_reads_the_colours(sheaf, compression, layers):
    needs("ffmpeg")
    render = sheaf.render("whitted", "--compression", compression, *layers, size=SIZE)
    picture: Picture = render.frame()
    np.testing.assert_allclose(by_ffmpeg(render.files[0]), shown_by_ffmpeg(picture), atol=1e-3)


def test_dwaa_of_colour_alone_is_read_and_says_nothing(sheaf):
    run = sheaf.render("whitted", "--compression", "dwaa", size=SIZE)
    assert run.stderr == ""
    needs("ffmpeg")
    np.testing.assert_allclose(by_ffmpeg(run.files[0]), shown_by_ffmpeg(run.frame()), atol=0.05)


@pytest.mark.parametrize("layers", ["Z", "albedo", "id", "Z,tests"])
def test_dwaa_with_layers_warns_of_ffmpeg(sheaf, layers):
    run = sheaf.render("whitted", "--compression", "dwaa", "--aov", layers, size=SIZE)
    (line,) = run.stderr.splitlines()
    assert line.startswith("sheaf: warning: --compression dwaa with --aov: ffmpeg")


def test_the_preview_is_a_picture_of_the_frame(sheaf):
    """Grey of the frame and of its preview rise and fall together, at every pixel."""
    needs("ffmpeg")
    render = sheaf.render("whitted", "--preview", size=SIZE)
    png = render.out / "whitted.0000.png"
    done = run("ffmpeg", "-v", "error", "-i", png, "-pix_fmt", "rgb24", "-f", "rawvideo", "-")
    assert done.returncode == 0, done.stderr.decode()
    assert not done.stderr
    width, height = map(int, SIZE.split("x"))
    shown = np.frombuffer(done.stdout, np.uint8).reshape(height, width, 3)
    colour = render.frame().rgb
    low = colour.max(-1) < 0.7  # below the tone curve's shoulder
    least = colour[low].min(-1, keepdims=True)
    taken = np.where(least < 0.08, least - 6.25 * least**2, 0.04)
    linear = np.clip(colour[low] - taken, 0, 1)
    encoded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055) * 255
    # Half a step of the PNG, and what the frame's halves lost: 2^-15 below 0.125, at up to 12.92 x 255 steps per unit.
    assert np.abs(shown[low] - encoded).max() <= 0.5 + 2**-15 * 12.92 * 255
