"""What one run found: times, angles, rates, and what follows from them.

n is the number of links, n_t the number of kept times. Angles are absolute, from +x towards +y, and
y points **down**. Nothing is computed before it is asked for.
"""

from __future__ import annotations

from typing import TypeVar

import numpy as np
import numpy.typing as npt

from pendcore import _core
from pendcore.messages.arguments import Floats, finite_array, known_keywords
from pendcore.messages.progress import Progress
from pendcore.run.accuracy import Accuracy
from pendcore.run.energy import Energy, Ledger
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

    __slots__ = ("_events", "accuracy", "known_error", "name", "run", "scene")

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

    @known_keywords
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

    @known_keywords
    def events_asked_for(self) -> list[Event]:
        """Return the events that the run looked for."""
        return [event_of(kind, values) for kind, values in self.run.arguments["events"]]

    @known_keywords
    def relative_angles(self) -> Floats:
        """Angles of the joints, phi_i = q_i - q_{i-1} with q_0 = 0, rad, (n_t, n)."""
        return np.diff(self.q, prepend=0.0)

    @known_keywords
    def accelerations(self) -> Floats:
        """Angular accelerations, rad/s^2, (n_t, n)."""
        return self.scene.accelerations(self.t, self.q, self.qd)

    @known_keywords
    def positions(self) -> Floats:
        """Pivot, joints and tip, m, (n_t, n+1, 2): x right, y down; a driven pivot moves."""
        return self.scene._compiled.positions(self.t, self.q)

    @known_keywords
    def mass_centers(self) -> Floats:
        """Mass centres of the links, a payload excluded, m, (n_t, n, 2): x right, y down."""
        return self.scene._compiled.mass_centers(self.t, self.q)

    @known_keywords
    def reactions(self) -> Floats:
        """Force on each link at the joint where it begins, N, (n_t, n, 2): x right, y down.

        The textbook's F_01 (the ground's on link 1), F_12 (link 1's on link 2), and so on.
        """
        return self.scene._compiled.reactions(self.t, self.q, self.qd)

    @known_keywords
    def energy(self) -> Energy:
        """Kinetic, potential and total energy, J, each (n_t,), and the ledger if one was kept."""
        kinetic, potential = self.scene._compiled.energy(self.t, self.q, self.qd)
        with np.errstate(all="ignore"):  # a blow-up's energies may be infinite
            total = kinetic + potential
        asked = self.run.arguments
        if not asked["ledger"]:
            return Energy(kinetic, potential, total)
        start = self.scene._compiled.energy(
            np.array([asked["t_start"]]), asked["q0"][np.newaxis], asked["qd0"][np.newaxis]
        )
        with np.errstate(all="ignore"):
            gain = total - sum(start)
            return Energy(kinetic, potential, total, Ledger(self.run.ledger, gain))

    @known_keywords
    def largest_reactions(self, *, progress: Progress = None) -> list[LargestReaction]:
        """Return the largest force of each joint: ``.joint``, ``.force`` (N), ``.t`` (s).

        A run that stored its interpolants gives the largest force on the whole curve, also between
        steps and on both sides of every jump; other runs give the largest at the kept times. The
        impulse of an impact is not a force. See `pendcore.LargestReaction`; ``progress`` is as in
        `simulate`.
        """
        return largest_reactions(self.scene, self.run, progress)
