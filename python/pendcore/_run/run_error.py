"""What follows a run that was not finished, or not verified: a warning, an exception, nothing."""

from __future__ import annotations

from pendcore._messages.handed_over import hand_over
from pendcore._messages.warning import PendcoreWarning, warn
from pendcore._run.solution import ENDED_FROM_OUTSIDE, Solution

REMEDY = 'on_failure="raise" raises an error, on_failure="ignore" says nothing'


class RunError(RuntimeError):
    """A run was not finished, or not verified in time, and ``on_failure="raise"`` asked for it.

    Attributes
    ----------
    solution : Solution
        The run as far as it came; its ``status`` and ``message`` tell why it ended.

    Examples
    --------
    >>> scene = pc.Scene.textbook()
    >>> try:
    ...     pc.simulate(scene, (0, 5), 0.5, max_steps=10, on_failure="raise")
    ... except pc.RunError as ended:
    ...     print(ended.solution.status, len(ended.solution.t))
    max_steps 11
    """

    solution: Solution


def require_on_failure(on_failure: object) -> None:
    """Raise ValueError for a wrong ``on_failure``, before a run that may take an hour."""
    if not (isinstance(on_failure, str) and on_failure in ("warn", "raise", "ignore")):
        raise ValueError(f'on_failure = {on_failure!r}: must be "warn", "raise" or "ignore"')


def checked(solution: Solution, on_failure: str) -> Solution:
    """Return a solution; one that is not finished and verified as ``on_failure`` says."""
    if on_failure == "ignore" or (solution.success and not solution.why_unverified):
        return solution
    if on_failure == "raise":
        raise hand_over(RunError(_complaint(solution)), solution=solution)
    try:
        warn(f"{_complaint(solution)}; {REMEDY}")
    except PendcoreWarning as error:  # where warnings are errors the run is not lost either
        hand_over(error, solution=solution)
        raise
    return solution


def _complaint(solution: Solution) -> str:
    """Say why a run ended and what continues it; some messages say the latter themselves."""
    if solution.success:
        return solution.why_unverified
    t_end, message = solution._run.arguments["t_end"], solution.message
    complaint = (
        f"the run ended before t_end = {t_end:.6g} s, with status {solution.status}: "
        f"{message.removeprefix(f'{solution.status}: ')}"
    )
    if solution.accuracy is not None:
        return f"{complaint}; its error: {solution.accuracy.text()}"
    if solution.can_resume and "resume" not in message:
        complaint += f"; solution.resume({t_end!r}) continues it"
    elif solution.sensitivity_names and solution.status in ENDED_FROM_OUTSIDE:
        complaint += (
            "; but a run with sensitivities cannot be resumed: simulate again, with a larger limit"
        )
    return complaint
