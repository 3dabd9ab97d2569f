"""Effects on bodies and what holds them: a payload, a rotor, a lock, a pivot that is moved."""

from __future__ import annotations

from typing import Any

from sympy import Expr, Integer

from pendcore.derive.chain import Chain, Vector, dot
from pendcore.derive.laws.law import Law, NotSmooth, sinusoid
from pendcore.derive.notation import Notation
from pendcore.derive.writing import MASS


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
