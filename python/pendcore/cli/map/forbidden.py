"""Events that cannot happen, because the energy does not suffice.

A chain without effects keeps its energy E = T + V, and T is never negative. With link i at an angle
q, V is least if every other link hangs::

    V = -g sum_j w_j sin q_j,    w_j = m_j c_j + L_j (m_{j+1} + ... + m_n)
    V_least = -|g| sum_{j != i} |w_j| - g w_i sin q

For two equal uniform rods released at rest, and link 2 upright, this is the condition
3 cos(theta_1) + cos(theta_2) > 2 of Heyl (2008), with angles from hanging.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from pendcore import Scene
from pendcore.events import Event, LinkAngle

MARGIN = 1e-9
"""The share of the energies that must be missing: rounding makes nothing impossible."""


def is_forbidden(
    scene: Scene, q0: npt.ArrayLike, qd0: npt.ArrayLike, event: Event
) -> npt.NDArray[np.bool_]:
    """Return at which starts (..., n) the event is known not to happen, (...).

    Nothing is known of scenes with effects, and of other events.
    """
    if scene.effects or not isinstance(event, LinkAngle):
        return np.zeros(np.shape(q0)[:-1], dtype=bool)
    kinetic, potential = scene.energy(0.0, q0, np.broadcast_to(qd0, np.shape(q0)))
    hanging = np.pi / 2 * np.eye(len(scene.links))  # one link in each pose; the others are level
    weights = -scene.energy(0.0, hanging, np.zeros_like(hanging))[1]  # g w_j
    i = event.link - 1
    least = -np.abs(weights).sum() + abs(weights[i]) - weights[i] * np.sin(event.value)
    scale = np.abs(kinetic) + np.abs(potential) + np.abs(weights).sum()
    return np.asarray(least - (kinetic + potential) > MARGIN * scale)
