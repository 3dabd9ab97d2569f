"""The comparison of chains: time and memory of a right-hand side of n links, C++ beside C++."""

from __future__ import annotations

import time

import numpy as np
from chain_scenes import Array, ChainScene, chain_scene
from contenders.contender import Unsupported
from contenders.forward_dynamics import Calls, ForwardDynamics, contenders
from machine import circumstances
from measure import Timing, interleave
from record import Point, Record
from tqdm import tqdm

LENGTHS = (2, 3, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000)
QUICK_LENGTHS = (2, 10, 100, 500)
BURST_SECONDS = 2e-3
CHECKED_UP_TO = 200  # links; beyond, the dense solution is no better than what it checks
ALLOWED_DISAGREEMENT = 1e-6  # relative angles are badly conditioned in long chains


def accelerations(scene: ChainScene) -> Array:
    """Solve the dense equations of the documents for qdd (n,) at the scene's first state.

    sum_j A_ij cos(q_i - q_j) qdd_j + sum_j A_ij sin(q_i - q_j) qd_j^2 = a_i g cos q_i
    """
    masses, lengths, q, qd = scene.masses, scene.lengths, scene.q[0], scene.qd[0]
    beyond = np.append(np.cumsum(masses[::-1])[::-1][1:], 0.0)
    moments = lengths * (masses / 2 + beyond)
    links = np.arange(len(masses))
    matrix = lengths[np.minimum.outer(links, links)] * moments[np.maximum.outer(links, links)]
    matrix[links, links] = lengths**2 * (masses / 3 + beyond)
    apart = q[:, None] - q[None, :]
    forces = moments * scene.gravity * np.cos(q) - (matrix * np.sin(apart)) @ qd**2
    return np.linalg.solve(matrix * np.cos(apart), forces)


def disagreement(found: Array, known: Array) -> float:
    """Return the largest difference as a share of the largest acceleration."""
    return float(np.abs(found - known).max() / np.abs(known).max())


def nanoseconds(timing: Timing) -> Point:
    return {
        "minimum_ns": 1e9 * timing.minimum,
        "median_ns": 1e9 * timing.median,
        "calls": timing.calls,
    }


def row_of(contender: str, case: str, timing: Timing, calls: Calls, error: float | None) -> Point:
    named = {"contender": contender, "case": case, **nanoseconds(timing)}
    return {**named, "bytes": calls.bytes(), "disagreement": error}


def prepare(
    entrants: list[ForwardDynamics], lengths: tuple[int, ...]
) -> tuple[dict[tuple[str, int], Calls], dict[tuple[str, int], float], dict[str, str]]:
    """Prepare all calls. Return how far each is from the dense equations, and why some stop."""
    calls: dict[tuple[str, int], Calls] = {}
    errors: dict[tuple[str, int], float] = {}
    stops: dict[str, str] = {}
    for n in lengths:
        scene = chain_scene(n)
        known = accelerations(scene) if n <= CHECKED_UP_TO else None
        for contender in entrants:
            if contender.name in stops:
                continue
            try:
                one = contender.prepare(scene)
            except Unsupported as reason:
                stops[contender.name] = f"stops before n = {n}: {reason}"
                continue
            calls[contender.name, n] = one
            if known is not None and not contender.name.endswith("_step"):
                error = disagreement(one.accelerations(), known)
                if not error <= ALLOWED_DISAGREEMENT:
                    raise RuntimeError(
                        f"{contender.label}, n = {n}: off by {error:.1e} of the largest "
                        "acceleration; no time is worth noting for a wrong answer"
                    )
                errors[contender.name, n] = error
    return calls, errors, stops


def measure(*, quick: bool, rounds: int) -> Record:
    """Measure everything that is here."""
    begin = time.perf_counter()
    lengths = QUICK_LENGTHS if quick else LENGTHS
    with contenders() as found:
        entrants = [one for one in found if not one.name.endswith(("_run", "_kernel"))]
        calls, errors, stops = prepare(entrants, lengths)
        bar = tqdm(range(rounds), desc="chains", unit="round", disable=None)
        timings = interleave(calls, bar, BURST_SECONDS)
        rows = [
            row_of(who.name, str(n), timings[key], calls[key], errors.get(key))
            for who in entrants
            for n in lengths
            if (key := (who.name, n)) in timings
        ]
    return Record.of(
        {"comparison": "chains", **circumstances(begin, rounds, BURST_SECONDS)},
        {who.name: {**who.facts(), "stops": stops.get(who.name)} for who in entrants},
        {str(n): {"n": n} for n in lengths},
        rows,
    )
