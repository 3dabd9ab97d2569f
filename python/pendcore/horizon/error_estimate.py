"""The error of a run over time, from independent second runs.

Another method at a tighter tolerance (`pendcore.accuracy.second_run`) makes errors of its own, but
smaller ones: the distance is the error of the first run. Two things could spoil that:

* What all runs share does not show: rounded constants of the scene, and that a start is a double.
  So a second run begins a few last bits beside the start. In a chaotic motion that grows as
  fast as any error: the estimate includes what no computation in doubles can know.
* All that grows in a chaotic motion grows along one direction. Where two errors are of one
  size they may cancel there, and the runs agree on what is wrong. So there are two second runs,
  one on either side of the start and at tolerances a factor of ten apart; the larger of the two
  distances counts. Both cannot cancel: |a - b| and |a + b| are not both less than |a|.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from math import inf
from time import monotonic
from typing import TypeAlias

import numpy as np

from pendcore.accuracy.position_error import distances
from pendcore.accuracy.run import Choice, Start, run, start_of, tightened
from pendcore.accuracy.second_run import TIGHTEST, choice_of, second_choices
from pendcore.arguments import Floats, number, time_limit_of
from pendcore.progress import Progress, callback, close
from pendcore.solution import Solution

Report: TypeAlias = Callable[[float], object]

SAFETY = 4.0
"""By which `valid_until` takes the error to be larger than the distance of the two runs."""
TIGHTER = 100.0
"""How much tighter the tolerance of the looser second run is than that of the first."""
APART = 10.0
"""And that of the other one, than that."""
MORE_STEPS = 10
"""How many times the steps that were allowed to the first run they may take."""
LOST = np.pi
"""rad; runs that are farther apart have nothing to do with each other."""
LAST_BITS = 16 * np.finfo(np.float64).eps
"""How far beside the start the second run begins, relatively."""
FEWEST, MOST = 1001, 20001
"""Times of the estimate, for a run with dense output."""
LEGS = 32
"""In as many parts a second run is made; it ends with that in which it and the first are lost."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ErrorEstimate:
    """How far a run is off, estimated.

    Attributes
    ----------
    begin : float
        s, the start of the run.
    t : ndarray, (n_t,)
        s, of those that the run kept. They end before the run does where a second run has nothing
        to do with it any more, or did not get further.
    angle : ndarray, (n_t,)
        The largest difference over the links, rad.
    position : ndarray, (n_t,)
        The largest distance over the joints and the tip, as a share of the total length.
    method, rtol : str, float
        Of the second runs, the looser one's.
    is_lost : bool
        Whether they had nothing to do with the run any more at the last of the times.
    is_complete : bool
        Whether the times go as far as that, or to the end of the run.
    """

    begin: float
    t: Floats
    angle: Floats
    position: Floats
    method: str
    rtol: float
    is_lost: bool
    is_complete: bool

    def valid_until(self, limit: float = 0.1, *, of: str = "angle") -> float:
        """Return the last time until which the error stays within a limit, s.

        Parameters
        ----------
        limit : float
            > 0, rad; with ``of="position"`` a share of the total length.
        of : {"angle", "position"}
            What is limited: the angles of the links, or the positions of joints and tip.

        Returns
        -------
        float
            The end of the run where the limit is not passed before; its start where it is passed
            at the first time that was kept, or none was compared. On the safe side: the error is
            taken to be four times what the runs differ by, and never to shrink.
        """
        error = self._limited(of)
        limit = number("limit", limit, "rad" if of == "angle" else "of the total length")
        if not limit > 0:
            raise ValueError(f"limit = {limit}: must be > 0")
        is_past = ~(SAFETY * error <= limit)
        is_past[-1:] |= self.is_lost
        within = np.argmax(is_past) if is_past.any() else len(self.t)
        return float(self.t[within - 1]) if within else self.begin

    def __str__(self) -> str:
        until = self.t[-1] if len(self.t) else self.begin
        ends = ""
        if self.is_lost:
            ends = "; past that the runs have nothing to do with each other any more"
        elif not self.is_complete:
            ends = "; the run goes on past that: it is not known there yet"
        return (
            f"error estimated at {len(self.t)} times from t = {self.begin:.6g} to {until:.6g} s: "
            f"angles up to {self.angle.max(initial=0.0):.1e} rad, positions up to "
            f"{self.position.max(initial=0.0):.1e} of the total length, from second runs by "
            f"{self.method} at rtol {self.rtol:.0e} and tighter{ends}"
        )

    def _limited(self, of: str) -> Floats:
        if of not in ("angle", "position"):
            raise ValueError(f'of = {of!r}: must be "angle" (rad) or "position" (a share)')
        return self.angle if of == "angle" else self.position


