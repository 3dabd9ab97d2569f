"""Motions that repeat: found by Newton's method, with multipliers, families and manifolds."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from math import log
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from pendcore import Scene, Solution, events, simulate
from pendcore.messages import Floats, did_you_mean, require_scene, vector, whole_number
from pendcore.orbits.continuation import followed
from pendcore.orbits.guess import (
    cut_as_it_grows,
    finite_positive,
    period_of,
    require_free_joints,
    require_same_after,
    states_given,
)
from pendcore.orbits.manifold import SECTION, Manifold
from pendcore.orbits.multipliers import Complexes, direction, multipliers, product
from pendcore.orbits.shooting import (
    Arcs,
    Closed,
    NotClosedError,
    Shooting,
    require_energy,
    total_energy,
    velocity,
)

KEEP_ENERGY = {"torsional_spring", "rotor_inertia", "payload"}
"""The effects beside which the energy is kept."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class PeriodicOrbit:
    """A motion that repeats, or that does but for whole turns of links.

    Attributes
    ----------
    scene : Scene
    q0, qd0 : ndarray, (n,)
        Where it is at t = 0, rad and rad/s.
    period : float
        s.
    turns : ndarray, (n,)
        By how many whole turns each link has gone round when the orbit closes.
    energy : float
        J, at t = 0; it is kept unless an effect changes it.
    is_forced : bool
        Whether a drive sets the period.
    monodromy : ndarray, (2n, 2n)
        The derivative of the state after a period by (q0, qd0).
    multipliers : ndarray, (2n,)
        Floquet's, the eigenvalues of ``monodromy``, complex, the largest first. Those that are 1
        for every such orbit are exactly 1: one where no drive sets the period, two where energy
        is kept.
    closure : float
        By how much the arcs of the orbit fail to close, rad; rates count over 2 pi/period.
    state_error : ndarray, (2n,)
        How far (q0, qd0) may be from the orbit, rad and rad/s, at the same phase: what runs of
        another method and rounding make of it, by the condition of the equations.
    period_error : float
        The same of the period, s; 0 where a drive sets it.
    corrections : int
        Newton's.
    arcs : ndarray, (m, 2n)
        The orbit at m equal times, the first of which is 0.

    Examples
    --------
    >>> scene = pc.Scene(links=[pc.Link(mass=1.0, length=1.0)])
    >>> orbit = pc.periodic_orbit(scene, [0.0])  # let go, level
    >>> f"{orbit.period:.9f} s"
    '1.933630539 s'
    >>> orbit.period_error < 1e-12
    True
    """

    scene: Scene
    q0: Floats
    qd0: Floats
    period: float
    turns: npt.NDArray[np.int_]
    energy: float
    is_forced: bool
    monodromy: Floats
    multipliers: Complexes
    closure: float
    state_error: Floats
    period_error: float
    corrections: int
    arcs: Floats
    _shooting: Shooting = field()
    _transitions: Floats = field()

    @property
    def is_stable(self) -> bool:
        """Whether no small change grows by more than a millionth in a period."""
        return bool(np.abs(self.multipliers).max() <= 1 + 1e-6)

    def __repr__(self) -> str:
        around = f", {', '.join(map(str, self.turns))} turns" if self.turns.any() else ""
        return (
            f"<PeriodicOrbit: period {self.period:.9g} s{around}, energy {self.energy:.6g} J, "
            f"largest multiplier {np.abs(self.multipliers).max():.6g}, closes to "
            f"{self.closure:.1g} rad>"
        )

    def solution(self, **options: Any) -> Solution:
        """Simulate one period from ``q0`` and ``qd0``; the options are those of `simulate`.

        By its end a single run has lost what the largest multiplier makes of its errors.

        Examples
        --------
        >>> scene = pc.Scene(links=[pc.Link(mass=1.0, length=1.0)])
        >>> sol = pc.periodic_orbit(scene, [0.0]).solution()
        >>> bool(np.abs(sol.q[-1] - sol.q[0]).max() < 1e-7)
        True
        """
        return simulate(self.scene, (0.0, self.period), self.q0, self.qd0, **options)

    def continued(
        self, name: str, until: float, *, step: float = 0.2, most: int = 200
    ) -> tuple[PeriodicOrbit, ...]:
        """Follow the family of this orbit, by pseudo-arclength, round folds too.

        Parameters
        ----------
        name : str
            What changes: ``"energy"`` (J, where it is kept) or one of ``scene.parameters()``. A
            parameter changes at this orbit's energy, where energy is kept; a frequency that drives
            the scene takes the period along.
        until : float
            Its value at the last orbit.
        step : float
            The longest step along the family, in rad, shares of the period and of the way to
            ``until``, together.
        most : int
            The most orbits to compute.

        Returns
        -------
        tuple of PeriodicOrbit
            From this one to that at ``until``.

        Raises
        ------
        RuntimeError
            If the family is lost, or does not come to ``until`` within ``most`` orbits, as after a
            fold it may not; and where it shrinks to an equilibrium before that. The attribute
            ``orbits`` has those that were found.
        ValueError
            If no motion has the energy ``until``.

        Notes
        -----
        Source: Keller, in *Applications of Bifurcation Theory*, Academic Press (1977) 359.

        Examples
        --------
        >>> hanging = pc.equilibria(pc.Scene.textbook())[0]
        >>> small = hanging.orbit(1, amplitude=0.01)
        >>> family = small.continued("energy", until=hanging.energy + 5.0)
        >>> f"{small.period:.3f} s, {family[-1].period:.3f} s"
        '2.345 s, 2.408 s'
        """
        value = self._value_of(name)
        (until,) = vector("until", until, 1, "")
        step = finite_positive("step", step, "")
        if until == value:
            return (self,)
        shooting = replace(self._shooting, free=name, span=abs(until - value))
        if shooting.period_follows and len(self.arcs) > 1:
            raise ValueError(f"{name}: the frequency changes only in orbits of one arc: arcs=1")
        family = followed(
            shooting, Arcs(self.arcs, self.period, value), until, step, whole_number("most", most)
        )
        found = (self, *(self._at(shooting, one) for one in family.found))
        if family.lost:
            raise FamilyLostError(
                f"the family does not come to {name} = {until:.6g}: {family.lost}; {len(found)} "
                f"orbits were found, the last at {name} = {found[-1]._value_of(name):.6g}",
                found,
            )
        return found

    def manifold(
        self,
        stability: Literal["stable", "unstable"],
        side: Literal[1, -1] = 1,
        *,
        until: events.Event | None = None,
        duration: float | None = None,
        offset: float = 4e-5,
    ) -> Manifold:
        """Return the motions that leave this orbit, or that come to it, on one side.

        Parameters
        ----------
        stability : {"unstable", "stable"}
            Away from the orbit forward in time, or backward: along what grows fastest.
        side : {1, -1}
            The side of the orbit. A change of sign of ``side`` is one of the direction.
        until : event, optional
            Each motion ends where this is found, as ``pc.events.LinkAngle(2, np.pi / 2)``.
        duration : float, optional
            s, the longest a motion may take. Default: ten periods, and the time in which
            ``offset`` grows to 1 rad.
        offset : float
            How far the motions begin from the orbit, rad. They are then off the manifold by the
            order of its square.

        Returns
        -------
        Manifold

        Raises
        ------
        ValueError, TypeError
            If the orbit has no such multiplier, or a pair of complex ones, or if an argument is
            not what is asked for.

        Examples
        --------
        >>> _, down_up, *_ = pc.equilibria(pc.Scene.textbook())
        >>> orbit = down_up.orbit(1, amplitude=0.1)
        >>> hanging = pc.events.LinkAngle(2, np.pi / 2, every_turn=True)
        >>> tube = orbit.manifold("unstable", until=hanging)
        >>> tube.crossings(12).shape
        (12, 4)
        """
        if until is not None and not isinstance(until, events.Event):
            raise TypeError(f"until = {until!r}: {SECTION}")
        if stability not in ("stable", "unstable"):
            raise ValueError(f"stability = {stability!r}: must be 'stable' or 'unstable'")
        if side not in (1, -1):
            raise ValueError(f"side = {side!r}: must be 1 or -1")
        (away,) = vector("offset", offset, 1, "rad")
        if not 0 < away <= 0.01:
            raise ValueError(f"offset = {offset}: must be > 0 and <= 0.01 (rad)")
        forward = stability == "unstable"
        directions, multiplier = direction(self._transitions, self._shooting.scales, forward)
        longest = self.period * (10 - log(away) / abs(log(abs(multiplier))))
        if duration is not None:
            longest = finite_positive("duration", duration, "s")
        return Manifold(
            scene=self.scene, stability=stability, multiplier=multiplier, period=self.period,
            is_forced=self.is_forced, until=until, duration=longest, offset=away, arcs=self.arcs,
            directions=side * directions,
        )  # fmt: skip

    def _value_of(self, name: str) -> float:
        known = self.scene.parameters()
        if name == "energy" and self._shooting.energy is not None:
            return self.energy
        if name not in known:
            about = "; nothing keeps the energy here" if name == "energy" else ""
            raise ValueError(f"name = {name!r}: {did_you_mean(name, ['energy', *known])}{about}")
        return known[name]

    def _at(self, shooting: Shooting, closed: Closed) -> PeriodicOrbit:
        """Return the orbit of a family."""
        value, energy = closed.arcs.value, shooting.energy
        if shooting.free == "energy":
            energy = value
        return _orbit(
            replace(shooting, scene=shooting.at(value), energy=energy, free="", span=1.0), closed
        )


