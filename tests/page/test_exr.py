# SPDX-License-Identifier: MIT
"""The page's own reader of EXR files, against OpenEXR."""

from __future__ import annotations

import base64
import pathlib
from collections.abc import Callable
from typing import Any

import numpy as np
import OpenEXR
import pytest

import sheaf
from conftest import PATIENCE_MS, SCENES, PageError, expect

Visit = Callable[..., Any]

# The numbers as text: what is infinite has no place in JSON.
READ = """async (bytes) => {
  const exr = await readExr(bytes);
  return Object.fromEntries(Object.entries(exr.channels).map(([name, plane]) => [name, Array.from(plane, String)]));
}"""
FETCHED = f"async (path) => ({READ})(await (await ask(path)).arrayBuffer())"
GIVEN = f"async (text) => ({READ})(Uint8Array.from(atob(text), (each) => each.charCodeAt(0)).buffer)"


def numbers(texts: list[str]) -> np.ndarray:
    return np.array([float(text.replace("Infinity", "inf")) for text in texts], np.float32)


def check(read: dict[str, list[str]], name: str, wanted: np.ndarray) -> None:
    np.testing.assert_array_equal(numbers(read[name]), wanted.astype(np.float32).ravel(), err_msg=name)


@pytest.mark.parametrize("compression", ["none", "rle", "zips", "zip"])
def test_every_compression_is_read_as_it_is(visit: Visit, client: sheaf.Client, compression: str) -> None:
    settings: dict[str, Any] = {"size": "70x75", "strategy": "reference", "aov": "Z,id", "compression": compression}
    job = client.submit(SCENES / "whitted.glb", frames=0, **settings).wait(timeout=PATIENCE_MS / 1000)
    read = visit().evaluate(FETCHED, f"v1/jobs/{job.id}/frames/0.exr")
    layers = job.frame(0).layers
    for index, name in enumerate("RGBA"):
        check(read, name, layers["RGBA"][..., index])
    check(read, "Z", layers["Z"])
    check(read, "id.object", layers["id.object"])


@pytest.mark.parametrize("compression", ["piz", "dwaa"])
def test_a_frame_of_another_compression_is_previewed_and_downloaded(
    visit: Visit, client: sheaf.Client, compression: str
) -> None:
    settings: dict[str, Any] = {"size": "70x75", "strategy": "reference", "compression": compression}
    job = client.submit(SCENES / "whitted.glb", frames=0, **settings).wait(timeout=PATIENCE_MS / 1000)
    page = visit(f"#job={job.id}")
    page.click("#open")
    expect(page.locator("#pixel")).to_contain_text(f"compressed with {compression} are not shown in the browser")
    expect(page.locator("#canvas")).to_have_attribute("width", "70")
    assert page.locator("#layer option").count() == 0
    with page.expect_download() as download:
        page.get_by_role("button", name="Download").click()
    with OpenEXR.File(str(download.value.path()), separate_channels=True) as file:
        assert sorted(file.channels()) == ["A", "B", "G", "R"]


def written(path: pathlib.Path, compression: OpenEXR.Compression, **layers: np.ndarray) -> dict[str, np.ndarray]:
    """A file by OpenEXR, and what OpenEXR reads out of it."""
    header = {"compression": compression, "type": OpenEXR.scanlineimage}
    with OpenEXR.File(header, {name: OpenEXR.Channel(pixels) for name, pixels in layers.items()}) as file:
        file.write(str(path))
    with OpenEXR.File(str(path), separate_channels=True) as file:
        return {name: channel.pixels for name, channel in file.channels().items()}


def picture(width: int, height: int) -> dict[str, np.ndarray]:
    """Smooth on the left, noise on the right; below and above 1; of every type."""
    y, x = np.mgrid[0:height, 0:width]
    rng = np.random.default_rng(width)
    smooth = np.stack([np.sin(x / 7) + 1.2 + y / height, np.cos(y / 5) + 1.1, (x + y) / 99, np.full(x.shape, 0.75)], -1)
    colour = smooth + 0.1 * rng.random(smooth.shape) * (x > width / 2)[..., None]
    return {
        "RGBA": colour.astype(np.float16),
        "albedo": (colour[..., :3] / 4).astype(np.float32),
        "Z": (1000 / (1 + x + y)).astype(np.float32),
        "id.object": (x // 5 + y // 7 * 9).astype(np.uint32),
        "tests": rng.random(x.shape).astype(np.float32),
    }


@pytest.mark.parametrize("name", ["RLE", "ZIPS", "ZIP"])
def test_what_openexr_writes_is_read(visit: Visit, tmp_path: pathlib.Path, name: str) -> None:
    page = visit()
    for size in ((1, 1), (3, 40), (37, 21), (130, 30)):  # less than a block of 16 lines, and beyond one
        path = tmp_path / "picture.exr"
        wanted = written(path, getattr(OpenEXR, f"{name}_COMPRESSION"), **picture(*size))
        read = page.evaluate(GIVEN, base64.b64encode(path.read_bytes()).decode())
        assert sorted(read) == sorted(wanted)
        for channel, pixels in wanted.items():
            check(read, channel, pixels)


def test_what_cannot_be_shown_says_so(visit: Visit, tmp_path: pathlib.Path) -> None:
    path = tmp_path / "picture.exr"
    written(path, OpenEXR.B44_COMPRESSION, **picture(8, 8))
    with pytest.raises(PageError, match="compressed with b44 are not shown in the browser"):
        visit().evaluate(GIVEN, base64.b64encode(path.read_bytes()).decode())


@pytest.mark.parametrize("name", ["RLE", "ZIP"])
def test_a_damaged_file_is_refused(visit: Visit, tmp_path: pathlib.Path, name: str) -> None:
    path = tmp_path / "picture.exr"
    written(path, getattr(OpenEXR, f"{name}_COMPRESSION"), **picture(64, 64))
    whole = path.read_bytes()
    page = visit()
    for share in (0.3, 0.6, 0.95):
        middle = int(len(whole) * share)
        for bad in (whole[:middle], whole[:middle] + bytes(64) + whole[middle + 64 :]):
            found = page.evaluate(
                "(text) => Promise.race([(" + GIVEN + ")(text).then(() => 'read', () => 'refused'),"
                "new Promise((end) => setTimeout(end, 20000, 'hangs'))])",
                base64.b64encode(bad).decode(),
            )
            assert found == "refused" if len(bad) < len(whole) else found != "hangs"
