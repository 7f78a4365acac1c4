# SPDX-License-Identifier: MIT
"""What a farm made of an animation, and how the engine's sums add up."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any


@dataclass
class FarmResult:
    """What a farm made of an animation.

    Attributes:
        files: paths of all whole files by frame, the EXR first.
        seconds: from beginning to end.
        worker_seconds: that the program ran, over all workers: what it costs.
        totals: the engine's sums over all chunks: frames, rays and tests by kind, wall_ms.
        frames_by_host: how many frames came from which machine.
        versions: of the engine; more than one means that frames may differ in their last bits.
        retried: how often a frame was tried again.
        copies: how many chunks were so late that another worker was given a copy.
        skipped: frames that were there already.
        outdated: frames that were there of another scene, camera, setting or version, or not whole, and were rendered
            again.
    """

    files: dict[int, list[Path]] = field(default_factory=dict)
    seconds: float = 0.0
    worker_seconds: float = 0.0
    totals: dict[str, Any] = field(default_factory=dict)
    frames_by_host: Counter[str] = field(default_factory=Counter)
    versions: set[str] = field(default_factory=set)
    retried: int = 0
    copies: int = 0
    skipped: int = 0
    outdated: int = 0


def add_sums(sums: dict[str, Any], more: Mapping[str, Any]) -> None:
    """Adds numbers, also those within; rates and shares are no sums and are left out."""
    for name, value in more.items():
        if isinstance(value, Mapping):
            add_sums(sums.setdefault(name, {}), value)
        elif isinstance(value, (int, float)) and not isinstance(value, bool) and not _is_rate(name):
            sums[name] = sums.get(name, 0) + value


def _is_rate(name: str) -> bool:
    return name.startswith(("tests_per_ray", "reduction", "rays_per_second", "peak"))
