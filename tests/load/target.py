# SPDX-License-Identifier: MIT
"""The service under load: started on one port again and again, and killed, as are its workers, by chance."""

from __future__ import annotations

import os
import pathlib
import random
import signal
import socket
import subprocess
import sys
import threading
import time
import urllib.error
import urllib.request

HERE = pathlib.Path(__file__).resolve().parent
FAKE = HERE.parent / "service" / "fake_sheaf.py"


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


class Target:
    """`sheafd` on a folder of its own."""

    def __init__(self, sheafd: pathlib.Path, sheaf: pathlib.Path, data: pathlib.Path, options: list[str]) -> None:
        self.port = free_port()
        self.url = f"http://127.0.0.1:{self.port}"
        self.data = data
        reads = [word for place in (sys.base_prefix, FAKE.parent) for word in ("--worker-reads", str(place))]
        self._command = [str(sheafd), "--listen", f"127.0.0.1:{self.port}", "--data", str(data), "--sheaf", str(sheaf)]
        self._command += ["--min-free", "0", "--attempts", "1000000", *reads, *options]
        self._log = (data.parent / "sheafd.log").open("ab")
        self.process = self._start()

    def _start(self) -> subprocess.Popen[bytes]:
        process = subprocess.Popen(self._command, stderr=self._log)
        while True:
            try:
                urllib.request.urlopen(self.url + "/healthz", timeout=10).close()
                return process
            except (urllib.error.URLError, ConnectionError, TimeoutError):
                if process.poll() is not None:
                    raise RuntimeError(f"sheafd ended with {process.returncode}: see {self._log.name}") from None
                time.sleep(0.01)

    def kill(self) -> float:
        """kill -9, and starts it again; seconds until it answers."""
        self.process.kill()
        self.process.wait()
        begun = time.monotonic()
        self.process = self._start()
        return time.monotonic() - begun

    def stop(self) -> int:
        self.process.send_signal(signal.SIGTERM)
        code = self.process.wait(60)
        self._log.close()
        return code

    def workers(self) -> list[int]:
        """Living processes that render for this service."""
        found = []
        for place in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
            try:
                words = place.read_bytes().split(b"\0")
                if b"render" in words and any(word.startswith(str(self.data).encode()) for word in words):
                    found.append(int(place.parent.name))
            except OSError:
                continue
        return found


class Killer(threading.Thread):
    """Kills the service or a worker every so often, whichever chance takes."""

    def __init__(self, target: Target, seconds: float, seed: int) -> None:
        super().__init__(name="killer")
        self._target, self._seconds = target, seconds
        self._chance = random.Random(seed)
        self._over = threading.Event()
        self.kills = {"service": 0, "worker": 0}
        self.restarts: list[float] = []
        self.failure: BaseException | None = None

    def run(self) -> None:
        try:
            while not self._over.wait(self._chance.uniform(0.2, 1.8) * self._seconds):
                self._kill()
        except BaseException as error:
            self.failure = error

    def _kill(self) -> None:
        if self._chance.random() < 0.5:
            self.restarts.append(self._target.kill())
            self.kills["service"] += 1
        elif workers := self._target.workers():
            try:
                os.kill(self._chance.choice(workers), signal.SIGKILL)
                self.kills["worker"] += 1
            except ProcessLookupError:
                pass  # it came to its end first

    def stop(self) -> None:
        self._over.set()
        self.join()
        if self.failure:
            raise self.failure
