"""The other conventions for angles: from a vertical, counter-clockwise.

pendcore measures ``q`` from the horizontal x axis towards y, and y points down: ``q = pi/2`` hangs
straight down, ``q = -pi/2`` stands upright. Many books measure ``theta`` from the hanging or the
upright vertical, counter-clockwise as seen: ``theta = pi/2 - q`` or ``theta = -pi/2 - q``. Rates
change their sign: ``thetad = -qd``.
"""

from __future__ import annotations

from math import pi
from typing import Any, Literal

import numpy.typing as npt

from pendcore._messages.arguments import finite_array

ZEROS = {"hanging": pi / 2, "upright": -pi / 2}
"""The angle ``q`` of a link at which ``theta`` is zero, by the name of that vertical."""
Zero = Literal["hanging", "upright"]


def angles_from_vertical(theta: npt.ArrayLike, *, zero: Zero = "hanging") -> Any:
    """Turn angles from a vertical into pendcore's.

    Parameters
    ----------
    theta : array_like, any shape
        Angles from the vertical, counter-clockwise, rad.
    zero : {"hanging", "upright"}
        Where a link points at ``theta = 0``: down or up.

    Returns
    -------
    ndarray or float
        ``q = pi/2 - theta``, from upright ``q = -pi/2 - theta``; the same shape, rad.

    Raises
    ------
    ValueError
        If ``theta`` is not finite, or ``zero`` another word.
    TypeError
        If ``theta`` does not hold real numbers.

    Notes
    -----
    For absolute angles alone. Rates have no pi/2 in them: ``qd = -thetad``, so negate them, and
    never pass them through here; torques that turn towards growing ``theta`` need a minus as well.

    Examples
    --------
    >>> pc.angles_from_vertical(np.radians([0.0, 30.0, 90.0])).round(4)
    array([1.5708, 1.0472, 0.    ])
    >>> pc.angles_from_vertical([0.0, 0.1], zero="upright").round(4)
    array([-1.5708, -1.6708])
    """
    return _at_zero(zero) - finite_array("theta", theta, "rad")


def angles_to_vertical(q: npt.ArrayLike, *, zero: Zero = "hanging") -> Any:
    """Turn pendcore's angles into angles from a vertical.

    Parameters
    ----------
    q : array_like, any shape
        Absolute angles, from +x towards +y (down), rad.
    zero : {"hanging", "upright"}
        As in `angles_from_vertical`, whose notes and errors hold here, too.

    Returns
    -------
    ndarray or float
        ``theta = pi/2 - q``, from upright ``theta = -pi/2 - q``, counter-clockwise; the same shape,
        rad. Whole turns stay: from upright, a link that hangs at ``q = pi/2`` is at ``-pi``.

    Examples
    --------
    >>> sol = pc.Case.textbook().simulate()
    >>> np.degrees(pc.angles_to_vertical(sol.q[0])).round(6)
    array([45., 30.])
    >>> np.degrees(pc.angles_to_vertical([-np.pi / 2, 0.0], zero="upright")).round(6)
    array([  0., -90.])
    """
    return _at_zero(zero) - finite_array("q", q, "rad")


def _at_zero(zero: object) -> float:
    if not isinstance(zero, str) or zero not in ZEROS:
        raise ValueError(f'zero = {zero!r}: must be "hanging" or "upright"')
    return ZEROS[zero]
