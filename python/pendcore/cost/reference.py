"""What computed motions are compared with: the most accurate runs of two methods.

Neither is exact. Their distance from each other is what is known of the error of either, and errors
that are not above it cannot be told apart. A method is compared with the other method's run.
"""

from __future__ import annotations

from math import inf
from time import monotonic
from typing import Any, NamedTuple

import numpy as np

import pendcore as pc
from pendcore import methods
from pendcore.cost.runs import Start
from pendcore.messages import Floats
from pendcore.options import atol_beside

# In a stiff scene an implicit method comes first.
REFEREES_IF_STIFF = (methods.implicit_method(), "dop853", methods.pair_of("dopri5"))
TOO_UNCERTAIN = 1e-6
"""The uncertainty beyond which the span is cut to where both methods agree to `KNOWN`."""
KNOWN = 1e-8


class Reference(NamedTuple):
    """Two runs, the times on which they are compared (n_t,), s, and how far apart they are."""

    first: pc.Solution
    second: pc.Solution
    times: Floats
    apart: Floats

    @property
    def uncertainty(self) -> float:
        """The largest distance of the two, as a share of the total length."""
        return float(self.apart.max())

    def known_until(self) -> int:
        """Return how many of the times are known well enough: all, or those up to a horizon."""
        if self.uncertainty <= TOO_UNCERTAIN:
            return len(self.times)
        return int(np.argmax(~(self.apart <= KNOWN)))

    def error_of(self, solution: pc.Solution) -> float:
        """Return the largest distance of a run from the reference run by another method."""
        kin = methods_of(solution.method)
        other = self.second if self.first.method in kin else self.first
        if not (solution.success and len(solution.t) >= len(self.times)):
            return inf
        q, r = (one.q[: len(self.times)] for one in (solution, other))
        error = float(solution.scene.distances(q, r).max())
        return error if error == error else inf

    def texts(self) -> tuple[str, str]:
        """Return how the two runs were made, for people."""
        told = "{0.method} at rtol {0.options[rtol]:.0e}, compensated"
        return told.format(self.first), told.format(self.second)


def reference(
    start: Start, *, stiff: bool, points: int, time_limit: float, **limits: Any
) -> Reference:
    """Run two methods as accurately as doubles allow, each in its share of the time.

    They are compared at the times that both reach.
    """
    times = np.linspace(start.t_start, start.t_end, points)
    times = times[np.append(True, np.diff(times) != 0)]  # a span of a few last bits has fewer
    runs: list[pc.Solution] = []
    until = monotonic() + time_limit
    for method in REFEREES_IF_STIFF if stiff else methods.most_accurate():
        if not start.is_supported_by(method):
            continue
        is_implicit = methods.implicit_method() in methods_of(method)
        rtol = methods.TIGHTEST_IMPLICIT if is_implicit else methods.TIGHTEST
        left = max(until - monotonic(), 1e-3) / 2
        how = {"rtol": rtol, "atol": atol_beside(rtol), "compensated": True, "t_eval": times}
        runs.append(start.run(method, **how, time_limit=left, **limits))
        if sum(made.success for made in runs) == 2:
            break
    first, second = sorted(runs, key=lambda made: abs(made.t_reached - start.t_end))[:2]
    count = min(len(one) for one in (times, first.t, second.t))
    apart = first.scene.distances(first.q[:count], second.q[:count])
    return Reference(first, second, times[:count], np.where(np.isnan(apart), inf, apart))


def methods_of(method: str) -> set[str]:
    """Return a method's name and, for a pair, the names of its two methods."""
    known = methods.known_methods()[method]
    return {method, known["first"], known["second"]} - {""}
