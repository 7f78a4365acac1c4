#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Makes the blocking client out of the asynchronous one, so that what both do is written once.

    client/make_sync.py            writes _session.py, _job.py and _client.py
    client/make_sync.py --check    says which of them are not what their sources make, and exits with 1

Words are replaced, in code, comments and docstrings alike. What differs otherwise stands in `_async_workers` and
`_workers`, which have the same functions.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
from pathlib import Path

PACKAGE = Path(__file__).resolve().parent / "src/sheaf"
MADE = ("session", "job", "client")

WORDS = (
    (r"\basync (def|for|with)\b", r"\1"),
    (r"\bawait ", ""),
    (r"\b[Aa]n async context manager", "A context manager"),
    (r"\bAwaitable, ", ""),
    (r"\bAwaitable\[(\w+)\]", r"\1"),
    (r"\bAsyncGenerator\[(\w+), None\]", r"Generator[\1, None, None]"),
    (r"\bAsync(Generator|Iterator|BaseTransport|Client|Job|Session)\b", r"\1"),
    (r"\b__a(enter|exit)__\b", r"__\1__"),
    (r"\basynccontextmanager\b", "contextmanager"),
    (r"\ba(close|closing|read|iter_bytes)\b", r"\1"),
    (r"\b_async_(client|job|session|workers)\b", r"_\1"),
)


def made_from(source: Path) -> str:
    text = source.read_text()
    for pattern, replacement in WORDS:
        text = re.sub(pattern, replacement, text)
    text = text.replace("\n", f"\n# Made by client/make_sync.py from {source.name}: change that.\n", 1)
    return tidied(tidied(text, "check", "--quiet", "--fix", "--exit-zero", "--select=I"), "format")


def tidied(text: str, *command: str) -> str:
    ruff = Path(sys.executable).with_name("ruff")
    words = [ruff if ruff.is_file() else "ruff", *command, "--stdin-filename", PACKAGE / "_made.py", "-"]
    return subprocess.run(words, input=text, text=True, capture_output=True, check=True).stdout


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="compare instead of writing")
    only_check = parser.parse_args().check
    stale = 0
    for name in MADE:
        path, text = PACKAGE / f"_{name}.py", made_from(PACKAGE / f"_async_{name}.py")
        if path.is_file() and path.read_text() == text:
            continue
        stale += 1
        if only_check:
            print(f"{path.name} is not what _async_{name}.py makes: run client/make_sync.py", file=sys.stderr)
        else:
            path.write_text(text)
            print(f"wrote {path.name}")
    return 1 if only_check and stale else 0


if __name__ == "__main__":
    sys.exit(main())
