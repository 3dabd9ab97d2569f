"""What was computed before an exception is handed over with it, so that nothing is lost."""

from __future__ import annotations

from typing import TypeVar

Stop = TypeVar("Stop", bound=BaseException)


def hand_over(stop: Stop, **so_far: object) -> Stop:
    """Give an exception attributes: a run, an ensemble, a measurement as far as it came."""
    vars(stop).update(so_far)
    return stop


def raise_with(stop: BaseException | None, **so_far: object) -> None:
    """Raise an exception, if there is one, with what was computed before it."""
    if stop is not None:
        try:
            raise hand_over(stop, **so_far)
        finally:
            del stop  # its traceback holds this frame: it would wait for the collector


def forget_inner_runs(stop: BaseException) -> None:
    """Take from an exception what a run on the way handed over: the user asked for none of them."""
    for name in ("solution", "estimate", "exponents"):
        vars(stop).pop(name, None)
