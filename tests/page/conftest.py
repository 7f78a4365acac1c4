# SPDX-License-Identifier: MIT
"""The service's page in a real browser: Debian's chromium, driven by Playwright. Skipped where either is missing,
unless SHEAF_REQUIRE_TOOLS=1 says that they are there: then that is a failure."""

from __future__ import annotations

import contextlib
import os
import pathlib
import shutil
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from typing import Any

import pytest

import sheaf

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))

from default_signals import default_signals  # noqa: F401 - a fixture of every test

BUILD = pathlib.Path(os.environ.get("SHEAF_BUILD", HERE / "../../build")).resolve()
SCENES = HERE.parent / "scenes"
PATIENCE_MS = 60_000

REQUIRED = os.environ.get("SHEAF_REQUIRE_TOOLS") == "1"

if REQUIRED:
    import playwright.sync_api as playwright
else:
    playwright = pytest.importorskip("playwright.sync_api")

expect, PageError = playwright.expect, playwright.Error


def chromium() -> str:
    found = os.environ.get("SHEAF_CHROMIUM") or shutil.which("chromium") or shutil.which("chromium-browser")
    if not found and REQUIRED:
        pytest.fail("no chromium")
    return found or pytest.skip("no chromium")


@contextlib.contextmanager
def running(data: pathlib.Path, *options: str) -> Iterator[str]:
    """The address of a service whose worker is the real engine."""
    command: list[str | pathlib.Path] = [BUILD / "sheafd", "--listen", "127.0.0.1:0", "--min-free", "0"]
    command += ["--data", data, *options]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    assert process.stderr
    said = (line.split('"address":"') for line in process.stderr if '"address":"' in line)
    address = next((rest.split('"')[0] for _, rest in said), None)
    reader = threading.Thread(target=process.stderr.read, daemon=True)  # or the pipe fills up
    reader.start()
    assert address, "sheafd did not start"
    yield f"http://{address}/"
    process.terminate()
    assert process.wait(60) == 0


@pytest.fixture(scope="session")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    with running(tmp_path_factory.mktemp("service") / "data") as address:
        yield address


@pytest.fixture
def guarded(tmp_path: pathlib.Path) -> Iterator[tuple[str, str]]:
    """A service that wants a token, and the token."""
    made = subprocess.run(
        [BUILD / "sheafd", "--new-token", "visitor=read,submit"], capture_output=True, text=True, check=False
    )
    (tmp_path / "tokens").write_text(made.stdout)
    with running(tmp_path / "data", "--token-file", str(tmp_path / "tokens")) as address:
        yield address, made.stderr.split()[-1]


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    with playwright.sync_playwright() as driver:
        # The sandbox wants user namespaces, which root in a container has not.
        launched = driver.chromium.launch(executable_path=chromium(), args=["--no-sandbox"])
        yield launched
        launched.close()


@pytest.fixture
def visit(browser: Any, service: str) -> Iterator[Callable[..., Any]]:
    """Opens the page in a window of its own. Errors on it, and requests to anywhere else, fail the test."""
    bad: list[str] = []
    contexts = []

    def open_page(path: str = "", at: str = service, **options: object) -> Any:
        context = browser.new_context(**{"viewport": {"width": 1280, "height": 900}, **options})
        context.set_default_timeout(PATIENCE_MS)
        playwright.expect.set_options(timeout=PATIENCE_MS)
        contexts.append(context)
        page = context.new_page()
        page.on("pageerror", lambda error: bad.append(f"error: {error}"))
        page.on("request", lambda request: bad.append(request.url) if is_elsewhere(request.url, at) else None)
        page.goto(at + path)
        return page

    yield open_page
    for context in contexts:
        context.close()
    assert bad == []


def is_elsewhere(url: str, service: str) -> bool:
    return not url.startswith((service, "blob:", "data:"))


@pytest.fixture(scope="session")
def client(service: str) -> Iterator[sheaf.Client]:
    with sheaf.Client(service) as made:
        yield made


@pytest.fixture(scope="session")
def done(client: sheaf.Client) -> sheaf.Job:
    """A small job with all layers, rendered in double precision: that needs no device to warm up."""
    job = client.submit(
        SCENES / "whitted.glb", frames="0-3", size="64x36", strategy="reference", aov="Z,N,id,tests", depth=2
    )
    return job.wait(timeout=PATIENCE_MS / 1000)
