"""What becomes of price and promise if a number of `pendcore._accuracy.tuning` is another.

    python docs/generators/tuning.py

Each number is halved and doubled, and each strategy is left out, on the 200 scenes by which
`asked_errors.py` judges. Work is counted, not timed. The table is written into
docs/background/accuracy_cost.md.
"""

from __future__ import annotations

from typing import Any
from unittest import mock

import asked_errors
import numpy as np
import pendcore as pc
from page_part import ROOT, rewrite
from pendcore._accuracy import strategies, tuning

RUNS_DO_NOT_DEPEND_ON = {"HOPELESS", "LATE", "LARGE_ANGLE", "MOST_SEARCHES"}
HEAD = """\
| changed | within 3.5 times | within 6 times | median | largest | largest true / told error |
|---|--:|--:|--:|--:|--:|
"""


def outcome(scene: Any) -> dict[str, Any]:
    """Return the outcome of a scene; a refusal is infinitely expensive."""
    try:
        return asked_errors.outcome(scene)
    except pc.AccuracyError:
        return {"verified": np.inf, "error": 0.0, "told": 1.0}


def judged(scenes: list[Any]) -> str:
    """Return the cells of a row: price and promise as they are now."""
    found = [outcome(one) for one in scenes]
    verified = np.array([one["verified"] for one in found])
    too_little = max(one["error"] / one["told"] for one in found)
    cells = [f"{np.mean(verified <= most):.1%}" for most in (3.5, 6)]
    cells += [f"{x:.2f}" for x in (np.median(verified), verified.max(), too_little)]
    return " | ".join(cells)


def table(scenes: list[Any]) -> str:
    """Return the rows of all changes that show, and the names of the numbers that never do."""
    usual = judged(scenes)
    text = HEAD + f"| nothing | {usual} |\n"
    silent = []
    for name, value in vars(tuning).items():
        if not name.isupper() or name in RUNS_DO_NOT_DEPEND_ON:
            continue
        rows = ""
        for factor in (0.5, 2.0):
            other = type(value)(value * factor)
            with mock.patch.object(tuning, name, other):  # those who count by it look it up
                if (cells := judged(scenes)) != usual:
                    rows += f"| `{name}` = {other:g}, not {value:g} | {cells} |\n"
        text += rows
        silent += [] if rows else [f"`{name}`"]
    return f"{text}\nNo difference: {', '.join(silent)}.\n"


def tables(scenes: list[Any]) -> str:
    """Return the table of all strategies, and that of second runs alone."""
    every = strategies.FROM_DEFECT
    whole = table(scenes)
    without = ""
    for left_out in every:
        others = tuple(one for one in every if one is not left_out)
        with mock.patch.object(strategies, "FROM_DEFECT", others):
            without += f"| no defect of {left_out.method}, {left_out.points} | {judged(scenes)} |\n"
    with mock.patch.object(strategies, "FROM_DEFECT", ()):
        alone = table(scenes)
    nothing, _, rest = whole.partition("\n| `")
    return f"{nothing}\n{without}| `{rest}\nWith second runs alone:\n\n{alone}"


def main() -> None:
    scenes = [asked_errors.regular(seed) for seed in asked_errors.SCENES]
    rewrite(ROOT / "docs/background/accuracy_cost.md", tuning=tables(scenes))


if __name__ == "__main__":
    main()
