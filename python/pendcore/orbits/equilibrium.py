"""Where a scene is in balance, and how it moves about there."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from math import ceil, log

import numpy as np
import numpy.typing as npt

from pendcore import Scene
from pendcore.explanation.equilibria import FreeAngles
from pendcore.messages import Floats, require_scene, vector, whole_number
from pendcore.orbits.multipliers import Complexes
from pendcore.orbits.periodic_orbit import PeriodicOrbit, periodic_orbit
from pendcore.orbits.shooting import GROWTH, total_energy

MOST_LINKS = 10
"""A chain of so many has a thousand poses in which its links hang or stand."""
_NOISE = 1e-7
"""The real part that counts as zero, as a share of the largest eigenvalue, where there is damping;
without it the eigenvalues are roots of real numbers, and exact."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Equilibrium:
    """A pose in which a scene is in balance, and its modes.

    Attributes
    ----------
    scene : Scene
    q : ndarray, (n,)
        rad.
    name : str
        How each link stands, ``"down-up"``; no name where one is neither hanging nor upright.
    energy : float
        J.
    eigenvalues : ndarray, (k,)
        Complex, 1/s: of the linear motion about it, the one that grows fastest first; k is 2n, less
        2 for each locked joint.
    eigenvectors : ndarray, (2n, k)
        A column for each: (dq, dqd), the largest angle 1.

    Examples
    --------
    >>> for one in pc.equilibria(pc.Scene.textbook()):
    ...     print(one.name, one.kind, one.frequencies.round(3), one.growth.round(3))
    down-down centre [2.68  7.188] []
    down-up saddle-centre [3.938] [4.89]
    up-down saddle-centre [4.89] [3.938]
    up-up saddle [] [7.188 2.68 ]
    """

    scene: Scene
    q: Floats
    name: str
    energy: float
    eigenvalues: Complexes
    eigenvectors: Complexes

    @property
    def frequencies(self) -> Floats:
        """Angular frequencies of what neither grows nor decays, rad/s, the slowest first."""
        kept = self._centre
        return np.sort(self.eigenvalues[kept & (self.eigenvalues.imag > 0)].imag)

    @property
    def growth(self) -> Floats:
        """Rates at which something grows, 1/s, the fastest first."""
        return self.eigenvalues.real[~self._centre & (self.eigenvalues.real > 0)]

    @property
    def kind(self) -> str:
        """What it is: ``"centre"``, ``"saddle"``, ``"saddle-centre"``, ``"sink"`` or ``"source"``.

        A saddle has motions that come to it and others that leave it; ``"-centre"`` says that
        others neither come nor leave. With a rate of zero it is ``"degenerate"``.
        """
        if np.abs(self.eigenvalues).min(initial=np.inf) <= _NOISE * self._size:
            return "degenerate"
        kept = self._centre
        grows, decays = (bool((~kept & (s * self.eigenvalues.real > 0)).any()) for s in (1, -1))
        named = {(True, True): "saddle", (True, False): "source", (False, True): "sink"}
        parts = [named.get((grows, decays), "")] + ["centre"] * bool(kept.any())
        return "-".join(part for part in parts if part)

    @property
    def _size(self) -> float:
        return float(np.abs(self.eigenvalues).max(initial=0.0))

    @property
    def _centre(self) -> npt.NDArray[np.bool_]:
        return np.abs(self.eigenvalues.real) <= _NOISE * self._size

    def __repr__(self) -> str:
        named = f"{self.name}, " if self.name else ""
        return f"<Equilibrium: {named}{self.kind}, q {self.q.round(6)}, energy {self.energy:.6g} J>"

    def orbit(self, mode: int = 1, amplitude: float = 0.01) -> PeriodicOrbit:
        """Return the periodic orbit that a mode becomes when it is not small any more.

        Parameters
        ----------
        mode : int
            Which of ``frequencies`` it has: 1 is the slowest.
        amplitude : float
            How far the angle that swings most would swing, rad, in the linear motion; the orbit has
            the energy that the scene has there, at rest. Begin small, and let
            `PeriodicOrbit.continued` go on.

        Raises
        ------
        ValueError
            If it has no such mode.
        RuntimeError
            If no orbit is found.

        Examples
        --------
        >>> hanging = pc.equilibria(pc.Scene.textbook())[0]
        >>> slow = hanging.orbit(1, amplitude=1e-3)
        >>> bool(np.isclose(2 * np.pi / slow.period, hanging.frequencies[0]))
        True
        """
        there = self.frequencies
        if not len(there):
            raise ValueError(f"mode = {mode}: there is none: every mode grows or decays here")
        if not 1 <= whole_number("mode", mode) <= len(there):
            told = "must be 1, the only mode that neither grows nor decays here"
            if len(there) > 1:
                told = f"must be 1 to {len(there)}: so many modes neither grow nor decay here"
            raise ValueError(f"mode = {mode}: {told}")
        (size,) = vector("amplitude", amplitude, 1, "rad")
        if not size:
            raise ValueError("amplitude = 0.0: must not be 0 (rad)")
        w = there[mode - 1]
        which = int(np.argmin(np.abs(self.eigenvalues - 1j * w)))
        grown = self.growth.max(initial=0.0) * 2 * np.pi / w
        turns = np.linspace(0, 2j * np.pi, max(2, ceil(grown / log(GROWTH)) + 1))[:-1]
        swing = size * (self.eigenvectors[:, which] * np.exp(turns)[:, np.newaxis]).real
        q, qd = np.split(swing, 2, axis=1)
        return periodic_orbit(self.scene, self.q + q, qd, 2 * np.pi / w)


