# SPDX-License-Identifier: MIT
"""The drawing of the layers in docs/architecture.md is true: no file includes a header that its own folder may not use.

The allowed uses are the arrows of the document's first drawing and what follows from them transitively.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
INCLUDE = re.compile(r'^\s*#include "([a-z_/0-9]+)/[^/"]+"', re.MULTILINE)

Graph = dict[str, set[str]]


def drawn_layers(text: str) -> Graph:
    """The folders of the first Mermaid drawing, and for each the folders it uses directly."""
    drawing = text.split("```mermaid", 1)[1].split("```", 1)[0]
    names = dict(re.findall(r'(\w+)\["([a-z_/]+)', drawing))
    uses: Graph = {folder: set() for folder in names.values()}
    for line in drawing.splitlines():
        arrow = re.match(r'\s*(\w+)(?:\["[^"]*"\])? --> (\w+)', line)
        if arrow:
            source, target = (names.get(name, name) for name in arrow.groups())
            uses.setdefault(source, set()).add(target)
            uses.setdefault(target, set())
    return uses


def closure(uses: Graph) -> Graph:
    """Every folder that can be reached from each, itself included."""
    reached: Graph = {}
    for start in uses:
        found, waiting = {start}, [start]
        while waiting:
            new = uses[waiting.pop()] - found
            found |= new
            waiting += new
        reached[start] = found
    return reached


def forbidden(folder: str, text: str, allowed: set[str], folders: set[str]) -> list[str]:
    """The folders that `text`, a file of `folder`, includes against the drawing."""
    found = []
    for included in INCLUDE.findall(text):
        target = f"engine/{included}" if f"engine/{included}" in folders else included.split("/")[0]
        if target in folders and target != folder and target not in allowed:
            found.append(target)
    return found


USES = drawn_layers((ROOT / "docs/architecture.md").read_text())
REACHED = closure(USES)
ENGINE = sorted(folder for folder in USES if folder.startswith("engine/"))


def test_every_folder_of_the_engine_is_drawn() -> None:
    folders = {f"engine/{path.name}" for path in (ROOT / "engine").iterdir() if path.is_dir()}
    assert folders == set(ENGINE)


def test_no_layers_use_each_other() -> None:
    for folder in USES:
        assert not any(folder in REACHED[used] for used in USES[folder]), f"{folder} takes part in a cycle"


@pytest.mark.parametrize("folder", ENGINE)
def test_includes_follow_the_drawing(folder: str) -> None:
    for path in sorted((ROOT / folder).iterdir()):
        if path.suffix in {".cpp", ".hpp"}:
            against = forbidden(folder, path.read_text(), REACHED[folder], set(USES))
            assert not against, f"{path.relative_to(ROOT)} includes {against}, which {folder} may not use"


def test_a_forbidden_include_is_found() -> None:
    text = '#include "frame/renderer.hpp"\n#include "vulkan/device.hpp"\n#include <vector>\n'
    assert forbidden("engine/stages", text, REACHED["engine/stages"], set(USES)) == ["engine/frame"]
