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
    """Kinetic and potential energy of a chain, J, and the powers that effects bring into it, W."""

    def __init__(self, motion: Motion) -> None:
        self.motion = motion
        self.equations = motion.equations
        self.chain = motion.equations.chain
        self.symbols = s = motion.symbols
        bodies = [*zip(s.masses, s.inertias, s.qd, strict=True)]
        places, velocities = [*self.chain.centers], [*self.chain.center_velocities]
        if (payload := self.equations.payload) is not None:
            bodies.append((payload.mass, payload.inertia, s.qd[-1]))
            places.append(self.chain.joints[-1])
            velocities.append(self.chain.joint_velocities[-1])
        self._bodies = [*zip(bodies, places, velocities, strict=True)]

    @cached_property
    def kinetic(self) -> Expr:
        """The kinetic energy of links, payload and rotors, J."""
        found = Integer(0)
        for (mass, inertia, rate), _, v in self._bodies:
            found += mass * dot(v, v) / 2 + inertia * rate**2 / 2
        for joint, armature in enumerate(self.equations.armatures, start=1):
            found += armature * self.chain.joint(joint)[1] ** 2 / 2
        return of_differences(found)

    @cached_property
    def potential(self) -> Expr:
        """The potential energy of weights and springs, J; zero at the height of the origin."""
        found = expand(-self.symbols.gravity * sum(m * y for (m, *_), (_, y), _ in self._bodies))
        for law in self.equations.laws:
            if law.stored is not None:
                found += law.stored(self.chain.joint(law.effect.joint)[0])
        return found

    @cached_property
    def powers_by_definitions(self) -> dict[Any, Expr]:
        """The power of each effect, W, with its loads as symbols."""
        return self.powers_with(self.equations.reactions[0])

    def powers_with(self, ground_force: Vector) -> dict[Any, Expr]:
        """Return the power of each effect, W, with the ground's force on link 1 as it is given."""
        found: dict[Any, Expr] = {}
        for law in self.equations.laws:
            if law.power is not None:
                power = law.power(self.chain, ground_force)
            elif law.couple is not None and law.stored is None:
                phi, w, _ = self.chain.joint(law.effect.joint)
                power = law.couple(phi, w) * w
            else:
                continue
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
        s, motion = self.symbols, self.motion
        torques = {d.symbol: d.value for d in self.equations.torques.values()}
        residual = self.chain.rate(self.kinetic + self.potential)
        residual -= sum(self.powers_by_definitions.values(), Integer(0))
        for i, rate in enumerate(s.qd):
            line = sum(motion.mass_matrix[i, k] * a for k, a in enumerate(s.qdd))
            residual -= rate * (line - motion.forcing_by_definitions[i].xreplace(torques))
        rates = dict[Symbol, Expr]()  # of links beyond a lock: those of the links before it
        for joint in self.equations.locked:
            before = s.qd[joint - 2] if joint > 1 else Integer(0)
            rates[s.qd[joint - 1]] = rates.get(before, before)
        left = residual.xreplace(torques).subs(rates).xreplace(self.chain.path)
        return of_differences(left) + self.motion.power_of_the_error()
