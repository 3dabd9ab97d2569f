"""Whether `simulate(error=...)` keeps what it was asked for, and what that costs.

    make asked-errors

On 200 random regular scenes, it measures the error against another method's most accurate run. It
compares the right-hand sides with those of the best of all methods and tolerances swept, and then
the times in turns: of the best run, of the run that was chosen, of that run with its verification,
and of the whole call. It writes docs/records/asked_errors.json and the table of
docs/background/accuracy_cost.md. tests/accuracy/test_asked_errors.py runs the same without the
clock.
"""

from __future__ import annotations

import json
import random
import sys
from collections.abc import Callable, Iterable
from functools import partial
from math import inf
from pathlib import Path
from time import perf_counter
from typing import Any, TypeAlias

import numpy as np
from pendcore.accuracy.defect_correction import Way, correction_along, ways
from pendcore.accuracy.trials import COMPENSATED_BELOW, leading
from pendcore.run.accuracy import DEFECT, Paid
from pendcore.run.call import Choice, Start, atol_beside, run
from pendcore.run.methods import error_over_rtol

ROOT = Path(__file__).parents[2]
sys.path += [str(ROOT / "tests"), str(ROOT / "tests/models")]
from regular_scenes import Regular, regular  # noqa: E402

SCENES = range(1000, 1200)
"""Seeds other than those that served to choose the numbers in `accuracy/method_choice.py`."""
ROUNDS = 30
Timed: TypeAlias = Callable[..., object]
BEGIN, END = "<!-- asked: begin -->\n", "<!-- asked: end -->"
# The table has a row for each of these: its words, its key, and the goal, where there is one.
ROWS: list[tuple[str, str, float | None]] = [
    ("true error / asked", "error", 1.0),
    ("time of the run / best of the sweep", "run_time", None),
    ("time of the run with its verification / best", "verified_time", 3.5),
    ("work of the run / best of the sweep", "run", None),
    ("work of the run with its verification / best", "verified", None),
    ("work of all that it took / best", "all", None),
    ("time of the whole call, ms", "all_ms", None),
]


def outcome(one: Regular) -> dict[str, Any]:
    """Ask for the error of a scene; return error and work as multiples of error asked and best."""
    solution = one.run(error=one.error)
    told = solution.accuracy
    assert told is not None
    best = one.cheapest()[3]
    run, verify = told.work("run"), told.work("verify")
    return {
        "asked": one.error,
        "method": solution.method,
        "error": one.error_of(solution) / one.error,
        "told": told.achieved / one.error,
        "run": run / best,
        "verified": (run + verify) / best,
        "all": told.work() / best,
    }


def times(one: Regular) -> dict[str, float]:
    """Time the best run of the sweep, the run that was chosen, the same verified, and the call."""
    scene, q0, qd0, span = one.arguments
    start = Start(scene, q0, qd0, *span)
    told = one.run(error=one.error).accuracy
    assert told is not None
    timed = {
        f"best {method}": again(start, method, rtol, one) for method, rtol in best_of_each(one)
    }
    chosen = next(paid for paid in told.paid if paid.purpose == "run")
    timed["run"] = again(start, chosen.method, chosen.rtol, one)
    verify = [paid for paid in told.paid if paid.purpose == "verify"]
    seconds = {
        f"second {i}": again(start, paid.method, paid.rtol, one) for i, paid in enumerate(verify)
    }
    if verify[0].method.startswith(DEFECT):
        seconds = {}
        timed["verified"] = with_correction(start, chosen, verify[0].nfev, one)
    timed |= seconds
    timed["all"] = partial(one.run, error=one.error)
    least = least_times(timed)
    verified = least.get("verified", least["run"]) + sum(least[name] for name in seconds)
    best = min(seconds for name, seconds in least.items() if name.startswith("best"))
    return {
        "run_time": least["run"] / best,
        "verified_time": verified / best,
        "all_ms": 1e3 * least["all"],
    }


def best_of_each(one: Regular) -> list[tuple[str, float]]:
    """Return the loosest run of each method that keeps the error: one of them is the fastest."""
    loosest: dict[str, float] = {}
    for method, rtol, error, _ in one.sweep:
        if error <= one.error:
            loosest[method] = max(rtol, loosest.get(method, 0.0))
    return [*loosest.items()]


def again(start: Start, method: str, rtol: float, one: Regular) -> Timed:
    choice = Choice(method, rtol, atol_beside(rtol), compensated=rtol < COMPENSATED_BELOW)
    return partial(run, start, choice, one.times)


def with_correction(start: Start, chosen: Paid, nfev: int, one: Regular) -> Timed:
    """Return the run that was chosen, with the correction that took so many right-hand sides."""
    alone = again(start, chosen.method, chosen.rtol, one)
    scale = chosen.rtol * error_over_rtol(leading(chosen.method))

    def both(way: Way) -> int:
        correction = correction_along(start, way, scale)
        alone(correction=correction)
        return correction.nfev

    return partial(both, next(way for way in ways(start, one.error) if both(way) == nfev))


def least_times(timed: dict[str, Timed]) -> dict[str, float]:
    """Time all of them in turns."""
    least = dict.fromkeys(timed, inf)
    for number in range(ROUNDS):
        for name in random.Random(number).sample([*timed], len(timed)):
            begin = perf_counter()
            timed[name]()
            least[name] = min(least[name], perf_counter() - begin)
    return least


def table(found: list[dict[str, Any]]) -> str:
    """Return the table of the page."""
    lines = [
        "| of 200 scenes | median | 90 % | 97 % | all | goal, for all | kept by |",
        "|---|--:|--:|--:|--:|--:|--:|",
    ]
    for what, key, goal in ROWS:
        numbers = [one[key] for one in found]
        cells = [f"{x:.2f}" for x in np.percentile(numbers, [50, 90, 97, 100])]
        if goal is None:
            cells += ["", ""]
        else:
            kept = np.mean([x <= goal for x in numbers])
            cells += [f"{goal:g}", f"{100 * kept:.1f} %"]
        lines.append(f"| {what} | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def with_progress(scenes: Iterable[int]) -> Iterable[int]:
    from tqdm import tqdm

    return tqdm(scenes, unit="scene", disable=not sys.stderr.isatty())


def main() -> None:
    found = []
    for seed in with_progress(SCENES):
        one = regular(seed)
        found.append(outcome(one) | times(one))
    (ROOT / "docs/records/asked_errors.json").write_text(json.dumps(found, indent=1) + "\n")
    page = ROOT / "docs/background/accuracy_cost.md"
    before, _, rest = page.read_text().partition(BEGIN)
    page.write_text(before + BEGIN + table(found) + END + rest.partition(END)[2])
    print(table(found))


if __name__ == "__main__":
    main()
