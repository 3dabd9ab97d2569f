"""Random runs with all smooth effects, and the derivatives of their ends.

Those of odd seeds are in air.
"""

from __future__ import annotations

import random
from typing import Any

from described_scenes import scene_of
from numpy.typing import NDArray
from reference.arithmetic import multiple_precision
from reference.effects import Described
from reference.named_numbers import Numbers
from reference.newton_euler import Body
from reference.slopes_of_ends import ends_beside

from derivatives.random_run import RandomRun

MANY = multiple_precision(40)
CHANGE = MANY.number(10) ** -12


def drawn(seed: int) -> RandomRun:
    """Draw a case of one to six links, whose ends depend on some fifty names."""
    some = random.Random(seed)
    n, between = some.randint(1, 6), some.uniform
    bodies = []
    for _ in range(n):
        mass, length = 10 ** between(-1, 1), 10 ** between(-0.5, 0.5)
        center = length * between(0.2, 0.8)
        inertia = between(0.1, 0.9) * mass * center * (length - center)
        bodies.append(Body(mass, length, center, inertia))

    def sinusoid(size: float) -> dict[str, float]:
        return {"amplitude": between(-size, size), "angular_frequency": between(0, 9),
                "phase": between(-3, 3)}  # fmt: skip

    def curves(*names: str, size: float) -> dict[str, list[float]]:
        times = [-0.1, *sorted(between(0, 0.5) for _ in range(some.randint(1, 4))), 0.6]
        return {"t": times, **{name: [between(-size, size) for _ in times] for name in names}}

    described: list[Described] = [
        ("payload", {"mass": between(0, 5), "inertia": between(0, 1)}),
    ]
    if some.random() < 0.6:
        pivot = some.choice([{"x": sinusoid(0.3), "y": sinusoid(0.3)},
                             {"spline": curves("x", "y", size=0.1)}])  # fmt: skip
        described.append(("driven_pivot", pivot))
    kinds = ["viscous_joint", "torsional_spring", "rotor_inertia", "motor"]
    for kind in [*kinds, *["rod_drag"][: seed % 2]]:
        for joint in some.sample(range(1, n + 1), some.randint(1, min(n, 3))):
            size = bodies[joint - 1].mass * bodies[joint - 1].length ** 2
            motor = some.choice([
                {"constant": between(-5, 5) * size},
                {"sinusoid": sinusoid(5 * size)},
                {"table": curves("torque", size=5 * size)},
                {"pd": {"kp": between(0, 10) * size, "kd": between(0, 2) * size,
                        "reference": between(-3, 3)}},
            ])  # fmt: skip
            told: dict[str, Any] = {
                "viscous_joint": {"damping": between(0, 3) * size, "damping2": between(0, 1) * size,
                                  "damping3": between(0, 0.3) * size},
                "torsional_spring": {"stiffness": between(0, 20) * size,
                                     "rest_angle": between(-3, 3)},
                "rotor_inertia": {"armature": between(0, 2) * size},
                "motor": motor | some.choice([{}, {"limit": between(0.5, 5) * size}]),
                "rod_drag": {"drag_coefficient": between(0.5, 2), "air_density": between(0.5, 1.5),
                             "diameter": between(0.01, 0.2),
                             "wind": (between(-9, 9), between(-9, 9))},
            }[kind]  # fmt: skip
            described.append((kind, {"link" if kind == "rod_drag" else "joint": joint, **told}))
    gravity = some.choice([0.0, between(1, 20)])
    starts = [f"{what}[{i}]" for what in ("q0", "qd0", "torque") for i in range(1, n + 1)]
    names = [*starts, "pivot.x", "pivot.y", *scene_of(bodies, gravity, described).parameters()]
    return RandomRun(
        bodies=bodies, gravity=gravity, described=described, t_end=between(0.05, 0.4),
        q0=[between(-4, 4) for _ in range(n)], qd0=[between(-10, 10) for _ in range(n)],
        changes={name: some.choice([-1, 1]) for name in names},
    )  # fmt: skip


def by_differences(
    case: RandomRun, changes: dict[str, float], tolerance: float, longest: float
) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return the state at the end, and its derivative along these changes."""
    starts = []
    for sign in (1, -1):
        numbers = Numbers(case.bodies, case.gravity, case.described, [*case.q0, *case.qd0], MANY)
        for name, by in changes.items():
            numbers.move(name, sign * by * CHANGE)
        starts.append((numbers.rig(), numbers.y))
    ahead, behind = ends_beside(
        starts, (MANY.number(0), MANY.number(case.t_end)), tolerance, longest
    )
    return ((ahead + behind) / 2).astype(float), ((ahead - behind) / (2 * CHANGE)).astype(float)
