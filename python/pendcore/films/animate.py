"""Matplotlib's animation of runs, for notebooks and windows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from pendcore import Solution
from pendcore.films.stage import Choices, Stage
from pendcore.plotting import figure_of_pyplot

if TYPE_CHECKING:
    from matplotlib.animation import FuncAnimation


def animate(solutions: Sequence[Solution], names: Sequence[str], choices: Choices) -> FuncAnimation:
    """Return an animation; it must be kept as long as it is to move."""
    from matplotlib.animation import FuncAnimation

    width = 6.4 * (len(solutions) if choices.beside else 1)
    figure = figure_of_pyplot(figsize=(min(width, 16.0), 6.4 if choices.energy else 5.4))
    stage = Stage(solutions, figure, choices, names)
    return FuncAnimation(
        figure,
        stage.show,
        frames=len(stage.times),
        interval=1000.0 / choices.fps,
        blit=True,
        repeat=True,
    )
