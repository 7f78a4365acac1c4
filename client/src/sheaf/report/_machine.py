# SPDX-License-Identifier: MIT
"""What was measured on, and with which versions."""

from __future__ import annotations

import contextlib
import importlib.metadata
import os
import platform
from datetime import datetime, timezone
from pathlib import Path

from .._program import Program
from .._version import __version__

_PACKAGES = ("numpy", "OpenEXR", "matplotlib", "flip-evaluator")


def describe_machine() -> dict[str, str | int]:
    """Processor, cores that may be used, memory and system."""
    machine: dict[str, str | int] = {
        "processor": _field("/proc/cpuinfo", "model name") or platform.processor() or platform.machine(),
        "cores": _cores(),
        "system": platform.platform(),
    }
    memory = _field("/proc/meminfo", "MemTotal")
    if memory:
        machine["memory_mib"] = int(memory.split()[0]) // 1024
    return machine


def describe_versions(program: Program) -> dict[str, str]:
    """Of the engine, of this package and of what it computes with."""
    versions = {"sheaf": program.version.removeprefix("sheaf "), "sheaf-client": __version__}
    versions["python"] = platform.python_version()
    for package in _PACKAGES:
        with contextlib.suppress(importlib.metadata.PackageNotFoundError):
            versions[package] = importlib.metadata.version(package)
    return versions


def now() -> str:
    """The time, RFC 3339, to the second."""
    return datetime.now(timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")


def _cores() -> int:
    with contextlib.suppress(AttributeError):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _field(file: str, name: str) -> str | None:
    with contextlib.suppress(OSError):
        for line in Path(file).read_text(encoding="utf-8", errors="replace").splitlines():
            key, _, value = line.partition(":")
            if key.strip() == name:
                return value.strip()
    return None
