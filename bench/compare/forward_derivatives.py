"""The comparison of derivatives: those of the accelerations of n links, C++ beside C++.

Everyone computes the derivatives of accelerations by angles, rates and torques in the joints:
pendcore for the angles of links, Pinocchio for those of joints.
"""

from __future__ import annotations

import time
from typing import Any

import mpmath  # type: ignore[import-untyped]
import numpy as np
from cases import Array
from contenders.programs import Calls
from dense_chain import DenseChain
from forward_dynamics import ChainScene, chain_scene, contenders, disagreement, facts
from machine import circumstances
from measure import interleave
from record import Record

LENGTHS = (2, 7, 30)
BURST_SECONDS = 2e-3
SCENES = range(1, 11)
"""Seeds of the scenes whose derivatives are compared; the first is timed."""
DIGITS = 40
OURS = "_derivatives"


def many_digits(numbers: Array) -> Any:
    return np.vectorize(mpmath.mpf, otypes=[object])(numbers)


def derivatives(scene: ChainScene, *, at_joints: bool) -> Array:
    """Differentiate the dense equations in many digits, at the scene's first state: (3, n, n).

    sum_j A_ij (cos(q_i - q_j) qdd_j + sin(q_i - q_j) qd_j^2) = a_i g cos q_i + tau_i - tau_{i+1}
    """
    n = len(scene.masses)
    with mpmath.workdps(DIGITS):
        q, qd = many_digits(scene.q[0]), many_digits(scene.qd[0])
        if at_joints:  # whose angles and rates are rounded as well
            q, qd = (many_digits(np.diff(x, prepend=0.0)) for x in (scene.q[0], scene.qd[0]))
            q, qd = np.cumsum(q), np.cumsum(qd)
        masses, lengths = many_digits(scene.masses), many_digits(scene.lengths)
        chain = DenseChain(masses=masses, lengths=lengths, gravity=scene.gravity)
        matrix, apart = chain.couplings, q[:, None] - q[None, :]
        weights = chain.moments * mpmath.mpf(scene.gravity)
        sine, cosine = (np.vectorize(f, otypes=[object]) for f in (mpmath.sin, mpmath.cos))
        c, s = matrix * cosine(apart), matrix * sine(apart)
        inverse = np.array(mpmath.inverse(mpmath.matrix(c.tolist())).tolist(), dtype=object)
        qdd = inverse @ (weights * cosine(q) - s @ qd**2)
        by_q = c * qd**2 - s * qdd  # of what the equation lacks, by the other links' angles
        by_q += np.diag(-weights * sine(q) - by_q.sum(axis=1))
        by_torques = np.eye(n) - np.eye(n, k=1)
        found = inverse @ np.array([by_q, -2 * s * qd, by_torques])
        if at_joints:  # each angle less that of the link before
            found = by_torques.T @ found
            found[:2] = found[:2] @ np.tri(n)
    return found.astype(np.float64)


def prepare() -> tuple[dict[tuple[str, int], Calls], dict[tuple[str, int], float], dict[str, Any]]:
    """Prepare the calls; return how far each is off, and who they are."""
    calls: dict[tuple[str, int], Calls] = {}
    errors: dict[tuple[str, int], float] = {}
    entrants = [one for one in contenders() if one.name.endswith(OURS)]
    for n in LENGTHS:
        for seed in SCENES:
            scene = chain_scene(n, seed=seed)
            known = [derivatives(scene, at_joints=joints) for joints in (False, True)]
            for who in entrants:
                key = (who.name.removesuffix(OURS), n)
                one = who.prepare(scene)
                calls.setdefault(key, one)
                found = np.hsplit(one.outcome().reshape(n, 3 * n), 3)
                off = max(map(disagreement, found, known[who.name.startswith("pinocchio")]))
                errors[key] = max(off, errors.get(key, 0.0))
    return calls, errors, {who.name.removesuffix(OURS): facts(who) for who in entrants}


def measure(*, quick: bool, rounds: int) -> Record:
    """Measure everything that is here."""
    del quick  # it is quick
    begin = time.perf_counter()
    calls, errors, entrants = prepare()
    timings = interleave(calls, rounds, BURST_SECONDS, what="derivatives")
    return Record.of(
        {"comparison": "derivatives", **circumstances(begin, rounds, BURST_SECONDS)},
        entrants,
        {str(n): {"n": n} for n in LENGTHS},
        [
            {"contender": who, "case": str(n), **timing.row("ns", 1e9), "error": errors[who, n]}
            for (who, n), timing in timings.items()
        ],
    )
