"""What was computed before an exception is handed over with it, so that nothing is lost."""

from __future__ import annotations


def hand_over(stop: BaseException, **so_far: object) -> None:
    """Give an exception attributes: a run, an ensemble, a measurement as far as it came."""
    vars(stop).update(so_far)


def forget_inner_runs(stop: BaseException) -> None:
    """Take from an exception what a run on the way handed over: the user asked for none of them."""
    for name in ("solution", "estimate", "exponents"):
        vars(stop).pop(name, None)
