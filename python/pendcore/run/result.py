"""What one run found: times, angles, rates, and what follows from them.

n is the number of links, n_t the number of kept times. Angles are absolute, from +x towards +y, and
y points **down**. Nothing is computed before it is asked for.
"""

from __future__ import annotations

from typing import TypeVar

import numpy as np
import numpy.typing as npt

from pendcore import _core
from pendcore.messages.arguments import Floats, finite_array, text
from pendcore.messages.progress import Progress
from pendcore.run.accuracy import Accuracy
from pendcore.run.energy import Energy, energy_over
from pendcore.run.error_estimate import ErrorEstimate
from pendcore.run.events import Event, event_of
from pendcore.run.found_events import FoundEvents, found_events
from pendcore.run.largest_reactions import LargestReaction, largest_reactions
from pendcore.run.statistics import Statistics
from pendcore.scene.scene import SceneData

Result = TypeVar("Result", bound="RunResult")


class RunResult:
    """A run without what is built on it; `pendcore.Solution` has the rest.

    Attributes
    ----------
    scene : SceneData
        What moved.
    run : pendcore._core.Run
        The core's run: what was asked for, what was kept, and what is needed to resume.
    name : str
        A name for people.
    accuracy : Accuracy or None
        What ``simulate(error=...)`` asked for, reached and paid; else None.
    known_error : ErrorEstimate or None
        How far off the run is, once it has been estimated.
    """

    __slots__ = ("_events", "_name", "accuracy", "known_error", "run", "scene")

    def __init__(
        self,
        scene: SceneData,
        run: _core.Run,
        name: str = "",
        accuracy: Accuracy | None = None,
        error: ErrorEstimate | None = None,
    ) -> None:
        self.scene, self.run, self.name = scene, run, name
        self.accuracy, self.known_error = accuracy, error
        self._events: list[FoundEvents] | None = None

    @property
    def name(self) -> str:
        """A name for people; it may be set to any text that a file can hold."""
        return self._name

    @name.setter
    def name(self, name: str) -> None:
        self._name = name if name == "" else text("name", name)  # 3 % of a run of one step

    @property
    def t(self) -> Floats:
        """Times of the accepted steps, or ``t_eval``, s, (n_t,)."""
        return self.run.t

    @property
    def q(self) -> Floats:
        """Absolute angles, rad, (n_t, n)."""
        return self.run.states[:, : len(self.scene.links)]

    @property
    def qd(self) -> Floats:
        """Angular rates, rad/s, (n_t, n)."""
        return self.run.states[:, len(self.scene.links) :]

    @property
    def y(self) -> Floats:
        """States as SciPy lays them out, (2n, n_t): q_1..q_n (rad), then qd_1..qd_n (rad/s)."""
        return self.run.states.T

    @property
    def t_reached(self) -> float:
        """The time to which the run came, s: its end, or where it broke off.

        With ``t_eval`` it may lie beyond all of ``t``.
        """
        return self.run.t_reached

    @property
    def y_reached(self) -> Floats:
        """The state at ``t_reached``, (2n,): q_1..q_n (rad), then qd_1..qd_n (rad/s).

        Examples
        --------
        >>> how = {"t_eval": [9.0], "max_steps": 5, "on_failure": "ignore"}
        >>> sol = pc.simulate(pc.Scene.textbook(), (0, 9), q0=0.5, **how)
        >>> len(sol.t), f"{sol.t_reached:.1f} s", sol.y_reached.shape
        (0, '0.5 s', (4,))
        """
        return self.run.y_reached

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

        Examples
        --------
        >>> sol = pc.Case.textbook().simulate()
        >>> sol(2.5).round(4)  # q_1, q_2 (rad), qd_1, qd_2 (rad/s)
        array([ 0.9337,  0.7049, -0.0193,  1.4848])
        >>> sol([0.0, 2.5, 5.0]).shape
        (4, 3)
        """
        times = finite_array("t", t, "s")
        if times.ndim > 1:
            raise ValueError(f"t: shape {times.shape}: must be a number or (k,) (s)")
        states = self.run.evaluate(times.reshape(-1)).T
        return states[:, 0] if times.ndim == 0 else states

    @property
    def status(self) -> str:
        """How the run ended, in a word: ``"finished"``, ``"max_steps"``, ``"non_finite"``, ..."""
        return self.run.status

    @property
    def message(self) -> str:
        """How the run ended, in a sentence, with advice where there is some."""
        return self.run.message

    @property
    def success(self) -> bool:
        """Whether the run reached its end, or an event ended it as asked."""
        return self.run.success

    @property
    def method(self) -> str:
        """Name of the method."""
        return self.run.method

    @property
    def store(self) -> str:
        """What was kept: ``"dense"``, ``"steps"``, ``"times"`` or ``"end"``."""
        return self.run.store

    @property
    def stats(self) -> Statistics:
        """What the run took: right-hand sides, steps, and what limited them."""
        return Statistics(**self.run.statistics)

    @property
    def events(self) -> list[FoundEvents]:
        """What was found of each event asked for: a list for each, with arrays ``t, q, qd, y``.

        The states come from the method's interpolant at the exact place in the step;
        ``sol(event.t)`` differs by the rounding of t. See `pendcore.events.FoundEvents`.
        """
        if self._events is None:
            self._events = found_events(
                len(self.events_asked_for()), len(self.scene.links), self.run.found
            )
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
        return [event_of(kind, values) for kind, values in self.run.arguments["events"]]

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

    def energy(self) -> Energy:
        """Kinetic, potential and total energy, J, each (n_t,), and the ledger if one was kept.

        Examples
        --------
        >>> energy = pc.Case.textbook().simulate().energy()
        >>> f"{energy.total[0]:.4f} J at first, {energy.total[-1]:.4f} J at last"
        '-14.6484 J at first, -14.6484 J at last'
        """
        run = self.run
        return energy_over(self.scene, run.arguments, run.t, run.states, run.ledger)

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
        return largest_reactions(self.scene, self.run, progress)
