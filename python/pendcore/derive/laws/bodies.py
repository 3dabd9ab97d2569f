"""Effects on bodies and what holds them: a payload, a rotor, a lock, a pivot that is moved."""

from __future__ import annotations

from typing import Any

from sympy import Expr, Integer

from pendcore.derive.chain import Chain, Vector, dot
from pendcore.derive.laws.law import Law, NotSmooth
from pendcore.derive.notation import Notation
from pendcore.derive.writing import MASS


class Payload(Law):
    """A rigid body at the tip: its weight and inertia act on the last link."""

    def __init__(self, effect: Any, notation: Notation) -> None:
        super().__init__(effect, notation)
        rank = (MASS, notation.n + 1)
        self.mass = notation.parameter(
            "m_p", "m_{p}", effect.mass, "kg", "mass of the payload", rank
        )
        self.inertia: Expr = Integer(0)
        if effect.inertia != 0.0:
            words = "moment of inertia of the payload about its mass centre"
            self.inertia = notation.parameter("I_p", "I_{p}", effect.inertia, "kg m^2", words, rank)

    def statement(self) -> str:
        """Return what the payload is."""
        mass, inertia = map(self.notation.latex, self.payload())
        turning = (
            f"; its moment of inertia about its mass centre is ${inertia}$, and it turns with link "
            f"{self.notation.n}"
        )
        return (
            f"A payload of mass ${mass}$ is fixed to the tip, where its mass centre is"
            f"{turning if self.inertia else ', a point mass'}."
        )

    def payload(self) -> tuple[Expr, Expr]:
        """Return the mass and the moment of inertia."""
        return self.mass, self.inertia


class RotorInertia(Law):
    """A rotor that turns with a joint, T = J phid^2 / 2; turning it takes the couple J phidd."""

    def __init__(self, effect: Any, notation: Notation) -> None:
        super().__init__(effect, notation)
        j = effect.joint
        self.inertia = notation.parameter(
            f"J_{j}", f"J_{{{j}}}", effect.armature, "kg m^2", f"inertia of the rotor at joint {j}"
        )

    def statement(self) -> str:
        """Return what the rotor takes."""
        joint, inertia = self.effect.joint, self.notation.latex(self.inertia)
        return (
            f"A rotor with the moment of inertia ${inertia}$ turns with joint {joint}, by the "
            f"joint's angle: the joint has to supply the couple "
            f"${inertia}\\,\\ddot{{\\varphi}}_{{{joint}}}$ that accelerates the rotor."
        )

    def armature(self) -> tuple[int, Expr]:
        """Return the joint and the moment of inertia."""
        return self.effect.joint, self.inertia


class Lock(Law):
    """A locked joint: phi = constant, held by a couple that is one more unknown.

    The couple Lambda_j does no work; qdd_j = qdd_(j-1) is one more equation. The angle at which the
    joint is locked comes from the state.
    """

    def statement(self) -> str:
        """Return what the lock does."""
        j = self.effect.joint
        return (
            f"Joint {j} is locked: a couple $\\Lambda_{{{j}}}$, one more unknown, keeps its angle "
            f"$\\varphi_{{{j}}}$ as it is at the start."
        )

    def lock(self) -> int:
        """Return its joint."""
        return int(self.effect.joint)


class DrivenPivot(Law):
    """A pivot that is moved: x_0 and y_0 are sinusoids of time; the power is F_01 . v_0.

    A spline is smooth only in pieces: its third derivative jumps at every point.
    """

    def __init__(self, effect: Any, notation: Notation) -> None:
        super().__init__(effect, notation)
        if effect.spline is not None:
            raise NotSmooth(
                "spline: its path is given by points, with a different polynomial between each "
                "two, and not by a law",
                "give sinusoids, x= and y=",
            )
        self.path = self._axis("x", effect.x), self._axis("y", effect.y)

    def _axis(self, axis: str, wave: Any) -> Expr:
        if wave is None:
            return Integer(0)
        names = f"{axis.upper()}0", rf"\hat{{{axis}}}_{{A}}"
        return self.sinusoid(wave, names, "m", axis, f"the pivot's motion along {axis}")

    def statement(self) -> str:
        """Return how the pivot moves."""
        x, y = map(self.notation.latex, self.path)
        return f"The pivot $A$ is moved by $\\left({x}, {y}\\right)$."

    def pivot(self) -> Vector:
        """Return the position of the pivot, m."""
        return self.path

    def power(self, chain: Chain, ground_force: Vector) -> Expr:
        """Return the power of what moves the pivot, W."""
        symbols = {law: symbol for symbol, law in chain.path.items()}
        x, y = (law.diff(self.notation.t) for law in self.path)
        return dot(ground_force, (symbols.get(x, x), symbols.get(y, y)))
