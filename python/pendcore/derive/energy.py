"""Energies of the chain, the powers of effects, and the balance of both, which holds exactly.

The rate of change of T + V is the sum of the powers of all effects, and nothing else:

d/dt (T + V) = sum of powers        when        M qdd = f
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

from sympy import Expr, Integer, Symbol, expand

from pendcore.derive.chain import Vector, dot, of_differences
from pendcore.derive.motion import Motion


class Energy:
    """Kinetic and potential energy of a chain, J, and the powers that effects bring into it, W.

    Parameters
    ----------
    motion : Motion
        The equations of motion, solved.
    """

    def __init__(self, motion: Motion) -> None:
        self.motion = motion
        self.equations = motion.equations
        self.chain = motion.equations.chain
        self.notation = motion.notation

    @cached_property
    def kinetic(self) -> Expr:
        """The kinetic energy of links, payload and rotors, J."""
        s, found = self.notation, Integer(0)
        for i, v in enumerate(self.chain.center_velocities):
            found += s.masses[i] * dot(v, v) / 2 + s.inertias[i] * s.qd[i] ** 2 / 2
        if self.equations.payload is not None:
            mass, inertia = self.equations.payload.mass, self.equations.payload.inertia
            v = self.chain.joint_velocities[-1]
            found += mass * dot(v, v) / 2 + inertia * s.qd[-1] ** 2 / 2
        for joint, armature in enumerate(self.equations.armatures, start=1):
            found += armature * self.chain.joint_rate(joint) ** 2 / 2
        return of_differences(found)

    @cached_property
    def potential(self) -> Expr:
        """The potential energy of weights and springs, J; zero at the height of the origin."""
        s = self.notation
        heights = [m * c[1] for m, c in zip(s.masses, self.chain.centers, strict=True)]
        if self.equations.payload is not None:
            heights.append(self.equations.payload.mass * self.chain.joints[-1][1])
        stored = [law.potential_energy(self.chain) for law in self.equations.laws]
        return expand(-s.gravity * sum(heights)) + sum(stored, Integer(0))

    @cached_property
    def powers_by_definitions(self) -> dict[Any, Expr]:
        """The power of each effect, W, with its loads as symbols."""
        return self.powers_with(self.equations.reactions[0])

    def powers_with(self, ground_force: Vector) -> dict[Any, Expr]:
        """Return the power of each effect, W, with the ground's force on link 1 as it is given."""
        found: dict[Any, Expr] = {}
        for law in self.equations.laws:
            power = law.power(self.chain, ground_force)
            if power is not None:
                found[law.effect] = found.get(law.effect, Integer(0)) + power
        return found

    @cached_property
    def powers(self) -> dict[Any, Expr]:
        """The power that each effect brings in, W; negative where the effect takes energy."""
        known = self.motion.definitions
        return {effect: p.xreplace(known) for effect, p in self.powers_by_definitions.items()}

    def rate(self) -> Expr:
        """Return d/dt (T + V) minus all powers, along the motion: 0.

        The accelerations are put in by two steps, each of them exact. Let R(qdd) be this difference
        for any accelerations, and let e = M qdd - f. The first step brings R(qdd) - qd . e to a
        normal form: that is 0 for all accelerations if forces, energies and powers fit together.
        The second step adds qd . e at the solved accelerations: that is 0 if they solve the
        equations.
        """
        s, motion = self.notation, self.motion
        torques = {d.symbol: d.value for d in self.equations.torques}
        locked = self._locked_rates()
        total = self.chain.rate(self.kinetic + self.potential)
        residual = total - sum(self.powers_by_definitions.values(), Integer(0))
        unbalanced = Integer(0)
        for i, rate in enumerate(s.qd):
            line = sum(motion.mass_matrix[i, k] * a for k, a in enumerate(s.qdd))
            unbalanced += rate * (line - motion.forcing_by_definitions[i].xreplace(torques))
        left = (residual - unbalanced).xreplace(torques).subs(locked)
        left = of_differences(left.xreplace(self.chain.path))
        return left + self.motion.power_of_the_error()

    def _locked_rates(self) -> dict[Symbol, Expr]:
        """Return, for each link beyond a lock, its rate: that of the link before the lock."""
        s, found = self.notation, dict[Symbol, Expr]()
        for joint in self.equations.locked:
            before = s.qd[joint - 2] if joint > 1 else Integer(0)
            found[s.qd[joint - 1]] = found.get(before, before)
        return found