class FamilyLostError(RuntimeError):
    """A family did not come where it was to; ``orbits`` are those that were found."""

    def __init__(self, message: str, orbits: tuple[PeriodicOrbit, ...]) -> None:
        super().__init__(message)
        self.orbits = orbits


def periodic_orbit(
    scene: Scene,
    q0: npt.ArrayLike,
    qd0: npt.ArrayLike = 0.0,
    period: float | None = None,
    *,
    energy: float | None = None,
    turns: npt.ArrayLike | None = None,
    arcs: int | None = None,
) -> PeriodicOrbit:
    """Find the periodic orbit near a state.

    Parameters
    ----------
    scene : Scene
        What moves, without locks. Orbits may go through impacts and sticking, whose derivatives
        `simulate` knows; a stick makes a multiplier zero.
    q0, qd0 : array_like, (n,) or (m, n)
        A guess: angles, rad, and rates, rad/s. With m rows they are guesses at m equal times of a
        period, for orbits so unstable that no run stays close to them.
    period : float, optional
        s. Where drives depend on time, the period of the orbit, a whole number of theirs; default:
        2 pi over the largest frequency. Elsewhere a guess; default: the first time at which the
        motion from the state comes back close to it.
    energy : float, optional
        J, where energy is kept: the orbit has this energy. Default: that of the guess.
    turns : int or array_like, (n,), optional
        By how many whole turns each link has gone round when the orbit closes. Default: as the
        motion from the guess has it.
    arcs : int, optional
        Into how many arcs the orbit is cut. Default: so many that a small change grows by less
        than 30 in each; m, if guesses at m times are given.

    Returns
    -------
    PeriodicOrbit
        Its phase is that of the guess, but for small changes.

    Raises
    ------
    RuntimeError
        If no orbit is found: the message says by how much the last one fails to close.
    ValueError, TypeError
        If an argument is not what is asked for, and if the scene jumps or sticks.

    Examples
    --------
    Both rods swing as one, and close after whole turns of both:

    >>> scene = pc.Scene.textbook()
    >>> orbit = pc.periodic_orbit(scene, np.pi / 2, [12.0, 12.0])
    >>> orbit.turns, orbit.is_stable
    (array([1, 1]), True)
    """
    require_scene(scene)
    require_free_joints(scene)
    states, n = states_given(scene, q0, qd0), len(scene.links)
    start = states[0]
    period, is_forced = period_of(scene, start, period)
    keeps = not is_forced and {effect.kind for effect in scene.effects} <= KEEP_ENERGY
    if energy is not None and not keeps:
        raise ValueError(f"energy = {energy}: this scene does not keep its energy")
    guess = Arcs(states, period)
    kept = None
    if keeps:
        given = total_energy(scene, start) if energy is None else energy
        (kept,) = vector("energy", given, 1, "J")
        if energy is not None:
            require_energy("energy", kept, scene)
    shooting = Shooting(
        scene=scene, is_forced=is_forced, energy=kept, turns=np.zeros(n), unit=2 * np.pi / period
    )
    if len(states) == 1:
        guess = cut_as_it_grows(shooting, guess, arcs)
    if turns is None:
        end = shooting.runs(guess)[-1].q[-1]
        turned = np.rint((end - guess.states[0, :n]) / (2 * np.pi))
    else:
        if np.shape(turns) not in ((), (n,)):
            raise ValueError(f"turns: shape {np.shape(turns)}: must be one number, or ({n},)")
        turned = np.array([whole_number("turns", x) for x in np.broadcast_to(turns, n).tolist()])
    require_same_after(scene, start, turned)
    shooting = replace(shooting, turns=turned)
    try:
        closed = shooting.closed(guess)
    except NotClosedError as failure:
        raise RuntimeError(
            f"no periodic orbit found near q0 = {np.round(start[:n], 6)}, period = {period:.6g}: "
            f"{failure}; start closer, with another period, or with guesses at m times, (m, {n})"
        ) from None
    found = closed.arcs.states[0]
    f = velocity(scene, 0.0, found) / shooting.scales
    if not is_forced and np.abs(f).max() < 1e-7 * shooting.unit:
        raise RuntimeError(
            f"no periodic orbit found near q0 = {np.round(start[:n], 6)}, period = {period:.6g}: "
            f"Newton's method came to the equilibrium q = {np.round(found[:n], 6)}"
        )
    return _orbit(shooting, closed)


def _orbit(shooting: Shooting, closed: Closed) -> PeriodicOrbit:
    arcs, scene = closed.arcs, shooting.scene
    n = len(shooting.turns)
    q0, qd0 = np.split(arcs.states[0], 2)
    return PeriodicOrbit(
        scene=scene, q0=q0, qd0=qd0, period=arcs.period, turns=shooting.turns.astype(int),
        energy=float(total_energy(scene, arcs.states[0])), is_forced=shooting.is_forced,
        monodromy=product(closed.transitions),
        multipliers=multipliers(shooting, arcs, closed.transitions), closure=closed.closure,
        state_error=closed.errors[: 2 * n],
        period_error=0.0 if shooting.is_forced else float(closed.errors[arcs.states.size]),
        corrections=closed.corrections, arcs=arcs.states, _shooting=shooting,
        _transitions=closed.transitions,
    )  # fmt: skip
