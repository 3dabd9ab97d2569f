"""What one run found: times, angles, rates, what follows from them, and what can be made of it.

n is the number of links, n_t the number of kept times. Angles are absolute, from +x towards +y, and
y points **down**. Nothing is computed before it is asked for: methods import what they call.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from pendcore import _core
from pendcore._messages.arguments import Floats, finite_array, moments, text, whole_number
from pendcore._messages.progress import Progress
from pendcore._run.accuracy import Accuracy
from pendcore._run.energy import Energy, energy_over
from pendcore._run.error_estimate import ErrorEstimate
from pendcore._run.largest_reactions import LargestReaction, largest_reactions
from pendcore._run.statistics import Statistics
from pendcore._scene.parametrized import OfFunction
from pendcore._scene.scene import Scene
from pendcore.events import Event, Found, FoundEvents, event_of
from pendcore.options import RUN_DEFAULTS, OnFailure

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from matplotlib.animation import FuncAnimation
    from matplotlib.artist import Artist

    from pendcore._accuracy.defect import Defect
    from pendcore._cases.case import Case
    from pendcore._horizon.lyapunov import LyapunovExponents
    from pendcore._run.energy_drift import EnergyDrift
    from pendcore._run.event_sensitivities import EventSensitivities
    from pendcore._run.extreme_sensitivities import ExtremeSensitivities
    from pendcore.page.notebook import NotebookPage
    from pendcore.plotting.plot import What


ENDED_FROM_OUTSIDE = ("max_steps", "max_turns", "time_limit", "interrupted")
"""The statuses of runs that a limit or Ctrl-C ended before their ``t_end``."""


class Solution:
    """The result of `simulate`.

    Call it, ``sol(t)``, for the state between the steps; ``t``, ``q`` and ``qd`` are what it kept.
    It pickles; `save` and `load` keep it all but estimates of errors, which are made again.

    Attributes
    ----------
    scene : Scene
        What moved.
    known_error : ErrorEstimate or None
        The error at each time, where `simulate` or `estimate_error` has found it.
    sensitivities : ndarray, (n_t, 2n, k), or None
        d(q, qd)/d(name) at each time, for each of the names that ``simulate(sensitivities=...)``
        was given, which ``sensitivity_names`` has; in rad and rad/s per unit of what is named.
    known_sensitivity_errors : ndarray, (n_t, k), or None
        Their errors, where `sensitivity_errors` has found them.
    accuracy : Accuracy or None
        What ``simulate(error=...)`` asked for, reached and paid; None for other runs. Its ``asked``
        and ``achieved`` are shares of the total length, and ``paid`` lists the runs that were made.
        A run that was resumed, or run again from its `case`, has none.

    Examples
    --------
    >>> sol = pc.simulate(pc.Scene.textbook(), (0, 5), [np.pi / 4, np.pi / 3])
    >>> sol.status, sol.q.shape == (len(sol.t), 2)
    ('finished', True)
    >>> f"q_2 = {sol(2.5)[1]:.6f} rad at 2.5 s"
    'q_2 = 0.704933 rad at 2.5 s'
    """

    __slots__ = (
        "_events",
        "_name",
        "_run",
        "accuracy",
        "known_error",
        "known_sensitivity_errors",
        "scene",
        "sensitivities",
        "sensitivity_names",
    )

    def __init__(
        self,
        scene: Scene,
        run: _core.Run,
        name: str = "",
        accuracy: Accuracy | None = None,
        error: ErrorEstimate | None = None,
        sensitivities: Floats | None = None,
        sensitivity_names: tuple[str, ...] = (),
    ) -> None:
        self.scene, self._run = scene, run
        self.sensitivities, self.sensitivity_names = sensitivities, sensitivity_names
        self._name = name and text("name", name)
        self.accuracy, self.known_error = accuracy, error
        self.known_sensitivity_errors: Floats | None = None
        self._events: list[FoundEvents] | None = None

    @property
    def name(self) -> str:
        """A name for people, at first the case's; any text that a file can hold may be set."""
        return self._name

    @name.setter
    def name(self, name: str) -> None:
        self._name = text("name", name)

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

    @property
    def t_span(self) -> tuple[float, float]:
        """Start and end of the run, s, as they were asked for."""
        asked = self._run.arguments
        return float(asked["t_start"]), float(asked["t_end"])

    @property
    def t_reached(self) -> float:
        """The time to which the run came, s: its end, or where it broke off.

        With ``t_eval`` it may lie beyond all of ``t``.
        """
        return self._run.t_reached

    @property
    def y_reached(self) -> Floats:
        """The state at ``t_reached``, (2n,): q_1..q_n (rad), then qd_1..qd_n (rad/s)."""
        return self._run.y_reached

    def __call__(self, t: npt.ArrayLike) -> Floats:
        """State at any time within the run, from the method's own interpolant.

        Parameters
        ----------
        t : float or array_like, (k,)
            s.

        Returns
        -------
        ndarray, (2n,) or (2n, k)
            q_1..q_n (rad), then qd_1..qd_n (rad/s), as in SciPy. The methods of `Scene` take times
            along the first axis: ``q, qd = np.split(sol(t).T, 2, axis=-1)`` is what
            ``scene.accelerations(t, q, qd)`` wants.

        Raises
        ------
        ValueError
            If a time lies outside the run, or the run did not store its interpolants: see
            `with_dense_output`.

        Examples
        --------
        >>> sol = pc.Case.textbook().simulate()
        >>> sol(2.5).round(4)  # q_1, q_2 (rad), qd_1, qd_2 (rad/s)
        array([ 0.9337,  0.7049, -0.0193,  1.4848])
        >>> sol([0.0, 2.5, 5.0]).shape
        (4, 3)
        """
        times = moments(t)
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
        """Whether the run reached its end, or an event ended it as asked."""
        return self._run.success

    @property
    def why_unverified(self) -> str:
        """Why a finished run for an ``error`` was not verified in time; empty if nothing is so."""
        told = self.accuracy
        if told is None or told.outcome != "ended early":
            return ""
        return f"the run is finished, but not verified: {told.verified_by}"

    @property
    def method(self) -> str:
        """Name of the method."""
        return self._run.method

    @property
    def store(self) -> str:
        """What was kept: ``"dense"``, ``"steps"``, ``"times"`` or ``"end"``."""
        return self._run.store

    @property
    def options(self) -> dict[str, Any]:
        """Every option of the run by its name: those given, those chosen, and defaults."""
        start = ("q0", "qd0", "t_start", "t_end", "events")
        return {name: x for name, x in self._run.arguments.items() if name not in start}

    @property
    def last_method(self) -> str:
        """Name of the method of the last step: of a pair, the one that it ended with."""
        return self._run.last_method

    @property
    def step_starts(self) -> Floats:
        """Times at which the accepted steps begin, s; none where the run has no dense output."""
        return self._run.step_starts

    @property
    def fingerprint(self) -> str:
        """A hash of every bit of the run: equal runs on any machine have equal ones."""
        return self._run.fingerprint

    @property
    def can_resume(self) -> bool:
        """Whether a limit or Ctrl-C ended the run before its ``t_end``, and `resume` gets there.

        A run with sensitivities cannot be resumed.
        """
        return self.status in ENDED_FROM_OUTSIDE and not self.sensitivity_names

    @property
    def keeps_every_step(self) -> bool:
        """Whether the kept times are those of the steps, and not those asked for."""
        return self.store in ("dense", "steps") and self._run.arguments["t_eval"] is None

    @property
    def has_own_functions(self) -> bool:
        """Whether an effect or an event is a function of the user's, which no file can hold."""
        acting_and_found = (*self.scene.effects, *self.events_asked_for())
        return any(isinstance(one, OfFunction) for one in acting_and_found)

    @property
    def stats(self) -> Statistics:
        """What the run took: right-hand sides, steps, and what limited them."""
        return Statistics(**self._run.statistics)

    @property
    def events(self) -> list[FoundEvents]:
        """What was found of each event asked for: a list for each, with arrays ``t, q, qd, y``.

        The states come from the method's interpolant at the exact place in the step;
        ``sol(event.t)`` differs by the rounding of t. See `pendcore.events.FoundEvents`.
        """
        if self._events is None:
            n, asked = len(self.scene.links), self._run.arguments["events"]
            self._events = [FoundEvents(n) for _ in asked]
            for event, t, direction, y, y_before in self._run.found:
                self._events[event].append(Found(t, y, direction, y_before))
        return self._events

    def events_asked_for(self) -> list[Event]:
        """Return the events that the run looked for.

        Times and states of what was found are in ``events``.

        Examples
        --------
        >>> bottom = pc.events.LinkAngle(1, np.pi / 2)
        >>> sol = pc.simulate(pc.Scene.textbook(), (0, 1), 0.5, events=[bottom])
        >>> sol.events_asked_for() == [bottom]
        True
        """
        return [event_of(kind, values) for kind, values in self._run.arguments["events"]]

    def relative_angles(self) -> Floats:
        """Angles of the joints, phi_i = q_i - q_{i-1} with q_0 = 0, rad, (n_t, n).

        Examples
        --------
        >>> sol = pc.Case.textbook().simulate()
        >>> np.degrees(sol.relative_angles()[0]).round(6)
        array([45., 15.])
        """
        return np.diff(self.q, prepend=0.0)

    def accelerations(self) -> Floats:
        """Angular accelerations, rad/s^2, (n_t, n).

        Examples
        --------
        >>> sol = pc.Case.textbook().simulate()
        >>> sol.accelerations()[0].round(3)  # at the start
        array([10.811, -8.309])
        """
        return self.scene.accelerations(self.t, self.q, self.qd)

    def positions(self) -> Floats:
        """Pivot, joints and tip, m, (n_t, n+1, 2): x right, y down; a driven pivot moves.

        Examples
        --------
        >>> sol = pc.Case.textbook().simulate()
        >>> sol.positions()[0].round(3)  # pivot, joint 2, tip
        array([[0.   , 0.   ],
               [0.707, 0.707],
               [1.207, 1.573]])
        """
        return self.scene._compiled.positions(self.t, self.q)

    def mass_centers(self) -> Floats:
        """Mass centres of the links, a payload excluded, m, (n_t, n, 2): x right, y down.

        Examples
        --------
        >>> sol = pc.Case.textbook().simulate()
        >>> sol.mass_centers()[0].round(3)
        array([[0.354, 0.354],
               [0.957, 1.14 ]])
        """
        return self.scene._compiled.mass_centers(self.t, self.q)

    def reactions(self) -> Floats:
        """Force on each link at the joint where it begins, N, (n_t, n, 2): x right, y down.

        The textbook's F_01 (the ground's on link 1), F_12 (link 1's on link 2), and so on.

        Examples
        --------
        >>> sol = pc.Case.textbook().simulate()
        >>> sol.reactions()[0].round(3)  # F_01 and F_12 at the start
        array([[ -7.869, -10.224],
               [ -4.047,  -4.24 ]])
        """
        return self.scene._compiled.reactions(self.t, self.q, self.qd)

    def energy(self, t: npt.ArrayLike | None = None) -> Energy:
        """Kinetic, potential and total energy, J, each (n_t,), and the ledger if one was kept.

        With times ``t`` within the run, s, (k,), those at these times, from the dense output; the
        errors are as in ``sol(t)``.

        Examples
        --------
        >>> sol = pc.Case.textbook().simulate()
        >>> energy = sol.energy()
        >>> f"{energy.total[0]:.4f} J at first, {energy.total[-1]:.4f} J at last"
        '-14.6484 J at first, -14.6484 J at last'
        >>> sol.energy([1.0, 2.0]).kinetic.round(3)
        array([1.27 , 3.676])
        """
        run = self._run
        if t is None:
            return energy_over(self.scene, run.arguments, run.t, run.states, run.ledger)
        times = finite_array("t", t, "s")
        if times.ndim != 1:
            raise ValueError(f"t: shape {times.shape}: must be (k,) (s)")
        found = run.evaluate(times), run.ledger_at(times)
        return energy_over(self.scene, run.arguments, times, *found)

    def energy_drift(self, every: int = 1) -> EnergyDrift:
        """Return how well the run kept its energy, or the ledger's balance where effects do work.

        With ``every``, it is computed from one kept time in so many, which is faster.

        Examples
        --------
        >>> drift = pc.Case.textbook().simulate().energy_drift()
        >>> f"{drift.largest_drift:.0e} J", drift.too_large
        ('7e-09 J', False)
        """
        from pendcore._run.energy_drift import energy_drift

        return energy_drift(self, every)

    def trusted_digits(self) -> int:
        """Return how many digits of the run's forces are worth printing, 2 to 6.

        By tolerance, energy drift and any verified error. It does not hold past the time to which a
        chaotic run is right: see `estimate_error`.

        Examples
        --------
        >>> pc.Case.textbook().simulate().trusted_digits()
        6
        """
        from pendcore._run.energy_drift import trusted_digits

        return trusted_digits(self)

    def largest_reactions(self, *, progress: Progress = None) -> list[LargestReaction]:
        """Return the largest force of each joint: ``.joint``, ``.force`` (N), ``.t`` (s).

        A run that stored its interpolants gives the largest force on the whole curve, also between
        steps and on both sides of every jump; other runs give the largest at the kept times. The
        impulse of an impact is not a force. See `pendcore.LargestReaction`; ``progress`` is as in
        `simulate`.

        Examples
        --------
        >>> first, second = pc.Case.textbook().simulate().largest_reactions()
        >>> f"{first.force:.2f} N at joint {first.joint}, t = {first.t:.3f} s"
        '31.93 N at joint 1, t = 0.644 s'
        """
        return largest_reactions(self.scene, self._run, progress)

    def defect(self, *, progress: Progress = None) -> Defect:
        """Return the spurious torques, N m: what motors would have to add to make the curve exact.

        See `pendcore.Defect`; `docs/background/defect.md` says how to read them. ``progress`` is as
        in `simulate`. Raises a ValueError if the run did not store its interpolants
        (``store="dense"``).

        Examples
        --------
        >>> sol = pc.Case.textbook().simulate()
        >>> found = sol.defect()
        >>> f"{found.largest:.0e} N m at joint {found.joint}"
        '3e-06 N m at joint 1'
        """
        from pendcore._accuracy.defect import defect

        return defect(self.scene, self._run, progress)

    def estimate_error(
        self, *, time_limit: float | None = None, progress: Progress = None
    ) -> ErrorEstimate:
        """Estimate the error over time from independent second runs, made when first asked for.

        The second runs use another method, at a hundredth of this run's tolerances or less, with
        constants and start moved by some last bits. If the run switched to ``"radau5"``, second
        runs use ``"radau5"`` too. They end where they have nothing in common with this run any
        more. A run that kept an ``error`` has the estimate that verified it.

        Parameters
        ----------
        time_limit : float, optional
            s of wall-clock time, > 0, after which the estimate ends where it is.
        progress : as in `simulate`

        Returns
        -------
        ErrorEstimate
            ``.t`` (n_t,), s, ``.angle``, rad, ``.position``, a share of the total length.

        Raises
        ------
        KeyboardInterrupt, or any exception of ``progress`` or of an effect's function
            The attribute ``estimate`` is what was found so far, ``solution`` is this run.

        Examples
        --------
        >>> sol = pc.Case.textbook().simulate()
        >>> error = sol.estimate_error()
        >>> f"{error.angle.max():.0e} rad, {error.position.max():.0e} of the length"
        '5e-09 rad, 2e-09 of the length'
        """
        from pendcore._accuracy.estimate import error_of

        return error_of(self, time_limit=time_limit, progress=progress)

    def valid_until(
        self, limit: float = 0.1, *, of: str = "angle", time_limit: float | None = None
    ) -> float:
        """Return how far to trust the run: the time at which its error passes a limit, s.

        The answer errs on the safe side.

        Parameters
        ----------
        limit, of
            As in `ErrorEstimate.valid_until`.
        time_limit : float, optional
            As in `estimate_error`; the answer is then how far the run is known to hold by then.

        Examples
        --------
        >>> sol = pc.simulate(pc.Scene.textbook(), (0, 40), 0.0)  # chaotic
        >>> f"{sol.valid_until():.0f} s, {sol.valid_until(1e-6, of='position'):.0f} s"
        '18 s, 7 s'
        """
        return self.estimate_error(time_limit=time_limit).valid_until(limit, of=of)

    def sensitivity_errors(self) -> Floats:
        """Estimate how far the sensitivities of this run are off, as the run's tolerances let them.

        They are compared with those along a run whose tolerances are a tenth, or whose steps are
        half as long. Sensitivities that are no larger than their errors mean nothing:
        `sensitivities_valid_until` says from when on.

        Returns
        -------
        ndarray, (n_t, k)
            The largest difference among the angles (rad) and rates (rad/s) per unit of each name.
            NaN where one of the two runs has no derivative: where a joint only just grazes its
            stop, the other run may do so though this one does not, and nothing is known of the
            error from there on.

        Raises
        ------
        ValueError
            If the run has no sensitivities.

        Examples
        --------
        >>> scene = pc.Scene.textbook()
        >>> sol = pc.simulate(scene, (0, 5), 0.5, sensitivities=["q0[1]"], rtol=1e-6)
        >>> bool(sol.sensitivity_errors().max() < 1e-2)
        True
        """
        from pendcore._run.sensitivities import errors_of

        if self.known_sensitivity_errors is None:
            self.known_sensitivity_errors = errors_of(self)
            self.known_sensitivity_errors.flags.writeable = False
        return self.known_sensitivity_errors.copy()

    def sensitivities_valid_until(self, limit: float = 0.1) -> Floats:
        """Return how far to trust the sensitivities: when their errors pass a limit, by each name.

        That is the last of the kept times up to which both hold: `sensitivity_errors` are at most
        ``limit`` times the largest that the sensitivities by this name have been until then, and
        the run itself is right, as `valid_until` says. Both errors grow as the sensitivities do.
        Sensitivities are slopes: they tell what a change of a name makes of the run as long as
        that is small, far below 1 rad.

        Parameters
        ----------
        limit : float
            > 0 and finite, a share of the largest sensitivity.

        Returns
        -------
        ndarray, (k,)
            s; the start of the run, if the error at the first kept time is beyond the limit.

        Raises
        ------
        ValueError
            If the run has no sensitivities, or a limit is not above 0 or not finite.

        Examples
        --------
        >>> sol = pc.simulate(pc.Scene.textbook(), (0, 40), 0.0, sensitivities=["q0[1]"])
        >>> sol.sensitivities_valid_until().round(), sol.sensitivities_valid_until(1e-6).round()
        (array([17.]), array([7.]))
        """
        from pendcore._run.sensitivities import valid_until_of

        return valid_until_of(self, limit)

    def sensitivities_at(self, t: npt.ArrayLike) -> Floats:
        """Return the sensitivities at any time within the run, d(q, qd)/d(name).

        The run is made again with its own steps, whatever it kept, and is known at these times as
        well as at its steps. At a jump they are those after it, as in ``sol(t)``.

        Parameters
        ----------
        t : float or array_like, (k,)
            s, in any order.

        Returns
        -------
        ndarray, (2n, m) or (k, 2n, m)
            For the m names of ``sensitivity_names``, rad and rad/s per unit of what is named.

        Raises
        ------
        ValueError
            If a time lies outside the run, the run has no sensitivities, or it takes another course
            when it is made again, because a function of the user's gives other values now.

        Examples
        --------
        >>> names = ["q0[1]", "gravity"]
        >>> sol = pc.simulate(pc.Scene.textbook(), (0, 5), 0.5, sensitivities=names)
        >>> sol.sensitivities_at(2.5)[:2].round(3)  # of both angles, by each name
        array([[ 0.99 ,  0.058],
               [ 0.169, -0.056]])
        >>> sol.sensitivities_at([2.5, 1.0]).shape
        (2, 4, 2)
        """
        from pendcore._run.sensitivities import sensitivities_at

        return sensitivities_at(self, t)

    def output_sensitivities(
        self, outputs: Iterable[str], t: npt.ArrayLike | None = None
    ) -> Floats:
        """Return how places, velocities and energies change with each name, at fixed times.

        With S the sensitivities and h an output, that is ``h_y S + h_p``: a longer link moves the
        tip at the same angles, too, and a pivot that is pushed from the start of the run on,
        ``"pivot.x"``, carries places, velocities and energies along.

        Parameters
        ----------
        outputs : iterable of str, p of them
            Those of `Scene.linearize`: ``"x[2]"``, ``"vy[1]"``, ``"phi[2]"``, ``"energy"``, ...
        t : float or array_like, (k,), optional
            Times within the run, s, as in `sensitivities_at`. Default: the kept times.

        Returns
        -------
        ndarray, (n_t, p, m); (k, p, m) or (p, m) with ``t``
            m, m/s, J, ... per unit of each of the m names of ``sensitivity_names``. NaN where the
            sensitivities have none.

        Raises
        ------
        ValueError
            If the run has no sensitivities, an output is not known, or a time lies outside the run.

        Warns
        -----
        PendcoreWarning
            If ``"qdd[1]"`` is asked for and `Scene.linearize` refuses some of the states: at a
            stop, in a joint at rest under dry friction. There it is NaN.

        Notes
        -----
        Energies are polynomials and sines of all that they depend on, so that differences of a few
        of their values are exact to rounding.

        Examples
        --------
        >>> names = ["q0[1]", "link[2].length"]
        >>> sol = pc.simulate(pc.Scene.textbook(), (0, 2), 0.5, sensitivities=names)
        >>> by = sol.output_sensitivities(["x[2]", "energy"])
        >>> by.shape == (len(sol.t), 2, 2)
        True
        >>> by[-1, 1].round(4)  # J/rad, J/m: nothing takes energy out, so they are as at the start
        array([-12.9097,  -2.3509])
        >>> (-9.807 * np.array([1.5 * np.cos(0.5), 0.5 * np.sin(0.5)])).round(4)
        array([-12.9097,  -2.3509])
        """
        from pendcore._run.output_sensitivities import output_sensitivities

        return output_sensitivities(self, outputs, t)

    def event_sensitivities(self) -> list[EventSensitivities]:
        """Find how the times of events, and the states there, change with each name.

        With S the sensitivities at a fixed time, f the rates of change of the state and g the
        event's function, ``dt = -(g_y S + g_p) / (g_t + g_y f)`` and ``dy = S + f dt``. Where an
        impact turns a rate round, or a joint comes to stick, ``dt = -(S_after - S_before) /
        (f_after - f_before)`` of what is continuous there, and the state is the one after it. The
        run is made again with its own steps, and keeps its bits.

        Returns
        -------
        list of EventSensitivities
            One for each event asked for, with ``t`` (k, m) and ``y`` (k, 2n, m) for the k times in
            ``events`` and the m names of ``sensitivity_names``. NaN where an event has no
            derivative: where it only touches zero (``direction`` 0); by a name that moves it away
            from an impact on which it falls, to rounding; the rates, by a name that moves it away
            from where a joint sticks or another law changes; between the last bounces before rest,
            some 5e-8 s apart; and where S has none.

        Raises
        ------
        ValueError
            If the run has no sensitivities, or looked for no events.

        Notes
        -----
        A `pendcore.events.Function` is differentiated by central differences in t, q and qd, to
        some ten digits where it is smooth; what else it depends on is taken as fixed.

        Examples
        --------
        >>> turn = pc.events.RateZero(link=1)
        >>> how = {"sensitivities": ["q0[1]", "gravity"], "events": [turn]}
        >>> sol = pc.simulate(pc.Scene.textbook(), (0, 3), 0.5, **how)
        >>> sol.event_sensitivities()[0].t.round(3)  # two turns: s/rad, s^3/m
        array([[-0.167, -0.061],
               [-0.256, -0.126]])
        """
        from pendcore._run.event_sensitivities import sensitivities_at_events

        return sensitivities_at_events(self)

    def extreme_sensitivities(self) -> ExtremeSensitivities:
        """Find the least and the greatest angles and rates, and how they change with each name.

        Where a component turns back, its derivative is the sensitivity there, whatever its time
        does. Where it is extreme at an impact, or where a law changes, that time moves by dt, and
        with the rates of change f before and after it, what is continuous tells by how much:
        ``dt = -(S_after - S_before) / (f_after - f_before)``; the derivative is ``S + f dt``. The
        ends of the run are fixed, but for one at which an event ended it.

        Returns
        -------
        ExtremeSensitivities
            ``values`` and ``t``, (2, 2n), and ``sensitivities``, (2, 2n, m). Derivatives are NaN
            where a component is as small, or as large, at several places by the run's tolerances,
            and these change differently, and where the sensitivities have none.

        Raises
        ------
        ValueError
            If the run has no sensitivities, or cannot be had again: see `with_dense_output`.

        Examples
        --------
        >>> names = ["q0[1]", "link[1].length"]
        >>> sol = pc.simulate(pc.Scene.textbook(), (0, 5), 0.5, sensitivities=names)
        >>> found = sol.extreme_sensitivities()
        >>> f"link 1 comes to {found.values[1, 0]:.3f} rad at {found.t[1, 0]:.3f} s"
        'link 1 comes to 2.686 rad at 3.744 s'
        >>> found.sensitivities[1, 0].round(3)  # rad/rad, rad/m
        array([-0.739,  0.105])
        """
        from pendcore._run.extreme_sensitivities import sensitivities_at_extremes

        return sensitivities_at_extremes(self)

    def lyapunov(
        self,
        *,
        count: int | None = None,
        transient: float = 0.0,
        t_eval: npt.ArrayLike | None = None,
        progress: Progress = None,
    ) -> LyapunovExponents:
        """Compute the Lyapunov exponents of this very run, 1/s; see `pendcore.lyapunov`.

        Examples
        --------
        >>> found = pc.Case.textbook().simulate().lyapunov()
        >>> found.exponents.round(2)  # 1/s
        array([ 0.42,  0.04, -0.06, -0.44])
        """
        from pendcore._horizon.lyapunov import lyapunov_of

        how = {"count": count, "transient": transient, "t_eval": t_eval, "progress": progress}
        return lyapunov_of(self, **how)

    def with_dense_output(self) -> Solution:
        """Return the run with a state at any time; one that kept none is run again, to the bit.

        Raises
        ------
        ValueError
            If the run cannot be had again: a function of the user's gives other values now, another
            version wrote the file, or the dense output would take more than 2 GiB.

        Examples
        --------
        >>> ends = pc.simulate(pc.Scene.textbook(), (0, 5), 0.5, store="end")
        >>> ends.with_dense_output()(2.5).round(4)
        array([ 0.4186,  0.7948,  0.4516, -0.4362])
        """
        from pendcore._run.dense_output import with_dense_output

        return with_dense_output(self)

    def resume(
        self,
        t_end: float,
        t_eval: npt.ArrayLike | None = None,
        *,
        max_steps: int = RUN_DEFAULTS["max_steps"],
        time_limit: float | None = None,
        on_failure: OnFailure = "warn",
        progress: Progress = None,
    ) -> Solution:
        """Continue to a later end, bitwise as if the run had never stopped.

        Parameters
        ----------
        t_end : float
            s; not before the end of this run, in its direction.
        t_eval : array_like, (k,), optional
            More times to keep, s: at or beyond the end of this run, and beyond its own ``t_eval``.
            Only a run that had a ``t_eval`` takes it; without more times it keeps nothing later,
            but ``y_reached`` has its end.
        max_steps, time_limit, on_failure, progress
            As in `simulate`, for the continuation. It begins before the first attempt that the
            earlier ``t_end`` cut short, because all later steps depend on that cut. Attempts that
            are repeated to the same ``t_end`` do not count, so a ``max_steps`` of 1 makes progress,
            too.

        Returns
        -------
        Solution
            The whole run, from its first start. This solution does not change.

        Raises
        ------
        ValueError, TypeError
            If an argument is out of its range or of the wrong type; the message names it.

        Examples
        --------
        >>> case = pc.Case.textbook()
        >>> longer = case.simulate().resume(10.0)
        >>> whole = pc.simulate(case.scene, (0, 10), case.q0, method="ode45")
        >>> np.array_equal(longer.y, whole.y)  # every bit
        True
        """
        from pendcore._run.call import resumed
        from pendcore._run.run_error import checked, require_on_failure

        require_on_failure(on_failure)
        longer = resumed(
            self, t_end, t_eval, max_steps=max_steps, time_limit=time_limit, progress=progress
        )
        return checked(longer, on_failure)

    def case(self) -> Case:
        """Return the case of this run, ready to be run again or written as TOML.

        Examples
        --------
        >>> sol = pc.Case.textbook().simulate()
        >>> again = sol.case().simulate()
        >>> np.array_equal(again.y, sol.y)
        True
        """
        from pendcore._cases.case import case_of

        return case_of(self)

    def save(self, path: str | os.PathLike[str], *, progress: Progress = None) -> None:
        """Write everything to a file of NumPy's npz format; see `pendcore.load`.

        The file has just that name, and is complete or absent. ``progress`` is as in `simulate`.

        Examples
        --------
        >>> sol = pc.Case.textbook().simulate()
        >>> sol.save("run.npz")
        >>> np.array_equal(pc.load("run.npz").y, sol.y)
        True
        """
        from pendcore._cases.archive import save

        save(self, path, progress=progress)

    def to_pandas(self) -> pd.DataFrame:
        """Return a table with a row per time and the columns q_1.., qd_1..; units in ``attrs``.

        Times are in s, angles in rad, rates in rad/s. ``attrs`` also holds ``case``, the TOML of
        what was simulated, unless an effect or an event is a function. ImportError if pandas is not
        installed.

        Examples
        --------
        >>> sol = pc.Case.textbook().simulate()
        >>> table = sol.to_pandas()
        >>> table.iloc[-1].round(4).to_dict()
        {'q_1': 1.0831, 'q_2': 0.5385, 'qd_1': 1.0004, 'qd_2': 0.3936}
        >>> table.attrs["units"]["qd_2"]
        'rad/s'
        """
        from pendcore._cases.export import to_pandas

        return to_pandas(self)

    def to_xarray(self) -> xr.Dataset:
        """Return ``q`` and ``qd`` over time and link; units and the case in ``attrs``.

        Times are in s, angles in rad, rates in rad/s; each is (n_t, n). The case is there as TOML
        unless an effect or an event is a function. ImportError if xarray is not installed.

        Examples
        --------
        >>> sol = pc.Case.textbook().simulate()
        >>> data = sol.to_xarray()
        >>> f"{data.qd.sel(link=2)[-1]:.4f} {data.qd.attrs['units']}"
        '0.3936 rad/s'
        """
        from pendcore._cases.export import to_xarray

        return to_xarray(self)

    def __reduce__(self) -> tuple[type[Solution], tuple[Any, ...]]:
        # The scene comes first: if it cannot be pickled, its message says so best.
        verified = None if self.accuracy is None else self.known_error
        derivatives = self.sensitivities, self.sensitivity_names
        return type(self), (
            self.scene, self._run, self.name, self.accuracy, verified, *derivatives
        )  # fmt: skip

    def __deepcopy__(self, memo: object) -> Solution:
        make, parts = self.__reduce__()
        return make(*parts)  # none of these ever changes, so the copy shares them

    def __repr__(self) -> str:
        from pendcore.explanation.solution_text import text

        return text(self)

    def _repr_html_(self) -> str:
        from pendcore.explanation.solution_html import html

        return html(self)

    def plot(
        self,
        what: What = "angles",
        ax: Any = None,
        *,
        label: str | None = None,
        horizon: float | None = None,
        t: npt.ArrayLike | None = None,
        event: int | None = None,
        link: int | None = None,
        **line_properties: Any,
    ) -> list[Artist]:
        """Draw a figure; without ``what``, the textbook's: the angles, deg, over time, s.

        Curves go from the first to the last time that was kept, or from start to end if there is
        but one. A run without dense output is simulated anew where it is not known between them.

        =================  ========================================================================
        ``"angles"``       the absolute angle of each link, deg, over time
        ``"rates"``        the rate of each link, rad/s, over time
        ``"reactions"``    the force on each link at its joint, N, over time: x, y (down), magnitude
        ``"energy"``       kinetic, potential and total energy, J, over time; with ``ledger=True``
                           the work and loss of every effect
        ``"path"``         the path of the tip in the plane, with the chain at the start and the end
        ``"phase"``        the rate of each link, rad/s, over its angle, rad
        ``"section"``      a Poincare section: rate over angle of a ``link`` where an ``event``
                           happened, an index into ``sol.events``; without one, of the first link
                           whose angle differs there
        ``"strip"``        the chain at the times ``t``, s, (k,), four in a row
        ``"free_bodies"``  each link by itself with the forces on it, N, at the time ``t``, s;
                           couples in joints are not drawn
        =================  ========================================================================

        Parameters
        ----------
        what : str
            The figure.
        ax : Axes or array of Axes, optional
            One axes; for angles, rates and phase also one for each link, for reactions one for each
            joint, for energy as many as it has panels. Default: a new figure of pyplot's, which is
            not shown. Where curves are drawn already, the next ones are dashed.
        label : str, optional
            Name of this solution in the legend.
        horizon : float, optional
            rad. What lies past the time at which the estimated error passes it is shaded or pale,
            and the legend says that time
            (`valid_until`: that takes further runs, when it is first asked for).
        t, event, link
            As above. Defaults: eight times along the curves, or where they begin; 0; as above.
        **line_properties
            Passed on to matplotlib's ``Line2D``, such as ``color``, ``linestyle`` or ``linewidth``;
            free bodies have no lines.

        Returns
        -------
        list of Artist
            The lines; of poses also texts and arrows. ``artists[0].axes`` leads to the rest.

        Raises
        ------
        ValueError, TypeError
            If there is no such figure, or a parameter is not one of it; in the words of ``sol(t)``
            if the run kept no dense output and cannot be simulated anew: a function of the user's
            gives other values now, say.

        Examples
        --------
        >>> sol = pc.Case.textbook().simulate()
        >>> first, second = sol.plot(label="section 2.1")
        >>> second.axes.get_ylabel()  # .axes.figure.savefig("angles.png") keeps it
        '$q_{2}$ (deg)'
        >>> sol.plot("path")[0].axes.get_ylabel()
        'y (m), downwards'
        """
        from pendcore.plotting.plot import plot

        own = {"t": t, "event": event, "link": link, "label": label, "horizon": horizon}
        return plot(self, what, ax, own, line_properties)

    def animate(
        self,
        *others: Solution,
        names: tuple[str, ...] | None = None,
        speed: float = 1.0,
        fps: float = 30.0,
        trace: float | None = 2.0,
        reactions: bool = False,
        energy: bool = False,
        horizon: float | None = None,
        beside: bool = False,
    ) -> FuncAnimation:
        """Return matplotlib's animation of the run, in true time; keep it while it is to move.

        The parameters are those of `to_video`. In a notebook ``HTML(sol.animate().to_jshtml())``
        shows it; `to_video` writes it far faster than ``animation.save``.

        Examples
        --------
        >>> sol = pc.Case.textbook().simulate()
        >>> animation = sol.animate(energy=True)
        >>> len([*animation.new_frame_seq()])  # 5 s at 30 frames a second
        151
        """
        from pendcore.plotting.stage import Film, animate

        film = Film(
            solutions=(self, *others), names=names, speed=speed, fps=fps, trace=trace,
            reactions=reactions, energy=energy, horizon=horizon, beside=beside,
        )  # fmt: skip
        return animate(film)

    def to_video(
        self,
        path: str | os.PathLike[str],
        *others: Solution,
        names: tuple[str, ...] | None = None,
        speed: float = 1.0,
        fps: float = 30.0,
        trace: float | None = 2.0,
        reactions: bool = False,
        energy: bool = False,
        horizon: float | None = None,
        beside: bool = False,
        size: tuple[int, int] | None = None,
        progress: Progress = None,
    ) -> Path:
        """Write a film of the run, in true time; return where it is.

        In a wide frame, curves stand beside the chain: the angles, unless others are asked for.

        A run without dense output is simulated anew for it, or refused in the words of ``sol(t)``.

        Parameters
        ----------
        path : path
            Ends with ``.mp4`` (takes ffmpeg, or the package imageio-ffmpeg; without either, a GIF
            is written, and a warning says so) or with ``.gif``. The file is complete or absent.
        *others : Solution
            More runs in the same film: on top of this one, or with ``beside`` next to it.
        names : tuple of str, optional
            What the runs are called beside their tips. Default: their names, if there are several.
        speed : float
            How fast time passes; 1 is true time, 0.25 slow motion.
        fps : float
            Frames a second.
        trace : float, optional
            s of the run that the trace of the tip shows; None draws none.
        reactions : bool
            Whether arrows show the force on each link at its joint, and, of a single run, curves
            show their magnitudes, N. Arrows are as long as forces are large, within limits: the
            shortest can be seen, and the largest twentieth of the forces are as long as each other.
        energy : bool
            Whether the energies of this run are shown over time, in place of the angles.
        horizon : float, optional
            rad; a run is drawn pale past the time until which its error is below this
            (`Solution.valid_until`, which takes further runs); the film says that time.
        beside : bool
            Whether several runs are drawn side by side.
        size : (int, int), optional
            Width and height in pixels, even. Default: (1920, 1080), for a GIF (640, 360).
        progress : as in `simulate`

        Examples
        --------
        >>> sol = pc.Case.textbook().simulate()
        >>> sol.to_video("swing.gif", speed=2).name
        'swing.gif'
        """
        from pendcore.plotting.stage import Film
        from pendcore.plotting.video import to_video

        film = Film(
            solutions=(self, *others), names=names, speed=speed, fps=fps, trace=trace,
            reactions=reactions, energy=energy, horizon=horizon, beside=beside,
        )  # fmt: skip
        return to_video(film, path, size, progress)

    def to_html(self, path: str | os.PathLike[str], *, title: str | None = None) -> Path:
        """Write the run as one page with the core inside, which opens from disk; return its path.

        The page simulates by itself, with the bits of this run, and says so by both hashes. Its
        reader drags links, changes every parameter, adds effects, chooses method and tolerance, and
        sees reactions, energies, until when the run can be trusted, and what accuracy costs. Its
        address holds the run that it shows. Pages of scenes with functions of one's own, and pages
        made by an install without the core for browsers, play back what was computed here, and say
        so. The file is complete or absent.

        Parameters
        ----------
        path : path
        title : str, optional
            The headline. Default: the name of the run.

        Examples
        --------
        >>> sol = pc.Case.textbook().simulate()
        >>> sol.to_html("run.html").name
        'run.html'
        """
        from pendcore._cases.whole_file import whole_file
        from pendcore.page.html import page_of

        if Path(path).suffix.lower() not in (".html", ".htm"):
            raise ValueError(f"path = {os.fspath(path)!r}: must end with .html")
        page = page_of(self, title)
        with whole_file(path) as file:
            file.write_text(page, encoding="utf-8")
        return Path(path)

    def page(self, *, height: int = 900) -> NotebookPage:
        """Return the page of `to_html` as a notebook shows it: alive, in exported notebooks, too.

        ``height`` is in pixels. A notebook grows by the size of the page.

        Examples
        --------
        >>> sol = pc.Case.textbook().simulate()
        >>> sol.page()._repr_html_()[:15]  # a notebook calls this
        '<iframe srcdoc='
        """
        from pendcore.page.html import page_of
        from pendcore.page.notebook import NotebookPage

        pixels = whole_number("height", height)
        return NotebookPage(page_of(self), pixels)

    def widget(self, *, height: int = 900) -> Any:
        """Return the same page as an anywidget (which takes that package).

        Its attribute ``case`` is the case that the page shows now, named as in a case file: what
        its reader has dragged and set can be read in Python.

        Examples
        --------
        >>> widget = pc.Case.textbook().simulate().widget()
        >>> widget.case is None  # until a notebook shows it
        True
        """
        from pendcore.page.html import page_of
        from pendcore.page.notebook import widget_of

        pixels = whole_number("height", height)
        return widget_of(page_of(self), pixels)
