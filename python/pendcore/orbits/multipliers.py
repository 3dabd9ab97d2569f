"""Floquet multipliers and their directions, from the transition matrices of an orbit's arcs."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from pendcore.messages import Floats
from pendcore.orbits.shooting import Arcs, Shooting, energy_gradient, velocity

_FORWARD = 0.5
"""Smaller multipliers come from the inverse of the matrix, where energy is kept."""
Complexes = npt.NDArray[np.complex128]


def product(matrices: Floats) -> Floats:
    """Return the matrix that applies these one after the other, (2n, 2n)."""
    made = np.eye(matrices.shape[1])
    for one in matrices:
        made = one @ made
    return made


def multipliers(shooting: Shooting, arcs: Arcs, transitions: Floats) -> Complexes:
    """Return the multipliers, the largest first, (2n,).

    The velocity f of an orbit that no drive sets comes back as it was, and so do, where energy is
    kept, changes across its levels: two multipliers are 1, which as eigenvalues of the whole matrix
    are right to half the digits only. The others are the eigenvalues of what the matrix does to
    changes of the state that keep the energy, along f left out.
    """
    m = len(arcs.states)
    scales = shooting.scales
    scene, times = shooting.at(arcs.value), np.linspace(0.0, arcs.period, m + 1)
    frames = []
    for t, state in zip(times, arcs.states, strict=False):
        known = []
        if not shooting.is_forced:
            known.append(velocity(scene, t, state) / scales)
        if shooting.energy is not None:
            known.append(energy_gradient(scene, state) * scales)
        whole = np.eye(len(scales))
        frames.append(np.linalg.svd(known)[2][len(known) :].T if known else whole)
    reduced = np.array(
        [
            frames[(k + 1) % m].T @ (one * scales / scales[:, np.newaxis]) @ frames[k]
            for k, one in enumerate(transitions)
        ]
    )
    found = _largest_first(np.linalg.eigvals(product(reduced)).astype(complex))
    if shooting.energy is not None:
        kept = found[np.abs(found) > _FORWARD]
        back = np.linalg.eigvals(product(np.linalg.inv(reduced)[::-1])).astype(complex)
        small = 1 / _largest_first(back)[: len(found) - len(kept)][::-1]
        found = np.concatenate([kept, small])
    ones = np.ones(len(scales) - len(found))
    return _largest_first(np.concatenate([found, ones]))


def _largest_first(values: Complexes) -> Complexes:
    return values[np.lexsort([-values.imag, -np.abs(values)])]


def direction(transitions: Floats, scales: Floats, forward: bool) -> tuple[Floats, float]:
    """Return the direction that grows fastest, at the start of each arc, and its multiplier.

    Forward in time, or backward; (m, 2n). These are v(t) = |mu|^(-t/T) Phi(t) v(0), which come back
    as they were, or reversed: so small changes along them grow evenly. The longest has 1 rad.

    Raises
    ------
    ValueError
        If nothing grows, or two directions turn about each other as they do.
    """
    scaled = transitions * scales / scales[:, np.newaxis]
    steps = scaled if forward else np.linalg.inv(scaled)[::-1].astype(float)
    values, vectors = np.linalg.eig(product(steps))
    largest = int(np.argmax(np.abs(values)))
    growth = values[largest]
    kind = "unstable" if forward else "stable"
    if abs(growth) < 1 + 1e-4:
        raise ValueError(f"the orbit has no {kind} manifold: no multiplier is off the unit circle")
    if abs(growth.imag) > 1e-9 * abs(growth):
        raise ValueError(f"the {kind} multipliers {growth:.6g} and its conjugate have no one line")
    one = vectors[:, largest].real
    found = [one * np.sign(one[np.argmax(np.abs(one))])]
    for step in steps[:-1]:
        found.append(step @ found[-1] / abs(growth) ** (1 / len(steps)))
    if not forward:  # at the starts of arcs m, m - 1, ... 1, of which arc m begins as the first
        found = [found[0], *found[:0:-1]]
    longest = np.linalg.norm(found, axis=1).max()
    return np.array(found) * scales / longest, float((growth if forward else 1 / growth).real)
