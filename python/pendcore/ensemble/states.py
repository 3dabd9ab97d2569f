"""Quantities that follow from the states that an ensemble kept."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from pendcore import _core
from pendcore.ensemble.members import Members
from pendcore.messages.arguments import Floats

Quantity = Callable[[_core.Scene, Floats, Floats, Floats], Floats]
"""A quantity of k states of one scene, (k, ...), from times (k,), angles and rates (k, n)."""


def of_states(quantity: Quantity, members: Members, t: Floats, q: Floats, qd: Floats) -> Floats:
    """Return a quantity of every state that was kept; of a member that was refused, NaN.

    ``q`` and ``qd`` are (..., n), or (..., n_t, n) at n_t times, and ``t`` broadcasts with their
    axes before the last. The result has these axes, and then those of the quantity.
    """
    axes, n = q.shape[:-1], q.shape[-1]
    times = np.broadcast_to(t, axes)

    def of(scene: _core.Scene, t: Floats, q: Floats, qd: Floats) -> Floats:
        found = quantity(scene, t.reshape(-1), q.reshape(-1, n), qd.reshape(-1, n))
        return found.reshape(*t.shape, *found.shape[1:])

    values = of(members.scene._compiled, times, q, qd)
    if members.vary:
        for place in np.ndindex(members.shape):
            try:
                scene = members.scene_of(place)
            except ValueError:
                values[place] = np.nan
            else:
                values[place] = of(scene._compiled, times[place], q[place], qd[place])
    values[np.isnan(q).any(axis=-1)] = np.nan  # the pivot has a place without a state
    return values
