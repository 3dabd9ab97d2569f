"""Writes a page for each numbered example: what it is about, its lines, what they print and draw.

The lines are executed with the page (executed.py), as if they were run from the example's file.
"""

from __future__ import annotations

import ast
import shutil
from pathlib import Path


def write(examples: Path, folder: Path) -> None:
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    rows = []
    for path in sorted(examples.glob("[0-9]*.py")):
        text = path.read_text()
        about = ast.get_docstring(ast.parse(text)) or ""
        title = about.partition("\n")[0].rstrip(".").partition(":")[0]
        code = text.split('"""', 2)[2].strip()
        lines = [f"# {title}", "", f"<!-- the file: {path} -->", "", about, ""]
        lines += [
            "```python",
            code,
            "```",
            "",
            f"{{download}}`{path.name} <../../examples/{path.name}>`",
        ]
        (folder / f"{path.stem}.md").write_text("\n".join(lines) + "\n")
        rows.append(f"* [{title}]({path.stem}.md)")
    tree = [path.stem for path in sorted(folder.glob("*.md"))]
    index = ["# Examples", "", "Programs of one screen, with what they print and draw.", "", *rows]
    index += ["", ":::{toctree}", ":hidden:", "", *tree, ":::"]
    (folder / "index.md").write_text("\n".join(index) + "\n")
