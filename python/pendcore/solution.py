"""What a run found: times, angles, rates, and what follows from them.

n is the number of links, n_t the number of kept times. Angles are absolute, from +x towards +y, and
y points **down**. Nothing is computed before it is asked for.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from pendcore import _core
from pendcore.arguments import Floats, finite_array, time_limit_of
from pendcore.energy import Energy, Ledger
from pendcore.events import Event, Found, event_of, found_events
from pendcore.largest_reactions import LargestReaction, largest_reactions
from pendcore.progress import Progress, callback, close
from pendcore.run_error import checked, require_check
from pendcore.scene import Scene
from pendcore.statistics import Statistics

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from matplotlib.lines import Line2D

    from pendcore.accuracy.defect import Defect
    from pendcore.accuracy.estimate import ErrorEstimate
    from pendcore.accuracy.report import Accuracy
    from pendcore.case import Case
    from pendcore.horizon.lyapunov import LyapunovExponents


class Solution:
    """The result of `simulate`.

    Call it, ``sol(t)``, for the state between the steps. It pickles; `save` and `load` keep it all.

    Attributes
    ----------
    scene : Scene
        What moved.
    name : str
        For people; of the case, if there was one. It may be set.
    """

    __slots__ = ("_accuracy", "_error", "_events", "_run", "name", "scene")

    def __init__(
        self,
        scene: Scene,
        run: _core.Run,
        name: str = "",
        accuracy: Accuracy | None = None,
        error: ErrorEstimate | None = None,
    ) -> None:
        self.scene, self._run, self.name = scene, run, name
        self._accuracy, self._error = accuracy, error
        self._events: list[list[Found]] | None = None

    @property
    def t(self) -> Floats:
        """Times of the accepted steps, or ``t_eval``, s, (n_t,)."""
        return self._run.t

    @property
    def q(self) -> Floats:
        """Absolute angles, rad, (n_t, n)."""
        return self._run.states[:, : len(self.scene.links)]

    @property
    def qd(self) -> Floats:
        """Angular rates, rad/s, (n_t, n)."""
        return self._run.states[:, len(self.scene.links) :]

    @property
    def y(self) -> Floats:
        """States as SciPy lays them out, (2n, n_t): q_1..q_n (rad), then qd_1..qd_n (rad/s)."""
        return self._run.states.T

    def __call__(self, t: npt.ArrayLike) -> Floats:
        """State at any time within the run, from the method's own interpolant.

        Parameters
        ----------
        t : float or array_like, (k,)
            s.

        Returns
        -------
        ndarray, (2n,) or (2n, k)
            q_1..q_n (rad), then qd_1..qd_n (rad/s).

        Raises
        ------
        ValueError
            If a time lies outside the run, or the run did not store its interpolants.
        """
        times = finite_array("t", t, "s")
        if times.ndim > 1:
            raise ValueError(f"t: shape {times.shape}: must be a number or (k,) (s)")
        states = self._run.evaluate(times.reshape(-1)).T
        return states[:, 0] if times.ndim == 0 else states

    @property
    def status(self) -> str:
        """How the run ended, in a word: ``"finished"``, ``"max_steps"``, ``"non_finite"``, ..."""
        return self._run.status

    @property
    def message(self) -> str:
        """How the run ended, in a sentence, with advice where there is some."""
        return self._run.message

    @property
    def success(self) -> bool:
        """Whether the run got where it was to go."""
        return self._run.success

    @property
    def method(self) -> str:
        """Name of the method."""
        return self._run.method

    @property
    def store(self) -> str:
        """What was kept: ``"dense"``, ``"steps"``, ``"times"`` or ``"end"``."""
        return self._run.store

    @property
    def stats(self) -> Statistics:
        """What the run took: right-hand sides, steps, and what limited them."""
        return Statistics(**self._run.statistics)

    @property
    def accuracy(self) -> Accuracy | None:
        """What ``simulate(error=...)`` asked for, reached and paid; else None.

        Its ``asked`` and ``achieved`` are shares of the total length, ``paid`` are the runs. It is
        of this run: one that was resumed, or run again from its `case`, has none.
        """
        return self._accuracy

    @property
    def events(self) -> list[list[Found]]:
        """What was found of each event asked for, along the run: ``.t``, ``.q``, ``.qd``, ``.y``.

        Their states are the method's interpolant at the very place in the step; ``sol(event.t)``
        differs by the rounding of t. See `pendcore.events.Found`.
        """
        if self._events is None:
            self._events = found_events(len(self._events_asked_for()), self._run.found)
        return self._events

    def _events_asked_for(self) -> list[Event]:
        return [event_of(kind, values) for kind, values in self._run.arguments["events"]]

    def relative_angles(self) -> Floats:
        """Angles of the joints, phi_i = q_i - q_{i-1} with q_0 = 0, rad, (n_t, n)."""
        return np.diff(self.q, prepend=0.0)

    def accelerations(self) -> Floats:
        """Angular accelerations, rad/s^2, (n_t, n)."""
        return self.scene.accelerations(self.t, self.q, self.qd)

    def positions(self) -> Floats:
        """Pivot, joints and tip, m, (n_t, n+1, 2): x right, y down; a driven pivot moves."""
        return self.scene._compiled.positions(self.t, self.q)

    def mass_centers(self) -> Floats:
        """Mass centres of the links, a payload excluded, m, (n_t, n, 2): x right, y down."""
        return self.scene._compiled.mass_centers(self.t, self.q)

    def reactions(self) -> Floats:
        """Force on each link at the joint where it begins, N, (n_t, n, 2): x right, y down.

        The textbook's F_01 (the ground's on link 1), F_12 (link 1's on link 2), and so on.
        """
        return self.scene._compiled.reactions(self.t, self.q, self.qd)

    def energy(self) -> Energy:
        """Kinetic, potential and total energy, J, each (n_t,), and the ledger if one was kept."""
        kinetic, potential = self.scene._compiled.energy(self.t, self.q, self.qd)
        with np.errstate(all="ignore"):  # a blow-up's energies may be infinite
            total = kinetic + potential
        asked = self._run.arguments
        if not asked["ledger"]:
            return Energy(kinetic, potential, total)
        start = self.scene._compiled.energy(
            np.array([asked["t_start"]]), asked["q0"][np.newaxis], asked["qd0"][np.newaxis]
        )
        with np.errstate(all="ignore"):
            gain = total - sum(start)
            return Energy(kinetic, potential, total, Ledger(self._run.ledger, gain))

    def largest_reactions(self, *, progress: Progress = None) -> list[LargestReaction]:
        """Return the largest force of each joint: ``.joint``, ``.force`` (N), ``.t`` (s).

        Of a run with its interpolants it is that of the whole curve, between the steps too and on
        both sides of every jump; of others the largest at the kept times. What an impact does in no
        time is no force. See `pendcore.LargestReaction`; ``progress`` is as in `simulate`.
        """
        return largest_reactions(self.scene, self._run, progress)

    def defect(self, *, progress: Progress = None) -> Defect:
        """Return the spurious torques: what motors would have to add to make the curve exact.

        See `pendcore.Defect` and, for what they tell, `docs/defect.md`; ``progress`` is as in
        `simulate`. A ValueError if the run did not store its interpolants: ``store="dense"``.
        """
        from pendcore.accuracy.defect import defect

        return defect(self.scene, self._run, progress)

    def error(self, *, time_limit: float | None = None, progress: Progress = None) -> ErrorEstimate:
        """Estimate the error over time from independent second runs, made when first asked for.

        They are of another method (of ``"radau5"`` too if a default run has changed over to it), at
        tolerances a hundredth and less of this run's, with constants and start moved by some last
        bits, and go on until they have nothing to do with it any more. For a run with an ``error``
        that was asked for, the estimate is the one that verified it.

        Parameters
        ----------
        time_limit : float, optional
            s of the clock, > 0, after which the estimate ends where it is.
        progress : as in `simulate`

        Returns
        -------
        ErrorEstimate
            ``.t`` (n_t,), s, ``.angle``, rad, ``.position``, a share of the total length.

        Raises
        ------
        KeyboardInterrupt, or any exception of ``progress`` or of an effect's function
            With what was found so far as the attribute ``estimate``, and this run as ``solution``.
        """
        from pendcore.accuracy.estimate import error_estimate

        time_limit_of(time_limit)  # also where it is known already
        if self._error is None:
            found = error_estimate(self, time_limit=time_limit, progress=progress)
            if not found.is_complete:
                return found  # another time there may be more time
            self._error = found
        return self._error

    def valid_until(
        self, limit: float = 0.1, *, of: str = "angle", time_limit: float | None = None
    ) -> float:
        """Return how far to trust the run: the time at which its `error` passes a limit, s.

        On the safe side; the end of the run where it does not. See `ErrorEstimate.valid_until`.

        Parameters
        ----------
        limit : float, rad; with ``of="position"`` a share of the total length
        of : {"angle", "position"}, of the links, or of joints and tip
        time_limit : as in `error`; how far the run is known to hold by then
        """
        return self.error(time_limit=time_limit).valid_until(limit, of=of)

    def lyapunov(
        self,
        *,
        count: int | None = None,
        transient: float = 0.0,
        t_eval: npt.ArrayLike | None = None,
        progress: Progress = None,
    ) -> LyapunovExponents:
        """Compute the Lyapunov exponents of this very run, 1/s; see `pendcore.lyapunov`."""
        from pendcore.horizon.lyapunov import lyapunov_of

        return lyapunov_of(self, count, transient, t_eval, progress)

    def resume(
        self,
        t_end: float,
        t_eval: npt.ArrayLike | None = None,
        *,
        max_steps: int = 10_000_000,
        time_limit: float | None = None,
        check: bool | None = None,
        progress: Progress = None,
    ) -> Solution:
        """Continue to a later end, bitwise as if the run had never stopped.

        Parameters
        ----------
        t_end : float
            s; not before where this run ended, in its direction.
        t_eval : array_like, (k,), optional
            More times to keep, s: at or beyond where this run ended, and beyond those it was asked
            for. Only for a run that had a ``t_eval``.
        max_steps, time_limit, check, progress
            As in `simulate`, for the continuation. It begins before the first attempt that the
            earlier ``t_end`` cut short, as what came after that depends on it. To the same
            ``t_end`` the attempts made since then are made again and do not count, so that a
            ``max_steps`` of 1 gets on as well.

        Returns
        -------
        Solution
            The whole run, from its first start. This one stays as it is.

        Raises
        ------
        ValueError, TypeError
            If an argument is not what is asked for; the message names it.
        """
        require_check(check)
        report = callback(progress)
        run = self._run.resume(t_end, t_eval, max_steps, time_limit, report)
        return checked(solution_of(self.scene, run, report, self.name), check)

    def case(self) -> Case:
        """Return what was asked for, ready to be run again or written as TOML."""
        from pendcore.case import Case

        return Case.of_solution(self)

    def save(self, path: str | os.PathLike[str], *, progress: Progress = None) -> None:
        """Write everything to a file of NumPy's npz format; see `pendcore.load`.

        It has its name only when it is whole. ``progress`` is as in `simulate`.
        """
        from pendcore.archive import save

        save(self, path, progress=progress)

    def plot(
        self,
        ax: Any = None,
        *,
        label: str | None = None,
        horizon: float | None = None,
        **line_properties: Any,
    ) -> list[Line2D]:
        """Draw the angles over time, as in the textbook; see `pendcore.views.plot.plot`.

        ``ax`` is one axes, or one for each link; ``label`` names the solution in the legend; what
        is past `valid_until` (``horizon``), rad, is shaded; the rest are properties of matplotlib's
        ``Line2D``. The lines are returned.
        """
        from pendcore.views.plot import plot

        return plot(self, ax, label=label, horizon=horizon, **line_properties)

    def to_pandas(self) -> pd.DataFrame:
        """Return a table with a row per time and the columns q_1.., qd_1..; units in ``attrs``."""
        from pendcore.views.export import to_pandas

        return to_pandas(self)

    def to_xarray(self) -> xr.Dataset:
        """Return ``q`` and ``qd`` over time and link; units and the case in ``attrs``."""
        from pendcore.views.export import to_xarray

        return to_xarray(self)

    def __reduce__(self) -> tuple[object, ...]:
        # The scene first: it says best that it cannot be pickled, if it cannot.
        rest = self._run, self.name, self._accuracy, self._verified_error()
        return type(self), (self.scene, *rest)

    def __deepcopy__(self, memo: object) -> Solution:
        # None of them ever changes.
        return Solution(self.scene, self._run, self.name, self._accuracy, self._verified_error())

    def _verified_error(self) -> ErrorEstimate | None:
        """Return the estimate behind `accuracy`; another is made anew where it is asked for."""
        return None if self._accuracy is None else self._error

    def __repr__(self) -> str:
        from pendcore.views.table import text

        return text(self)

    def _repr_html_(self) -> str:
        from pendcore.views.table import html

        return html(self)


def solution_of(
    scene: Scene, run: _core.Run, report: Callable[[float], object] | None, name: str = ""
) -> Solution:
    """Wrap a run; if it was broken off by an exception, raise that with the run so far."""
    solution = Solution(scene, run, name)
    close(report)
    error = run.error
    if error is not None:
        error.solution = solution  # type: ignore[attr-defined]
        raise error
    return solution
