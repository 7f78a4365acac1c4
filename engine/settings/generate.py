#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes the committed files that follow from the engine's table of settings: run it after a change of table.def.

    engine/settings/generate.py [--sheaf build/sheaf] [--check]

`--check` writes nothing and fails where a file is not what it would write.
"""

import argparse
import json
import pathlib
import subprocess
import sys
import textwrap

ROOT = pathlib.Path(__file__).resolve().parents[2]
WIDTH = 116  # of a line of Python

PYTHON_TYPES = {
    "flag": "bool",
    "integer": "int",
    "number": "float",
    "number-or-inf": "float | str",
    "rate": "float | str",
    "samples": "int | str",
    "color": "str | tuple[float, float, float]",
    "size": "str | tuple[int, int]",
    "frames": "str | int | Iterable[int]",
    "layers": "str | Sequence[str]",
    "name-or-index": "str | int",
}


def sentence(text: str) -> str:
    return text[0].upper() + text[1:] + "."


def docstring(text: str) -> list[str]:
    """What stands below a field, in lines that are not too long."""
    lines = textwrap.wrap(sentence(text), WIDTH - 6)
    lines = ['    """' + lines[0], *("    " + line for line in lines[1:])]
    if len(lines) > 1:
        return [*lines, '    """']
    return [lines[0] + '"""']


def number(value: float) -> str:
    return str(int(value)) if value == int(value) else str(value)


def facts(setting: dict) -> str:
    """Range, choices and default, in words."""
    words = []
    if setting["range"]:
        low, high = (number(bound) for bound in setting["range"])
        words.append(f"above {low}, at most {high}" if setting.get("above") else f"{low} to {high}")
    if setting["choices"]:
        words.append(", ".join(setting["choices"]))
    text = "; ".join(words)
    return f"{text} {setting['unit']}".strip() if setting["unit"] else text


def python_type(setting: dict) -> str:
    if setting["type"] == "choice":
        return "Literal[" + ", ".join(json.dumps(choice) for choice in setting["choices"]) + "]"
    return PYTHON_TYPES.get(setting["type"], "str")


def python_text(table: list[dict]) -> str:
    lines = [
        "# SPDX-License-Identifier: MIT",
        "# Written by engine/settings/generate.py from the engine's table of settings.",
        '"""The settings that a service takes: their types, and what is known of them."""',
        "",
        "from __future__ import annotations",
        "",
        "from collections.abc import Iterable, Mapping, Sequence",
        "from typing import Literal, NamedTuple, TypedDict",
        "",
        "",
        "class RenderSettings(TypedDict, total=False):",
        '    """What `Client.submit` takes beside scene and camera; what is not given is the service\'s default.',
        "",
        "    `None` counts as not given. The service checks all values and answers `InvalidRequest` with the reason.",
        '    """',
        "",
    ]
    taken = [setting for setting in table if setting["http"]]
    for setting in taken:
        name = setting["name"].replace("-", "_")
        field = f"    {name}: {python_type(setting)} | None"
        if len(field) > WIDTH + 4:
            choices = [f'            "{choice}",' for choice in setting["choices"]]
            field = "\n".join([f"    {name}: (", "        Literal[", *choices, "        ]", "        | None", "    )"])
        known = f" ({facts(setting)})" if facts(setting) and setting["type"] != "choice" else ""
        lines += [field, *docstring(setting["help"] + known)]
    lines += [
        "",
        "",
        "class Setting(NamedTuple):",
        '    """What is known of a setting.',
        "",
        "    Attributes:",
        "        kind: of its value, as `sheaf options` names it.",
        "        syntax: on a command line; empty for a switch.",
        "        choices: where there is a list of them.",
        "        default: of the engine; None where that depends on the scene.",
        "        help: what it is.",
        '    """',
        "",
        "    kind: str",
        "    syntax: str",
        "    choices: tuple[str, ...]",
        "    default: str | int | float | bool | None",
        "    help: str",
        "",
        "",
        "SETTINGS: Mapping[str, Setting] = {",
    ]
    for setting in taken:
        values = (
            setting["type"],
            setting["syntax"],
            tuple(setting["choices"] or ()),
            setting["default"],
            setting["help"],
        )
        lines.append(f"    {setting['name']!r}: Setting{values!r},")
    lines += ["}", "", "PRESETS: Mapping[str, Mapping[str, str | int | float]] = {"]
    for setting in table:
        lines += [f"    {name!r}: {values!r}," for name, values in setting.get("presets", {}).items()]
    return "\n".join([*lines, "}", ""])


