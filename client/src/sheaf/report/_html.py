# SPDX-License-Identifier: MIT
"""Pieces of a page: escaped text, tables, pictures inside the file."""

from __future__ import annotations

import base64
import html
from collections.abc import Sequence
from dataclasses import dataclass

NONE = "\N{EN DASH}"
"""Where there is no value."""


@dataclass(frozen=True)
class Cell:
    """A table's cell; numbers stand to the right."""

    text: str
    is_number: bool = False
    mark: str = ""
    """A class: "good", "bad", "front"."""


def number(value: float | None, form: str = ".3g", *, mark: str = "") -> Cell:
    """A number's cell; a dash where there is none."""
    return Cell(NONE if value is None else format(value, form), True, mark)


def percent(value: float | None) -> Cell:
    """A share's cell, marked by its sign."""
    if value is None:
        return Cell(NONE, True)
    return Cell(f"{value:+.1%}", True, "good" if value > 0.005 else "bad" if value < -0.005 else "")


def table(caption: str, head: Sequence[str], body: Sequence[Sequence[Cell | str]]) -> str:
    """A table that scrolls by itself where the page is narrow."""
    columns = "".join(f'<th scope="col">{escaped(name)}</th>' for name in head)
    rows = "\n".join(f"<tr>{''.join(_cell(i, entry) for i, entry in enumerate(row))}</tr>" for row in body)
    return (
        f'<div class="wide" tabindex="0" role="region" aria-label="{escaped(caption)}"><table>'
        f"<caption>{escaped(caption)}</caption><thead><tr>{columns}</tr></thead>\n<tbody>{rows}</tbody></table></div>"
    )


def _cell(index: int, entry: Cell | str) -> str:
    cell = Cell(entry) if isinstance(entry, str) else entry
    classes = " ".join(filter(None, ("number" if cell.is_number else "", cell.mark)))
    attribute = f' class="{classes}"' if classes else ""
    name = 'th scope="row"' if index == 0 else "td"
    return f"<{name}{attribute}>{escaped(cell.text)}</{name.partition(' ')[0]}>"


def image(png: bytes, words: str, dark: bytes | None = None) -> str:
    """A picture inside the page; `dark` takes its place on a dark ground."""
    other = f'<source srcset="{_data(dark)}" media="(prefers-color-scheme: dark)">' if dark else ""
    return f'<picture>{other}<img src="{_data(png)}" alt="{escaped(words)}"></picture>'


def escaped(text: object) -> str:
    """Text that stays text."""
    return html.escape(str(text))


def _data(png: bytes) -> str:
    return f"data:image/png;base64,{base64.b64encode(png).decode()}"


STYLE = """
:root { color-scheme: light dark; --ground: #fff; --ink: #1c2024; --quiet: #5b6470; --line: #dfe3e8; --card: #f6f7f9;
  --good: #06724f; --bad: #b3401a; --front: #d55e00; font: 16px/1.55 system-ui, sans-serif; }
@media (prefers-color-scheme: dark) { :root { --ground: #16191d; --ink: #e8eaed; --quiet: #9aa3ad; --line: #2c3138;
  --card: #1d2126; --good: #4cc79b; --bad: #f08a5d; --front: #f28c4b; } }
* { box-sizing: border-box; }
body { background: var(--ground); color: var(--ink); margin: 0 auto; max-width: 70rem; padding: 1.5rem 1rem 4rem; }
h1 { font-size: 1.9rem; line-height: 1.2; margin: 0 0 .3rem; }
h2 { border-top: 1px solid var(--line); font-size: 1.4rem; margin: 2.5rem 0 .5rem; padding-top: 1.5rem; }
h3 { font-size: 1.08rem; margin: 1.8rem 0 .4rem; }
p, li { max-width: 46rem; } .quiet, caption, figcaption { color: var(--quiet); font-size: .9rem; }
nav ul { display: flex; flex-wrap: wrap; gap: .3rem 1.2rem; list-style: none; padding: 0; }
a { color: inherit; }
.headline { background: var(--card); border-radius: .6rem; padding: .6rem 1.2rem; }
.headline ul { margin: 0; padding-left: 1.1rem; } .headline li { margin: .3rem 0; }
.headline strong { font-variant-numeric: tabular-nums; }
.wide { overflow-x: auto; margin: .8rem 0; } .wide:focus-visible { outline: 2px solid var(--front); }
table { border-collapse: collapse; font-size: .88rem; font-variant-numeric: tabular-nums; white-space: nowrap; }
caption { padding: .2rem 0 .4rem; text-align: left; white-space: normal; }
th, td { border-bottom: 1px solid var(--line); padding: .28rem .7rem .28rem 0; text-align: left; }
th[scope=row] { font-weight: 500; } thead th { color: var(--quiet); font-weight: 600; vertical-align: bottom; }
.number { text-align: right; } .good { color: var(--good); } .bad { color: var(--bad); font-weight: 600; }
.front { color: var(--front); font-weight: 600; }
figure { margin: 1rem 0; } figure img { max-width: 100%; height: auto; display: block; border-radius: .3rem; }
.strip { display: grid; gap: 1rem; grid-template-columns: repeat(auto-fill, minmax(15rem, 1fr)); }
.strip figure { margin: 0; } .strip img { image-rendering: pixelated; width: 100%; margin-bottom: .3rem; }
"""
