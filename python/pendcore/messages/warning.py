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
    >>> import warnings
    >>> with warnings.catch_warnings(record=True) as told:
    ...     warnings.simplefilter("always")
    ...     sol = pc.simulate(pc.Scene.textbook(), q0=[45, 60], t_span=(0, 1))
    >>> print(told[0].message)
    q0[0] = 45.0 rad: that is 2578 degrees: angles are in radians (numpy.radians converts degrees)
    """


def warn(message: str) -> None:
    """Give a warning that is blamed on the line of the user's that led to it."""
    frame, level = sys._getframe(1), 2
    while frame.f_back is not None and frame.f_code.co_filename.startswith(_PACKAGE):
        frame, level = frame.f_back, level + 1
    warnings.warn(message, PendcoreWarning, stacklevel=level)