def formatted(text: str) -> str:
    """As the package's formatter has it, where that is installed."""
    for program in (pathlib.Path(sys.executable).with_name("ruff"), ROOT / "build/venv/bin/ruff"):
        if program.is_file():
            target = ROOT / "client/src/sheaf/_render_settings.py"
            command = [str(program), "format", "--stdin-filename", str(target), "-"]
            told = subprocess.run(command, input=text, text=True, capture_output=True, check=True, cwd=ROOT)
            return told.stdout
    raise SystemExit("no ruff: pip install -e './client[dev]'")


def cell(text: str) -> str:
    return text.replace("|", "\\|")


def markdown_text(table: list[dict]) -> str:
    lines = [
        "<!-- SPDX-License-Identifier: MIT. Written by engine/settings/generate.py from engine/settings/table.def. -->",
        "# Settings",
        "",
        "Every option of `sheaf render`. `sheaf options --json` prints the same for programs. A service takes those "
        "that are",
        "marked in a job's `settings`, by the same names; the Python client takes them with `_` for `-`.",
        "",
        "What an option decides: `view` (which scene, camera and time the picture shows), `pixels` (written into each "
        "frame as",
        "`sheaf:settings`), `speed` (time and memory, no pixel) or `output` (what else is written and said).",
    ]
    group = None
    for setting in table:
        if setting["group"] != group:
            group = setting["group"]
            lines += ["", f"## {group.capitalize()}", ""]
            lines += ["| option | what | values | default | decides | HTTP |", "| --- | --- | --- | --- | --- | --- |"]
        default = setting["default"]
        shown = "" if default is None or default is False else f"`{default}`"
        http = "yes" if setting["http"] else f"part `{setting['part']}`" if setting["part"] else ""
        option = f"`--{setting['name']} {setting['syntax']}`".replace(" `", "`")
        row = (option, sentence(setting["help"]), facts(setting), shown, setting["decides"], http)
        lines.append("| " + " | ".join(cell(text) for text in row) + " |")
    presets = next(setting["presets"] for setting in table if "presets" in setting)
    lines += ["", "## Qualities", "", "| `--quality` | stands for |", "| --- | --- |"]
    for name, values in presets.items():
        lines.append(f"| `{name}` | `" + " ".join(f"--{key} {value}" for key, value in values.items()) + "` |")
    return "\n".join([*lines, ""])


def generated(sheaf: pathlib.Path) -> dict[pathlib.Path, str]:
    told = subprocess.run([sheaf, "options", "--json"], capture_output=True, text=True, check=True)
    table = json.loads(told.stdout)
    return {
        ROOT / "client/src/sheaf/_render_settings.py": formatted(python_text(table)),
        ROOT / "docs/options.md": markdown_text(table),
    }


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sheaf", type=pathlib.Path, default=ROOT / "build/sheaf")
    parser.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    stale = [
        path for path, text in generated(arguments.sheaf).items() if not path.is_file() or path.read_text() != text
    ]
    for path in stale:
        if arguments.check:
            print(f"{path.relative_to(ROOT)} is not what the table of settings says: run engine/settings/generate.py")
        else:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(generated(arguments.sheaf)[path])
            print(f"wrote {path.relative_to(ROOT)}")
    return 1 if stale and arguments.check else 0


if __name__ == "__main__":
    sys.exit(main())
