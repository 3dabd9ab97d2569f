"""Writes the pages of the C++ reference from the comments of the public headers.

A header begins with a comment that says what it is for; declarations have their own. Both are shown
as they are written, because their equations are laid out as text.
"""

from __future__ import annotations

import re
from pathlib import Path

from pages_of_files import toctree

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
        found = [header for name in names for header in sorted(headers.glob(f"{name}.hpp"))]
        shown.update(found)
        sections = [section(headers, header) for header in found]
        (folder / f"{title.lower()}.md").write_text("\n".join([f"# {title}\n", *sections]))
    if missing := {*headers.rglob("*.hpp")} - shown:
        raise ValueError(f"PAGES has no place for {sorted(map(str, missing))}")
    about = "The headers, from their comments. A first program: [](../../how_to/cpp.md)."
    tree = toctree(map(str.lower, PAGES), ":maxdepth: 1")
    (folder / "index.md").write_text(f"# C++\n\n{about}\n\n{tree}")


def section(home: Path, header: Path) -> str:
    _, comment, code = ABOUT.split(header.read_text())
    about = "\n".join(line[4:] for line in comment.splitlines())
    return f"""## {header.relative_to(home)}

```text
{about}
```

:::{{dropdown}} Declarations
```cpp
{DIRECTIVE.sub("", code).strip()}
```
:::
"""
