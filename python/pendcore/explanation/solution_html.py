"""A solution as notebooks show it: its text as a table, beside a drawing of the run."""

from __future__ import annotations

import numpy as np

from pendcore import Solution
from pendcore.explanation.solution_text import rows_of
from pendcore.messages import Floats, beside, drawing, table
from pendcore.plotting.curve import curve_of, span_of

_POSES = 6
"""The number of poses in a drawing of a run."""
_POINTS, _STEPS, _TURN = 1000, 250, 0.2
"""The most points of the tip's path and the most steps; by how much links turn from one point to
the next, rad, which nobody sees in a drawing of this size."""
_QUICK = 200_000
"""The product of right-hand sides and links up to which a run is simulated anew for a drawing."""


def html(solution: Solution) -> str:
    """Return the lines that `print` shows as an HTML table, beside a drawing of the run."""
    rows = table(rows_of(solution))
    dense = _with_dense_output(solution)
    if dense is None:
        count = len(solution.t)
        k = np.unique(np.linspace(0, count - 1, min(count, _POSES)).round().astype(np.intp))
        poses = _places(solution, solution.t[k], solution.q[k])
    else:
        t = np.linspace(*span_of(solution), _POSES)
        poses = _places(solution, t, np.hsplit(dense(t).T, 2)[0])
    if not len(poses):
        return rows
    many = f"{len(poses)} times, the last of them plainest"
    title = f"the chain at {many if len(poses) > 1 else 'one time'}"
    if dense is None:
        return beside(rows, drawing(poses, None, title))
    t, q, _, _ = curve_of(dense, _TURN, _POINTS // 4, _STEPS)
    t, path = t[-_POINTS:], _places(solution, t[-_POINTS:], q[-_POINTS:])[:, -1]
    last = "" if t[0] == span_of(solution)[0] else f" in the last {abs(t[-1] - t[0]):.3g} s"
    return beside(rows, drawing(poses, path, f"{title}, and the path of its tip{last}"))


def _with_dense_output(solution: Solution) -> Solution | None:
    """Return a run that has a state at any time, or None.

    A notebook that shows a run waits for no long one, and calls no function of the user's.
    """
    work = solution.stats.nfev * len(solution.scene.links)
    if solution.store != "dense" and (work > _QUICK or solution.has_own_functions):
        return None
    try:
        return solution.with_dense_output()
    except ValueError:  # it cannot be had again
        return None


def _places(solution: Solution, t: Floats, q: Floats) -> Floats:
    """Return the places of a chain where its angles are finite, m, (k, n+1, 2)."""
    right = np.isfinite(q).all(axis=1)
    return solution.scene.positions(t[right], q[right])
