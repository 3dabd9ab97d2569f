"""The comparison of whole solves: what accuracy costs, pendcore and its peers on one case."""

from __future__ import annotations

import sys
import time
from typing import Any

import contenders
from cases import Case, one_step, read_case
from contenders.contender import Contender, Run, Unsupported
from machine import circumstances
from measure import Timing, achieved, interleave
from tqdm import tqdm

ONE_STEP_TOLERANCE = 1e-6
BURST_SECONDS = 1e-3

Key = tuple[str, float | None]  # contender and tolerance; None for the call of one step


def ladder(per_decade: int) -> list[float]:
    """List tolerances from 1e-1 to 1e-13, the whole decades exact."""
    finer = [10.0 ** -(part / per_decade) for part in range(per_decade)]
    return [float(f"1e-{decade}") * share for decade in range(1, 13) for share in finer] + [1e-13]


def prepare(entrants: list[Contender], case: Case, tolerances: list[float]) -> dict[Key, Run]:
    """Prepare all runs of the contenders that carry the case; the others are named on stderr."""
    runs: dict[Key, Run] = {}
    for contender in entrants:
        try:
            runs |= {(contender.name, tol): contender.prepare(case, tol) for tol in tolerances}
            runs[contender.name, None] = contender.prepare(one_step(case), ONE_STEP_TOLERANCE)
        except Unsupported as reason:
            print(f"{contender.label}: left out: {reason}", file=sys.stderr)
    return runs


def microseconds(timing: Timing) -> dict[str, float | int]:
    return {
        "minimum_us": 1e6 * timing.minimum,
        "median_us": 1e6 * timing.median,
        "calls": timing.calls,
    }


def measure(name: str, *, quick: bool, rounds: int) -> dict[str, Any]:
    """Measure all there is, and say on what: the record, as JSON holds it."""
    begin = time.perf_counter()
    case, tolerances = read_case(name), ladder(1 if quick else 4)
    entrants = contenders.installed()
    runs = prepare(entrants, case, tolerances)
    points = {key: achieved(run, case) for key, run in runs.items() if key[1] is not None}
    bar = tqdm(range(rounds), desc="rounds", unit="round", disable=None)
    timed = {key: run for key, run in runs.items() if "failure" not in points.get(key, {})}
    timings = interleave(timed, bar, BURST_SECONDS)
    return {
        "case": case.name,
        **circumstances(begin, rounds, BURST_SECONDS),
        "contenders": [
            {
                "name": contender.name,
                "label": contender.label,
                "about": contender.about,
                "compile_seconds": contender.compile_seconds,
                "one_step": {
                    "evaluations": runs[contender.name, None].outcome().evaluations,
                    **microseconds(timings[contender.name, None]),
                },
                "points": [
                    {"tolerance": tol, **points[contender.name, tol]}
                    | (
                        microseconds(timings[key])
                        if (key := (contender.name, tol)) in timings
                        else {}
                    )
                    for tol in tolerances
                ],
            }
            for contender in entrants
            if (contender.name, None) in runs
        ],
    }
