"""Effects at joints, tip and pivot: couples, rotors, locks, a payload, a pivot that is moved."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from sympy import Abs, Expr, Integer

from pendcore.derive.chain import Chain, Vector, dot
from pendcore.derive.laws.law import Law, NotSmooth, sinusoid
from pendcore.derive.notation import ANGLE, MASS, RATE, Notation

Couple = Callable[[Expr, Expr], Expr]


def _law(effect: Any, s: Notation, words: str, couple: Couple, stored: Any = None) -> Law:
    j = effect.joint
    phi = s.symbol(f"phi{j}", rf"\varphi_{{{j}}}", ANGLE, j)
    w = s.symbol(f"phid{j}", rf"\dot{{\varphi}}_{{{j}}}", RATE, j)
    statement = f"{words} at joint {j} is the couple ${s.latex(couple(phi, w))}$."
    return Law(effect, statement, couple=couple, stored=stored)


def viscous_joint(effect: Any, s: Notation) -> Law:
    """Viscous damping: tau = -(b w + b2 w abs(w) + b3 w^3), which is odd in w."""
    j, words = effect.joint, f"linear damping of joint {effect.joint}"
    coefficients = {1: s.parameter(f"b_{j}", f"b_{{{j}}}", effect.damping, "N m s/rad", words)}
    for power, word in ((2, "quadratic"), (3, "cubic")):
        value = getattr(effect, f"damping{power}")
        if value != 0.0:
            name, unit = (f"b{power}_{j}", f"b_{{{power},{j}}}"), f"N m s^{power}/rad^{power}"
            words = f"{word} damping of joint {j}"
            coefficients[power] = s.parameter(*name, value, unit, words)

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
    j, pd, wave, limit = effect.joint, effect.pd, effect.sinusoid, effect.limit
    if effect.table is not None:
        raise NotSmooth(
            "table: its torque is given by points, not by a law, and has a corner at each of them",
            "give it as constant, sinusoid or pd",
        )
    if pd is not None and limit != float("inf"):
        raise NotSmooth(
            f"limit = {limit!r}: a controller that is clipped has a corner at +-limit",
            "leave limit out",
        )
    largest = abs(wave.amplitude if wave is not None else effect.constant or 0.0)
    if largest > limit:
        raise NotSmooth(
            f"limit = {limit!r}: the torque of up to {largest!r} N m is clipped there",
            "give the torque that is left" if wave is None else "leave limit out",
        )
    of, torque = f"of the motor at joint {j}", (f"tauM_{j}", rf"\tau_{{M,{j}}}")
    if pd is not None:
        kp = s.parameter(f"kp_{j}", f"k_{{p,{j}}}", pd.kp, "N m/rad", f"proportional gain {of}")
        kd = s.parameter(f"kd_{j}", f"k_{{d,{j}}}", pd.kd, "N m s/rad", f"derivative gain {of}")
        name = f"phiR_{j}", rf"\varphi_{{r,{j}}}"
        target = s.parameter(*name, pd.reference, "rad", f"target angle {of}")
        return _law(effect, s, "A motor", lambda phi, w: kp * (target - phi) - kd * w)
    if wave is None:
        tau = s.parameter(*torque, effect.constant, "N m", f"torque {of}")
    else:
        tau = sinusoid(s, wave, torque, "N m", str(j), f"torque {of}")
    return _law(effect, s, "A motor", lambda phi, w: tau)


def payload(effect: Any, s: Notation) -> Law:
    """A rigid body at the tip: its weight and inertia act on the last link."""
    rank, inertia, turning = (MASS, s.n + 1), Integer(0), ", a point mass"
    mass = s.parameter("m_p", "m_{p}", effect.mass, "kg", "mass of the payload", rank)
    if effect.inertia != 0.0:
        words = "moment of inertia of the payload about its mass centre"
        inertia = s.parameter("I_p", "I_{p}", effect.inertia, "kg m^2", words, rank)
        turning = (
            f"; its moment of inertia about its mass centre is ${s.latex(inertia)}$, and it turns "
            f"with link {s.n}"
        )
    words = f"A payload of mass ${s.latex(mass)}$ is fixed to the tip, where its mass centre is"
    return Law(effect, f"{words}{turning}.", payload=(mass, inertia))


def rotor_inertia(effect: Any, s: Notation) -> Law:
    """A rotor that turns with a joint, T = J phid^2 / 2; turning it takes the couple J phidd."""
    j = effect.joint
    words = f"inertia of the rotor at joint {j}"
    inertia = s.parameter(f"J_{j}", f"J_{{{j}}}", effect.armature, "kg m^2", words)
    couple = rf"{s.latex(inertia)} \ddot{{\varphi}}_{{{j}}}"
    statement = (
        f"A rotor with the moment of inertia ${s.latex(inertia)}$ turns with joint {j}, by the "
        f"joint's angle: the joint has to supply the couple ${couple}$ that accelerates the rotor."
    )
    return Law(effect, statement, armature=inertia)


def lock(effect: Any, s: Notation) -> Law:
    """A locked joint: phi = constant, held by a couple that is one more unknown.

    The couple Lambda_j does no work; qdd_j = qdd_(j-1) is one more equation. The angle at which the
    joint is locked comes from the state.
    """
    j = effect.joint
    statement = (
        f"Joint {j} is locked: a couple $\\Lambda_{{{j}}}$, one more unknown, keeps its angle "
        f"$\\varphi_{{{j}}}$ as it is at the start."
    )
    return Law(effect, statement, locks=True)


def driven_pivot(effect: Any, s: Notation) -> Law:
    """A pivot that is moved: x_0 and y_0 are sinusoids of time; the power is F_01 . v_0.

    A spline is smooth only in pieces: its third derivative jumps at every point.
    """
    if effect.spline is not None:
        raise NotSmooth(
            "spline: its path is given by points, with a different polynomial between each "
            "two, and not by a law",
            "give sinusoids, x= and y=",
        )

    def along(axis: str, wave: Any) -> Expr:
        if wave is None:
            return Integer(0)
        names = f"{axis.upper()}0", rf"\hat{{{axis}}}_{{A}}"
        return sinusoid(s, wave, names, "m", axis, f"the pivot's motion along {axis}")

    path = along("x", effect.x), along("y", effect.y)

    def power(chain: Chain, ground_force: Vector) -> Expr:
        symbols = {law: symbol for symbol, law in chain.path.items()}
        x, y = (law.diff(s.t) for law in path)
        return dot(ground_force, (symbols.get(x, x), symbols.get(y, y)))

    moved = ", ".join(map(s.latex, path))
    statement = f"The pivot $A$ is moved by $\\left({moved}\\right)$."
    return Law(effect, statement, pivot=path, power=power)
