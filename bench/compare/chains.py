"""The comparison of chains: time and memory of a right-hand side of n links, C++ beside C++."""

from __future__ import annotations

import time

import numpy as np
from cases import Array
from contenders.contender import Contender, Unsupported
from contenders.programs import Calls
from dense_chain import DenseChain
from forward_dynamics import ChainScene, chain_scene, contenders, disagreement, facts
from machine import circumstances
from measure import interleave
from record import Record

LENGTHS = (2, 3, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000)
QUICK_LENGTHS = (2, 10, 100, 500)
BURST_SECONDS = 2e-3
CHECKED_UP_TO = 200  # links; beyond, the dense solution is no better than what it checks
ALLOWED_DISAGREEMENT = 1e-6  # relative angles are badly conditioned in long chains


def accelerations(scene: ChainScene) -> Array:
    """Solve the dense equations of the documents for qdd (n,) at the scene's first state."""
    chain = DenseChain(masses=scene.masses, lengths=scene.lengths, gravity=scene.gravity)
    q, qd = scene.q[0], scene.qd[0]
    return np.linalg.solve(chain.mass_matrix(q), chain.forces(q, qd, np.zeros(chain.n)))


def prepare(
    entrants: list[Contender], lengths: tuple[int, ...]
) -> tuple[dict[tuple[str, int], Calls], dict[tuple[str, int], float], dict[str, str]]:
    """Prepare all calls. Return how far each is from the dense equations, and why some stop."""
    calls: dict[tuple[str, int], Calls] = {}
    errors: dict[tuple[str, int], float] = {}
    stops: dict[str, str] = {}
    for n in lengths:
        scene = chain_scene(n)
        known = accelerations(scene) if n <= CHECKED_UP_TO else None
        for who in entrants:
            if who.name in stops:
                continue
            try:
                one = calls[who.name, n] = who.prepare(scene)
            except Unsupported as reason:
                stops[who.name] = f"stops before n = {n}: {reason}"
                continue
            if known is not None and not who.name.endswith("_step"):
                error = errors[who.name, n] = disagreement(one.outcome(), known)
                if not error <= ALLOWED_DISAGREEMENT:
                    raise RuntimeError(
                        f"{who.label}, n = {n}: off by {error:.1e} of the largest "
                        "acceleration; no time is worth noting for a wrong answer"
                    )
    return calls, errors, stops


def measure(*, quick: bool, rounds: int) -> Record:
    """Measure everything that is here."""
    begin = time.perf_counter()
    lengths = QUICK_LENGTHS if quick else LENGTHS
    others = ("_run", "_kernel", "_derivatives")
    entrants = [one for one in contenders() if not one.name.endswith(others)]
    calls, errors, stops = prepare(entrants, lengths)
    timings = interleave(calls, rounds, BURST_SECONDS, what="chains")
    rows = [
        {"contender": who.name, "case": str(n), **timings[key].row("ns", 1e9)}
        | {"bytes": calls[key].bytes(), "disagreement": errors.get(key)}
        for who in entrants
        for n in lengths
        if (key := (who.name, n)) in timings
    ]
    return Record.of(
        {"comparison": "chains", **circumstances(begin, rounds, BURST_SECONDS)},
        {who.name: {**facts(who), "stops": stops.get(who.name)} for who in entrants},
        {str(n): {"n": n} for n in lengths},
        rows,
    )
