# SPDX-License-Identifier: MIT
"""Which workers a cluster has."""

from __future__ import annotations

import time

from distributed import Client as DaskClient

FRESH_SECONDS = 1.0
"""How long an answer holds: asked with every chunk, the scheduler of a thousand workers would do little else."""


class Workers:
    """The addresses of all workers, as they were at most a second ago."""

    def __init__(self, dask: DaskClient) -> None:
        self._dask = dask
        self._addresses: tuple[str, ...] = ()
        self._asked: float | None = None

    def addresses(self) -> tuple[str, ...]:
        now = time.monotonic()
        if self._asked is None or now - self._asked >= FRESH_SECONDS:
            self._addresses = tuple(self._dask.nthreads())  # type: ignore[no-untyped-call]
            self._asked = now
        return self._addresses

    def __len__(self) -> int:
        """How many there are; at least one, for a cluster may still be waiting for its first."""
        return max(1, len(self.addresses()))
