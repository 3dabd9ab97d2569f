"""Writes a page for each numbered example, and for each notebook.

A page of an example says what it is about and has its lines; that of a notebook has its cells, and
below a cell what its last line shows there. The Python of both is executed with the page, that of
an example as if it were run from its file (executed.py).
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path

NOTEBOOKS = ("textbook_swing", "chaos_and_trust", "friction_and_stops", "saddle_transport")


def write_examples(files: Path, folder: Path) -> None:
    pages = {}
    for path in sorted(files.glob("[0-9]*.py")):
        about, code = parts_of(path)
        title = about.partition("\n")[0].rstrip(".").partition(":")[0]
        pages[path] = f"# {title}\n\n{about}\n\n```python\n{code}\n```\n"
    _write(folder, "# Examples\n\nPrograms of one screen, with what they print and draw.", pages)


def write_notebooks(files: Path, folder: Path) -> None:
    pages = {}
    for path in (files / f"{name}.ipynb" for name in NOTEBOOKS):
        cells = json.loads(path.read_text())["cells"]
        texts = ["".join(cell["source"]) for cell in cells]
        shown = [
            f"```python\n{text}\n```\n" if cell["cell_type"] == "code" else f"{text}\n"
            for cell, text in zip(cells, texts, strict=True)
        ]
        pages[path] = "\n".join(shown)
    about = (
        "Each can be downloaded, and is run while the site is built: what it shows is alive here."
    )
    _write(folder, f"# Notebooks\n\n{about}", pages)


def parts_of(program: Path) -> tuple[str, str]:
    """Return what a program says of itself, and its code."""
    _, about, code = program.read_text().split('"""', 2)
    return about.strip(), code.strip()


def toctree(pages: Iterable[str], option: str) -> str:
    """Return the list of pages that the site's navigation reads."""
    listed = "\n".join(pages)
    return f":::{{toctree}}\n{option}\n\n{listed}\n:::\n"


def _write(folder: Path, about: str, pages: dict[Path, str]) -> None:
    """Write pages, and one that lists them."""
    folder.mkdir(parents=True)
    for path, text in pages.items():
        file = f"../../examples/{'notebooks/' * (path.suffix == '.ipynb')}{path.name}"
        (folder / f"{path.stem}.md").write_text(f"{text}\n{{download}}`{path.name} <{file}>`\n")
    tree = toctree((path.stem for path in pages), ":maxdepth: 1")
    (folder / "index.md").write_text(f"{about}\n\n{tree}")
