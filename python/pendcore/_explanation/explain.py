"""What a scene simulates and what it does not, what that costs, and how fast it moves."""

from __future__ import annotations

from math import pi

import numpy as np

from pendcore import _core
from pendcore._explanation.constraints import constraint_rank
from pendcore._explanation.equilibria import Equilibrium, find_equilibria
from pendcore._explanation.explanation import STEPS_A_PERIOD, Cost, Explanation
from pendcore._explanation.not_modelled import absent
from pendcore._scene.drives import changes_with_time, fastest_drive, outside_of_tables
from pendcore._scene.scene import Scene

MANY = 60
"""The number of links beyond which matrices of the chain would be too large."""


@np.errstate(all="ignore")  # an equilibrium that overflows is reported as not found
def explain(scene: Scene, t: float, start: tuple[float, ...] | None) -> Explanation:
    """Return the explanation of a scene; see `Scene.explain`."""
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
        lanes=_core.methods_with_lanes(scene._compiled),
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
