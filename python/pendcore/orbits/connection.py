"""Motions that leave one periodic orbit and come to another, or to the same: connections."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from pendcore import Solution
from pendcore.messages import Floats, at_least
from pendcore.orbits.manifold import SECTION, Manifold
from pendcore.orbits.shooting import total_energy

CORRECTIONS = 12
FEWEST = 3
"""So many points make a closed curve."""
OFFSETS = (1.0, 0.5, 0.25)
"""The shares of the manifolds' offset at which a connection is computed."""
ANOTHER: dict[str, Any] = {"method": "dop853", "rtol": 1e-14}
_PHASE = 1e-6
"""The difference of phases for derivatives of crossings."""
_SAME = 1e-6
"""Connections that are closer in phase are one."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Connection:
    """A motion that leaves a periodic orbit and comes to one of the same energy.

    Attributes
    ----------
    q, qd : ndarray, (n,)
        Where it passes the section at which both manifolds end, rad and rad/s.
    error : float
        How far that may be from the section of the true connection, rad; rates count over the
        orbit's 2 pi/period: twice the changes when both manifolds begin at a half and at a quarter
        of their offset and by another method, and what Newton's method left.
    gap : float
        By how much the two halves miss each other, rad.
    angle : float
        Between the manifolds in the section, rad, rates as in ``error``: 0 where they touch.
    phases : (float, float)
        Where its two halves begin: the phases of the unstable and of the stable manifold.
    leaving, arriving : Solution
        From near the first orbit to the section, and from near the second, backward; both with
        dense output.

    Examples
    --------
    >>> _, down_up, *_ = pc.equilibria(pc.Scene.textbook())
    >>> orbit = down_up.orbit(1).continued("energy", until=0.0)[-1]
    >>> hanging = pc.events.LinkAngle(2, np.pi / 2, every_turn=True)
    >>> away = orbit.manifold("unstable", 1, until=hanging)
    >>> back = orbit.manifold("stable", -1, until=hanging)
    >>> found = pc.connections(away, back, count=100)
    >>> len(found), max(one.error for one in found) < 1e-8
    (6, True)
    """

    q: Floats
    qd: Floats
    error: float
    gap: float
    angle: float
    phases: tuple[float, float]
    leaving: Solution
    arriving: Solution

    def __repr__(self) -> str:
        at = ", ".join(f"{x:.9g}" for x in (*self.q, *self.qd))
        return f"<Connection: passes ({at}) to {self.error:.0e} rad, angle {self.angle:.3g} rad>"

    def motion(self, count: int = 200) -> tuple[Floats, Floats]:
        """Return times, s, (2 count - 1,), even in each half, and states, (2 count - 1, 2n).

        The time is 0 in the section. Angles are those of the first half: the second is turned by
        whole turns to go on there.
        """
        first, second = self.leaving, self.arriving
        n = len(self.q)
        turned = np.zeros(2 * n)
        turned[:n] = 2 * np.pi * np.rint((first.q[-1] - second.q[-1]) / (2 * np.pi))
        before = np.linspace(first.t[0], first.t[-1], count)
        after = np.linspace(second.t[-1], second.t[0], count)[1:]
        t = np.concatenate([before - first.t[-1], after - second.t[-1]])
        return t, np.vstack([first(before).T, second(after).T + turned])


def connections(
    unstable: Manifold, stable: Manifold, *, count: int = 1000
) -> tuple[Connection, ...]:
    """Find where an unstable manifold meets a stable one of the same energy, in two links.

    Both end in the same section, by their ``until``. Where the closed curves of their crossings
    intersect, a connection is refined by Newton's method on the two phases.

    Parameters
    ----------
    unstable, stable : Manifold
        They belong to one orbit, and the connections are homoclinic, or to two: heteroclinic.
    count : int
        How many motions of each draw its curve, >= 3.

    Returns
    -------
    tuple of Connection
        By the phase of ``unstable``; none where the curves do not meet. Where curves are torn,
        because some motions pass the section late, there may be more with every ``count``.

    Raises
    ------
    ValueError, TypeError
        If the manifolds have no section in common, are not of one scene of two links and one
        energy, or turn over in each period, as those of negative multipliers do.

    Examples
    --------
    >>> _, down_up, *_ = pc.equilibria(pc.Scene.textbook())
    >>> orbit = down_up.orbit(1).continued("energy", until=0.0)[-1]
    >>> hanging = pc.events.LinkAngle(2, np.pi / 2, every_turn=True)
    >>> away = orbit.manifold("unstable", 1, until=hanging)
    >>> back = orbit.manifold("stable", -1, until=hanging)
    >>> sorted(f"{x.angle:.2f}" for x in pc.connections(away, back, count=100))
    ['0.50', '0.50', '0.83', '0.95', '0.95', '1.57']
    """
    _check(unstable, stable)
    at_least("count", count, FEWEST)
    curves = [one.crossings(count) for one in (unstable, stable)]
    found: list[Connection] = []
    for phases in _meetings(curves[0], curves[1]):
        made = _refined(unstable, stable, phases)
        if made is not None and not any(_near(made, other) for other in found):
            found.append(made)
    return tuple(sorted(found, key=lambda one: one.phases))


def _check(unstable: Manifold, stable: Manifold) -> None:
    for name, one in (("unstable", unstable), ("stable", stable)):
        if not isinstance(one, Manifold):
            wanted = f'must be a manifold, as orbit.manifold("{name}", until=...) returns'
            raise TypeError(f"{name} = {one!r}: {wanted}")
    if (unstable.stability, stable.stability) != ("unstable", "stable"):
        raise ValueError("connections: must be given an unstable manifold, and then a stable one")
    for one in (unstable, stable):
        if len(one.scene.links) != 2 or one.is_forced:
            raise ValueError("connections: must be of two links that nothing drives")
        if one.multiplier < 0:
            raise ValueError(
                f"connections: a manifold of multiplier {one.multiplier:.6g} has one side"
            )
    if unstable.scene != stable.scene:
        raise ValueError("connections: the manifolds are of two scenes: must be of one")
    energies = [float(total_energy(one.scene, one.arcs[0])) for one in (unstable, stable)]
    if abs(energies[0] - energies[1]) > 1e-8 * (1 + abs(energies[0])):
        raise ValueError(
            f"connections: energies {energies[0]:.9g}, {energies[1]:.9g} J: must agree"
        )
    if unstable.until is None or stable.until is None:
        raise ValueError(f"until = None: {SECTION}")
    # Each may come to it another way, or another time.
    surfaces = [
        replace(one, direction=0, terminal=False, name=None)
        for one in (unstable.until, stable.until)
    ]
    if surfaces[0] != surfaces[1]:
        raise ValueError(
            f"connections: until = {surfaces[0]!r} and {surfaces[1]!r}: must be one section, "
            "where both manifolds end"
        )


def _wrapped(states: Floats) -> Floats:
    """Return states with angles within half a turn of hanging."""
    n = states.shape[-1] // 2
    turned = states.copy()
    turned[..., :n] = (turned[..., :n] + np.pi / 2) % (2 * np.pi) - np.pi / 2
    return turned


def _meetings(one: Floats, other: Floats) -> list[tuple[float, float]]:
    """Return the phases at which two closed polygons intersect, in the angle that varies most."""
    link = int(np.nanargmax(np.nanstd(_wrapped(one)[:, :2], axis=0)))
    a, b = (_wrapped(x)[:, [link, link + 2]] for x in (one, other))
    along = [np.roll(x, -1, axis=0) - x for x in (a, b)]
    for x in along:  # where an angle jumps by a turn there is no line
        x[np.abs(x[:, 0]) > np.pi] = np.nan
    found = []
    with np.errstate(invalid="ignore", divide="ignore"):
        for i, (start, u) in enumerate(zip(a, along[0], strict=True)):
            apart, v = b - start, along[1]
            area = u[0] * v[:, 1] - u[1] * v[:, 0]
            s = (apart[:, 0] * v[:, 1] - apart[:, 1] * v[:, 0]) / area
            r = (apart[:, 0] * u[1] - apart[:, 1] * u[0]) / area
            for j in np.flatnonzero((s >= 0) & (s < 1) & (r >= 0) & (r < 1)):
                found.append(((i + s[j]) / len(a), (j + r[j]) / len(b)))
    return found


def _newton(
    unstable: Manifold, stable: Manifold, phases: Floats
) -> tuple[Floats, Floats, Floats] | None:
    """Return phases, the miss (2n,) and the slopes (2n, 2) of two motions that meet."""
    scales = np.repeat([1.0, 2 * np.pi / unstable.period], 2)

    def miss(at: Floats) -> Floats:
        ends = _wrapped(unstable.crossing(at[0])) - _wrapped(stable.crossing(at[1]))
        ends[:2] = (ends[:2] + np.pi) % (2 * np.pi) - np.pi
        apart: Floats = ends / scales
        return apart

    before = np.inf
    for _ in range(CORRECTIONS):
        off = miss(phases)
        moves = _PHASE * np.eye(2)
        slopes = np.array([miss(phases + x) - miss(phases - x) for x in moves]).T / (2 * _PHASE)
        if not (np.isfinite(off).all() and np.isfinite(slopes).all()):
            return None
        step = np.linalg.lstsq(slopes, -off, rcond=None)[0]
        size = np.abs(step).max()
        if size < 1e-13 or (size < 1e-8 and size > before / 4):
            return phases, off, slopes
        phases, before = phases + step * min(1.0, 0.02 / size), size
    return None


def _refined(
    unstable: Manifold, stable: Manifold, phases: tuple[float, float]
) -> Connection | None:
    """Return the connection near two phases, if the curves meet there in every coordinate."""
    at, scales = np.array(phases), np.repeat([1.0, 2 * np.pi / unstable.period], 2)
    # At half the distance from its orbit the same motion begins earlier.
    rates = [np.log(abs(one.multiplier)) for one in (unstable, stable)]
    places: list[Floats] = []
    for share in OFFSETS:
        both = [replace(one, offset=share * one.offset) for one in (unstable, stable)]
        made = _newton(both[0], both[1], at + np.log(share) / rates)
        if made is None or np.abs(made[1]).max() > 1e-6:
            return None
        here, off, slopes = made
        at = here - np.log(share) / rates
        places.append(_wrapped(both[0].crossing(here[0])))
    phases = float(here[0] % 1), float(here[1] % 1)
    by_offset = np.abs(np.array(places) - places[-1]).max(axis=0) / scales
    # What another method makes of both runs moves the curves; along themselves, that is nothing.
    moves = [
        one.crossing(x, **ANOTHER) - one.crossing(x) for one, x in zip(both, here, strict=True)
    ]
    shift = np.linalg.lstsq(slopes, (moves[1] - moves[0]) / scales, rcond=None)[0]
    by_method = np.abs(slopes[:, 0] * shift[0] + moves[0] / scales)
    lines = slopes / np.linalg.norm(slopes, axis=0)
    return Connection(
        q=places[-1][:2], qd=places[-1][2:], gap=float(np.abs(off).max()),
        error=float(2 * (by_offset + by_method).max() + np.abs(off).max()),
        angle=float(np.arctan2(np.linalg.svd(lines)[1].prod(), abs(lines[:, 0] @ lines[:, 1]))),
        phases=phases, leaving=both[0].run(phases[0], store="dense"),
        arriving=both[1].run(phases[1], store="dense"),
    )  # fmt: skip


def _near(one: Connection, other: Connection) -> bool:
    apart = np.subtract(one.phases, other.phases)
    return bool(np.abs((apart + 0.5) % 1 - 0.5).max() < _SAME)
