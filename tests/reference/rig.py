"""A chain with the effects of a scene: its motion, its energy, and where the energy goes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from reference.arithmetic import DOUBLE, Arithmetic, Number
from reference.instant import AT_REST, Instant, PivotMotion
from reference.loads import Loads
from reference.newton_euler import Body, Equations, Motion, chain_equations, motion_of

# What the ledger books as lost; the other entries are work done on the chain.
LOSSES = {"viscous", "dry", "drag"}


class Energy(NamedTuple):
    """Kinetic and potential energy, J; the potential is zero at the height of the pivot."""

    kinetic: Number
    potential: Number


@dataclass(frozen=True)
class Law:
    """An effect that does nothing; most laws define one of its parts (`reference.effects`)."""

    def pivot(self, t: Number, arithmetic: Arithmetic) -> PivotMotion | None:
        """How the pivot moves, if the effect moves it."""
        return None

    def act(self, instant: Instant, loads: Loads) -> None:
        """Add forces and couples, inertia, constraints."""

    def break_times(self) -> Sequence[float]:
        """When the law is not analytic in time."""
        return ()

    def bends(self, instant: Instant) -> Sequence[Number]:
        """Numbers at whose zeros the law is continuous, but not analytic."""
        return ()

    def between_bends(self, signs: Sequence[int]) -> Law:
        """Return the analytic law that holds where the bends have these signs."""
        return self

    def kinetic(self, instant: Instant) -> Number:
        """Kinetic energy besides that of the links, J."""
        return 0

    def potential(self, instant: Instant) -> Number:
        """Potential energy besides that of the links, J."""
        return 0

    def shares(self, instant: Instant, motion: Motion) -> dict[str, Number]:
        """Power of each entry of the ledger, W; losses count as positive."""
        return {}


@dataclass(frozen=True, slots=True, kw_only=True)
class Rig:
    """What a scene describes, as the reference takes it."""

    bodies: Sequence[Body]
    gravity: float
    effects: Sequence[Law] = ()
    arithmetic: Arithmetic = DOUBLE

    def instant(self, t: Number, q: Sequence[Number], qd: Sequence[Number]) -> Instant:
        """Where the chain is; the pivot is where all that drives it has brought it."""
        driven = AT_REST
        for effect in self.effects:
            if (moved := effect.pivot(t, self.arithmetic)) is not None:
                driven = driven.plus(moved)
        return Instant(
            bodies=self.bodies,
            gravity=self.gravity,
            q=q,
            qd=qd,
            t=t,
            pivot=driven,
            arithmetic=self.arithmetic,
        )

    def loads(self, instant: Instant) -> Loads:
        """Let every effect act."""
        acceleration, size = instant.pivot.acceleration, instant.pivot.size
        loads = Loads(len(self.bodies), pivot_acceleration=acceleration, pivot_size=size)
        for effect in self.effects:
            effect.act(instant, loads)
        return loads

    def equations(self, instant: Instant) -> Equations:
        """Write the Newton-Euler equations with every load."""
        q, qd = instant.q, instant.qd
        loads = self.loads(instant)
        return chain_equations(self.bodies, self.gravity, q, qd, loads, self.arithmetic)

    def motion(self, t: Number, q: Sequence[Number], qd: Sequence[Number]) -> Motion:
        """Solve the Newton-Euler equations with every load."""
        instant = self.instant(t, q, qd)
        unknowns = self.equations(instant).solve(self.arithmetic)
        return motion_of(unknowns, self.bodies, q, qd, self.loads(instant), self.arithmetic)

    def accelerations(
        self, t: Number, q: Sequence[Number], qd: Sequence[Number]
    ) -> Sequence[Number]:
        """Return the angular accelerations of the links, rad/s^2, without what else is unknown."""
        return self.equations(self.instant(t, q, qd)).solve(self.arithmetic)[: len(q)]

    def energy(self, t: Number, q: Sequence[Number], qd: Sequence[Number]) -> Energy:
        """Sum m v^2/2 + I w^2/2 and -m g y over the links, and what the effects store."""
        instant, number = self.instant(t, q, qd), self.arithmetic.number
        kinetic = potential = number(0)
        for body, rate, center in zip(self.bodies, qd, instant.mass_centers(), strict=True):
            mass, w = number(body.mass), number(rate)
            kinetic += mass * (center.vx**2 + center.vy**2) / 2 + number(body.inertia) * w * w / 2
            potential -= mass * number(self.gravity) * center.y
        for effect in self.effects:
            kinetic += effect.kinetic(instant)
            potential += effect.potential(instant)
        return Energy(kinetic, potential)

    def angular_momentum(self, q: Sequence[Number], qd: Sequence[Number]) -> Number:
        """Sum m (x vy - y vx) + I w over the links: about the pivot, from x towards y."""
        number = self.arithmetic.number
        total, centers = number(0), self.instant(0, q, qd).mass_centers()
        for body, rate, (x, y, vx, vy) in zip(self.bodies, qd, centers, strict=True):
            total += number(body.mass) * (x * vy - y * vx) + number(body.inertia) * number(rate)
        return total

    def shares(self, t: Number, q: Sequence[Number], qd: Sequence[Number]) -> dict[str, Number]:
        """Power of every entry of the ledger, W; losses count as positive."""
        instant, motion = self.instant(t, q, qd), self.motion(t, q, qd)
        shares: dict[str, Number] = {}
        for effect in self.effects:
            for entry, power in effect.shares(instant, motion).items():
                shares[entry] = shares.get(entry, 0) + power
        return shares

    def mass_matrix(self, q: Sequence[Number]) -> list[list[Number]]:
        """Return the second derivatives of the kinetic energy by the rates: M, kg m^2."""
        n = len(self.bodies)

        def kinetic(*turning: int) -> Number:
            return self.energy(0, q, [turning.count(k) for k in range(n)]).kinetic

        still, single = kinetic(), [kinetic(i) for i in range(n)]
        # Twice the rate of one link is four times its own part: a second difference in each entry.
        return [[kinetic(i, j) - single[i] - single[j] + still for j in range(n)] for i in range(n)]


def balance(shares: dict[str, Number]) -> Number:
    """Return how fast kinetic and potential energy grow together, from the ledger's entries."""
    return sum(-power if entry in LOSSES else power for entry, power in shares.items())
