"""A solution in a few lines, as text and as HTML."""

from __future__ import annotations

from collections import Counter

import numpy as np

from pendcore._cases.case import has_own_functions
from pendcore._messages.arguments import Floats, listed
from pendcore._messages.html import beside, drawing, table
from pendcore._run.curve import curve_of, span_of
from pendcore._run.dense_output import with_dense_output
from pendcore._run.solution import Solution
from pendcore._views.energy_drift import energy_drift
from pendcore.methods import evaluations

_POSES = 6
"""The number of poses in a drawing of a run."""
_POINTS, _STEPS, _TURN = 1000, 250, 0.2
"""The most points of the tip's path and the most steps; by how much links turn from one point to
the next, rad, which nobody sees in a drawing of this size."""
_QUICK = 200_000
"""The product of right-hand sides and links up to which a run is simulated anew for a drawing."""
_MANY = 4000
"""With more times than this, a repr computes the energy at some of them only."""


def text(solution: Solution) -> str:
    """Return lines that say what was run, how it ended and where."""
    rows = _rows(solution)
    width = max(len(name) for name, _ in rows)
    return "\n".join(["Solution", *(f"  {name:{width}}  {value}" for name, value in rows)])


def html(solution: Solution) -> str:
    """Return these lines as an HTML table, beside a drawing of the run."""
    rows = table(_rows(solution))
    dense = _with_dense_output(solution)
    if dense is None:
        count = len(solution.t)
        k = np.unique(np.linspace(0, count - 1, min(count, _POSES)).round().astype(np.intp))
        poses = _places(solution, solution.t[k], solution._run.states[k])
    else:
        t = np.linspace(*span_of(solution), _POSES)
        poses = _places(solution, t, dense._run.evaluate(t))
    if not len(poses):
        return rows
    many = f"{len(poses)} times, the last of them plainest"
    title = f"the chain at {many if len(poses) > 1 else 'one time'}"
    if dense is None:
        return beside(rows, drawing(poses, None, title))
    t, states, _ = curve_of(dense, _TURN, _POINTS // 4, _STEPS)
    t, path = t[-_POINTS:], _places(solution, t[-_POINTS:], states[-_POINTS:])[:, -1]
    last = "" if t[0] == span_of(solution)[0] else f" in the last {abs(t[-1] - t[0]):.3g} s"
    return beside(rows, drawing(poses, path, f"{title}, and the path of its tip{last}"))


def _with_dense_output(solution: Solution) -> Solution | None:
    """Return a run that has a state at any time, or None.

    A notebook that shows a run waits for no long one, and calls no function of the user's.
    """
    work = solution.stats.nfev * len(solution.scene.links)
    if solution.store != "dense" and (work > _QUICK or has_own_functions(solution)):
        return None
    try:
        return with_dense_output(solution)
    except ValueError:  # it cannot be had again
        return None


def _places(solution: Solution, t: Floats, states: Floats) -> Floats:
    """Return the places of a chain where its states are finite, m, (k, n+1, 2)."""
    right = np.isfinite(states).all(axis=1)
    q = np.ascontiguousarray(states[right, : len(solution.scene.links)])
    return solution.scene._compiled.positions(t[right], q)


def outcome(status: str, message: str) -> str:
    """Return status and message, without the status twice."""
    return message if message.startswith(f"{status}:") else f"{status}: {message}"


def _rows(solution: Solution) -> list[tuple[str, str]]:
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
    of_some = f" (of one time in {every})" if every > 1 else ""
    drift, *trust = str(energy_drift(solution, every)).split("; ")
    rows.append(("energy", f"drift {drift}{of_some}"))
    rows += [("", told) for told in trust]
    return rows


def _evaluations(solution: Solution) -> str:
    return evaluations(solution.method, solution._run.last_method, solution.stats.nfev)


def _effects(solution: Solution) -> str:
    """Return the kinds, and how many of each there are."""
    count = Counter(effect.kind for effect in solution.scene.effects)
    return ", ".join(kind if k == 1 else f"{kind} ({k})" for kind, k in count.items())
