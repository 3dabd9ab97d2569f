"""Until when a run is right, in words: for the summary of `pendcore run`, and `pendcore trust`."""

from __future__ import annotations

from typing import NamedTuple

from pendcore import ErrorEstimate, Solution
from pendcore.explanation.solution_text import LIMIT

MOST_WORK, PATIENCE = 1_000_000, 10.0
"""The most right-hand sides of a run whose horizon is estimated unasked, and the time limit, s."""


class Horizon(NamedTuple):
    """Until when a run is right."""

    valid_until: float | None
    """s; None where it is not known."""
    sentence: str
    """The same in words, or why it is not known."""
    may_be_later: bool = False
    """Whether the estimate was stopped before it reached the limit of the error."""


def horizon_of(solution: Solution, estimate: ErrorEstimate, limit: float) -> Horizon:
    """Return the horizon of a run from an estimate of its error."""
    until = estimate.valid_until(limit)
    compared = float(estimate.t[-1]) if len(estimate.t) else estimate.begin
    if until != compared or estimate.is_lost:
        if solution.store == "end":
            return Horizon(None, "not known: wrong at its end, and no other time was kept")
        return Horizon(until, f"until t = {until:.6g} s, and lost after that")
    if not estimate.is_complete:
        return Horizon(until, f"at least until t = {until:.6g} s", may_be_later=True)
    if until == solution.t_reached:
        return Horizon(until, f"until its end, t = {until:.6g} s")
    return Horizon(until, f"until t = {until:.6g} s, the last time that was kept")


def unasked_horizon(solution: Solution) -> Horizon:
    """Return the horizon of a run if nobody has to wait long for it; else say what to ask.

    Second runs take a few times as long as the run.
    """
    ask = "`pendcore trust` tells"
    if solution.stats.nfev > MOST_WORK:
        return Horizon(None, f"not known: second runs take a while; {ask}")
    try:
        found = horizon_of(solution, solution.estimate_error(time_limit=PATIENCE), LIMIT)
    except KeyboardInterrupt:
        return Horizon(None, f"not known: interrupted; {ask}")
    except Exception as refusal:  # whatever stops second runs takes nothing from the first
        return Horizon(None, f"not known: {refusal}")
    if found.may_be_later:
        return Horizon(None, f"{found.sentence}; {ask} how much longer")
    return found
