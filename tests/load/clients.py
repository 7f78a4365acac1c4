# SPDX-License-Identifier: MIT
"""Clients that submit, watch and fetch, and remember what they were told."""

from __future__ import annotations

import asyncio
import collections
import hashlib
import json
import random
import time
import uuid
from dataclasses import dataclass, field
from typing import Any

import httpx

PATIENCE = 900.0  # seconds that one job may take before its client calls it lost: a machine may be slow


@dataclass
class Ledger:
    """What all clients were told, together."""

    accepted: dict[str, str] = field(default_factory=dict)  # key -> job
    frames: dict[str, dict[int, str]] = field(default_factory=dict)  # job -> frame -> SHA-256, as fetched
    finished: int = 0
    answers: collections.Counter[str] = field(default_factory=collections.Counter)
    broken: int = 0  # connections: the service was killed meanwhile
    trouble: list[str] = field(default_factory=list)  # what must not be


class Contract:
    """Which statuses the service says an operation may have."""

    def __init__(self, openapi: dict[str, Any]) -> None:
        self._paths = openapi["paths"]

    def allows(self, method: str, path: str, status: int) -> bool:
        described = self._paths[path][method.lower()]["responses"]
        return str(status) in described or ("default" in described and status in (404, 405, 408, 414, 431, 503))


class LoadClient:
    """One client: job after job until the time is over."""

    def __init__(
        self, number: int, http: httpx.AsyncClient, contract: Contract, ledger: Ledger, scene: bytes, name: str
    ) -> None:
        self._http, self._contract, self._ledger = http, contract, ledger
        self._scene, self._name = scene, name
        self._chance = random.Random(number)
        self._settings = {"frames": "0-2", "size": "32x18", "strategy": "hybrid"}

    async def run(self, until: float) -> None:
        while time.monotonic() < until:
            key = uuid.uuid4().hex
            try:
                await asyncio.wait_for(self._one_job(key), PATIENCE)
            except asyncio.TimeoutError:
                self._ledger.trouble.append(f"job {self._ledger.accepted.get(key)} did not end in {PATIENCE:.0f} s")

    async def _one_job(self, key: str) -> None:
        parts = {"scene": (self._name, self._scene), "settings": (None, json.dumps(self._settings))}
        reply = await self._ask("POST", "/v1/jobs", "/v1/jobs", files=parts, headers={"Idempotency-Key": key})
        job = reply.json()["id"]
        self._ledger.accepted[key] = job
        await (self._stream(job) if self._chance.random() < 0.5 else self._poll(job))
        info = (await self._ask("GET", "/v1/jobs/{id}", f"/v1/jobs/{job}")).json()
        if info["state"] != "done":
            self._ledger.trouble.append(f"job {job} ended as {info['state']}: {info.get('error')}")
            return
        got: dict[int, str] = {}
        for frame in info["frames"]:
            data = (await self._ask("GET", "/v1/jobs/{id}/frames/{frame}.exr", frame["exr"])).content
            got[frame["frame"]] = hashlib.sha256(data).hexdigest()
            if got[frame["frame"]] != frame["sha256"]:
                self._ledger.trouble.append(f"job {job}: frame {frame['frame']} is not what the service says")
        self._ledger.frames[job] = got
        self._ledger.finished += 1

    async def _poll(self, job: str) -> None:
        after, ended = 0, False
        while not ended:
            query = f"?wait=20&after={after}"
            page = (await self._ask("GET", "/v1/jobs/{id}/events", f"/v1/jobs/{job}/events{query}")).json()
            numbers = [event["id"] for event in page["events"]]
            if numbers != list(range(after + 1, after + 1 + len(numbers))):
                self._ledger.trouble.append(f"job {job}: events {numbers} after {after}")
            after, ended = page["last"], page["ended"]

    async def _stream(self, job: str) -> None:
        last = 0
        while True:
            try:
                headers = {"Last-Event-ID": str(last)}
                async with self._http.stream("GET", f"/v1/jobs/{job}/events", headers=headers) as reply:
                    self._ledger.answers[f"GET events {reply.status_code}"] += 1
                    if reply.status_code == 204:
                        return
                    if reply.status_code == 200:
                        async for line in reply.aiter_lines():
                            if not line.startswith("id:"):
                                continue
                            if int(line[3:]) != last + 1:
                                self._ledger.trouble.append(f"job {job}: event {line[3:]} after {last}")
                            last = int(line[3:])
            except httpx.TransportError:
                self._ledger.broken += 1
            await asyncio.sleep(0.05 + self._chance.random() * 0.1)

    async def _ask(self, method: str, path: str, url: str, **more: Any) -> httpx.Response:
        """The answer; asked again after a lost connection or a 503 that says when."""
        while True:
            try:
                reply = await self._http.request(method, url, **more)
            except httpx.TransportError:
                self._ledger.broken += 1
                await asyncio.sleep(0.05 + self._chance.random() * 0.2)
                continue
            self._ledger.answers[f"{method} {path} {reply.status_code}"] += 1
            if reply.is_success:
                return reply
            if not self._contract.allows(method, path, reply.status_code):
                self._ledger.trouble.append(f"{method} {url}: {reply.status_code} {reply.text[:300]}")
            elif reply.status_code != 503 or "Retry-After" not in reply.headers:
                self._ledger.trouble.append(
                    f"{method} {url}: {reply.status_code}, not expected here: {reply.text[:300]}"
                )
            await asyncio.sleep(min(float(reply.headers.get("Retry-After", 1)), 5.0) * (0.5 + self._chance.random()))
