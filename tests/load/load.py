# SPDX-License-Identifier: MIT
"""Many clients at once, while service and workers are killed: what is lost, what is twice, and how long a status takes.

    tests/load/load.py --build build --seconds 600                  with the fake worker of tests/service
    tests/load/load.py --build build --seconds 600 --real           with the engine and tests/scenes/whitted.glb

Ends with 1 if anything was lost, came twice or was answered in a way that the contract does not name.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import os
import pathlib
import platform
import random
import subprocess
import sys
import tempfile
import time
from typing import Any

import httpx

sys.path.insert(0, str(pathlib.Path(__file__).parent))

from clients import Contract, Ledger, LoadClient
from target import FAKE, HERE, Killer, Target

SCENE = json.dumps({"asset": {"version": "2.0"}, "extras": {"fake": {"pace": 0.005, "padding": 2000}}}).encode()


def options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--build", type=pathlib.Path, default=HERE / "../../build", help="folder with sheafd (and sheaf)"
    )
    parser.add_argument("--clients", type=int, default=200)
    parser.add_argument("--seconds", type=float, default=600)
    parser.add_argument("--kill-every", type=float, default=5, help="seconds between kills, on average; 0: none")
    parser.add_argument("--jobs", type=int, default=2, help="workers at once")
    parser.add_argument("--rate", type=float, default=20, help="status requests a second that are timed")
    parser.add_argument("--real", action="store_true", help="render with the engine")
    parser.add_argument("--seed", type=int, default=random.randrange(1 << 32))
    parser.add_argument("--json", type=pathlib.Path, help="write the figures to this file")
    return parser.parse_args()


async def use(given: argparse.Namespace, target: Target, ledger: Ledger) -> list[dict[str, Any]]:
    """Runs the clients; then the jobs that the service knows."""
    limits = httpx.Limits(max_connections=None, max_keepalive_connections=given.clients)
    async with httpx.AsyncClient(base_url=target.url, timeout=60, limits=limits) as http:
        contract = Contract((await http.get("/openapi.json")).json())
        scene = (HERE / "../scenes/whitted.glb").read_bytes() if given.real else SCENE
        name = "whitted.glb" if given.real else "scene.gltf"
        killer = Killer(target, given.kill_every, given.seed) if given.kill_every > 0 else None
        if killer:
            killer.start()
        until = time.monotonic() + given.seconds
        clients = [LoadClient(i, http, contract, ledger, scene, name) for i in range(given.clients)]
        await asyncio.gather(*(client.run(until) for client in clients))
        if killer:
            await asyncio.to_thread(killer.stop)
            given.kills, given.restarts = killer.kills, killer.restarts
        return await all_jobs(http)


async def all_jobs(http: httpx.AsyncClient) -> list[dict[str, Any]]:
    jobs: list[dict[str, Any]] = []
    cursor: str | None = None
    while True:
        page = (await http.get("/v1/jobs", params={"limit": 200, **({"cursor": cursor} if cursor else {})})).json()
        jobs += page["jobs"]
        cursor = page["next"]
        if cursor is None:
            return jobs


def percentile(values: list[float], share: float) -> float:
    return sorted(values)[min(len(values) - 1, int(len(values) * share))] if values else float("nan")


def figures(
    given: argparse.Namespace, ledger: Ledger, jobs: list[dict[str, Any]], probe: dict[str, Any]
) -> dict[str, Any]:
    known = [job["id"] for job in jobs]
    told = set(ledger.accepted.values())
    times = probe["milliseconds"]
    return {
        "worker": "engine" if given.real else "fake",
        "seconds": given.seconds,
        "clients": given.clients,
        "kills": getattr(given, "kills", {}),
        "slowest_restart_s": round(max(getattr(given, "restarts", [0]) or [0]), 3),
        "jobs_accepted": len(told),
        "jobs_finished": ledger.finished,
        "jobs_lost": len(told - set(known)),
        "jobs_twice": len(set(known) - told) + len(known) - len(set(known)) + len(ledger.accepted) - len(told),
        "jobs_not_done": sum(job["state"] != "done" for job in jobs),
        "broken_connections": ledger.broken,
        "answers": dict(sorted(ledger.answers.items())),
        "trouble": ledger.trouble[:20],
        "troubles": len(ledger.trouble),
        "status_requests": len(times),
        "status_ms": {
            name: round(percentile(times, share), 2) for name, share in (("p50", 0.5), ("p90", 0.9), ("p99", 0.99))
        },
        "status_ms_max": round(max(times, default=float("nan")), 2),
        "seed": given.seed,
        "machine": f"{os.cpu_count()} cores, {platform.machine()}, load {os.getloadavg()[1]:.1f} over five minutes",
    }


def main() -> int:
    given = options()
    build = given.build.resolve()
    ledger = Ledger()
    with tempfile.TemporaryDirectory(prefix="sheaf-load-") as folder:
        sheaf = build / "sheaf" if given.real else FAKE
        limits = ["--jobs", str(given.jobs), "--max-queue", "10000"]
        target = Target(build / "sheafd", sheaf, pathlib.Path(folder) / "data", limits)
        command = [sys.executable, str(HERE / "prober.py"), target.url, str(given.seconds), str(given.rate)]
        prober = subprocess.Popen(command, stdout=subprocess.PIPE)
        try:
            jobs = asyncio.run(use(given, target, ledger))
            probe = json.loads(prober.communicate(timeout=120)[0])
        finally:
            prober.kill()
            code = target.stop()
    report = figures(given, ledger, jobs, probe)
    text = json.dumps(report, indent=2)
    print(text)
    if given.json:
        given.json.write_text(text + "\n")
    bad = code != 0 or report["jobs_lost"] or report["jobs_twice"] or report["jobs_not_done"] or report["troubles"]
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
