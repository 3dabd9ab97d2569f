"""A solution as a table for spreadsheets."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from pendcore import Solution
from pendcore.messages import reporting

ROWS_AT_ONCE = 10_000
"""The number of rows of a CSV file between two reports of progress."""


def write_csv(solution: Solution, path: Path) -> None:
    """Write a row per time: t (s), q_1.. (rad), qd_1.. (rad/s), every number with all its digits.

    The first row names columns and units. A jump has two rows at one time.
    """
    links = range(1, len(solution.scene.links) + 1)
    names = ["t (s)", *(f"q_{i} (rad)" for i in links), *(f"qd_{i} (rad/s)" for i in links)]
    rows = np.column_stack([solution.t, solution.q, solution.qd])
    with (
        reporting(None, f"writing {path.name}") as report,
        path.open("w", newline="", encoding="utf-8") as file,
    ):
        writer = csv.writer(file)
        writer.writerow(names)
        for begin in range(0, len(rows), ROWS_AT_ONCE):
            writer.writerows(rows[begin : begin + ROWS_AT_ONCE].tolist())
            report(min(begin + ROWS_AT_ONCE, len(rows)) / len(rows))
