"""What a scene simulates and what it does not, what that costs, and how fast it moves."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

import numpy as np

from pendcore import Scene, effects
from pendcore.explanation.constraints import constraint_rank
from pendcore.explanation.equilibria import Equilibrium, find_equilibria
from pendcore.explanation.explanation import (
    STEPS_A_PERIOD,
    Absence,
    Cost,
    Explanation,
    may_change_with_time,
)

MANY = 60
"""The number of links beyond which matrices of the chain would be too large."""

NOT_MODELLED = (
    Absence("bending", "Bending of the links: they are rigid.", available=False),
    Absence("play", "Play in the joints: they are perfect hinges.", available=False),
    Absence("third_dimension", "Motion out of the plane.", available=False),
)
"""Physics that no effect models yet."""


@np.errstate(all="ignore")  # an equilibrium that overflows is reported as not found
def explain(
    scene: Scene,
    t: float,
    start: tuple[float, ...] | None,
    costs: Sequence[tuple[str, int | None, float]],
    lanes: tuple[str, ...],
) -> Explanation:
    """Return the explanation of a scene; see `Scene.explain`.

    ``costs``, as measured, and ``lanes`` are what the core says of them.
    """
    remarks: list[str] = []
    equilibria: tuple[Equilibrium, ...] = ()
    has_matrices = len(scene.links) <= MANY
    if not has_matrices:
        remarks.append(f"more than {MANY} links: no equilibria, frequencies and ranks are computed")
    elif outside := _outside_of_tables(scene, t):
        remarks.append(f"t = {t:.6g} s is outside {outside}: no equilibria are computed there")
    else:
        equilibria, remarks = find_equilibria(scene, t, start)
    if equilibria and may_change_with_time(scene):
        has_own = any(effect.description.is_function for effect in scene.effects)
        own = " (a function of yours may)" if has_own else ""
        remarks.append(
            f"equilibria are those of the instant t = {t:.6g} s, as if what changes with time{own} "
            "stayed as it is then; what a fast drive does on average is not in them"
        )
    rank = constraint_rank(scene) if has_matrices else None
    rates, drive = [found.stiffest_rate for found in equilibria], scene.fastest_drive()
    fastest = max([*rates, drive])
    each = (f"effect {i} ({effect.kind})" for i, effect in enumerate(scene.effects, start=1))
    named = ["links", *each, "all"]
    return Explanation(
        scene=scene,
        t=t,
        costs=tuple(Cost(*one)._replace(what=what) for what, one in zip(named, costs, strict=True)),
        mobility=scene.mobility(),
        constraint_rank=rank,
        degrees_of_freedom=None if rank is None else 3 * len(scene.links) - rank,
        equilibria=equilibria,
        stiffest_rate=max(rates, default=None),
        fastest_drive=drive,
        first_step=2 * pi / (STEPS_A_PERIOD * fastest) if equilibria and fastest > 0 else None,
        not_simulated=tuple(absent(scene)),
        lanes=lanes,
        remarks=tuple(remarks),
    )


def absent(scene: Scene) -> list[Absence]:
    """Return what a scene does not simulate."""
    present = {effect.kind for effect in scene.effects}
    could_have = [
        Absence(kind, cls.description.sentence, available=True)
        for kind, cls in effects.kinds().items()
        if kind not in present and not cls.description.is_function
    ]
    return [*could_have, *NOT_MODELLED]


def _outside_of_tables(scene: Scene, t: float) -> str:
    """Name the table or spline that does not reach to a time, and its effect; empty if none."""
    for i, effect in enumerate(scene.effects, start=1):
        for name, part in effect.parts().items():
            if isinstance(part, effects.Table | effects.Spline):
                first, last = part.t[0], part.t[-1]
                if not first <= t <= last:
                    where = f"{first:.6g} to {last:.6g} s"
                    return f"the {name} of effect {i} ({effect.kind}), {where}"
    return ""
