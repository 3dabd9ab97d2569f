"""The one class of warning that pendcore gives."""

from __future__ import annotations

import os
import re
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path

_PACKAGE = str(Path(__file__).parents[1]) + os.sep
_VALUE = re.compile(
    r"(?<![\w.[/-])(?<!link )(?<!joint )(?<!effect )(?<!event )-?(\d[\d.e+-]*|inf\b|nan\b)"
)
"""A number in a message, unless it counts links, joints, effects, events, or is part of a name."""


class PendcoreWarning(UserWarning):
    """Something is allowed and looks wrong: the message names it, and why.

    Examples
    --------
    >>> import warnings
    >>> with warnings.catch_warnings(record=True) as told:
    ...     warnings.simplefilter("always")
    ...     sol = pc.simulate(pc.Scene.textbook(), (0, 1), [45, 60])
    >>> str(told[0].message).partition(" (")[0]
    'q0[0] = 45.0 rad: that is 2578 degrees: angles are in radians'
    """


_SILENT: ContextVar[bool] = ContextVar("_SILENT", default=False)


@contextmanager
def silence() -> Iterator[None]:
    """Give no warning within: Python's filters would be changed for all threads.

    They would also forget what they have shown.
    """
    before = _SILENT.set(True)
    try:
        yield
    finally:
        _SILENT.reset(before)


def warn(message: str) -> None:
    """Give a warning that is blamed on the line of the user's that led to it.

    Python's default filter shows a text once for each line of code. Here it shows a kind once:
    texts that differ in their values are of one kind, as a fit would else hear of every scene.
    """
    if _SILENT.get():
        return
    frame = sys._getframe(1)
    while frame.f_back is not None and frame.f_code.co_filename.startswith(_PACKAGE):
        frame = frame.f_back
    line, names = frame.f_lineno, frame.f_globals
    shown = names.setdefault("__warningregistry__", {})
    text = (message, PendcoreWarning, line)  # as Python notes what it has shown
    # Inputs by hand all have line 1, but code of their own.
    kind = (_VALUE.sub("#", message), PendcoreWarning, line, frame.f_code)
    if kind in shown:
        shown[text] = True  # Python drops both notes if filters have changed since
    module = names.get("__name__", "<string>")
    warnings.warn_explicit(message, PendcoreWarning, frame.f_code.co_filename, line, module, shown)
    if shown.pop(text, False):
        shown[kind] = True
