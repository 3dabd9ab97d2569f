"""How a report's pictures are lettered, and saved."""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl

from pendcore.derive.document import Drawing

lettering = mpl.rc_context({
    "mathtext.fontset": "stix",
    "font.family": "STIXGeneral",
    "font.size": 11,
    "axes.titlesize": 11,
    "svg.hashsalt": "pendcore",
})  # fmt: skip
"""Decorates what draws: figures have the letters of the equations, and are saved the same."""


@lettering
def save(drawing: Drawing, path: Path) -> None:
    """Write a picture into a file, of the kind that its suffix says, the same every time."""
    dates = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}.get(path.suffix)
    drawing.figure.draw_without_rendering()
    drawing.figure.set_layout_engine("none")  # every picture has the first one's layout
    drawing.figure.savefig(path, dpi=150, metadata=dates)
