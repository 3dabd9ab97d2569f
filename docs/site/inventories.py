"""Links to other projects' documentation, without asking their sites while the site is built.

Sphinx wants a list of each project's names; these are the few that the reference uses.
"""

from __future__ import annotations

import zlib
from pathlib import Path

NAMES = {
    "python": """https://docs.python.org/3/
ValueError py:exception 1 library/exceptions.html#$ -
TypeError py:exception 1 library/exceptions.html#$ -
KeyboardInterrupt py:exception 1 library/exceptions.html#$ -
pathlib.Path py:class 1 library/pathlib.html#$ -
""",
    "numpy": """https://numpy.org/doc/stable/
numpy.ndarray py:class 1 reference/generated/$.html#$ -
numpy.savez py:function 1 reference/generated/$.html#$ -
""",
    "matplotlib": """https://matplotlib.org/stable/
matplotlib.axes.Axes py:class 1 api/_as_gen/$.html#$ -
""",
}
"""The address of each project, and names as an inventory has them."""


def write(folder: Path) -> dict[str, tuple[str, str]]:
    """Write the lists, and return them as Sphinx wants them named."""
    folder.mkdir(parents=True, exist_ok=True)
    mapping = {}
    for project, text in NAMES.items():
        site, _, rows = text.partition("\n")
        head = f"# Sphinx inventory version 2\n# Project: {project}\n# Version: \n"
        head += "# The remainder of this file is compressed using zlib.\n"
        path = folder / f"{project}.inv"
        path.write_bytes(head.encode() + zlib.compress(rows.encode()))
        mapping[project] = (site, str(path))
    return mapping
