"""What a scene simulates and what it does not, what that costs, and how fast it moves."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from math import pi
from typing import Any, NamedTuple

import numpy as np

from pendcore.effect_class import Part
from pendcore.explanation.absence import Absence, absent
from pendcore.explanation.constraints import constraint_rank
from pendcore.explanation.equilibria import Equilibrium, find_equilibria
from pendcore.scene import Mobility, Scene

MANY = 60
"""Links beyond which no matrix of them is made."""
STEPS_A_PERIOD = 500
"""How many steps a period of the fastest oscillation takes without a rejected one, from a start at
rest up to half a radian from an equilibrium, at the tolerances that `simulate` has by default."""


class Cost(NamedTuple):
    """What a part of a right-hand side takes.

    Attributes
    ----------
    what : str
        ``"links"`` (with gravity), an effect by its number and kind, or ``"all"``.
    operations : int or None
        Additions, multiplications, divisions and the like that an effect adds; None where they are
        not counted, as in a function of the user's.
    nanoseconds : float
        Measured on the spot; of an effect, what it adds to the links alone.
    """

    what: str
    operations: int | None
    nanoseconds: float


@dataclass(frozen=True, slots=True, repr=False)
class Explanation:
    """What `Scene.explain` finds. It prints as a table.

    Attributes
    ----------
    scene : Scene
        What is explained.
    t : float
        Time at which motors and pivot were looked at, s.
    costs : tuple of Cost
        The links, each effect, all.
    mobility : Mobility
        The textbook's count.
    constraint_rank : int or None
        Rank of the constraint Jacobian of the hinges and locks, on 3 coordinates a link; None
        where the links are too many.
    equilibria : tuple of Equilibrium
        Hanging, upright and the start, where they are in balance, or what Newton's method finds
        from there; each with its natural frequencies. Dry friction is left out.
    stiffest_rate : float or None
        The largest eigenvalue about any of them, 1/s; None without one.
    fastest_drive : float
        The largest angular frequency of a sinusoid, rad/s; 0 without one.
    first_step : float or None
        The period of the faster of the two over `STEPS_A_PERIOD`, s: safe for a start at rest near
        an equilibrium, at the default tolerances. None where no equilibrium is known.
    not_simulated : tuple of Absence
        What the program knows and the scene has not, then what the program does not know.
    remarks : tuple of str
        What was left out here, and why.
    """

    scene: Scene
    t: float
    costs: tuple[Cost, ...]
    mobility: Mobility
    constraint_rank: int | None
    equilibria: tuple[Equilibrium, ...]
    stiffest_rate: float | None
    fastest_drive: float
    first_step: float | None
    not_simulated: tuple[Absence, ...]
    remarks: tuple[str, ...]

    @property
    def degrees_of_freedom(self) -> int | None:
        """Coordinates less constraints, ``3 n - rank``; None where the rank is."""
        rank = self.constraint_rank
        return None if rank is None else 3 * len(self.scene.links) - rank

    def to_dict(self) -> dict[str, Any]:
        """Return the same as JSON can hold it; None where there is no number."""
        from pendcore.explanation.table import plain

        told = {
            "links": [asdict(link) for link in self.scene.links],
            "gravity": self.scene.gravity,
            "effects": [repr(effect) for effect in self.scene.effects],
            "t": self.t,
            "costs": [cost._asdict() for cost in self.costs],
            "mobility": self.mobility._asdict(),
            "constraint_rank": self.constraint_rank,
            "degrees_of_freedom": self.degrees_of_freedom,
            "equilibria": [
                found._asdict() | {"modes": [mode._asdict() for mode in found.modes]}
                for found in self.equilibria
            ],
            "stiffest_rate": self.stiffest_rate,
            "fastest_drive": self.fastest_drive,
            "first_step": self.first_step,
            "not_simulated": [absence._asdict() for absence in self.not_simulated],
            "remarks": self.remarks,
        }
        return plain(told)  # type: ignore[no-any-return]

    def __repr__(self) -> str:
        from pendcore.explanation.table import text

        return text(self)


@np.errstate(all="ignore")  # what overflows is told as not found
def explain(scene: Scene, t: float, start: tuple[float, ...] | None) -> Explanation:
    """Find it all; see `Scene.explain`."""
    remarks: list[str] = []
    equilibria: tuple[Equilibrium, ...] = ()
    rank = None
    if len(scene.links) > MANY:
        remarks.append(f"more than {MANY} links: no equilibria, frequencies and ranks are computed")
    elif outside := outside_of_tables(scene, t):
        remarks.append(f"t = {t:.6g} s is outside {outside}: no equilibria are computed there")
        rank = constraint_rank(scene)
    else:
        equilibria = tuple(find_equilibria(scene, t, start, remarks))
        rank = constraint_rank(scene)
    if equilibria and changes_with_time(scene):
        remarks.append(
            f"equilibria are those of the instant t = {t:.6g} s, as if what changes with time "
            "stayed as it is then; what a fast drive does on average is not in them"
        )
    rates = [found.stiffest_rate for found in equilibria]
    drive = fastest_drive(scene)
    fastest = max([*rates, drive], default=0.0)
    return Explanation(
        scene=scene,
        t=t,
        costs=costs(scene),
        mobility=scene.mobility(),
        constraint_rank=rank,
        equilibria=equilibria,
        stiffest_rate=max(rates, default=None),
        fastest_drive=drive,
        first_step=2 * pi / (STEPS_A_PERIOD * fastest) if equilibria and fastest > 0 else None,
        not_simulated=tuple(absent(scene)),
        remarks=tuple(remarks),
    )


def costs(scene: Scene) -> tuple[Cost, ...]:
    """Measure what a right-hand side takes; about 0.05 s of time."""
    links, *each, whole = (Cost(*cost) for cost in scene._compiled.costs())
    named = (
        cost._replace(what=f"effect {i} ({effect.kind})")
        for i, (cost, effect) in enumerate(zip(each, scene.effects, strict=True), start=1)
    )
    return links, *named, whole


def fastest_drive(scene: Scene) -> float:
    """Return the largest angular frequency of a sinusoid in any effect, rad/s."""
    return max((abs(getattr(x, "angular_frequency", 0.0)) for x in parts(scene)), default=0.0)


def parts(scene: Scene) -> Iterator[Part]:
    """What the effects hold that has parameters of its own."""
    for effect in scene.effects:
        for parameter in effect.description.parameters:
            value = getattr(effect, parameter.name)
            if isinstance(value, Part):
                yield value


def changes_with_time(scene: Scene) -> bool:
    """Whether an effect has a table, a spline or a sinusoid."""
    names = {p.name for part in parts(scene) for p in part.description.parameters}
    return not names.isdisjoint({"t", "angular_frequency"})


def outside_of_tables(scene: Scene, t: float) -> str:
    """Return whose table or spline does not reach to a time, and where it is; empty if none."""
    for i, effect in enumerate(scene.effects, start=1):
        for parameter in effect.description.parameters:
            value = getattr(effect, parameter.name)
            times = getattr(value, "t", None) if isinstance(value, Part) else None
            if times is not None and not times[0] <= t <= times[-1]:
                where = f"{times[0]:.6g} to {times[-1]:.6g} s"
                return f"the {parameter.name} of effect {i} ({effect.kind}), {where}"
    return ""
