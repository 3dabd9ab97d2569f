"""Which method is likely the cheapest for an error, and which methods verify a run.

The bounds below were measured on four hundred scenes of tests/models/regular_scenes.py (seeds 200
to 599); docs/generators/asked_errors.py tests others. Over the tolerances that matter the largest
position error of a run is proportional to rtol, by a factor that depends on the scene and the
method.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import floor, log10

import numpy as np

from pendcore._run.call import Start, supports
from pendcore._run.statistics import Statistics
from pendcore._run.work import series_work
from pendcore.methods import TIGHTEST, known_methods, most_accurate, pair_of

LOOSEST = 1e-2
"""The loosest rtol that is chosen."""
TIGHTEST_SECOND = {"taylor": 10 * float(np.finfo(np.float64).eps)}
"""The tightest rtol of a second run of ``taylor``, whose truncation is to be less than a trial's.
Rounding cannot mislead its step size, as it has no error estimate."""
SERIES_TO_DOP853 = 0.092
"""The typical number of series of taylor for each right-hand side of dop853, at rtol 1e-3."""
TAYLOR_BELOW = ((0.9, 5e-3), (1.08, 2e-5), (1.2, 1e-6), (1.6, 3e-6), (4.0, 1e-10))
"""Pairs: where taylor at 1e-3 takes up to this multiple of dop853's work, it takes less work than
the others for errors below this bound. Each row stands for a kind of scene that `series_work` tells
apart, so the bounds need not fall."""
DOPRI5_ABOVE, DOPRI5_ABOVE_IF_ONE_LINK = 3e-7, 1e-3
"""The errors above which dopri5 takes less work than dop853."""
_DIGITS = (1.0, 1.5, 2.0, 3.0, 5.0, 7.0)


def cheapest(start: Start, error: float) -> str:
    """Return the method that typically takes the least work for an error, if nothing is stiff."""
    share = SERIES_TO_DOP853 * series_work(start.scene, 1e-3)
    below = next((error for most, error in TAYLOR_BELOW if share <= most), 0.0)
    if error < below and supports("taylor", start):
        return "taylor"
    above = DOPRI5_ABOVE_IF_ONE_LINK if len(start.scene.links) == 1 else DOPRI5_ABOVE
    return "dopri5" if error > above else "dop853"


def rounded(rtol: float, tightest: float = TIGHTEST) -> float:
    """Return the next tolerance of few digits at or below a given one, within the bounds."""
    if not tightest < rtol < LOOSEST:
        return LOOSEST if rtol >= LOOSEST else tightest
    power = floor(log10(rtol) + 1e-9)
    digit = max((d for d in _DIGITS if d * 10.0**power <= rtol * 1.0001), default=1.0)
    return float(f"{digit}e{power}")


def leading(method: str) -> str:
    """Return the first method of a pair."""
    return str(known_methods()[method]["first"])


def same_or_other(method: str, stats: Statistics) -> str:
    """Return the method of a second run whose tolerance is to tell by how much it is better.

    It is the run's own: by how much another one is better could only be guessed, as a scene may
    suit one method and not another. Where most steps end at impacts and other breaks, the same
    method would take the same steps and make the same error in them; there it is another one.
    """
    if 2 * stats.limited_by_break > stats.accepted:
        return pair_of("dopri5" if leading(method) == "dop853" else "dop853")
    return method


def second_methods(start: Start, method: str, stiff: bool) -> Iterator[str]:
    """Yield the methods by which a run may be verified, the best one first.

    A wrong step size or coefficient of one method does not make the same error in another. Where
    stability limited the steps, an explicit method may take too many; then the method is implicit,
    perhaps the run's own.
    """
    known = known_methods()[method]
    begins, goes_on = known["first"], known["second"]
    methods: tuple[str, ...] = tuple(name for name in most_accurate() if name != begins)
    if stiff and goes_on:  # the second method made most of the run
        methods = (goes_on,)
    elif stiff:
        implicit = ("radau5", pair_of("dopri5"))
        methods = implicit[::-1] if begins == "radau5" else implicit
    yield from (name for name in methods if supports(name, start))
