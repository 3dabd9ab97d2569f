"""Whether a series of taylor costs what `simulate(error=)` takes it to cost, with every effect.

    make asked-errors

Series of taylor and right-hand sides of dop853 on the same scene are timed in turns. The ratio of
the two times is divided by what `series_work` of `pendcore.accuracy.method_choice` says. The
program prints the results, and fails if one of them is not within a factor of two. No test measures
times; tests/methods/test_series_work.py sees that every kind of effect is measured here.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from math import inf
from time import perf_counter
from typing import Any

import pendcore as pc
from pendcore.accuracy.method_choice import series_work

E = pc.effects
WAVE = E.Sinusoid(0.5, angular_frequency=3.0)
EFFECTS: dict[str, Any] = {
    "viscous_joint": E.ViscousJoint(joint=1, damping=0.05),
    "dry_joint_friction": E.DryJointFriction(joint=1, coulomb=0.02),
    "rod_drag": E.RodDrag(link=1, drag_coefficient=1.0, diameter=0.02),
    "torsional_spring": E.TorsionalSpring(joint=1, stiffness=2.0),
    "motor": E.Motor(joint=1, sinusoid=WAVE),
    "rotor_inertia": E.RotorInertia(joint=1, armature=0.1),
    "payload": E.Payload(mass=0.3),
    "lock": E.Lock(joint=2),
    "joint_stop": E.JointStop(joint=1, range=(-3.0, 3.0), restitution=0.5),
    "driven_pivot": E.DrivenPivot(y=WAVE),
}
NOT_CARRIED = {"rod_drag"}
"""Effects for which taylor has no series."""
TOGETHER: dict[str, tuple[Any, ...]] = {
    "none": (),
    **{kind: (one,) for kind, one in EFFECTS.items() if kind not in NOT_CARRIED},
    "damper and spring": (EFFECTS["viscous_joint"], EFFECTS["torsional_spring"]),
    "controller": (E.Motor(joint=1, pd=E.PD(kp=3.0, kd=0.1, reference=0.2)),),
    "damper, motor and pivot": tuple(
        EFFECTS[kind] for kind in ("viscous_joint", "motor", "driven_pivot")
    ),
    "three motors": tuple(
        E.Motor(joint=1, sinusoid=E.Sinusoid(0.5, angular_frequency=f)) for f in (1.0, 2.0, 3.0)
    ),
}
LINKS = (1, 2, 3, 4, 5)
YARDSTICK = ("dop853", 1e-9)
WAYS = (("taylor", 1e-4), ("taylor", 1e-8), ("taylor", 1e-12))
ROUNDS = 15
WITHIN = 2.0


def scenes() -> Iterator[tuple[str, pc.Scene]]:
    """Yield the chains and what acts on them; the lock of joint 2 needs two links."""
    for n in LINKS:
        for name, effects in TOGETHER.items():
            if name != "lock" or n > 1:
                yield name, pc.Scene(links=[pc.Link(mass=1, length=1)] * n, effects=effects)


def seconds_of_one(scene: pc.Scene, method: str, rtol: float) -> float:
    """Return the time of a run over the number of its right-hand sides or series, s."""
    q0 = [0.7 + 0.1 * i for i in range(len(scene.links))]
    begin = perf_counter()
    solution = pc.simulate(
        scene, q0, 0, (0, 5), method=method, rtol=rtol, atol=rtol / 1000, store="end",
        progress=False,
    )  # fmt: skip
    return (perf_counter() - begin) / solution.stats.nfev


def measured_over_forecast(scene: pc.Scene) -> list[float]:
    """Return the time of a series as a multiple of the forecast, for each of the ways."""
    least = dict.fromkeys((YARDSTICK, *WAYS), inf)
    for _ in range(ROUNDS):
        for way in least:
            least[way] = min(least[way], seconds_of_one(scene, *way))
    return [least[way] / least[YARDSTICK] / series_work(scene, way[1]) for way in WAYS]


def main() -> None:
    from tqdm import tqdm

    print("time of a series, measured / forecast, at rtol", *(f"{rtol:g}" for _, rtol in WAYS))
    beyond = 0
    for name, scene in tqdm([*scenes()], unit="scene", disable=not sys.stderr.isatty()):
        ratios = measured_over_forecast(scene)
        wrong = not all(1 / WITHIN < x < WITHIN for x in ratios)
        beyond += wrong
        cells = " ".join(f"{x:6.2f}" for x in ratios)
        tqdm.write(f"{len(scene.links)} links, {name:24} {cells}{'  <<' * wrong}", file=sys.stdout)
    if beyond:
        sys.exit(
            f"series_work in pendcore.accuracy.method_choice.py: wrong in {beyond} scenes (<<)"
        )


if __name__ == "__main__":
    main()
