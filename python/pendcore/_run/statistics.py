"""The work of a run."""

from __future__ import annotations

from typing import NamedTuple


class Statistics(NamedTuple):
    """What a run took.

    Attributes
    ----------
    nfev : int
        Right-hand sides; for ``taylor`` series, each of which takes as long as many of them.
    njev : int
        Jacobians.
    nlu : int
        Factorisations.
    accepted : int
        Steps that were kept.
    rejected : int
        Steps that were tried again, shorter.
    limited_by_tolerance : int
        Accepted steps of the size that accuracy allowed. Those that end at a kink of drag count.
    limited_by_max_step : int
        Accepted steps of the size of ``max_step``, or of a fixed step.
    limited_by_break : int
        Accepted steps that ended early, at the end of the run or where a law changes.
    min_step, max_step : float
        Sizes of the accepted steps, s, except those that ended early.
    stiff : bool
        Whether stability rather than accuracy limited the steps.

    Examples
    --------
    >>> scene = pc.Scene.textbook()
    >>> stats = pc.simulate(scene, (0, 1), 0.5, method="rk4", step=0.01).stats
    >>> stats.accepted, stats.nfev
    (100, 401)
    """

    nfev: int
    njev: int
    nlu: int
    accepted: int
    rejected: int
    limited_by_tolerance: int
    limited_by_max_step: int
    limited_by_break: int
    min_step: float
    max_step: float
    stiff: bool
