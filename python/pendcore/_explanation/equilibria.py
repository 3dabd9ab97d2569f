"""Where a scene is in balance, and how it moves about there.

With a chain's free angles z (what is locked turns together), the accelerations at rest are
zdd = f(z, 0), t frozen. Newton's method finds f = 0; about it, with A = df/dz and B = df/dzd by
central differences, the eigenvalues of

    d/dt (dz, dzd) = ((0, 1), (A, B)) (dz, dzd)

are the rates: a pair lambda = -zeta w +- i w sqrt(1 - zeta^2) is an oscillation of natural angular
frequency w and damping ratio zeta; a real one grows or decays. Rates that are slow beside the
fastest, as the fall of a rod in honey is beside its damping, come from the inverse of that matrix,

    ((-A^-1 B, A^-1), (1, 0)),

whose largest eigenvalues are the reciprocals of these rates.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import pi
from typing import Literal, NamedTuple

import numpy as np
import numpy.typing as npt

from pendcore._explanation.constraints import locks
from pendcore._messages.arguments import Floats
from pendcore._scene.scene import Scene

_STEP = 1e-5
"""rad and rad/s, the step of the differences, at which truncation and rounding are about equal."""
_LONGEST = 0.5
"""rad, the largest step of Newton's method, which is not to reach a distant equilibrium."""
_NOISE = 1e-5
"""The growth that counts as zero, as a share of the mode's size: differences are that inexact."""
_SLOW = 1e-3
"""The share of the stiffest rate below which a rate comes from the inverse."""
_SINGULAR = 1e-12
"""The share of A's largest singular value below which one means that nothing turns back."""
_LEFT_OUT = {
    "dry_joint_friction": "dry friction is left out of the equilibria: it can hold the scene near "
    "them",
    "joint_stop": "stops are left out of the equilibria: the scene can rest against them, and not "
    "beyond them",
}
"""Effects under which a motion jumps or sticks have no slope about a state of rest."""


Complexes = npt.NDArray[np.complex128]


class Mode(NamedTuple):
    """One way in which a scene moves about an equilibrium.

    Attributes
    ----------
    rate : float
        Real part of the eigenvalue, 1/s: it grows if positive, and decays if negative.
    angular_frequency : float
        Natural, rad/s; 0 where it does not oscillate.
    frequency : float
        The same in Hz.
    damping_ratio : float or None
        The damping ratio of an oscillation; 0 if nothing damps it, negative if something feeds it.
    """

    rate: float
    angular_frequency: float
    frequency: float
    damping_ratio: float | None


class Equilibrium(NamedTuple):
    """A pose in which the scene is in balance.

    Attributes
    ----------
    name : str
        ``"hanging"``, ``"upright"`` or ``"start"``, or from which of them it was found.
    q : tuple of float, (n,)
        rad.
    stability : {"stable", "unstable", "indifferent"}
        Stable where everything about it comes back or stays small; indifferent where nothing
        grows and something has no rate at all, as without gravity: a push goes on.
    modes : tuple of Mode
        The slowest first.
    stiffest_rate : float
        The largest eigenvalue in size, 1/s.
    """

    name: str
    q: tuple[float, ...]
    stability: Literal["stable", "unstable", "indifferent"]
    modes: tuple[Mode, ...]
    stiffest_rate: float

    @property
    def stable(self) -> bool:
        return self.stability == "stable"


class FreeAngles:
    """The angles that are left to a chain whose locked joints do not turn."""

    def __init__(self, scene: Scene, t: float, start: Floats) -> None:
        """A joint that is locked where it starts is locked as in ``start``, rad."""
        self._scene, self._t = scene, t
        locked, n = locks(scene), len(scene.links)
        self._fixed = np.zeros(n)
        """The angle of each link against the first link that turns with it, or the ground, rad."""
        self.leaders: list[int] = []
        self._turning = np.zeros((n, 0))
        """(n, m): which links turn with each of the free angles."""
        for i in range(n):
            if i + 1 not in locked:
                self.leaders.append(i)
                self._turning = np.hstack([self._turning, np.zeros((n, 1))])
                self._turning[i, -1] = 1.0
                continue
            before = start[i - 1] if i else 0.0
            angle = locked[i + 1]
            self._fixed[i] = start[i] - before if angle is None else angle
            if i:
                self._fixed[i] += self._fixed[i - 1]
                self._turning[i] = self._turning[i - 1]

    def q(self, z: Floats) -> Floats:
        """Angles of all links, (..., n), from the free ones, (..., m)."""
        return z @ self._turning.T + self._fixed

    def accelerations(self, z: Floats, zd: Floats) -> Floats:
        """Return the accelerations of the free angles, (..., m)."""
        found = self._scene.accelerations(self._t, self.q(z), zd @ self._turning.T)
        return found[..., self.leaders]

    def linearised(self, z: Floats) -> tuple[Floats, Floats]:
        """Derivatives of the accelerations at rest by angles and by rates, (m, m) each."""
        m = len(self.leaders)
        small, still = np.eye(m) * _STEP, np.zeros((m, m))
        at = np.broadcast_to(z, (m, m))
        by_angle = self.accelerations(z + small, still) - self.accelerations(z - small, still)
        by_rate = self.accelerations(at, small) - self.accelerations(at, -small)
        return by_angle.T / (2 * _STEP), by_rate.T / (2 * _STEP)

    def balanced_near(self, z: Floats) -> Floats | None:
        """Free angles near these at which nothing accelerates, by Newton's method."""
        still = np.zeros_like(z)
        for _ in range(100):
            residual = self.accelerations(z, still)
            slope, _ = self.linearised(z)
            if not (np.isfinite(residual).all() and np.isfinite(slope).all()):
                return None
            step = np.linalg.lstsq(slope, -residual, rcond=1e-10)[0]
            size = float(np.abs(step).max(initial=0.0))
            z = z + step * min(1.0, _LONGEST / size if size else 1.0)
            if size < 1e-10:
                after = np.abs(self.accelerations(z, still)).max(initial=0.0)
                return z if after <= 1e-7 * max(1.0, np.abs(slope).max(initial=0.0)) else None
        return None


