"""How wrong a computed trajectory is.

The measure is the largest distance, over a fixed grid of times, between computed and reference
joints and tip, divided by the total length. Arrays are (n_t, n) for angles and rates, (n,) for
masses and lengths; angles run from +x towards +y, y down.
"""

from __future__ import annotations

import numpy as np
from cases import Array
from dense_chain import DenseChain


def joints_and_tip(q: Array, lengths: Array) -> Array:
    """Find the positions (n_t, n, 2) of the far ends of the links."""
    along = np.stack([np.cos(q), np.sin(q)], axis=-1)
    return np.cumsum(lengths[:, None] * along, axis=-2)


def distances(q: Array, reference: Array, lengths: Array) -> Array:
    """Return the largest distance at each time (n_t,), as a share of the total length."""
    apart = joints_and_tip(q, lengths) - joints_and_tip(reference, lengths)
    return np.hypot(apart[..., 0], apart[..., 1]).max(axis=-1) / lengths.sum()


def position_error(q: Array, reference: Array, lengths: Array) -> float:
    """Return the largest of the distances over the grid; NaN if a state is NaN."""
    return float(distances(q, reference, lengths).max())


def end_error(q: Array, reference: Array, lengths: Array) -> float:
    """Return the distance at the last time alone."""
    return float(distances(q, reference, lengths)[-1])


def energy(q: Array, qd: Array, masses: Array, lengths: Array, gravity: float) -> Array:
    """Return the energy of uniform rods at each time, J, (n_t,)."""
    chain = DenseChain(masses=masses, lengths=lengths, gravity=gravity)
    matrices = chain.couplings * np.cos(q[:, :, None] - q[:, None, :])
    kinetic = 0.5 * np.einsum("ti,tij,tj->t", qd, matrices, qd)
    return kinetic - gravity * (np.sin(q) @ chain.moments)


def energy_error(q: Array, qd: Array, masses: Array, lengths: Array, gravity: float) -> float:
    """Measure the largest drift of the energy of uniform rods from its start.

    The drift is a share of the energy that the whole mass gains by falling the whole length, or,
    without gravity, of the kinetic energy at the start.
    """
    total = energy(q, qd, masses, lengths, gravity)
    scale = gravity * masses.sum() * lengths.sum() if gravity else total[0]
    return float(np.abs(total - total[0]).max() / scale)
