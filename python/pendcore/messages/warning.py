"""The one class of warning that pendcore gives."""

from __future__ import annotations

import os
import sys
import warnings
from pathlib import Path

_PACKAGE = str(Path(__file__).parents[1]) + os.sep


class PendcoreWarning(UserWarning):
    """Something is allowed and looks wrong: the message names it, and why.

    Examples
    --------
    Angles in degrees are allowed, and a mistake: turned into errors, such warnings end a program.

    >>> import warnings
    >>> with warnings.catch_warnings():
    ...     warnings.simplefilter("error", pc.PendcoreWarning)
    ...     pc.simulate(pc.Scene.textbook(), q0=[45, 60], t_span=(0, 1))
    Traceback (most recent call last):
    pendcore.messages.warning.PendcoreWarning: q0[0] = 45.0 rad: that is 2578 degrees: angles ...
    """


def warn(message: str) -> None:
    """Give a warning that is blamed on the line of the user's that led to it."""
    frame, level = sys._getframe(1), 2
    while frame.f_back is not None and frame.f_code.co_filename.startswith(_PACKAGE):
        frame, level = frame.f_back, level + 1
    warnings.warn(message, PendcoreWarning, stacklevel=level)
