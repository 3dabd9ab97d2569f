"""A solution in a few lines."""

from __future__ import annotations

from collections import Counter

from pendcore import Solution
from pendcore.messages import listed
from pendcore.methods import evaluations

_MANY = 4000
"""With more times than this, a repr computes the energy at some of them only."""


def text(solution: Solution) -> str:
    """Return lines that say what was run, how it ended and where."""
    rows = rows_of(solution)
    width = max(len(name) for name, _ in rows)
    return "\n".join(["Solution", *(f"  {name:{width}}  {value}" for name, value in rows)])


def rows_of(solution: Solution) -> list[tuple[str, str]]:
    """Return what the lines say, with the name of each."""
    n, t, stats = len(solution.scene.links), solution.t, solution.stats
    status, message = solution.status, solution.message
    called = evaluations(solution.method, solution.last_method, stats.nfev)
    rows = [
        ("status", message if message.startswith(f"{status}:") else f"{status}: {message}"),
        ("scene", f"{n} link{'s'[: n > 1]}, gravity {solution.scene.gravity:.6g} m/s^2"),
        *([("effects", _effects(solution))] if solution.scene.effects else []),
        ("method", f"{solution.method}, {stats.accepted} steps, {called}"),
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
    drift = solution.energy_drift(every)
    rows.append(("energy", f"drift {drift.in_words}{of_some}"))
    if drift.verdict:
        rows.append(("", drift.verdict))
    return rows


def _effects(solution: Solution) -> str:
    """Return the kinds, and how many of each there are."""
    count = Counter(effect.kind for effect in solution.scene.effects)
    return ", ".join(kind if k == 1 else f"{kind} ({k})" for kind, k in count.items())
