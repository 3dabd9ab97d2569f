"""Where a scene is in balance, and how it moves about there.

With a chain's free angles z (what is locked turns together), the accelerations are zdd = f(z, zd),
t frozen. Newton's method finds f(z, 0) = 0; about it, with A = df/dz and B = df/dzd, the
eigenvalues of

    d/dt (dz, dzd) = ((0, 1), (A, B)) (dz, dzd)

are the rates: a pair lambda = -zeta w +- i w sqrt(1 - zeta^2) is an oscillation of natural angular
frequency w and damping ratio zeta; a real one grows or decays. Rates that are slow beside the
fastest, as the fall of a rod in honey is beside its damping, come from the inverse of that matrix,

    ((-A^-1 B, A^-1), (1, 0)),

whose largest eigenvalues are the reciprocals of these rates.
"""

from __future__ import annotations

from math import pi
from typing import Literal, NamedTuple

import numpy as np
import numpy.typing as npt

from pendcore import Scene
from pendcore.explanation.constraints import locks
from pendcore.messages import Floats, silence

_LONGEST = 0.5
"""rad, the largest step of Newton's method, which is not to reach a distant equilibrium."""
_NOISE = 1e-5
"""The growth that counts as zero, as a share of the mode's size: nearly equal eigenvalues are that
inexact, and so are the differences by which functions of the user's are differentiated."""
_SLOW = 1e-3
"""The share of the stiffest rate below which a rate comes from the inverse."""
_SINGULAR = 1e-12
"""The share of A's largest singular value below which one means that nothing turns back."""
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


class FreeAngles:
    """The angles that are left to a chain whose locked joints do not turn."""

    def __init__(self, scene: Scene, t: float, start: Floats) -> None:
        """A joint that is locked where it starts is locked as in ``start``, rad."""
        self._scene, self._t = scene, t
        locked, n = locks(scene), len(scene.links)
        self.leaders = [i for i in range(n) if i + 1 not in locked]
        """The links that do not turn with the one before, or the ground."""
        turning, fixed = np.zeros((n + 1, len(self.leaders))), np.zeros(n + 1)  # the ground first
        turning[1:][self.leaders] = np.eye(len(self.leaders))
        for joint, angle in sorted(locked.items()):
            turn = np.diff(start, prepend=0.0)[joint - 1] if angle is None else angle
            turning[joint], fixed[joint] = turning[joint - 1], fixed[joint - 1] + turn
        self.turning = turning[1:]
        """(n, m): which links turn with each of the free angles."""
        self._fixed = fixed[1:]
        """The angle of each link against the first link that turns with it, or the ground, rad."""

    def q(self, z: Floats) -> Floats:
        """Angles of all links, (n,), from the free ones, (m,)."""
        return self.turning @ z + self._fixed

    def linearised(self, z: Floats) -> tuple[Floats, Floats, Floats]:
        """Accelerations at rest, (m,), and their derivatives by angles and by rates, (m, m)."""
        at_rest = self._t, self.q(z), np.zeros(len(self._fixed))
        residual = self._scene.accelerations(*at_rest)[self.leaders]
        both = (one @ self.turning for one in self._scene.jacobian(*at_rest))
        slope, by_rate = (one[self.leaders] for one in both)
        return residual, slope, by_rate

    def balanced_near(self, z: Floats) -> Floats | None:
        """Free angles near these at which nothing accelerates, by Newton's method."""
        for _ in range(100):
            residual, slope, _ = self.linearised(z)
            if not (np.isfinite(residual).all() and np.isfinite(slope).all()):
                return None
            step = np.linalg.lstsq(slope, -residual, rcond=1e-10)[0]
            size = float(np.abs(step).max(initial=0.0))
            z = z + step * min(1.0, _LONGEST / size if size else 1.0)
            if size < 1e-10:
                after = np.abs(self.linearised(z)[0]).max(initial=0.0)
                return z if after <= 1e-7 * max(1.0, np.abs(slope).max(initial=0.0)) else None
        return None


def find_equilibria(
    scene: Scene, t: float, start: tuple[float, ...] | None
) -> tuple[tuple[Equilibrium, ...], list[str]]:
    """Find those near hanging, upright and the start, and remarks on what was not found.

    Joints are locked at the angles that their locks give, else as in the start, and without a start
    as in the pose from which the search begins.
    """
    n = len(scene.links)
    poses = {"hanging": np.full(n, pi / 2), "upright": np.full(n, -pi / 2)}
    poses |= {} if start is None else {"start": np.array(start)}
    # What makes a motion jump or stick has no slope about a state of rest.
    rough = dict.fromkeys(x.kind for x in scene.effects if x.description.jumps_or_sticks)
    remarks = [
        f"{kind.replace('_', ' ')} is left out of the equilibria: it can hold the scene elsewhere, "
        "and keep it from them"
        for kind in rough
    ]
    with silence():  # what is implausible was said when the scene was made
        scene = scene.replace(effects=[one for one in scene.effects if one.kind not in rough])
    unknown = [str(joint) for joint, angle in locks(scene).items() if angle is None]
    if start is None and unknown:
        remarks.append(
            f"joint{'s'[: len(unknown) > 1]} {', '.join(unknown)}: a lock takes its angle from the "
            "start, and none was given: hanging and upright are taken as starts; give yours with "
            "explain(q=...)"
        )
    found: list[Equilibrium] = []
    for name, pose in poses.items():
        free = FreeAngles(scene, t, pose if start is None else np.array(start))
        z = free.balanced_near(pose[free.leaders])
        # Damping can be so large that the modes of an equilibrium are not finite.
        if z is None or not np.isfinite(slopes := free.linearised(z)[1:]).all():
            remarks.append(f"no equilibrium was found from {name} at t = {t:.6g} s")
            continue
        q = free.q(z)
        if any(np.abs(np.sin((q - other.q) / 2)).max() < 1e-6 for other in found):
            continue
        moved = np.abs(np.sin((q - pose) / 2)).max() > 1e-6
        found.append(_described(f"found from {name}" if moved else name, q, *slopes))
    return tuple(found), remarks


def _described(name: str, q: Floats, by_angle: Floats, by_rate: Floats) -> Equilibrium:
    rates, turns_back = _rates_about(by_angle, by_rate)
    # The slowest first; of two that are equally fast, what grows.
    upper = [x for x in rates.tolist() if x.imag >= 0]
    upper.sort(key=lambda x: (float(f"{abs(x):.9e}"), -x.real))
    grows = any(x.real > _NOISE * abs(x) for x in upper)
    return Equilibrium(
        name=name,
        q=tuple((q + 0.0).tolist()),  # no -0.0
        stability="unstable" if grows else "stable" if turns_back else "indifferent",
        modes=tuple(map(_mode, upper)),
        stiffest_rate=float(np.abs(rates).max(initial=0.0)),
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
    w, rate = abs(eigenvalue), eigenvalue.real + 0.0  # no -0.0
    if eigenvalue.imag == 0:
        return Mode(rate, 0.0, 0.0, None)
    return Mode(rate, w, w / (2 * pi), 0.0 - rate / w)
