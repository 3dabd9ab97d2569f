"""Effects that act by a couple in a joint: damping, springs and motors."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from sympy import Abs, Expr, Integer

from pendcore.derive.laws.law import Law, NotSmooth, sinusoid
from pendcore.derive.notation import Notation
from pendcore.derive.writing import ANGLE, RATE

Couple = Callable[[Expr, Expr], Expr]


def _law(effect: Any, s: Notation, words: str, couple: Couple, stored: Any = None) -> Law:
    j = effect.joint
    phi = s.symbol(f"phi{j}", rf"\varphi_{{{j}}}", ANGLE, j)
    w = s.symbol(f"phid{j}", rf"\dot{{\varphi}}_{{{j}}}", RATE, j)
    formula = s.latex(couple(phi, w))
    statement = f"{words} at joint {j} is the couple ${formula}$."
    return Law(effect, statement, couple=couple, stored=stored)


def viscous_joint(effect: Any, s: Notation) -> Law:
    """Viscous damping: tau = -(b w + b2 w abs(w) + b3 w^3), which is odd in w."""
    j = effect.joint
    coefficients = {1: s.parameter(
        f"b_{j}", f"b_{{{j}}}", effect.damping, "N m s/rad", f"linear damping of joint {j}"
    )}  # fmt: skip
    for power, word in ((2, "quadratic"), (3, "cubic")):
        value = getattr(effect, f"damping{power}")
        if value != 0.0:
            coefficients[power] = s.parameter(
                f"b{power}_{j}", f"b_{{{power},{j}}}", value,
                f"N m s^{power}/rad^{power}", f"{word} damping of joint {j}",
            )  # fmt: skip

    def couple(phi: Expr, w: Expr) -> Expr:
        terms = {1: w, 2: w * Abs(w), 3: w**3}
        return -sum((b * terms[power] for power, b in coefficients.items()), Integer(0))

    return _law(effect, s, "Viscous damping", couple)


def torsional_spring(effect: Any, s: Notation) -> Law:
    """A torsional spring: tau = -k (phi - phi_0); what it stores is V = k (phi - phi_0)^2 / 2."""
    j, rest = effect.joint, Integer(0)
    k = s.parameter(f"k_{j}", f"k_{{{j}}}", effect.stiffness, "N m/rad", f"stiffness at joint {j}")
    if effect.rest_angle != 0.0:
        words, name = f"angle of joint {j} at which its spring is at rest", rf"\varphi_{{0,{j}}}"
        rest = s.parameter(f"phi0_{j}", name, effect.rest_angle, "rad", words)
    return _law(
        effect, s, "A torsional spring",
        lambda phi, w: -k * (phi - rest),
        lambda phi: k * (phi - rest) ** 2 / 2,
    )  # fmt: skip


def motor(effect: Any, s: Notation) -> Law:
    """A motor: constant torque, sinusoid of time, or PD controller kp (phi_r - phi) - kd w.

    A limit that a constant or a sinusoid never reaches changes nothing. A limit that is reached
    makes a corner in the law, and a table has a corner at every point.
    """
    _check(effect)
    j, pd, of = effect.joint, effect.pd, f"of the motor at joint {effect.joint}"
    torque = f"tauM_{j}", rf"\tau_{{M,{j}}}"
    if pd is not None:
        kp = s.parameter(f"kp_{j}", f"k_{{p,{j}}}", pd.kp, "N m/rad", f"proportional gain {of}")
        kd = s.parameter(f"kd_{j}", f"k_{{d,{j}}}", pd.kd, "N m s/rad", f"derivative gain {of}")
        name = f"phiR_{j}", rf"\varphi_{{r,{j}}}"
        target = s.parameter(*name, pd.reference, "rad", f"target angle {of}")
        return _law(effect, s, "A motor", lambda phi, w: kp * (target - phi) - kd * w)
    if effect.constant is not None:
        tau = s.parameter(*torque, effect.constant, "N m", f"torque {of}")
    else:
        tau = sinusoid(s, effect.sinusoid, torque, "N m", str(j), f"torque {of}")
    return _law(effect, s, "A motor", lambda phi, w: tau)


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
