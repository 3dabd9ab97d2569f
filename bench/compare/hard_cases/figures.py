"""THE list of the figures: a case with a figure is a line here; its file draws the record."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
from matplotlib.figure import Figure

from hard_cases import bounces_figure, held_rod_figure, two_joints_figure, two_roots_figure

FIGURES: dict[str, Callable[[Any], Figure]] = {
    "held_rod": held_rod_figure.drawn,
    "two_joints": two_joints_figure.drawn,
    "bounces": bounces_figure.drawn,
    "two_roots": two_roots_figure.drawn,
}


def draw(record: dict[str, Any], folder: Path) -> None:
    """Draw the figures of the cases that the record has, as hard_cases_<name>.png."""
    for case in record["cases"]:
        if case["name"] in FIGURES:
            folder.mkdir(exist_ok=True)
            figure = FIGURES[case["name"]](case)
            figure.savefig(folder / f"hard_cases_{case['name']}.png", dpi=160)
            plt.close(figure)
