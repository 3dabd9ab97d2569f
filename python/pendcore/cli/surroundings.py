"""What a shell sets for this process, changed where a command would fail of it."""

from __future__ import annotations

import os
import sys
from io import TextIOWrapper


def make_surroundings_safe() -> None:
    """Draw by Agg, whatever backend is set, and print any text to any stream.

    A notebook sets a backend for all that is started from it, and matplotlib cannot be imported
    where that backend is missing. Letters that the encoding of a stream lacks are printed escaped.
    """
    os.environ["MPLBACKEND"] = "agg"
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:  # closed: print(file=None) would go to standard output
            setattr(sys, name, os.fdopen(os.open(os.devnull, os.O_WRONLY), "w", encoding="utf-8"))
        elif isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
