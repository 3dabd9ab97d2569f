"""The other convention for angles: from the hanging vertical, counter-clockwise.

pendcore measures ``q`` from the horizontal x axis towards y, and y points down: ``q = pi/2`` hangs
straight down. Many books measure ``theta`` from the hanging vertical, counter-clockwise as seen:
``theta = pi/2 - q``. Rates change their sign: ``thetad = -qd``.
"""

from __future__ import annotations

from math import pi
from typing import Any

import numpy.typing as npt

from pendcore.messages.arguments import finite_array, known_keywords


@known_keywords
def angles_from_vertical(theta: npt.ArrayLike) -> Any:
    """Turn angles from the hanging vertical into pendcore's.

    Parameters
    ----------
    theta : array_like, any shape
        Angles from the hanging vertical, counter-clockwise, rad.

    Returns
    -------
    ndarray or float
        ``q = pi/2 - theta``, the same shape, rad.

    Notes
    -----
    For angles alone. Rates have no pi/2 in them: ``qd = -thetad``, so negate them, and never pass
    them through here.

    Examples
    --------
    >>> pc.angles_from_vertical(np.radians([0.0, 30.0, 90.0])).round(4)
    array([1.5708, 1.0472, 0.    ])
    """
    return pi / 2 - finite_array("theta", theta, "rad")


@known_keywords
def angles_to_vertical(q: npt.ArrayLike) -> Any:
    """Turn pendcore's angles into angles from the hanging vertical.

    Parameters
    ----------
    q : array_like, any shape
        Absolute angles, from +x towards +y (down), rad.

    Returns
    -------
    ndarray or float
        ``theta = pi/2 - q``, the same shape, rad.

    Notes
    -----
    For angles alone. Rates have no pi/2 in them: ``thetad = -qd``, so negate them, and never pass
    them through here.

    Examples
    --------
    >>> sol = pc.Case.textbook().simulate()
    >>> np.degrees(pc.angles_to_vertical(sol.q[0])).round(6)
    array([45., 30.])
    """
    return pi / 2 - finite_array("q", q, "rad")
