"""A solution in a few lines."""

from __future__ import annotations

from collections import Counter

from pendcore import Solution
from pendcore.messages import listed
from pendcore.methods import evaluations

LIMIT = 0.1
"""rad: a run is right until its error passes this, unless another limit is asked for."""
_MANY = 4000
"""With more times than this, a repr computes the energy at some of them only."""


def text(solution: Solution) -> str:
    """Return lines that say what was run, how it ended and where."""
    rows = rows_of(solution)
    width = max(len(name) for name, _ in rows)
    return "\n".join(["Solution", *(f"  {name:{width}}  {value}" for name, value in rows)])


def rows_of(solution: Solution) -> list[tuple[str, str]]:
    """Return what the lines say, with the name of each: what matters most comes first."""
    t, stats = solution.t, solution.stats
    status, message = solution.status, solution.message
    called = evaluations(solution.method, solution.last_method, stats.nfev)
    rows = [("status", message if message.startswith(f"{status}:") else f"{status}: {message}")]
    if len(t):
        rows.append(("t", f"{t[0]:.6g} ... {t[-1]:.6g} s, {len(t)} kept"))
    rows.append(("right", _right(solution)))
    every = -(-len(t) // _MANY) or 1
    of_some = f" (of one time in {every})" if every > 1 else ""
    drift = solution.energy_drift(every)
    rows.append(("energy", f"drift {drift.in_words}{of_some}"))
    if drift.verdict:
        rows.append(("", drift.verdict))
    if len(t):
        rows.append(("last q", f"{listed(solution.q[-1])} rad"))
        rows.append(("last qd", f"{listed(solution.qd[-1])} rad/s"))
    if solution.accuracy is not None:
        rows.append(("accuracy", solution.accuracy.text()))
    rows.append(("scene", _scene(solution)))
    rows.append(("method", f"{solution.method}, {stats.accepted:,} steps, {called}"))
    return rows


def _right(solution: Solution) -> str:
    """Return until when a run is right, if that is known, or how to find out."""
    known = solution.known_error
    if known is None:
        return "not estimated yet: sol.valid_until() does, by a second run"
    until, end = known.valid_until(LIMIT), solution.t_reached
    return f"to {LIMIT:g} rad {'to the end' if until == end else f'until {until:.4g} s'}"


def _scene(solution: Solution) -> str:
    """Return the links, gravity, and the kinds of effects, with how many of each there are."""
    scene, n = solution.scene, len(solution.scene.links)
    count = Counter(effect.kind for effect in scene.effects)
    kinds = [kind if k == 1 else f"{kind} ({k})" for kind, k in count.items()]
    return ", ".join([f"{n} link{'s'[: n > 1]}, gravity {scene.gravity:.6g} m/s^2", *kinds])
