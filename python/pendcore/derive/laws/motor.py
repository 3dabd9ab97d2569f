"""A motor: constant torque, sinusoid of time, or PD controller kp (phi_r - phi) - kd w."""

from __future__ import annotations

from typing import Any

from sympy import Expr

from pendcore.derive.chain import Chain, Vector
from pendcore.derive.laws.law import Law, NotSmooth
from pendcore.derive.laws.sinusoid import Named, sinusoid
from pendcore.derive.notation import Notation


class Motor(Law):
    """See the core's effect of that name; its power is tau w.

    A limit that a constant or a sinusoid never reaches changes nothing. A limit that is reached
    makes a corner in the law, and a table has a corner at every point.
    """

    def __init__(self, effect: Any, notation: Notation) -> None:
        super().__init__(effect, notation)
        _check(effect)
        j, parameter = effect.joint, notation.parameter
        motor = f"of the motor at joint {j}"
        if effect.constant is not None:
            self.constant = parameter(
                f"tauM_{j}", rf"\tau_{{M,{j}}}", effect.constant, "N m", f"torque {motor}"
            )
        elif effect.sinusoid is not None:
            self.wave = sinusoid(
                effect.sinusoid,
                notation,
                Named(str(j), str(j), f"tauM_{j}", rf"\tau_{{M,{j}}}", "N m", f"torque {motor}"),
            )
        else:
            pd = effect.pd
            name, latex = f"kp_{j}", f"k_{{p,{j}}}"
            self.kp = parameter(name, latex, pd.kp, "N m/rad", f"proportional gain {motor}")
            name, latex = f"kd_{j}", f"k_{{d,{j}}}"
            self.kd = parameter(name, latex, pd.kd, "N m s/rad", f"derivative gain {motor}")
            name, latex = f"phiR_{j}", rf"\varphi_{{r,{j}}}"
            self.reference = parameter(name, latex, pd.reference, "rad", f"target angle {motor}")

    def sentence(self, notation: Notation) -> str:
        """Return the words and formulas of the law."""
        return f"A motor turns joint {self.effect.joint}."

    def couple(self, chain: Chain) -> Expr:
        """Return the torque, N m: constant, a sinusoid, or the controller's."""
        if self.effect.constant is not None:
            return self.constant
        if self.effect.sinusoid is not None:
            return self.wave
        j = self.effect.joint
        return self.kp * (self.reference - chain.joint_angle(j)) - self.kd * chain.joint_rate(j)

    def power(self, chain: Chain, ground_force: Vector) -> Expr:
        """Return the power of the motor, W."""
        return self.couple(chain) * chain.joint_rate(self.effect.joint)


def _check(effect: Any) -> None:
    """Refuse a motor whose law has corners."""
    if effect.table is not None:
        raise NotSmooth(
            "table: its torque is given by points, not by a law, and has a corner at each of them",
            "give it as constant, sinusoid or pd",
        )
    if effect.pd is not None and effect.limit != float("inf"):
        raise NotSmooth(
            f"limit = {effect.limit!r}: a controller that is clipped has a corner at +-limit",
            "leave limit out",
        )
    largest = effect.constant if effect.constant is not None else 0.0
    if effect.sinusoid is not None:
        largest = effect.sinusoid.amplitude
    if abs(largest) > effect.limit:
        remedy = "give the torque that is left" if effect.sinusoid is None else "leave limit out"
        raise NotSmooth(
            f"limit = {effect.limit!r}: the torque of up to {abs(largest)!r} N m is clipped there",
            remedy,
        )
