# SPDX-License-Identifier: MIT
"""The drawings of the layers in docs/architecture.md are true, for the includes and for the libraries' links.

The allowed uses are the arrows of the section's drawings and what follows from them transitively.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
INCLUDE = re.compile(r'^\s*#include "([a-z_]+)/[^"]+"', re.MULTILINE)

Graph = dict[str, set[str]]


def drawn_layers(text: str) -> Graph:
    """The folders that the drawings of the section "Layers" show, and for each those it uses directly."""
    section = text.split("\n## Layers\n", 1)[1].split("\n## ", 1)[0]
    drawings = "".join(part.split("```", 1)[0] for part in section.split("```mermaid")[1:])
    labels = re.findall(r'(\w+)\["([a-z_/]+)', drawings)
    names = {name: folder for name, folder in labels if (ROOT / folder).is_dir()}
    uses: Graph = {folder: set() for folder in names.values()}
    for source, target in re.findall(r'^\s*(\w+)(?:\["[^"]*"\])? --> (\w+)', drawings, re.MULTILINE):
        uses[names[source]].add(names[target])
    return uses


def linked_layers(folders: list[str]) -> Graph:
    """What the library of each folder links, as folders."""
    links: Graph = {}
    for folder in folders:
        own = ROOT / folder / "CMakeLists.txt"
        build = own.read_text() if own.exists() else ""
        libraries = re.findall(rf"target_link_libraries\({library_of(folder)}\s([^)]*)\)", build)
        links[folder] = {other for other in folders if library_of(other) in " ".join(libraries).split()}
    return links


def library_of(folder: str) -> str:
    return ("sheafd_" if folder.startswith("server/") else "sheaf_") + Path(folder).name


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


def forbidden(text: str, allowed: set[str], folders: set[str]) -> list[str]:
    """The folders that `text` includes and that are not allowed."""
    found = [folder for name in INCLUDE.findall(text) for folder in {f"engine/{name}", f"server/{name}"} & folders]
    found += ["shaders/interface" for name in INCLUDE.findall(text) if name.split("/")[0] == "interface"]
    return [folder for folder in found if folder not in allowed]


USES = drawn_layers((ROOT / "docs/architecture.md").read_text())
REACHED = closure(USES)
FOLDERS = sorted(USES)


def test_every_folder_with_cpp_is_drawn() -> None:
    files = [path for top in ("engine", "server") for path in (ROOT / top).rglob("*.[ch]pp")]
    drawn = set(FOLDERS) - {"client", "shaders", "shaders/interface"}
    assert {str(path.parent.relative_to(ROOT)) for path in files} == drawn


def test_no_layers_use_each_other() -> None:
    for folder in USES:
        assert not any(folder in REACHED[used] for used in USES[folder]), f"{folder} takes part in a cycle"


@pytest.mark.parametrize("folder", FOLDERS)
def test_includes_follow_the_drawing(folder: str) -> None:
    for path in sorted((ROOT / folder).glob("*.[ch]pp")):
        against = forbidden(path.read_text(), REACHED[folder], set(USES))
        assert not against, f"{path.relative_to(ROOT)} includes {against}, which {folder} may not use"


def test_libraries_link_what_is_drawn() -> None:
    built = [folder for folder in FOLDERS if folder != "client"]
    linked = closure(linked_layers(built))
    for folder in built:
        assert linked[folder] == REACHED[folder], folder


def test_a_forbidden_include_is_found() -> None:
    included = ['"frame/renderer.hpp"', '"vulkan/device.hpp"', '"http/router.hpp"', "<vector>"]
    text = "".join(f"#include {name}\n" for name in included)
    assert forbidden(text, REACHED["engine/stages"], set(USES)) == ["engine/frame", "server/http"]