def equilibria(
    scene: Scene, near: npt.ArrayLike | None = None, *, t: float = 0.0
) -> tuple[Equilibrium, ...]:
    """Find where a scene is in balance.

    Parameters
    ----------
    scene : Scene
        What moves, without dry friction and stops.
    near : array_like, (n,), optional
        A pose, rad: Newton's method begins here alone. Default: in every pose in which each link
        hangs or is upright; what is found more than once counts once.
    t : float
        What depends on time is as at this time, s.

    Returns
    -------
    tuple of Equilibrium
        Those that were found, the lowest energy first. Beside springs, motors and wind there may be
        more.

    Raises
    ------
    ValueError
        If the scene jumps or sticks there, and for more than ten links without ``near``.

    Examples
    --------
    >>> [one.name for one in pc.equilibria(pc.Scene.textbook())]
    ['down-down', 'down-up', 'up-down', 'up-up']
    """
    require_scene(scene)
    n = len(scene.links)
    if near is not None:
        poses = [np.array(vector("near", near, n, "rad"))]
    elif n > MOST_LINKS:
        raise ValueError(f"near = None: {n} links have 2**{n} poses to begin from: give one")
    else:
        poses = [np.pi / 2 * np.array(signs) for signs in product([1, -1], repeat=n)]
    for i, effect in enumerate(scene.effects, 1):
        if effect.description.jumps_or_sticks:
            raise ValueError(
                f"scene: effect {i} ({effect.kind}): where it holds a joint, no motion is linear: "
                "leave it out, scene.replace(effects=[...])"
            )
    found: list[Equilibrium] = []
    for pose in poses:
        free = FreeAngles(scene, t, pose)
        z = free.balanced_near(pose[free.leaders])
        if z is not None:
            q = free.q(z)
            if not any(np.abs(np.sin((q - one.q) / 2)).max() < 1e-7 for one in found):
                found.append(_described(scene, free, z))
    return tuple(sorted(found, key=lambda one: one.energy))


def _described(scene: Scene, free: FreeAngles, z: Floats) -> Equilibrium:
    _, by_q, by_qd = free.linearised(z)
    m, q = len(z), free.q(z)
    if by_qd.any():
        block = np.block([[np.zeros((m, m)), np.eye(m)], [by_q, by_qd]])
        values, vectors = np.linalg.eig(block)
        shapes = vectors[:m]
    else:
        squares, shapes = np.linalg.eig(by_q)
        roots = np.sqrt(squares.astype(complex))
        values, shapes = np.concatenate([roots, -roots]), np.hstack([shapes, shapes])
    values = values.astype(complex)
    angles = (free.turning @ shapes).astype(complex)
    for column in angles.T:
        column /= column[np.argmax(np.abs(column))]
    order = np.lexsort([-values.imag, np.abs(values.imag), -values.real])
    stands = {1: "down", -1: "up"}
    upright = np.sin(q)
    named = bool((np.abs(np.abs(upright) - 1) < 1e-12).all())
    return Equilibrium(
        scene=scene, q=q,
        name="-".join(stands[int(np.sign(x))] for x in upright) if named else "",
        energy=float(total_energy(scene, np.concatenate([q, 0 * q]))),
        eigenvalues=values[order],
        eigenvectors=np.vstack([angles, angles * values])[:, order],
    )  # fmt: skip
