"""Quantities that follow from the states that an ensemble kept."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress

import numpy as np

from pendcore import _core
from pendcore._ensemble.members import Members
from pendcore._messages.arguments import Floats
from pendcore._messages.warning import silence

Quantity = Callable[[_core.Scene, Floats, Floats, Floats], Floats]
"""A quantity of k states of one scene, (k, ...), from times (k,), angles and rates (k, n)."""


def quantity_of_states(
    quantity: Quantity, members: Members, t: Floats, q: Floats, qd: Floats
) -> Floats:
    """Return a quantity of every state that was kept; of a member that was refused, NaN.

    ``q`` and ``qd`` are (..., n), or (..., n_t, n) at n_t times, and ``t`` broadcasts with their
    axes before the last. The result has these axes, and then those of the quantity.
    """
    axes, n = q.shape[:-1], q.shape[-1]
    times = np.broadcast_to(t, axes)

    def computed(scene: _core.Scene, t: Floats, angles: Floats, rates: Floats) -> Floats:
        found = quantity(scene, t.reshape(-1), angles.reshape(-1, n), rates.reshape(-1, n))
        return found.reshape(*t.shape, *found.shape[1:])

    if not members.vary:
        values = computed(members.scene._compiled, times, q, qd)
    else:
        one = computed(members.scene._compiled, np.zeros(1), np.zeros((1, n)), np.zeros((1, n)))
        values = np.full((*axes, *one.shape[1:]), np.nan)
        with silence():  # of implausible parameters
            for place in np.ndindex(members.shape):
                with suppress(ValueError):  # it was refused
                    scene = members.scene_of(place)
                    values[place] = computed(scene._compiled, times[place], q[place], qd[place])
    values[np.isnan(q).any(axis=-1)] = np.nan  # positions() has a pivot even without a state
    return values