def error_estimate(
    solution: Solution, *, time_limit: float | None = None, progress: Progress = None
) -> ErrorEstimate:
    """Estimate the error of a solution; see `Solution.error`."""
    t, q = _kept(solution)
    if not len(t):
        raise ValueError(
            "error: the run ended before the first of its t_eval and kept no state to compare: "
            "ask for earlier times, or for none"
        )
    start = start_of(solution)
    first = choice_of(solution)
    until = monotonic() + time_limit_of(time_limit)
    report = callback(progress, "estimating the error")
    farthest: ErrorEstimate | None = None
    try:
        for choice in second_choices(start, first, stiff=solution.stats.stiff, tighter=TIGHTER):
            found = _compared(solution, choice, t, q, until, report)
            if farthest is None or len(found.t) > len(farthest.t):
                farthest = found
            if found.is_complete or monotonic() > until:
                break
    except BaseException as stop:
        stop.solution = solution  # type: ignore[attr-defined]
        raise
    finally:
        close(report)
    assert farthest is not None, "an explicit Runge-Kutta method carries every scene"
    return farthest


def _kept(solution: Solution) -> tuple[Floats, Floats]:
    """Return the times at which a solution is compared, and its angles there."""
    if solution.store != "dense":  # a time at which the state jumps is there twice
        t, kept = np.unique(solution.t, return_index=True)
        order = np.argsort(kept)
        return t[order], solution.q[kept[order]]
    first, last = solution._run.arguments["t_start"], solution._run.t_reached
    steps = int(np.clip(2 * solution.stats.accepted, FEWEST, MOST))
    t = np.linspace(first, last, steps) if first != last else np.array([last])
    t[-1] = last
    t = t[np.append(True, np.diff(t) != 0)]  # few bits have fewer times
    return t, solution(t)[: len(solution.scene.links)].T


def _beside(start: Start, side: float) -> Start:
    """Move the angles by a few last bits, unless effects say where they may be."""
    if any(effect.description.bounds_joint for effect in start.scene.effects):
        return start
    q = np.asarray(start.q0, dtype=np.float64)
    signs = np.where(np.arange(len(q)) % 2 == 0, side, -side)
    return start._replace(q0=q + signs * LAST_BITS * np.maximum(1.0, np.abs(q)))


def _compared(
    solution: Solution, choice: Choice, t: Floats, q: Floats, until: float, report: Report | None
) -> ErrorEstimate:
    """Compare with second runs of that choice, until they and the solution are lost."""
    choices = choice, tightened(choice, APART, TIGHTEST)
    found: list[ErrorEstimate] = []
    for number_of_run, (one, side) in enumerate(zip(choices, (1.0, -1.0), strict=True)):
        start = _beside(start_of(solution), side)

        def share(fraction: float, done: int = number_of_run) -> None:
            if report is not None:
                report((done + fraction) / len(choices))

        second: Solution | None = None
        try:
            for second in _legs(solution, start, one, t, until, share):
                reached = len(second.t)
                if reached and not _apart(second.q[-1], q[reached - 1]) < LOST:
                    break
        except BaseException as error:
            if isinstance(so_far := getattr(error, "solution", second), Solution):
                found.append(_estimate(solution, one, so_far, t, q))
                error.estimate = _larger(found)  # type: ignore[attr-defined]
            raise
        assert second is not None
        found.append(_estimate(solution, one, second, t, q))
    return _larger(found)


def _legs(
    solution: Solution, start: Start, choice: Choice, t: Floats, until: float, report: Report
) -> Iterator[Solution]:
    """Yield the second run as it gets on, part by part of the times."""
    asked = solution._run.arguments
    max_steps = MORE_STEPS * asked["max_steps"]
    parts = [part for part in np.array_split(t, LEGS) if len(part)]
    second: Solution | None = None
    for done, part in enumerate(parts):
        left = None if until == inf else max(1e-3, until - monotonic())

        def share(fraction: float, done: int = done) -> None:
            report((done + fraction) / len(parts))

        share(0.0)  # parts may be shorter than what the core calls after
        if second is None:
            second = run(
                start._replace(t_end=part[-1]), choice, part, max_step=asked["max_step"],
                max_steps=max_steps, time_limit=left, progress=share,
            )  # fmt: skip
        else:
            second = second.resume(
                part[-1], part, max_steps=max_steps, time_limit=left, check=False, progress=share
            )
        yield second
        if not second.success:
            return


def _apart(q: Floats, reference: Floats) -> Floats:
    """The largest difference over the links, rad."""
    largest: Floats = np.abs(q - reference).max(axis=-1, initial=0.0)
    return largest


def _estimate(
    solution: Solution, choice: Choice, second: Solution, t: Floats, q: Floats
) -> ErrorEstimate:
    count = len(second.t)
    apart = _apart(second.q, q[:count])
    lost = np.flatnonzero(~(apart < LOST))
    if is_lost := len(lost) > 0:
        count = int(lost[0]) + 1
    return ErrorEstimate(
        begin=float(solution._run.arguments["t_start"]),
        t=t[:count],
        angle=apart[:count],
        position=distances(solution.scene, q[:count], second.q[:count]),
        method=choice.method,
        rtol=float(np.min(choice.rtol)),
        is_lost=is_lost,
        is_complete=is_lost or count == len(t),
    )


def _larger(found: list[ErrorEstimate]) -> ErrorEstimate:
    """Return the larger of the estimates, for as long as there are all of them."""
    shortest = min(found, key=lambda one: len(one.t))
    count = len(shortest.t)
    return replace(
        shortest,
        angle=np.max([one.angle[:count] for one in found], axis=0),
        position=np.max([one.position[:count] for one in found], axis=0),
        rtol=max(one.rtol for one in found),
    )
