"""Writes the pages of the C++ reference: one for each folder of headers, from their comments.

A header begins with a comment that says what it is for; declarations have their own. Both are shown
as they are written, because their equations are laid out as text.
"""

from __future__ import annotations

import re
import shutil
from pathlib import Path

ABOUT = re.compile(r"\A/// \\file\n((?:///.*\n)+)")
DIRECTIVE = re.compile(r"^#(?:.*\\\n)*.*\n", re.MULTILINE)
TITLES = {
    "scene": "Scenes", "effects": "Effects", "simulate": "Runs", "ensemble": "Ensembles",
    "integrate": "Integrators",
    "dynamics": "Equations of motion", "analysis": "Analysis", "arithmetic": "Arithmetic",
    "text": "Messages",
}  # fmt: skip


def write(headers: Path, folder: Path) -> None:
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    folders = {path.name for path in headers.iterdir() if path.is_dir()}
    if folders != {*TITLES}:
        raise ValueError(f"TITLES and the folders of headers differ in {folders ^ {*TITLES}}")
    for name, title in TITLES.items():
        found = sorted((headers / name).rglob("*.hpp"))
        text = [f"# {title}", "", f"Headers in `pendcore/{name}`.", ""]
        for header in found:
            text += section(headers / name, header)
        (folder / f"{name}.md").write_text("\n".join(text) + "\n")
    about = "The headers, from their comments. A first program: [](../../how_to/cpp.md)."
    lines = ["# C++", "", about, "", ":::{toctree}", ":maxdepth: 1", "", *TITLES, ":::"]
    (folder / "index.md").write_text("\n".join(lines) + "\n")


def section(home: Path, header: Path) -> list[str]:
    text = header.read_text()
    about = ABOUT.match(text)
    lines = [f"## {header.relative_to(home)}", ""]
    if about:
        lines += ["```text", *(line[4:] for line in about.group(1).splitlines()), "```", ""]
    code = text[about.end() :] if about else text
    code = DIRECTIVE.sub("", code)
    return [*lines, ":::{dropdown} Declarations", "```cpp", code.strip(), "```", ":::", ""]
