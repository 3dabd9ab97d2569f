"""Whether `simulate(error=...)` keeps what it was asked for, and what that costs.

    make write PAGE=asked_errors

On 200 random regular scenes, it measures the error against another method's most accurate run. It
compares the work with that of the best of all methods and tolerances swept. Then it times, in
turns, the best run, the run that was chosen, that run with its verification, and the whole call. It
writes docs/records/asked_errors.json and the table of docs/background/accuracy_cost.md.
tests/accuracy/test_asked_errors.py runs the same without the clock.
"""

from __future__ import annotations

import json
import random
import sys
from collections.abc import Callable, Hashable
from functools import partial
from math import inf
from time import perf_counter
from typing import Any, TypeAlias, TypeVar

import numpy as np
import pendcore as pc
from page_part import ROOT, rewrite, table_of
from pendcore import _core
from pendcore._accuracy.strategies import strategies
from pendcore._accuracy.target_error import search
from pendcore._accuracy.trials import TrialRun, Trials
from pendcore._run.call import Choice, Start, run
from pendcore.options import OPTIONS, atol_beside

sys.path += [str(ROOT / "tests"), str(ROOT / "tests/models")]
from regular_scenes import Regular, regular

SCENES = range(1000, 1200)
"""Seeds other than those that served to choose the numbers in `accuracy/method_choice.py`."""
ROUNDS = 30
KNOWN_TO_CORE = [OPTIONS[told["name"]] for told in _core.run_options()]
OPTIONS_OF_TRIALS = {one.name: one.default for one in KNOWN_TO_CORE if not one.chosen_for_error}
Timed: TypeAlias = Callable[..., object]
Key = TypeVar("Key", bound=Hashable)
# The table has a row for each of these: its words, its key, and the goal, where there is one: a
# number and the least share of the scenes that keep it.
ROWS: list[tuple[str, str, tuple[float, float] | None]] = [
    ("true error / asked", "error", (1.0, 1.0)),
    ("time of the run / best of the sweep", "run_time", None),
    ("time of the run with its verification / best", "verified_time", (3.5, 0.97)),
    ("the same", "verified_time", (6.0, 1.0)),
    ("time of the verification / run", "verification", None),
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
    scene, span, q0, qd0 = one.arguments
    start = Start(scene, q0, qd0, *span)
    options = OPTIONS_OF_TRIALS | {"t_eval": one.times}
    runs = Trials(start, one.error, options, None, strategies(start, one.error))
    solution = search(runs)
    assert isinstance(solution, pc.Solution)
    chosen = next(made for made in runs.paid if made.solution is solution)
    timed: dict[str, Timed] = {
        f"best {method}": partial(run, start, Choice(method, rtol, atol_beside(rtol)), one.times)
        for method, rtol in loosest_of_each(one)
    }
    best = [*timed]
    timed["run"] = again(start, chosen)
    if runs.strategy.verify(runs, chosen) is solution.known_error and runs.strategy.method:
        verified = ["verified"]
        rerun, watch = again(start, chosen), partial(runs.strategy.correction, start, chosen.scale)
        timed["verified"] = lambda: rerun(watch=watch())  # each run has a watch of its own
    else:
        seconds = {f"second {i}": again(start, made) for i, made in enumerate(runs.seconds)}
        timed |= seconds
        verified = ["run", *seconds]
    timed["all"] = partial(one.run, error=one.error)
    least = least_times(timed, ROUNDS)
    fastest = min(least[name] for name in best)
    return {
        "run_time": least["run"] / fastest,
        "verified_time": sum(least[name] for name in verified) / fastest,
        "verification": sum(least[name] for name in verified) / least["run"] - 1,
        "all_ms": 1e3 * least["all"],
    }


def loosest_of_each(one: Regular) -> list[tuple[str, float]]:
    """Return each method with the loosest rtol that kept the error."""
    loosest: dict[str, float] = {}
    for method, rtol, error, _ in one.sweep:
        if error <= one.error:
            loosest[method] = max(rtol, loosest.get(method, 0.0))
    return [*loosest.items()]


def again(start: Start, made: TrialRun) -> Timed:
    """Return what makes a run of the search once more."""
    asked = made.solution._run.arguments
    choice = Choice(made.method, made.rtol, atol_beside(made.rtol), asked["compensated"])
    return partial(run, start, choice, asked["t_eval"], max_step=asked["max_step"])


def least_times(timed: dict[Key, Timed], rounds: int) -> dict[Key, float]:
    """Return the least time of each, s; they take turns."""
    least = dict.fromkeys(timed, inf)
    for number in range(rounds):
        for name in random.Random(number).sample([*timed], len(timed)):
            begin = perf_counter()
            timed[name]()
            least[name] = min(least[name], perf_counter() - begin)
    return least


def table(found: list[dict[str, Any]]) -> str:
    """Return the table of the page."""
    rows = []
    for what, key, goal in ROWS:
        numbers = [one[key] for one in found]
        cells = [f"{x:.2f}" for x in np.percentile(numbers, [0, 50, 90, 97, 100])]
        if goal is None:
            cells += ["", ""]
        else:
            most, of_all = goal
            kept = np.mean([x <= most for x in numbers])
            cells += [f"{most:g} in {of_all:.0%}", f"{kept:.1%}"]
        rows.append([what, *cells])
    heads = ["of 200 scenes", "least", "median", "90 %", "97 %", "largest", "goal", "kept by"]
    return table_of(heads, rows)


def main() -> None:
    from tqdm import tqdm

    found = []
    for seed in tqdm(SCENES, unit="scene", disable=None):
        one = regular(seed)
        found.append(outcome(one) | times(one))
    (ROOT / "docs/records/asked_errors.json").write_text(json.dumps(found, indent=1) + "\n")
    rewrite(ROOT / "docs/background/accuracy_cost.md", asked=table(found))
    print(table(found))


if __name__ == "__main__":
    main()
