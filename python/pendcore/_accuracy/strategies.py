"""The strategies by which ``simulate(error=...)`` verifies a run, in the order of their use.

A trial is a run of what was asked for. From its defect its error is known for little more than the
run costs; where that does not tell, second runs do. Each strategy from the defect told too small an
error of at most 5 of 7,200 runs (seeds 200 to 999 of tests/models/regular_scenes.py, nine
tolerances); no search for an error returned one of these. Without any one of them, fewer of the 200
scenes that judge the price keep it (docs/generators/tuning.py).
"""

from __future__ import annotations

from pendcore import _core
from pendcore._accuracy.defect_correction import FromDefect
from pendcore._accuracy.second_runs import SecondRuns
from pendcore._accuracy.trials import Strategy
from pendcore._run.call import Start, supports

LARGE, LOOSE, MANY_POINTS_BELOW = 0.1, 1e-5, 1e-8
"""Errors asked for. A larger one than LARGE is left to second runs: from 0.2 on, a correction
counts as lost. Above LOOSE, dop853 takes less work where series are expensive. Below the last, a
series has so many terms that its error needs many points."""

FROM_DEFECT = (
    FromDefect(
        method="dop853", points=(9, 8), agree=0.1, share=1.0, errors=(LOOSE, LARGE),
        series_are_expensive=True,
    ),
    FromDefect(
        method="taylor", points=(6, 5), agree=0.15, share=0.35, errors=(MANY_POINTS_BELOW, LARGE)
    ),
    FromDefect(
        method="taylor", points=(7, 6), agree=0.2, share=0.35, errors=(MANY_POINTS_BELOW, LARGE)
    ),
    FromDefect(
        method="taylor", points=(8, 7), agree=0.2, share=0.25, errors=(0.0, MANY_POINTS_BELOW)
    ),
)  # fmt: skip


def strategies(start: Start, error: float) -> list[Strategy]:
    """Return the strategies for an error, the first one to be tried first.

    None takes the defect where a law switches or has no series, or where a joint may be held.
    """
    is_smooth = _core.has_defect_correction(start.scene._compiled) and supports("taylor", start)
    from_defect = [one for one in FROM_DEFECT if is_smooth and one.serves(start, error)]
    return [*from_defect, SecondRuns()]
