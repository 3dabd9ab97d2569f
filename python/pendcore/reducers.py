"""What an ensemble keeps of each member beside its end: reducers for the ``keep`` of `ensemble`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from pendcore._messages.arguments import Floats, listed_names
from pendcore.events import Event


class Reducer:
    """What makes a number, or a few, of a whole run: one of the classes of `pendcore.reducers`.

    The core computes them. For anything else, keep the states at times, or go through the runs of
    `Ensemble.member`.

    Examples
    --------
    >>> isinstance(pc.reducers.EnergyDrift(), pc.reducers.Reducer)
    True
    """

    __slots__ = ()
    usual_name: ClassVar[str]
    """Its name, if it is given alone."""
    unit: ClassVar[str]
    axes: ClassVar[tuple[str, ...]] = ()
    """The names of its axes beyond those of the members."""
    is_log_if_wide: ClassVar[bool] = False
    """Whether figures show values of several orders of magnitude on a logarithmic scale."""
    needs_one_tolerance: ClassVar[bool] = False
    """Whether ``rtol`` and ``atol`` must be one number each, for all components."""
    is_told_by_states: ClassVar[bool] = False
    """Whether the angles tell which members are resolved, as no two runs have the same value."""

    def labels(self, n: int) -> dict[str, list[str]]:
        """Return its axes beyond those of the members, with the labels along each."""
        return {}

    @staticmethod
    def largest_difference(one: Floats, two: Floats) -> Floats | float:
        """Return how far values of two ensembles may differ and still confirm each other.

        It is 0.1 rad or rad/s unless a reducer says otherwise.
        """
        return 0.1


@dataclass(frozen=True, slots=True)
class FirstEvent(Reducer):
    """The time at which an event first happens, s; NaN where it does not.

    Parameters
    ----------
    event : pendcore.events.Event
        If it is ``terminal``, each member ends there, with status ``event``.

    Examples
    --------
    >>> over = pc.events.LinkAngle(2, -np.pi / 2, every_turn=True, terminal=True)
    >>> found = pc.ensemble(
    ...     pc.Scene.textbook(), q0=[[0.0, 0.0], [-1.2, -0.6]], t_span=(0, 5),
    ...     keep=pc.reducers.FirstEvent(over),
    ... )
    >>> found["first_event"].round(3)
    array([  nan, 1.343])
    """

    event: Event
    usual_name: ClassVar[str] = "first_event"
    unit: ClassVar[str] = "s"
    is_log_if_wide: ClassVar[bool] = True

    def __post_init__(self) -> None:
        if not isinstance(self.event, Event):
            wanted = "must be an event, such as pc.events.LinkAngle(1, 0.0)"
            raise TypeError(f"event = {self.event!r}: {wanted}")

    @staticmethod
    def largest_difference(one: Floats, two: Floats) -> Floats:
        """Return 1 % of the time."""
        return 0.01 * np.maximum(np.abs(one), np.abs(two))


@dataclass(frozen=True, slots=True)
class Extremes(Reducer):
    """The least and the greatest value of each angle, rad, and rate, rad/s, of a run: (2, 2n).

    They are found between the steps, on the dense output. Row 0 is the least values, row 1 the
    greatest; the columns are the angles of all links, then their rates.

    Examples
    --------
    >>> scene, starts = pc.Scene.textbook(), [[0.5, 1.0], [1.5, 1.5]]
    >>> found = pc.ensemble(scene, (0, 5), starts, keep=pc.reducers.Extremes())
    >>> np.ptp(found["extremes"], axis=1).round(2)[:, :2]  # rad, swings of both links
    array([[2.  , 2.67],
           [0.14, 0.21]])
    """

    usual_name: ClassVar[str] = "extremes"
    unit: ClassVar[str] = "rad, rad/s"
    axes: ClassVar[tuple[str, ...]] = ("extreme", "component")

    def labels(self, n: int) -> dict[str, list[str]]:
        """Return the axes and their labels."""
        return {"extreme": ["least", "greatest"], "component": _components(n)}


@dataclass(frozen=True, slots=True)
class EnergyDrift(Reducer):
    """The largest change of the total energy over the steps of a run, J.

    Where effects do work, it is the largest residual of the ledger, which each member then keeps.
    The energy tells of errors, but not how large they are: see `Ensemble.resolved`.

    Examples
    --------
    >>> found = pc.ensemble(
    ...     pc.Scene.textbook(), q0=[[0.5, 1.0], [1.5, 1.5]], t_span=(0, 5),
    ...     keep=pc.reducers.EnergyDrift(),
    ... )
    >>> bool((found["energy_drift"] < 1e-6).all())
    True
    """

    usual_name: ClassVar[str] = "energy_drift"
    unit: ClassVar[str] = "J"
    is_log_if_wide: ClassVar[bool] = True
    is_told_by_states: ClassVar[bool] = True


@dataclass(frozen=True, slots=True)
class LargestExponent(Reducer):
    """The largest finite-time Lyapunov exponent of a run, 1/s; see `pendcore.lyapunov`.

    It takes a run of its own, to the time that the member reached. Scenes with dry friction or
    stops have none.

    Examples
    --------
    >>> found = pc.ensemble(
    ...     pc.Scene.textbook(), q0=[[0.0, 0.0], [1.5, 1.5]], t_span=(0, 15),
    ...     keep=pc.reducers.LargestExponent(),
    ... )
    >>> found["largest_exponent"].round(2)
    array([1.02, 0.11])
    """

    usual_name: ClassVar[str] = "largest_exponent"
    unit: ClassVar[str] = "1/s"
    needs_one_tolerance: ClassVar[bool] = True

    @staticmethod
    def largest_difference(one: Floats, two: Floats) -> float:
        """Return a tenth of the largest exponent."""
        return 0.1 * float(np.nanmax(np.abs(one), initial=0.0))


@dataclass(frozen=True, slots=True)
class Sensitivities(Reducer):
    """The derivatives of a run's end by its start and by parameters, d(q, qd)/d(name): (2n, k).

    They have the bits of ``simulate(sensitivities=names)``, at each member's own values. Members
    run one by one in each thread, not in lanes. NaN stands where there is no derivative: in members
    that fail or are not run, and where the motion has none after some time, of which
    `Ensemble.member` warns. ``print(found)`` counts the members that have all; `Ensemble.resolved`
    says of those that have none, in both runs, that the two agree.

    Parameters
    ----------
    names : list of str, (k,)
        Those of ``simulate(sensitivities=...)``, whether they vary or not: ``"q0[1]"``,
        ``"qd0[2]"``, ``"torque[1]"``, ``"pivot.x"``, or any of `Scene.parameters`.

    Examples
    --------
    >>> names = ["q0[1]", "link[2].mass"]
    >>> found = pc.ensemble(
    ...     pc.Scene.textbook(), q0=[[0.5, 1.0], [1.5, 1.5]], t_span=(0, 2),
    ...     keep=pc.reducers.Sensitivities(names),
    ... )
    >>> found["sensitivities"].shape
    (2, 4, 2)
    >>> found["sensitivities"][:, 1, 1].round(3)  # of q_2 by the mass of link 2, rad/kg
    array([-0.543, -0.014])
    """

    names: Sequence[str]
    usual_name: ClassVar[str] = "sensitivities"
    unit: ClassVar[str] = "rad, rad/s per unit of each name"
    axes: ClassVar[tuple[str, ...]] = ("component", "by")

    def __post_init__(self) -> None:
        names = listed_names("names", self.names, "q0[1]")
        if not names:
            raise ValueError('names = []: must have one or more, such as ["q0[1]"]')
        object.__setattr__(self, "names", names)

    def labels(self, n: int) -> dict[str, list[str]]:
        """Return the axes and their labels."""
        return {"component": _components(n), "by": [*self.names]}

    @staticmethod
    def largest_difference(one: Floats, two: Floats) -> Floats:
        """Return 1 % of the largest derivative of each member by the same name."""
        largest: Floats = np.maximum(np.abs(one), np.abs(two)).max(axis=-2, keepdims=True)
        return 0.01 * largest


def _components(n: int) -> list[str]:
    return [f"{name}_{i}" for name in ("q", "qd") for i in range(1, n + 1)]


REDUCERS: tuple[type[Reducer], ...] = (
    FirstEvent,
    Extremes,
    EnergyDrift,
    LargestExponent,
    Sensitivities,
)
"""Those that the core computes, in the order of its arguments."""


__all__ = [
    "EnergyDrift",
    "Extremes",
    "FirstEvent",
    "LargestExponent",
    "Reducer",
    "Sensitivities",
]
__dir__ = __all__.copy
