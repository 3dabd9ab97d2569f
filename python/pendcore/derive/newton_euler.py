"""Newton's and Euler's equations of every link, with the joint forces as unknowns.

As in the textbook's (2.1) to (2.8), for any number of links:

    m_i a_Ci       = F_(i-1,i) + F_(i+1,i) + G_i + loads
    I_Ci alpha_i   = r_(Ci,P(i-1)) x F_(i-1,i) + r_(Ci,P(i)) x F_(i+1,i) + tau_i - tau_(i+1) + loads

F_(i-1,i) is the force of link i-1 on link i where link i begins, F_01 that of the ground. The
unknowns are F_01 and, as in the textbook, the forces of each link on the one before it: F_21, F_32
and so on, with F_12 = -F_21. Newton's equations give these forces, from the tip inwards: (2.9).
Put into the moment equations, they leave n equations without reactions: (2.10), (2.11).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import NamedTuple

from sympy import Expr, Integer, Symbol, expand

from pendcore.derive.chain import Chain, Vector, cross, minus, of_differences
from pendcore.derive.laws.law import Law, LinkLoad

NOTHING = Integer(0)


class Balance(NamedTuple):
    """One scalar equation: inertia on the left, what acts on the right."""

    inertia: Expr
    acting: Expr


class BodyEquations(NamedTuple):
    """The three equations of a link or a payload: Newton's along x and y, N, and Euler's, N m.

    Newton's give the unknown force of the ground on link 1, or of another body on the one before
    it, such as F_21 or F_p3: the opposite force acts on the body itself. Euler's is about the pivot
    A for link 1, if A is fixed; else about the mass centre.
    """

    mass: Expr
    inertia: Expr
    center: Vector
    rate: Symbol  # at which it turns
    acceleration: Vector
    force: tuple[Symbol, Symbol]
    newton: tuple[Balance, ...]
    moment: Balance
    about_pivot: bool = False

    def solved(self, axis: int, inertia: Expr) -> Expr:
        """Return the unknown force along an axis, with the inertia written in any form, N."""
        acting, symbol = self.newton[axis].acting, self.force[axis]
        return acting.coeff(symbol) * (inertia - acting.subs(symbol, 0))  # the coefficient is +-1


class NewtonEuler:
    """The equations of all links of a chain, with what acts on them besides gravity.

    Attributes
    ----------
    forces : tuple of (Symbol, Symbol)
        The unknown forces, N: F_01, F_21, F_32, ...
    payload : BodyEquations or None
        The body at the tip, all payloads together.
    near_forces, far_forces : list of (Expr, Expr)
        The force on each link where it begins, F_01, F_12 = -F_21, ..., and where it ends, N.
    loads : list of LinkLoad
        The forces on links and their moments.
    locked, holding : list of int, dict
        The locked joints, and their unknown couples on the link beyond them, N m.
    armatures : list of Expr
        Moment of inertia of the rotors at each joint, kg m^2.
    """

    def __init__(self, chain: Chain, laws: Sequence[Law]) -> None:
        self.chain, self.laws = chain, tuple(laws)
        self.notation, self.n = chain.notation, chain.notation.n
        self.forces = tuple(map(self._force, ["01", *(f"{i + 1}{i}" for i in range(1, self.n))]))
        self.loads: list[LinkLoad] = [law.load for law in laws if law.load is not None]
        self.locked = sorted({law.effect.joint for law in laws if law.locks})
        symbol = self.notation.symbol
        self.holding = {j: symbol(f"Lambda{j}", rf"\Lambda_{{{j}}}") for j in self.locked}
        self.armatures = [NOTHING] * self.n
        for law in laws:
            if law.armature is not None:
                self.armatures[law.effect.joint - 1] += law.armature
        self.payload = self._payload()
        at_tip = (NOTHING, NOTHING) if self.payload is None else self.payload.force
        self.near_forces = [self.forces[0], *((-x, -y) for x, y in self.forces[1:])]
        self.far_forces = [*self.forces[1:], at_tip]

    def _force(self, pair: str) -> tuple[Symbol, Symbol]:
        x, y = (self.notation.symbol(f"F{pair}{axis}", f"F_{{{pair}{axis}}}") for axis in "xy")
        return x, y

    def _payload(self) -> BodyEquations | None:
        found = [law.payload for law in self.laws if law.payload is not None]
        if not found:
            return None
        mass, inertia = (sum(column, NOTHING) for column in zip(*found, strict=True))
        force, weight = self._force(f"p{self.n}"), self.weight(mass)
        tip, rate = self.chain.joints[-1], self.notation.qd[-1]
        acceleration = self.chain.velocity(self.chain.joint_velocities[-1])
        newton = tuple(Balance(mass * acceleration[k], weight[k] - force[k]) for k in (0, 1))
        couple = inertia * self.notation.qdd[-1]
        euler = Balance(couple, couple)
        return BodyEquations(mass, inertia, tip, rate, acceleration, force, newton, euler)

    @cached_property
    def torques(self) -> dict[int, tuple[Symbol, Expr]]:
        """tau_j, the torque at each joint that has one, and the sum of laws it stands for, N m."""
        found: dict[int, Expr] = {}
        for law in self.laws:
            if law.couple is not None:
                j = law.effect.joint
                phi, w, _ = self.chain.joint(j)
                found[j] = found.get(j, NOTHING) + law.couple(phi, w)
        torques = {}
        for j, torque in sorted(found.items()):
            symbol = self.notation.symbol(f"tau{j}", rf"\tau_{{{j}}}")
            self.notation.meanings[symbol] = f"torque at joint {j}, N m"
            torques[j] = symbol, torque
        return torques

    @cached_property
    def definitions(self) -> dict[Symbol, Expr]:
        """All symbols that stand for laws, each in terms of those before it."""
        found = dict(self.chain.path)
        for law in self.laws:
            found |= law.definitions(self.chain)
        return found | dict(self.torques.values())

    def joint_couple(self, joint: int) -> Expr:
        """Return the couple on the link beyond a joint: torque, rotor and lock together, N m."""
        if joint > self.n:
            return NOTHING
        torque = self.torques[joint][0] if joint in self.torques else NOTHING
        rotor = self.armatures[joint - 1] * self.chain.joint(joint)[2]
        return torque + self.holding.get(joint, NOTHING) - rotor

    def couples(self, link: int) -> Expr:
        """Return the sum of the couples on a link, in its joints and from the payload, N m."""
        found = self.joint_couple(link) - self.joint_couple(link + 1)
        if link == self.n and self.payload is not None:
            found -= self.payload.moment.acting
        return found

    def weight(self, mass: Expr) -> Vector:
        """Return the weight of a mass: downward, towards +y."""
        return NOTHING, mass * self.notation.gravity

    @cached_property
    def links(self) -> tuple[BodyEquations, ...]:
        """The equations of every link."""
        return tuple(self._link(i) for i in range(1, self.n + 1))

    @property
    def bodies(self) -> tuple[BodyEquations, ...]:
        """The equations of every link, and of the payload if there is one."""
        return self.links if self.payload is None else (*self.links, self.payload)

    def _link(self, link: int) -> BodyEquations:
        s, chain = self.notation, self.chain
        mass, inertia, turning = s.masses[link - 1], s.inertias[link - 1], s.qdd[link - 1]
        begin, end, center = chain.joints[link - 1], chain.joints[link], chain.centers[link - 1]
        near, far = self.near_forces[link - 1], self.far_forces[link - 1]
        weight = self.weight(mass)
        loads = [load for load in self.loads if load.link == link]
        acceleration = chain.center_accelerations[link - 1]
        forces = [near, far, weight, *(load.force for load in loads)]
        newton = tuple(Balance(mass * acceleration[k], sum(f[k] for f in forces)) for k in (0, 1))
        about_pivot = link == 1 and chain.pivot_is_fixed
        point = begin if about_pivot else center
        resistance = inertia + mass * s.centers[link - 1] ** 2 if about_pivot else inertia
        moment = self.couples(link)
        for at, force in ((center, weight), (end, far), (begin, near)):
            moment += cross(minus(at, point), force)
        for load in loads:
            moment += of_differences(load.moment + cross(minus(begin, point), load.force))
        euler = Balance(resistance * turning, expand(moment))
        return BodyEquations(
            mass, inertia, center, s.qd[link - 1], acceleration, self.forces[link - 1], newton,
            euler, about_pivot,
        )  # fmt: skip

    @cached_property
    def solved_forces(self) -> dict[Symbol, Expr]:
        """Every reaction in terms of angles, rates and accelerations: the textbook's (2.9)."""
        solved: dict[Symbol, Expr] = {}
        for body in reversed(self.bodies):
            for k, symbol in enumerate(body.force):
                solved[symbol] = expand(body.solved(k, body.newton[k].inertia).xreplace(solved))
        return solved

    @cached_property
    def reactions(self) -> tuple[Vector, ...]:
        """Force on each link where it begins, N: F_01, F_12, ... as the core has them."""
        known = self.solved_forces
        return tuple((x.xreplace(known), y.xreplace(known)) for x, y in self.near_forces)

    @cached_property
    def without_reactions(self) -> tuple[Balance, ...]:
        """The moment equation of every link with the reactions put in: (2.10), (2.11)."""
        known, moments = self.solved_forces, (link.moment for link in self.links)
        return tuple(Balance(x.inertia, expand(x.acting.xreplace(known))) for x in moments)