def find_equilibria(
    scene: Scene, t: float, start: tuple[float, ...] | None, remarks: list[str]
) -> Iterator[Equilibrium]:
    """Find those near hanging, upright and the start; put into the remarks what was not found.

    Joints are locked at the angles that their locks give, else as in the start, and without a start
    as in the pose from which the search begins.
    """
    n = len(scene.links)
    poses = {"hanging": np.full(n, pi / 2), "upright": np.full(n, -pi / 2)}
    poses |= {} if start is None else {"start": np.array(start)}
    smooth = [one for one in scene.effects if not one.description.jumps_or_sticks]
    present = {effect.kind for effect in scene.effects}
    remarks += [remark for kind, remark in _LEFT_OUT.items() if kind in present]
    scene = Scene._unpickled(scene.links, scene.gravity, smooth)
    unknown = [str(joint) for joint, angle in locks(scene).items() if angle is None]
    if start is None and unknown:
        remarks.append(
            f"joint{'s'[: len(unknown) > 1]} {', '.join(unknown)}: a lock takes its angle from the "
            "start, and none was given: hanging and upright are taken as starts; give yours with "
            "explain(q=...)"
        )
    found: list[Floats] = []
    for name, pose in poses.items():
        free = FreeAngles(scene, t, pose if start is None else np.array(start))
        z = pose[free.leaders]
        balanced = free.balanced_near(z)
        # Damping can be so large that the modes of an equilibrium are not finite.
        if balanced is None or not all(np.isfinite(x).all() for x in free.linearised(balanced)):
            remarks.append(f"no equilibrium was found from {name} at t = {t:.6g} s")
            continue
        q = free.q(balanced)
        if any(np.abs(np.sin((q - other) / 2)).max() < 1e-6 for other in found):
            continue
        found.append(q)
        moved = np.abs(np.sin((q - pose) / 2)).max() > 1e-6
        yield _described(f"found from {name}" if moved else name, free, balanced)


def _described(name: str, free: FreeAngles, z: Floats) -> Equilibrium:
    rates, turns_back = _rates_about(*free.linearised(z))
    modes = sorted((_mode(x) for x in rates if x.imag >= 0), key=_size)
    grows = any(mode.rate > _NOISE * _size(mode) for mode in modes)
    q = tuple((free.q(z) + 0.0).tolist())  # no -0.0
    return Equilibrium(
        name,
        q,
        "unstable" if grows else "stable" if turns_back else "indifferent",
        tuple(modes),
        float(np.abs(rates).max(initial=0.0)),
    )


def _rates_about(by_angle: Floats, by_rate: Floats) -> tuple[Complexes, bool]:
    """Return the eigenvalues, and whether a small turn of every kind meets a torque."""
    m = len(by_angle)
    unit, zero = np.eye(m), np.zeros((m, m))
    rates = _by_size(np.linalg.eigvals(np.block([[zero, unit], [by_angle, by_rate]])))
    sizes = np.linalg.svd(by_angle, compute_uv=False)
    if m and sizes[-1] <= _SINGULAR * sizes[0]:
        rates[np.abs(rates) <= _NOISE * np.abs(rates[-1])] = 0.0
        return rates, False
    with np.errstate(over="ignore", invalid="ignore"):
        inverse = np.linalg.inv(by_angle)
        of_inverse = np.block([[-inverse @ by_rate, inverse], [unit, zero]])
    if not np.isfinite(of_inverse).all():
        return rates, True
    slow = np.linalg.eigvals(of_inverse)
    is_slow = np.abs(rates) < _SLOW * np.abs(rates).max(initial=0.0)
    return np.where(is_slow, _by_size(1.0 / slow), rates), True


def _by_size(rates: Floats | Complexes) -> Complexes:
    return rates[np.argsort(np.abs(rates), kind="stable")].astype(complex)


def _mode(eigenvalue: complex) -> Mode:
    w, rate = float(abs(eigenvalue)), float(eigenvalue.real) + 0.0  # no -0.0
    if eigenvalue.imag == 0:
        return Mode(rate, 0.0, 0.0, None)
    return Mode(rate, w, w / (2 * pi), 0.0 - rate / w)


def _size(mode: Mode) -> float:
    return max(mode.angular_frequency, abs(mode.rate))
