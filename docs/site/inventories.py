"""Links to other projects' documentation, without asking their sites while the site is built.

Sphinx wants a list of each project's names; these are the few that the reference uses.
"""

from __future__ import annotations

import zlib
from pathlib import Path

NAMES = {
    "python": (
        "https://docs.python.org/3/",
        {
            "ValueError": ("py:exception", "library/exceptions.html#$"),
            "TypeError": ("py:exception", "library/exceptions.html#$"),
            "KeyboardInterrupt": ("py:exception", "library/exceptions.html#$"),
            "pathlib.Path": ("py:class", "library/pathlib.html#$"),
        },
    ),
    "numpy": (
        "https://numpy.org/doc/stable/",
        {
            "numpy.ndarray": ("py:class", "reference/generated/$.html#$"),
            "numpy.savez": ("py:function", "reference/generated/$.html#$"),
        },
    ),
    "matplotlib": (
        "https://matplotlib.org/stable/",
        {"matplotlib.axes.Axes": ("py:class", "api/_as_gen/$.html#$")},
    ),
}


def write(folder: Path) -> dict[str, tuple[str, str]]:
    """Write the lists, and return them as Sphinx wants them named."""
    folder.mkdir(parents=True, exist_ok=True)
    mapping = {}
    for project, (site, names) in NAMES.items():
        head = f"# Sphinx inventory version 2\n# Project: {project}\n# Version: \n"
        head += "# The remainder of this file is compressed using zlib.\n"
        rows = "".join(f"{name} {role} 1 {at} -\n" for name, (role, at) in names.items())
        path = folder / f"{project}.inv"
        path.write_bytes(head.encode() + zlib.compress(rows.encode()))
        mapping[project] = (site, str(path))
    return mapping
