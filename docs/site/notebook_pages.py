"""Writes a page for each notebook of examples/notebooks; its cells are executed with the page.

What a cell's last line shows in a notebook stands below it (executed.py).
"""

from __future__ import annotations

import json
import shutil
from pathlib import Path

from executed import NOTEBOOK

INTRODUCTION = (
    "Each can be downloaded, and is run while the site is built: what it shows is alive here."
)


ORDER = ("textbook_swing", "chaos_and_trust", "friction_and_stops", "saddle_transport")


def write(notebooks: Path, folder: Path) -> None:
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    rows, tree = [], []
    for name in ORDER:
        path = notebooks / f"{name}.ipynb"
        cells = json.loads(path.read_text())["cells"]
        lines: list[str] = []
        for cell in cells:
            text = "".join(cell["source"])
            lines += ["```python", text, "```", ""] if cell["cell_type"] == "code" else [text, ""]
        lines += [f"{{download}}`{path.name} <../../examples/notebooks/{path.name}>`"]
        title = "".join(cells[0]["source"]).partition("\n")[0].removeprefix("# ")
        # MyST takes a title before anything else.
        (folder / f"{name}.md").write_text("\n".join([*lines, "", NOTEBOOK]) + "\n")
        rows.append(f"* [{title}]({name}.md)")
        tree.append(name)
    index = ["# Notebooks", "", INTRODUCTION, "", *rows, "", ":::{toctree}", ":hidden:", ""]
    (folder / "index.md").write_text("\n".join([*index, *tree, ":::"]) + "\n")
