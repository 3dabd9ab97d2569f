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
from pendcore.derive.laws import Definition, Law, LinkLoad

ZERO: Vector = (Integer(0), Integer(0))


class Balance(NamedTuple):
    """One scalar equation: inertia on the left, what acts on the right."""

    inertia: Expr
    acting: Expr


class LinkEquations(NamedTuple):
    """The three equations of a link.

    Attributes
    ----------
    newton : (Balance, Balance)
        Newton's equations along x and y, N.
    moment : Balance
        Euler's equation, N m: about the pivot A for link 1, if A is fixed; else about the mass
        centre.
    about_pivot : bool
        Whether Euler's equation is about the pivot.
    """

    newton: tuple[Balance, Balance]
    moment: Balance
    about_pivot: bool


class PayloadEquations(NamedTuple):
    """A body at the tip, and its equations.

    Attributes
    ----------
    mass, inertia : sympy.Expr
        All payloads together, kg and kg m^2.
    force : tuple of sympy.Symbol
        F_p3 and so on: the unknown force of the body on the last link. The opposite force acts on
        the body.
    newton : (Balance, Balance)
        Newton's equations along x and y, N.
    """

    mass: Expr
    inertia: Expr
    force: tuple[Symbol, Symbol]
    newton: tuple[Balance, Balance]


