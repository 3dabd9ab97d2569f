"""What becomes of a run that did not get where it was to go: a warning, an error, or nothing."""

from __future__ import annotations

from typing import Any

from pendcore.messages.warning import PendcoreWarning, warn
from pendcore.run.result import Result, RunResult

CAN_GO_ON = frozenset({"max_steps", "max_turns", "time_limit", "interrupted"})
"""Statuses after which `Solution.resume` gets further; also that of a loaded run, whose functions
are gone."""


class RunError(RuntimeError):
    """A run ended before it got where it was to go, and ``check=True`` asked for an exception.

    Attributes
    ----------
    solution : Solution
        The run as far as it came; its ``status`` and ``message`` tell why it ended.
    """

    def __init__(self, message: str, solution: Any) -> None:
        super().__init__(message)
        self.solution = solution

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (str(self), self.solution)


def require_check(check: object) -> None:
    """Refuse what is no answer to whether a run is to be checked, before it takes an hour."""
    if check is not None and not isinstance(check, bool):
        raise TypeError(
            f"check = {check!r}: must be None (warn if the run does not get to its end), True "
            "(raise) or False (say nothing)"
        )


def checked(solution: Result, check: bool | None) -> Result:
    """Return a solution; of one that is no success warn, or raise, or say nothing."""
    accuracy = solution.accuracy
    is_verified = accuracy is None or accuracy.outcome != "ended early"
    if check is False or (solution.success and is_verified):
        return solution
    if check:
        raise RunError(_complaint(solution), solution)
    try:
        warn(f"{_complaint(solution)}; check=True raises an error, check=False says nothing")
    except PendcoreWarning as error:  # where warnings are errors the run is not lost either
        error.solution = solution  # type: ignore[attr-defined]
        raise
    return solution


def _complaint(solution: RunResult) -> str:
    """Return status, time and remedy in a sentence; the message has the time, and some remedies."""
    if solution.success and solution.accuracy is not None:
        return f"the run got to its end, but {solution.accuracy.text()}"
    t_end, message = solution.run.arguments["t_end"], solution.message
    complaint = (
        f"the run ended before t_end = {t_end:.6g} s, with status {solution.status}: "
        f"{message.removeprefix(f'{solution.status}: ')}"
    )
    if solution.accuracy is not None:
        return f"{complaint}; it is no run of the error asked for: {solution.accuracy.text()}"
    if solution.status in CAN_GO_ON and "resume" not in message:
        complaint += f"; its resume({t_end!r}) goes on"
    return complaint
