# SPDX-License-Identifier: MIT
"""The service and its workers killed at random moments, hundreds of times: nothing is lost."""

import concurrent.futures
import contextlib
import os
import pathlib
import random
import signal
import time
from collections.abc import Iterable

from durable import begun, check_frames, workers_of
from service import Service, gltf

# How often the service or a worker is killed, in all. SHEAF_KILLS=5000 for a long run.
KILLS = int(os.environ.get("SHEAF_KILLS", "200"))


class Ledger:
    """What clients were told, against what is there in the end."""

    def __init__(self) -> None:
        self.accepted: dict[str, int] = {}  # jobs, and how many frames each has
        self.reported: dict[str, set[int]] = {}

    def unfinished(self) -> list[str]:
        return [job for job, frames in self.accepted.items() if len(self.reported[job]) < frames]

    def look(self, service: Service, jobs: Iterable[str]) -> None:
        for job in jobs:
            frames = self.accepted[job]
            info = service.job(job)
            assert info["state"] in ("queued", "running", "done"), info
            assert len(info["frames"]) == frames
            done = {frame["frame"] for frame in info["frames"] if frame["state"] == "done"}
            lost = self.reported[job] - done
            assert not lost, f"job {job}: frames {lost} were there and are not any more"
            self.reported[job] = done
            check_frames(service, info)


class Chaos:
    """A service that is killed, or a worker of its, whichever chance takes, while jobs are submitted and rendered."""

    def __init__(self, data: pathlib.Path, seed: int):
        self.chance = random.Random(seed)
        self.data = data
        self.ledger = Ledger()
        self.kills = {"service": 0, "worker": 0}
        self.service = self.start()

    def start(self) -> Service:
        inspecting = self.chance.choice([[], ["--max-triangles", "0", "--max-textures", "0"]])
        return Service(self.data, "--grace", "1", "--attempts", "1000000", "--jobs", "2", *inspecting)

    def submit(self) -> None:
        count = self.chance.randrange(1, 12)
        fake = gltf(pace=self.chance.choice([0, 0.001, 0.01]), padding=self.chance.randrange(30_000))
        job = self.service.accepted(fake, {"frames": f"0-{count - 1}"})
        self.ledger.accepted[job], self.ledger.reported[job] = count, set()

    def kill(self) -> None:
        if self.chance.random() < 0.5:
            with contextlib.suppress(IndexError, ProcessLookupError):  # there is none, or it has just ended
                os.kill(self.chance.choice(workers_of(self.data)), signal.SIGKILL)
                self.kills["worker"] += 1
            return
        self.service.process.kill()
        self.kills["service"] += 1
        self.service.stop()
        self.service = self.start()

    def run(self, kills: int) -> str:
        ledger = self.ledger
        while sum(self.kills.values()) < kills:
            while len(ledger.unfinished()) < 2:
                self.submit()
            ledger.look(self.service, {*ledger.unfinished(), self.chance.choice(list(ledger.accepted))})
            time.sleep(self.chance.random() * 0.12)
            self.kill()
        return self.count()

    def count(self) -> str:
        """Everything that was accepted is there, once, and nothing was rendered twice needlessly."""
        ledger, kills = self.ledger, self.kills
        for job in ledger.accepted:
            assert self.service.wait(job)["state"] == "done"
        ledger.look(self.service, ledger.accepted)
        listed = self.service.http.get("/v1/jobs", params={"limit": 200}).json()["jobs"]
        assert len({job["id"] for job in listed}) == len(listed) == min(200, len(ledger.accepted))
        wanted = sum(ledger.accepted.values())
        count = sum(len(begun(self.service, job)) for job in ledger.accepted)
        # A kill costs each of the two workers at most the frame it was at.
        assert wanted <= count <= wanted + kills["worker"] + 2 * kills["service"], (wanted, count, kills)
        assert not list((self.service.data / "incoming").iterdir())
        return f"{kills} kills, {len(ledger.accepted)} jobs, {wanted} frames, {count - wanted} begun anew; lost: 0"


def test_kills_at_random_moments_lose_nothing(tmp_path: pathlib.Path) -> None:
    """Two services side by side: most of the time one waits for something to start or to end."""
    seeds = [random.randrange(1 << 32) for _ in range(2)]
    print("seeds", seeds)  # of a run that fails
    runs = [Chaos(tmp_path / f"data{i}", seed) for i, seed in enumerate(seeds)]
    with concurrent.futures.ThreadPoolExecutor() as pool:
        try:
            for told in pool.map(lambda run: run.run(KILLS // len(runs)), runs):
                print(told)
        finally:
            for run in runs:
                run.service.stop()
