"""Writes the pages of the C++ reference from the comments of the public headers.

A header begins with a comment that says what it is for; declarations have their own. Both are shown
as they are written, because their equations are laid out as text.
"""

from __future__ import annotations

import re
from pathlib import Path

ABOUT = re.compile(r"\A/// \\file\n((?:///.*\n)+)")
DIRECTIVE = re.compile(r"^#(?:.*\\\n)*.*\n", re.MULTILINE)
PAGES = {
    "Scenes": ["scene", "parameters", "descriptor", "vector"],
    "Effects": ["effects", "effects/*"],
    "Runs": ["simulate", "options", "methods", "events", "solution", "status"],
    "Equations": ["equations", "mechanics"],
    "Ensembles": ["ensemble", "lyapunov"],
}
"""The headers of each page. `pendcore.hpp` includes them all and says nothing itself."""


def write(headers: Path, folder: Path) -> None:
    folder.mkdir(parents=True)
    shown = {headers / "pendcore.hpp"}
    for title, names in PAGES.items():
        text = [f"# {title}", ""]
        for name in names:
            for header in sorted(headers.glob(f"{name}.hpp")):
                text += section(headers, header)
                shown.add(header)
        (folder / f"{title.lower()}.md").write_text("\n".join(text) + "\n")
    if missing := {*headers.rglob("*.hpp")} - shown:
        raise ValueError(f"PAGES has no place for {sorted(map(str, missing))}")
    about = "The headers, from their comments. A first program: [](../../how_to/cpp.md)."
    pages = [title.lower() for title in PAGES]
    lines = ["# C++", "", about, "", ":::{toctree}", ":maxdepth: 1", "", *pages, ":::"]
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
