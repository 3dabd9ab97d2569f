"""How a report's pictures are lettered, and saved."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import matplotlib as mpl

from pendcore.derive.document import Drawing

_FONT: Any = {
    "mathtext.fontset": "stix",
    "font.family": "STIXGeneral",
    "font.size": 11,
    "axes.titlesize": 11,
    "svg.hashsalt": "pendcore",
}


@contextmanager
def lettering() -> Iterator[None]:
    """Draw figures with the letters of the equations, and save them the same every time."""
    with mpl.rc_context(_FONT):
        yield


@lettering()
def save(drawing: Drawing, path: Path) -> None:
    """Write a picture into a file, of the kind that its suffix says, the same every time."""
    dates = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}.get(path.suffix)
    drawing.figure.draw_without_rendering()
    drawing.figure.set_layout_engine("none")  # every picture has the first one's layout
    drawing.figure.savefig(path, dpi=150, metadata=dates)
