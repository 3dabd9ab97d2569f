"""How many digits of a run's forces are worth printing: no more than its own error leaves right."""

from __future__ import annotations

from math import floor, isfinite, log10

import numpy as np

from pendcore._run.solution import Solution

AMPLIFIED = 10.0
"""The ratio of a force's relative error to the tolerance, at most: errors of steps add up in a run,
as they have in its drift already."""
FEWEST, MOST = 2, 6


def trusted_digits(solution: Solution) -> int:
    """Return the number of digits, 2 to 6: by tolerance, energy drift and any verified error.

    It does not hold past the time to which a chaotic run is right: see `Solution.estimate_error`.
    """
    asked, accuracy = solution.options, solution.accuracy
    shares = [solution.energy_drift().relative_drift or 0.0]
    if asked["step"] is None:  # else tolerances set no step
        shares.append(AMPLIFIED * float(np.max(asked["rtol"])))
    if accuracy is not None and accuracy.times:
        shares.append(accuracy.achieved)
    share = max(shares)
    if not isfinite(share):
        return FEWEST
    return MOST if share == 0 else min(max(floor(-log10(share)), FEWEST), MOST)
