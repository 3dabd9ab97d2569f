"""The dense output of a run that kept none: the run is simulated anew, bit for bit as it was."""

from __future__ import annotations

from typing import Any

import numpy as np

from pendcore import _core
from pendcore._messages.arguments import Floats
from pendcore._messages.handed_over import forget_inner_runs
from pendcore._messages.warning import warn
from pendcore._run.call import resumed, run_again
from pendcore._run.solution import Solution

MOST_BYTES = 2**31
"""The largest dense output that is made for a run that was asked to keep less."""
ANOTHER_COURSE = (
    "simulated anew it takes another course: a function of its own depends on more than its "
    "arguments, or another version of pendcore made it"
)


def with_dense_output(solution: Solution) -> Solution:
    """See `Solution.with_dense_output`; what it raises has the words of ``sol(t)``."""
    return solution if solution.store == "dense" else _dense(solution)


def with_every_step(solution: Solution) -> Solution:
    """Return the run with dense output and all its steps, and both states at each jump."""
    is_so = solution.store == "dense" and solution.keeps_every_step
    return solution if is_so else _dense(solution, t_eval=None)


def _dense(solution: Solution, **changed: Any) -> Solution:
    dimension = 2 * len(solution.scene.links) + len(solution._run.ledger)
    size = 8 * solution.stats.accepted * (solution._run.dense_degree + 1) * dimension  # bytes
    if size > MOST_BYTES:
        given = f"{size / 2**30:.3g} GiB: must be at most {MOST_BYTES / 2**30:.3g}"
        raise _refusal(solution, f"made anew, that of all steps takes {given}: run a shorter span")
    again = simulated_anew(solution, store="dense", **changed)
    if not (ends_alike(again, solution) if changed else _is_the_same(again, solution)):
        raise _refusal(solution, ANOTHER_COURSE)
    return again


def simulated_anew(solution: Solution, **changed: Any) -> Solution:
    """Return the run as far as it came, whatever ended it, with another ``store`` or ``t_eval``."""
    try:
        return _simulated_anew(solution, changed)
    except BaseException as stop:
        forget_inner_runs(stop)
        raise


def _simulated_anew(solution: Solution, other: dict[str, Any]) -> Solution:
    whole = _attempts(solution)
    # A run that came to its end goes beyond its last attempt where everything rests. A run that
    # was broken off had begun another attempt, which is not repeated.
    most = whole + 1 if solution.success else max(whole, 1)
    changed: dict[str, Any] = {"max_steps": most, "time_limit": None}
    asked = solution._run.arguments
    if solution._run.t_reached == asked["t_start"]:  # it took no step, and none is to be taken
        changed |= {"t_end": asked["t_start"], "t_eval": solution.t if len(solution.t) else None}
    names = solution.sensitivity_names
    watch = _core.Sensitivities(solution.scene._compiled, list(names)) if names else None
    again = run_again(solution, watch, **changed | other)
    again.name = solution.name
    known = solution.sensitivities
    if watch is not None and known is not None:
        again.sensitivities, again.sensitivity_names = watch.values, names
        if watch.refusal and np.isfinite(known).all():  # it is news
            warn(watch.refusal)
    # A run that was resumed has passed events that end a run.
    while again.status == "event" and again._run.t_reached != solution._run.t_reached:
        most = max(whole + solution.success - _attempts(again), 1)
        again = resumed(again, again._run.arguments["t_end"], max_steps=most)
    return again


def _attempts(solution: Solution) -> int:
    return solution.stats.accepted + solution.stats.rejected


def ends_alike(again: Solution, solution: Solution) -> bool:
    """Whether two runs end at the same time and in the same state, to the bit."""
    one, other = again._run, solution._run
    return one.t_reached == other.t_reached and _bits(one.y_reached) == _bits(other.y_reached)


def _is_the_same(again: Solution, solution: Solution) -> bool:
    """Whether every bit that a run kept is there again."""
    one, other = again._run, solution._run
    same = ends_alike(again, solution)
    if solution.store == "end" or not len(other.t):
        return same
    return same and _bits(one.t) == _bits(other.t) and _bits(one.states) == _bits(other.states)


def _bits(numbers: Floats) -> bytes:
    return numbers.tobytes()


def _refusal(solution: Solution, reason: str) -> ValueError:
    """Return what the core says where it is asked for dense output, with a reason."""
    try:
        solution._run.evaluate(solution._run.t[:0])
    except ValueError as refused:
        return ValueError(f"{refused}; {reason}")
    return ValueError(f"dense output: {reason}")