class NewtonEuler:
    """The equations of all links of a chain.

    Parameters
    ----------
    chain : Chain
        Kinematics.
    laws : sequence of Law
        What acts besides gravity.
    """

    def __init__(self, chain: Chain, laws: Sequence[Law]) -> None:
        self.chain = chain
        self.laws = tuple(laws)
        s = self.notation = chain.notation
        self.n = s.n
        self.forces = tuple(self._force(i) for i in range(s.n))

    def _force(self, joint: int) -> tuple[Symbol, Symbol]:
        """F_01 for the pivot, counted as 0; F_21 for joint 1 between links 1 and 2; and so on."""
        pair = "01" if joint == 0 else f"{joint + 1}{joint}"
        return self._components(pair if joint < 9 else f"{joint + 1}_{joint}")

    def _components(self, pair: str) -> tuple[Symbol, Symbol]:
        shown = pair.replace("_", ",")
        x, y = (self.notation.symbol(f"F{pair}{axis}", f"F_{{{shown}{axis}}}") for axis in "xy")
        return x, y

    @cached_property
    def payload(self) -> PayloadEquations | None:
        """The body at the tip, if there is one."""
        found = [payload for law in self.laws if (payload := law.payload()) is not None]
        if not found:
            return None
        mass, inertia = (sum(column, Integer(0)) for column in zip(*found, strict=True))
        acceleration, weight = self.chain.tip_acceleration, self.weight(mass)
        force = self._components(f"p{self.n}")
        x, y = (Balance(mass * acceleration[k], weight[k] - force[k]) for k in (0, 1))
        return PayloadEquations(mass, inertia, force, (x, y))

    @cached_property
    def armatures(self) -> tuple[Expr, ...]:
        """Moment of inertia of the rotors at each joint, kg m^2."""
        found = [Integer(0)] * self.n
        for law in self.laws:
            if (rotor := law.armature()) is not None:
                found[rotor[0] - 1] += rotor[1]
        return tuple(found)

    @cached_property
    def locked(self) -> tuple[int, ...]:
        """The locked joints."""
        return tuple(sorted({joint for law in self.laws if (joint := law.lock()) is not None}))

    @cached_property
    def torques(self) -> tuple[Definition, ...]:
        """tau_j, the torque at each joint that has one, from the laws of effects, N m."""
        found: dict[int, Expr] = {}
        for law in self.laws:
            couple = law.couple(self.chain)
            if couple is not None:
                joint = law.effect.joint
                found[joint] = found.get(joint, Integer(0)) + couple
        symbol = self.notation.symbol
        return tuple(
            Definition(symbol(f"tau{j}", rf"\tau_{{{j}}}"), found[j], f"torque at joint {j}, N m")
            for j in sorted(found)
        )

    @cached_property
    def definitions(self) -> tuple[Definition, ...]:
        """All symbols that stand for laws, each in terms of those before it."""
        path = self.chain.path.items()
        units = {0: "m", 1: "m/s", 2: "m/s^2"}
        moved = [
            Definition(symbol, law, f"motion of the pivot, {units[symbol.name.count('d')]}")
            for symbol, law in path
        ]
        of_loads = [d for law in self.laws for d in law.definitions(self.chain)]
        return (*moved, *of_loads, *self.torques)

    @cached_property
    def loads(self) -> tuple[LinkLoad, ...]:
        """The forces on links and their moments."""
        return tuple(load for law in self.laws if (load := law.load(self.chain)) is not None)

    @cached_property
    def holding(self) -> dict[int, Symbol]:
        """Unknown couples of the locked joints on the link beyond them, N m."""
        symbol = self.notation.symbol
        return {j: symbol(f"Lambda{j}", rf"\Lambda_{{{j}}}") for j in self.locked}

    def joint_couple(self, joint: int) -> Expr:
        """Return the couple on the link beyond a joint: torque, rotor and lock together, N m."""
        if joint > self.n:
            return Integer(0)
        torque = {int(d.symbol.name[3:]): d.symbol for d in self.torques}.get(joint, Integer(0))
        rotor = self.armatures[joint - 1] * self.chain.joint_acceleration(joint)
        return torque + self.holding.get(joint, Integer(0)) - rotor

    def couples(self, link: int) -> Expr:
        """Return the sum of the couples on a link, in its joints and from the payload, N m."""
        found = self.joint_couple(link) - self.joint_couple(link + 1)
        if link == self.n and self.payload is not None:
            found -= self.payload.inertia * self.notation.qdd[link - 1]
        return found

    def near_force(self, link: int) -> Vector:
        """Return the force on a link where it begins: F_01, or F_12 = -F_21."""
        x, y = self.forces[link - 1]
        return (x, y) if link == 1 else (-x, -y)

    def far_force(self, link: int) -> Vector:
        """Return the force on a link where it ends, from the next link or from the payload."""
        if link < self.n:
            return self.forces[link]
        return ZERO if self.payload is None else self.payload.force

    def weight(self, mass: Expr) -> Vector:
        """Return the weight of a mass: downward, towards +y."""
        return Integer(0), mass * self.notation.gravity

    @cached_property
    def links(self) -> tuple[LinkEquations, ...]:
        """The equations of every link."""
        return tuple(self._link(i) for i in range(1, self.n + 1))

    def _link(self, link: int) -> LinkEquations:
        s, chain = self.notation, self.chain
        mass, inertia, turning = s.masses[link - 1], s.inertias[link - 1], s.qdd[link - 1]
        begin, end, center = chain.joints[link - 1], chain.joints[link], chain.centers[link - 1]
        near, far, weight = self.near_force(link), self.far_force(link), self.weight(mass)
        loads = [load for load in self.loads if load.link == link]
        acceleration = chain.center_accelerations[link - 1]
        x, y = (
            Balance(
                mass * acceleration[k],
                near[k] + far[k] + weight[k] + sum(load.force[k] for load in loads),
            )
            for k in (0, 1)
        )
        about_pivot = link == 1 and chain.pivot_is_fixed
        point = begin if about_pivot else center
        resistance = inertia + mass * s.centers[link - 1] ** 2 if about_pivot else inertia
        moment = cross(minus(center, point), weight) + cross(minus(end, point), far)
        moment += cross(minus(begin, point), near)
        for load in loads:
            moment += of_differences(load.moment + cross(minus(begin, point), load.force))
        moment += self.couples(link)
        return LinkEquations((x, y), Balance(resistance * turning, expand(moment)), about_pivot)

    @cached_property
    def solved_forces(self) -> dict[Symbol, Expr]:
        """Every reaction in terms of angles, rates and accelerations: the textbook's (2.9)."""
        solved: dict[Symbol, Expr] = {}
        if self.payload is not None:
            for symbol, line in zip(self.payload.force, self.payload.newton, strict=True):
                solved[symbol] = expand(line.acting + symbol - line.inertia)
        for link in range(self.n, 0, -1):
            equations = self.links[link - 1]
            for symbol, line in zip(self.forces[link - 1], equations.newton, strict=True):
                rest = (line.inertia - line.acting).subs(symbol, 0)  # sign F + rest = 0
                sign = 1 if link == 1 else -1
                solved[symbol] = expand(sign * rest.xreplace(solved))
        return solved

    @cached_property
    def reactions(self) -> tuple[Vector, ...]:
        """Force on each link where it begins, N: F_01, F_12, ... as the core has them."""
        return tuple(
            (expand(x.xreplace(self.solved_forces)), expand(y.xreplace(self.solved_forces)))
            for x, y in map(self.near_force, range(1, self.n + 1))
        )

    @cached_property
    def without_reactions(self) -> tuple[Balance, ...]:
        """The moment equation of every link with the reactions put in: (2.10), (2.11)."""
        return tuple(
            Balance(link.moment.inertia, expand(link.moment.acting.xreplace(self.solved_forces)))
            for link in self.links
        )
