"""Whether series of taylor and corrections cost what `simulate(error=)` takes them to cost.

    make write PAGE=asked_errors

Series of taylor, right-hand sides in the correction of their error and right-hand sides of dop853
are timed in turns on the same scene, with every effect. The ratios of the times are divided by what
`series_work` and `correction_work` of `pendcore._accuracy.method_choice` say. The program prints
the results, and fails if one of them is not within a factor of two. No test measures times;
tests/methods/test_taylor.py sees that every kind of effect is measured here.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from math import inf
from time import perf_counter
from typing import Any

import pendcore as pc
from pendcore._accuracy.strategies import FROM_DEFECT
from pendcore._core import DefectCorrection, has_defect_correction
from pendcore._run.call import Choice, Start, run
from pendcore._run.work import correction_work, series_work
from pendcore.options import atol_beside

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
SECONDS = 20.0
"""s of motion: so many that the call itself takes no part in the time."""
YARDSTICK = ("dop853", 1e-9)
WAYS = (("taylor", 1e-4), ("taylor", 1e-8), ("taylor", 1e-12))
CORRECTED = (WAYS[1], FROM_DEFECT[-1])
ROUNDS = 15
WITHIN = 2.0


def scenes() -> Iterator[tuple[str, pc.Scene]]:
    """Yield the chains and what acts on them; the lock of joint 2 needs two links."""
    for n in LINKS:
        for name, effects in TOGETHER.items():
            if name != "lock" or n > 1:
                yield name, pc.Scene(links=[pc.Link(mass=1, length=1)] * n, effects=effects)


def measured_over_forecast(scene: pc.Scene) -> list[float]:
    """Return the times of series, and of a correction, as multiples of the forecasts."""
    n = len(scene.links)
    start = Start(scene, [0.7 + 0.1 * i for i in range(n)], 0.0, 0.0, SECONDS)
    is_corrected = has_defect_correction(scene._compiled)
    one, whole = dict.fromkeys((YARDSTICK, *WAYS), inf), inf
    for _ in range(ROUNDS):
        for way in one:
            seconds, nfev = timed(start, way)
            one[way] = min(one[way], seconds / nfev)
        if is_corrected:
            correction = CORRECTED[1].correction(start, 1.0)
            seconds, nfev = timed(start, CORRECTED[0], correction)
            whole = min(whole, (seconds - nfev * one[CORRECTED[0]]) / correction.nfev)
    ratios = [one[way] / series_work(scene, way[1]) for way in WAYS]
    if is_corrected:
        ratios.append(whole / correction_work(scene))
    return [ratio / one[YARDSTICK] for ratio in ratios]


def timed(
    start: Start, way: tuple[str, float], correction: DefectCorrection | None = None
) -> tuple[float, int]:
    """Return the time of a run, s, and the number of its right-hand sides or series."""
    choice = Choice(*way, atol_beside(way[1]))
    begin = perf_counter()
    result = run(start, choice, store="end", correction=correction)
    return perf_counter() - begin, result.stats.nfev


def main() -> None:
    from tqdm import tqdm

    tolerances = ", ".join(f"{rtol:g}" for _, rtol in WAYS)
    print(f"time, measured / forecast: of a series at rtol {tolerances}; of a correction")
    beyond = 0
    for name, scene in tqdm([*scenes()], unit="scene", disable=None):
        ratios = measured_over_forecast(scene)
        wrong = not all(1 / WITHIN < x < WITHIN for x in ratios)
        beyond += wrong
        cells = " ".join(f"{x:6.2f}" for x in ratios)
        tqdm.write(f"{len(scene.links)} links, {name:24} {cells}{'  <<' * wrong}", file=sys.stdout)
    if beyond:
        sys.exit(f"pendcore._accuracy.method_choice: a work is wrong in {beyond} scenes (<<)")


if __name__ == "__main__":
    main()
