"""Whether `simulate(error=...)` keeps what it was asked for, and what that costs.

    make asked-errors

On 200 random regular scenes, it measures the error against another method's most accurate run. It
compares the right-hand sides with those of the best of all methods and tolerances swept, and then
the times of the two in turns. It writes docs/records/asked_errors.json and the table of
docs/background/accuracy_cost.md. tests/accuracy/test_asked_errors.py runs the same without the
clock.
"""

from __future__ import annotations

import json
import random
import sys
from collections.abc import Iterable
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
import pendcore as pc

ROOT = Path(__file__).parents[2]
sys.path += [str(ROOT / "tests"), str(ROOT / "tests/models")]
from regular_scenes import Regular, regular  # noqa: E402

SCENES = range(1000, 1200)
"""Seeds other than those that served to choose the numbers in `accuracy/method_choice.py`."""
ROUNDS = 30
BEGIN, END = "<!-- asked: begin -->\n", "<!-- asked: end -->"
# The table has a row for each of these: its words, its key, and the goal, where there is one.
ROWS: list[tuple[str, str, float | None]] = [
    ("true error / asked", "error", 1.0),
    ("work of the run / best of the sweep", "run", None),
    ("the same with its verification", "verified", 3.5),
    ("the same with all that it took to choose", "all", None),
    ("time of the run / best of the sweep", "run_time", None),
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
    """Time the run that was chosen, the best of the sweep and the whole call in turns."""
    case = one.run(error=one.error).case().options
    chosen = {key: case[key] for key in ("method", "rtol", "atol") if key in case}
    method, rtol, _, _ = one.cheapest()
    ways: dict[str, dict[str, Any]] = {
        "best": {"method": method, "rtol": rtol, "atol": rtol / 1000},
        "run": chosen,
        "all": {"error": one.error},
    }
    times = one.times
    seconds: dict[str, list[float]] = {name: [] for name in ways}
    for number in range(ROUNDS):
        for name in random.Random(number).sample([*ways], len(ways)):
            begin = perf_counter()
            pc.simulate(*one.arguments, t_eval=times, progress=False, **ways[name])
            seconds[name].append(perf_counter() - begin)
    best = min(seconds["best"])
    return {"run_time": min(seconds["run"]) / best, "all_ms": 1e3 * min(seconds["all"])}


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
