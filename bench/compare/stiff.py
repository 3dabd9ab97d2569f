"""The comparison on stiff scenes: pendcore's radau5 beside SciPy's Radau.

Two unit rods for 5 s, and in joint 2 a strong damper, a hard spring or a stiff controller. SciPy
has the analytic Jacobian, and the right-hand side in Python or compiled by numba. The reference is
SciPy's as well, with another method or far tighter tolerances; never pendcore's.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import cache
from typing import Any

import numba
import numpy as np
import pendcore as pc
import scipy
from contenders.stiff_rods import GRAVITY, jacobian, rates
from machine import circumstances
from scipy.integrate import solve_ivp
from tqdm import tqdm
from trajectory_error import Array, position_error

START = (0.8, 1.0, 0.0, 0.0)
TIMES = np.linspace(0.0, 5.0, 101)
TOLERANCES = tuple(10.0**-k for k in range(3, 10))
QUICK = (1e-3, 1e-5)
LONGEST = 2_000_000  # steps of an explicit run
BURST_SECONDS = 0.0  # a call is timed as a whole


@dataclass(frozen=True, slots=True, kw_only=True)
class StiffScene:
    """`k` (N m/rad), `b` (N m s/rad) and the angle of joint 2 without torque (rad).

    Below the `tightest` tolerance every method has to follow a vibration of 3e4 rad/s.
    """

    name: str
    label: str
    k: float
    b: float
    rest: float = START[1] - START[0]
    tightest: float = TOLERANCES[-1]

    @property
    def parameters(self) -> tuple[float, float, float]:
        return (self.k, self.b, self.rest)


@cache
def scene_of(one: StiffScene) -> pc.Scene:
    rods = [pc.Link(mass=1.0, length=1.0)] * 2
    effects: dict[str, Any] = {
        "damper": pc.effects.ViscousJoint(joint=2, damping=one.b),
        "spring": pc.effects.TorsionalSpring(joint=2, stiffness=one.k, rest_angle=one.rest),
        "controller": pc.effects.Motor(
            joint=2, pd=pc.effects.PD(kp=one.k, kd=one.b, reference=one.rest)
        ),
    }
    return pc.Scene(links=rods, gravity=GRAVITY, effects=[effects[one.name]])


SCENES = (
    StiffScene(name="damper", label="viscous joint, b/J = 1e6 1/s", k=0.0, b=1e6 / 3),
    StiffScene(
        name="spring", label="torsional spring, k = 1e8 N m/rad", k=1e8, b=0.0, tightest=1e-7
    ),
    StiffScene(name="controller", label="PD controller, kp = 1e6, kd = 1e3", k=1e6, b=1e3),
)
compiled_rates = numba.njit(rates)
compiled_jacobian = numba.njit(jacobian)

Solve = Callable[[StiffScene, float], tuple[Array, int, str]]
"""From a scene and a tolerance to angles (n_t, 2), steps, and how the run ended."""


def by_pendcore(method: str) -> Solve:
    def solve(one: StiffScene, tolerance: float) -> tuple[Array, int, str]:
        sol = pc.simulate(
            scene_of(one), START[:2], START[2:], (TIMES[0], TIMES[-1]), method=method,
            rtol=tolerance, atol=tolerance, t_eval=TIMES, max_steps=LONGEST,
        )  # fmt: skip
        return sol.q, sol.stats.accepted + sol.stats.rejected, sol.message

    return solve


def by_scipy(of_rates: Any, of_jacobian: Any) -> Solve:
    def solve(one: StiffScene, tolerance: float) -> tuple[Array, int, str]:
        found = solve_ivp(
            of_rates, (TIMES[0], TIMES[-1]), START, method="Radau", jac=of_jacobian,
            rtol=tolerance, atol=tolerance, dense_output=True, args=one.parameters,
        )  # fmt: skip
        return found.sol(TIMES)[:2].T, len(found.t) - 1, found.message

    return solve


CONTENDERS: dict[str, tuple[str, Solve]] = {
    "radau5": ("pendcore radau5", by_pendcore("radau5")),
    "auto": ("pendcore auto", by_pendcore("auto")),
    "dopri5": ("pendcore dopri5", by_pendcore("dopri5")),
    "scipy_numba": ("SciPy Radau, numba", by_scipy(compiled_rates, compiled_jacobian)),
    "scipy_python": ("SciPy Radau, Python", by_scipy(rates, jacobian)),
}


def reference(one: StiffScene, quick: bool = False) -> Array:
    """Return the angles, (n_t, 2), from SciPy alone."""
    tight = 1e-6 if quick else 1e-11
    how: dict[str, Any] = {"method": "Radau", "rtol": tight, "atol": tight}
    how["jac"] = compiled_jacobian
    if one.name == "spring" and not quick:  # its vibration is followed, a radian a step
        how = {"method": "DOP853", "rtol": 1e-10, "atol": 1e-10, "max_step": 3e-5}
    found = solve_ivp(
        compiled_rates, (0, TIMES[-1]), START, t_eval=TIMES, args=one.parameters, **how
    )
    if not found.success:
        raise RuntimeError(f"{one.label}: {found.message}")
    angles: Array = found.y[:2].T
    return angles


def point(solve: Solve, one: StiffScene, tolerance: float, exact: Array, rounds: int) -> Any:
    """Solve, several times where that is quick, and tell error, steps and the least time."""
    taken = []
    for _ in range(rounds):
        begin = time.perf_counter()
        angles, steps, message = solve(one, tolerance)
        taken.append(time.perf_counter() - begin)
        if sum(taken) > 2.0:
            break
    found = {"tolerance": tolerance, "steps": steps, "message": message}
    found["microseconds"] = 1e6 * min(taken)
    if angles.shape != exact.shape or not np.isfinite(angles).all():
        return {**found, "failure": message}
    return {**found, "error": position_error(angles, exact, np.ones(2))}


def measure(*, quick: bool, rounds: int) -> dict[str, Any]:
    """Measure all there is, and say on what: the record, as JSON holds it."""
    begin = time.perf_counter()
    tolerances = QUICK if quick else TOLERANCES
    scenes = []
    for one in tqdm(SCENES, desc="stiff", unit="scene", disable=None):
        exact = reference(one, quick)
        points = {
            name: [
                point(solve, one, tolerance, exact, rounds)
                for tolerance in tolerances
                if tolerance >= 0.9 * one.tightest
            ]
            for name, (_, solve) in CONTENDERS.items()
        }
        scenes.append({**asdict(one), "points": points})
    return {
        "comparison": "stiff",
        **circumstances(begin, rounds, BURST_SECONDS),
        "contenders": [
            {"name": name, "label": label, "about": ABOUT[name]}
            for name, (label, _) in CONTENDERS.items()
        ],
        "scenes": scenes,
    }


_SCIPY = f"SciPy {scipy.__version__} solve_ivp, method Radau, analytic Jacobian, rates "
ABOUT = {
    "radau5": "Python call, exact Jacobian by dual numbers",
    "auto": "Python call, dopri5 until it is stiff, then radau5",
    "dopri5": "Python call, explicit",
    "scipy_numba": _SCIPY + f"and Jacobian compiled by numba {numba.__version__}",
    "scipy_python": _SCIPY + "and Jacobian in Python on floats",
}
