"""Effects that act by a couple in a joint: damping, springs and motors."""

from __future__ import annotations

from typing import Any, ClassVar

from sympy import Abs, Expr, Integer

from pendcore.derive.chain import Chain, Vector
from pendcore.derive.laws.law import Law, NotSmooth
from pendcore.derive.notation import Notation
from pendcore.derive.writing import ANGLE, RATE


class Couple(Law):
    """A couple that is a function of the angle phi of its joint, the rate w and the time."""

    words: ClassVar[str]

    def __init__(self, effect: Any, notation: Notation) -> None:
        super().__init__(effect, notation)
        self.joint = int(effect.joint)

    def parameter(self, name: str, latex: str, value: float, unit: str, meaning: str) -> Expr:
        """Return the symbol of a number of the effect, marked by the joint."""
        j = self.joint
        return self.notation.parameter(f"{name}_{j}", latex.format(j), value, unit, meaning)

    def formula(self, phi: Expr, w: Expr) -> Expr:
        """Return the torque, N m."""
        raise NotImplementedError

    def couple(self, chain: Chain) -> Expr:
        """Return the torque in the angles and rates of the links, N m."""
        return self.formula(chain.joint_angle(self.joint), chain.joint_rate(self.joint))

    def power(self, chain: Chain, ground_force: Vector) -> Expr | None:
        """Return the power, W; negative where it takes energy from the motion."""
        return self.couple(chain) * chain.joint_rate(self.joint)

    def statement(self) -> str:
        """Return the words and the formula of the law."""
        j, symbol = self.joint, self.notation.symbol
        phi = symbol(f"phi{j}", rf"\varphi_{{{j}}}", ANGLE, j)
        w = symbol(f"phid{j}", rf"\dot{{\varphi}}_{{{j}}}", RATE, j)
        formula = self.notation.latex(self.formula(phi, w))
        return f"{self.words} at joint {j} is the couple ${formula}$."


class ViscousJoint(Couple):
    """Viscous damping: tau = -(b w + b2 w abs(w) + b3 w^3), which is odd in w."""

    words = "Viscous damping"

    def __init__(self, effect: Any, notation: Notation) -> None:
        super().__init__(effect, notation)
        self.coefficients = {1: self.parameter(
            "b", "b_{{{}}}", effect.damping, "N m s/rad", f"linear damping of joint {effect.joint}"
        )}  # fmt: skip
        for power, word in ((2, "quadratic"), (3, "cubic")):
            value = getattr(effect, f"damping{power}")
            if value != 0.0:
                self.coefficients[power] = self.parameter(
                    f"b{power}", f"b_{{{{{power},{{}}}}}}", value,
                    f"N m s^{power}/rad^{power}", f"{word} damping of joint {effect.joint}",
                )  # fmt: skip

    def formula(self, phi: Expr, w: Expr) -> Expr:
        """Return the torque, N m."""
        terms = {1: w, 2: w * Abs(w), 3: w**3}
        return -sum((b * terms[power] for power, b in self.coefficients.items()), Integer(0))


class TorsionalSpring(Couple):
    """A torsional spring: tau = -k (phi - phi_0); what it stores is V = k (phi - phi_0)^2 / 2."""

    words = "A torsional spring"

    def __init__(self, effect: Any, notation: Notation) -> None:
        super().__init__(effect, notation)
        j = effect.joint
        self.stiffness = self.parameter(
            "k", "k_{{{}}}", effect.stiffness, "N m/rad", f"stiffness at joint {j}"
        )
        self.rest_angle: Expr = Integer(0)
        if effect.rest_angle != 0.0:
            words = f"angle of joint {j} at which its spring is at rest"
            name = r"\varphi_{{0,{}}}"
            self.rest_angle = self.parameter("phi0", name, effect.rest_angle, "rad", words)

    def formula(self, phi: Expr, w: Expr) -> Expr:
        """Return the torque, N m: towards the rest angle if the stiffness is positive."""
        return -self.stiffness * (phi - self.rest_angle)

    def potential_energy(self, chain: Chain) -> Expr:
        """Return the energy of the spring, J."""
        return self.stiffness * (chain.joint_angle(self.joint) - self.rest_angle) ** 2 / 2

    def power(self, chain: Chain, ground_force: Vector) -> None:
        """Return None: what a spring does is stored as energy."""


class Motor(Couple):
    """A motor: constant torque, sinusoid of time, or PD controller kp (phi_r - phi) - kd w.

    A limit that a constant or a sinusoid never reaches changes nothing. A limit that is reached
    makes a corner in the law, and a table has a corner at every point.
    """

    words = "A motor"

    def __init__(self, effect: Any, notation: Notation) -> None:
        super().__init__(effect, notation)
        _check(effect)
        motor, pd = f"of the motor at joint {self.joint}", effect.pd
        if pd is not None:
            self.kp = self.parameter(
                "kp", "k_{{p,{}}}", pd.kp, "N m/rad", f"proportional gain {motor}"
            )
            self.kd = self.parameter(
                "kd", "k_{{d,{}}}", pd.kd, "N m s/rad", f"derivative gain {motor}"
            )
            self.reference = self.parameter(
                "phiR", r"\varphi_{{r,{}}}", pd.reference, "rad", f"target angle {motor}"
            )
            return
        words = f"torque {motor}"
        if effect.constant is not None:
            name = r"\tau_{{M,{}}}"
            self.torque = self.parameter("tauM", name, effect.constant, "N m", words)
        else:
            of = str(self.joint)
            names = f"tauM_{of}", rf"\tau_{{M,{of}}}"
            self.torque = self.sinusoid(effect.sinusoid, names, "N m", of, words)

    def formula(self, phi: Expr, w: Expr) -> Expr:
        """Return the torque, N m: constant, a sinusoid, or the controller's."""
        if self.effect.pd is not None:
            return self.kp * (self.reference - phi) - self.kd * w
        return self.torque


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
