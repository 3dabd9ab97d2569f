"""A solution in a few lines, as text and as HTML."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from pendcore.messages.arguments import Floats
from pendcore.messages.html import beside, drawing, table
from pendcore.run.methods import known_methods
from pendcore.run.result import RunResult
from pendcore.views import energy_drift

_POSES, _MOST_POINTS = 6, 400
"""The poses in a drawing of a run, and the most points of the tip's path."""
_MANY = 4000
"""With more times than this, a repr computes the energy at some of them only."""


def text(solution: RunResult) -> str:
    """Return lines that say what was run, how it ended and where."""
    rows = _rows(solution)
    width = max(len(name) for name, _ in rows)
    return "\n".join(["Solution", *(f"  {name:{width}}  {value}" for name, value in rows)])


def html(solution: RunResult) -> str:
    """Return these lines as an HTML table, beside a drawing of the run."""
    rows = table(_rows(solution))
    t, q = solution.t, solution.q
    right = np.isfinite(q).all(axis=1)
    if not right.any():
        return rows
    finite = np.flatnonzero(right)
    some = finite[_spread(len(finite), _MOST_POINTS)]
    places = solution.scene._compiled.positions(t[some], np.ascontiguousarray(q[some]))
    chosen = _spread(len(places), _POSES)
    title = f"the chain at {len(chosen)} times, the last of them plainest, and the path of its tip"
    return beside(rows, drawing(places[chosen], places[:, -1], title))


def _spread(count: int, most: int) -> npt.NDArray[np.intp]:
    """Return numbers from 0 to count - 1, the first and the last among them, at most so many."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(np.intp))


def listed(values: Sequence[float] | Floats, most: int = 6) -> str:
    """Return numbers as people read them: six digits, and dots in place of the last of many."""
    some = [f"{x:.6g}" for x in values[:most]]
    return ", ".join([*some, "..."] if len(values) > most else some)


def outcome(status: str, message: str) -> str:
    """Return status and message, without the status twice."""
    return message if message.startswith(f"{status}:") else f"{status}: {message}"


def evaluations(method: str, last_method: str, nfev: int) -> str:
    """Return the number of evaluations: series of Taylor's method, right-hand sides of others."""
    known = known_methods()
    first = known[method]["first"] or method
    if not known[first]["dense_output_is_series"]:
        return f"{nfev} right-hand sides"
    if last_method != first:
        return f"{nfev} series and right-hand sides"
    return f"{nfev} series, each as long as many right-hand sides"


def _rows(solution: RunResult) -> list[tuple[str, str]]:
    n, t, stats = len(solution.scene.links), solution.t, solution.stats
    rows = [
        ("status", outcome(solution.status, solution.message)),
        ("scene", f"{n} link{'s'[: n > 1]}, gravity {solution.scene.gravity:.6g} m/s^2"),
        *([("effects", _effects(solution))] if solution.scene.effects else []),
        ("method", f"{solution.method}, {stats.accepted} steps, {_evaluations(solution)}"),
    ]
    if solution.accuracy is not None:
        rows.append(("accuracy", solution.accuracy.text()))
    if len(t):
        rows += [
            ("t", f"{t[0]:.6g} ... {t[-1]:.6g} s, {len(t)} kept"),
            ("last q", f"{listed(solution.q[-1])} rad"),
            ("last qd", f"{listed(solution.qd[-1])} rad/s"),
        ]
    every = -(-len(t) // _MANY) or 1
    drift = energy_drift.energy_drift(solution, every)._asdict()
    of_some = f" (of one time in {every})" if every > 1 else ""
    rows.append(("energy", "drift " + energy_drift.text(drift) + of_some))
    rows += [("", energy_drift.TOO_LARGE)] * drift["too_large"]
    return rows


def _evaluations(solution: RunResult) -> str:
    return evaluations(solution.method, solution.run.last_method, solution.stats.nfev)


def _effects(solution: RunResult) -> str:
    """Return the kinds, and how many of each there are."""
    count = Counter(effect.kind for effect in solution.scene.effects)
    return ", ".join(kind if k == 1 else f"{kind} ({k})" for kind, k in count.items())
