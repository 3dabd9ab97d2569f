"""How far a run is from an exact motion, in the unit of an engineer: N m at a joint."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pendcore import _core
from pendcore._messages.arguments import Floats
from pendcore._messages.progress import Progress, reporting
from pendcore._scene.scene import Scene
from pendcore.methods import known_methods

STEPS_AT_ONCE = 2000
"""The number of steps between two reports of progress."""


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Defect:
    """The torques that would make a computed curve an exact motion.

    The curve consists of the rates of the dense output and of their integral, which begins at the
    first angles. With motors in the joints that add these torques, the curve would obey the
    equations of motion exactly. A joint that is held (lock, friction, stop) needs no torque,
    because its hold takes any. Compare the torques with what a model leaves out: bearing friction,
    air, a motor's ripple. They say nothing about how far a chaotic motion has moved away from the
    exact one.

    Attributes
    ----------
    t : ndarray, (n_steps,)
        Where each step begins, s.
    torque : ndarray, (n_steps, n)
        The largest torque at each joint within each step, N m, >= 0.
    apart : ndarray, (n_steps,)
        The largest distance of the curve's angles from those of ``sol(t)``, rad.
    weight : float
        m g L, N m: the links' masses times gravity times the length of all; 0 without gravity.
    order : int
        The order of the torque in the size of the steps, which is that of the dense output. If a
        pair of methods has switched, it is the order of the second method.
    is_bound : bool
        Whether the method's order is higher: other curves through the same steps need less torque.

    Examples
    --------
    >>> found = pc.Case.textbook().simulate().defect()
    >>> f"{found.largest:.0e} N m at joint {found.joint}, {found.share:.0e} of m g L"
    '3e-06 N m at joint 1, 8e-08 of m g L'
    """

    t: Floats
    torque: Floats
    apart: Floats
    weight: float
    order: int
    is_bound: bool

    @property
    def largest(self) -> float:
        """The largest torque at any joint, N m."""
        return float(self.torque.max(initial=0.0))

    @property
    def share(self) -> float:
        """The largest torque in units of m g L; inf without gravity."""
        if self.weight == 0.0:
            return 0.0 if self.largest == 0.0 else float("inf")
        return self.largest / self.weight

    @property
    def joint(self) -> int:
        """The joint of the largest torque, from 1."""
        return int(self.torque.max(axis=0, initial=0.0).argmax()) + 1

    def __repr__(self) -> str:
        at_most = "at most " if self.is_bound else ""
        share = f", {self.share:.1e} of m g L" if self.weight else ""
        torque = f"{at_most}{self.largest:.1e} N m more at joint {self.joint}{share}"
        apart = f"{self.apart.max(initial=0.0):.0e} rad"
        return f"an exact motion with {torque}; its angles are within {apart} of sol(t)"


def defect(scene: Scene, run: _core.Run, progress: Progress = None) -> Defect:
    """Return the torques at the joints that would make a run exact."""
    n = len(scene.links)
    starts = run.step_starts
    torque = np.empty((len(starts), n))
    apart = np.empty(len(starts))
    angles = np.empty(0)
    with reporting(progress, "looking for torques") as report:
        for first in range(0, max(len(starts), 1), STEPS_AT_ONCE):
            some = slice(first, min(first + STEPS_AT_ONCE, len(starts)))
            torque[some], apart[some], angles = run.defect(some.start, some.stop, angles)
            report(some.stop / max(len(starts), 1))
    mass, length = sum(link.mass for link in scene.links), sum(link.length for link in scene.links)
    method = known_methods()[run.last_method]
    is_series = method["dense_output_is_series"]  # whose order the tolerances choose
    return Defect(
        t=starts,
        torque=torque,
        apart=apart,
        weight=abs(scene.gravity) * mass * length,
        order=run.dense_degree if is_series else method["interpolant_order"],
        is_bound=not is_series and method["interpolant_order"] < method["order"],
    )
