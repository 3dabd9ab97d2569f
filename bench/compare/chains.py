"""The comparison of chains: time and memory of a right-hand side of n links, C++ beside C++."""

from __future__ import annotations

import sys
import time
from typing import Any

import numpy as np
from chain_scenes import Array, ChainScene, chain_scene
from contenders.contender import Unsupported
from contenders.forward_dynamics import Calls, ForwardDynamics, contenders
from machine import circumstances
from measure import Timing, interleave
from tqdm import tqdm

LENGTHS = (2, 3, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000)
QUICK_LENGTHS = (2, 10, 100, 500)
BURST_SECONDS = 2e-3
CHECKED_UP_TO = 200  # links; beyond, the dense solution is no better than what it checks
ALLOWED_DISAGREEMENT = 1e-6  # relative angles are badly conditioned in long chains

Key = tuple[str, int]  # contender and links


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


def nanoseconds(timing: Timing) -> dict[str, float | int]:
    return {
        "minimum_ns": 1e9 * timing.minimum,
        "median_ns": 1e9 * timing.median,
        "calls": timing.calls,
    }


def prepare(
    entrants: list[ForwardDynamics], lengths: tuple[int, ...]
) -> tuple[dict[Key, Calls], dict[Key, float], dict[str, str]]:
    """Prepare all calls. Return how far each is from the dense equations, and why some stop."""
    calls: dict[Key, Calls] = {}
    errors: dict[Key, float] = {}
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


def measure(*, quick: bool, rounds: int) -> dict[str, Any]:
    """Measure everything that is here; return the record, with the machine, as JSON holds it."""
    with contenders() as found:
        entrants = [one for one in found if not one.name.endswith(("_run", "_kernel"))]
        return measure_these(entrants, quick, rounds)


def measure_these(entrants: list[ForwardDynamics], quick: bool, rounds: int) -> dict[str, Any]:
    begin = time.perf_counter()
    if not entrants:
        print("chains: nobody takes part", file=sys.stderr)
    lengths = QUICK_LENGTHS if quick else LENGTHS
    calls, errors, stops = prepare(entrants, lengths)
    bar = tqdm(range(rounds), desc="chains", unit="round", disable=None)
    timings = interleave(calls, bar, BURST_SECONDS)
    return {
        "comparison": "chains",
        **circumstances(begin, rounds, BURST_SECONDS),
        "contenders": [
            {
                "name": contender.name,
                "label": contender.label,
                "about": contender.about,
                "stops": stops.get(contender.name),
                "points": [
                    {
                        "n": n,
                        **nanoseconds(timings[contender.name, n]),
                        "bytes": calls[contender.name, n].bytes(),
                        "disagreement": errors.get((contender.name, n)),
                    }
                    for n in lengths
                    if (contender.name, n) in timings
                ],
            }
            for contender in entrants
        ],
    }
