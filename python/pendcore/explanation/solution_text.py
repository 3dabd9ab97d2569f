"""A solution in a few lines."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np

from pendcore import Solution
from pendcore.messages import Floats, in_a_row, listed
from pendcore.methods import evaluations

LIMIT = 0.1
"""rad: a run is right until its error passes this, unless another limit is asked for."""
SHARE = 0.1
"""Sensitivities are right until their error passes this share of the largest."""
_MANY_NAMES = 4
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
    right = "not estimated yet: sol.valid_until() does, by a second run"
    if solution.known_error is not None:
        until = solution.known_error.valid_until(LIMIT)
        right = f"to {LIMIT:g} rad {_until(solution, until)}"
        if len(t) and until != t[0] and until == solution.t_span[0]:
            right = f"not to {LIMIT:g} rad at {t[0]:.4g} s, and no earlier time is kept"
    rows.append(("right", right))
    if solution.sensitivities is not None:
        rows.append(("sensitivities", _sensitivities(solution, solution.sensitivities)))
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


def _sensitivities(solution: Solution, found: Floats) -> str:
    """Return what the sensitivities are by, how large they are, and until when they are right."""
    names, there = solution.sensitivity_names, np.isfinite(np.abs(found).max(axis=1))
    told = f"by {_shortened(names)}"
    if not there.any():
        return f"{told}: none at the kept times"
    told += f", up to {np.nanmax(np.abs(found)):.2g}"
    if not there.all():
        lacking = [name for name, has in zip(names, there.T, strict=True) if not has.all()]
        since = solution.t[there.all(axis=1).argmin()]
        told += f", none by {_shortened(lacking)} from {since:.4g} s on"
    if solution.known_error is None or solution.known_sensitivity_errors is None:
        return f"{told}; until when, sol.sensitivities_valid_until() says, by further runs"
    start, _ = solution.t_span
    ends = solution.sensitivities_valid_until(SHARE)[there.any(axis=0)]
    return f"{told}, to {SHARE:.0%} {_until(solution, min(ends, key=lambda t: abs(t - start)))}"


def _shortened(names: Sequence[str]) -> str:
    few = names if len(names) <= _MANY_NAMES else (*names[:3], f"{len(names) - 3} more")
    return in_a_row(few)


def _until(solution: Solution, time: float) -> str:
    return "to the end" if time == solution.t_reached else f"until {time:.4g} s"


def _scene(solution: Solution) -> str:
    """Return the links, gravity, and the kinds of effects, with how many of each there are."""
    scene, n = solution.scene, len(solution.scene.links)
    count = Counter(effect.kind for effect in scene.effects)
    kinds = [kind if k == 1 else f"{kind} ({k})" for kind, k in count.items()]
    return ", ".join([f"{n} link{'s'[: n > 1]}, gravity {scene.gravity:.6g} m/s^2", *kinds])
