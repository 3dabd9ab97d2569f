"""Many runs at once: pendcore's ensembles beside heyoka's batches, loops of calls, and SciPy.

Unit rods are released at rest from random angles over the whole circle, and move for 5 s; what is
kept is the state at the end. A contender's time is for one trajectory, on one processor. Its error
is the median over the trajectories of the position error at the end, against heyoka in long double.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pendcore as pc
from cases import Array, Case, read_case
from contenders.contender import PYTHON, PythonRun, Unsupported
from contenders.equations import accelerations
from contenders.pendcore_python import scene_of
from machine import circumstances
from measure import interleave
from tqdm import tqdm
from trajectory_error import distances

Record = dict[str, Any]

MEMBERS = 4096
"""Starts of an ensemble."""
FEW = {"loop": 512, "scipy": 24}
"""Starts of contenders that need as long for one whatever their number."""
KNOWN = 512
"""Starts whose true end is computed."""
T_END = 5.0
BURST_SECONDS = 0.3
MOTOR = (2.0, 3.0)
"""Amplitude, N m, and angular frequency, rad/s, of the motor in joint 1."""
SCENES = {
    "bare": "two rods",
    "damped": "two rods, damping 0.1 and 0.05 N m s/rad",
    "motor": "two rods, a motor of 2 sin(3 t) N m in joint 1",
    "three_links": "three rods",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Contender:
    """`prepare` makes a call that returns angles at the end, (k, n), from a tolerance."""

    name: str
    label: str
    prepare: Callable[[Case, Array, float], Callable[[], Array]]
    tolerances: tuple[float, ...]
    members: int = MEMBERS
    ours: bool = False


def case_of(name: str) -> Case:
    """Return the rods of a scene; start and reference are another case's."""
    case = read_case("three_links" if name == "three_links" else "textbook")
    damping = (0.1, 0.05) if name == "damped" else (0.0,) * case.n
    return replace(case, name=name, damping=damping)


def has_motor(case: Case) -> bool:
    return case.name == "motor"


def scene(case: Case) -> pc.Scene:
    made = scene_of(case)
    if not has_motor(case):
        return made
    amplitude, frequency = MOTOR
    wave = pc.effects.Sinusoid(amplitude=amplitude, angular_frequency=frequency)
    return replace(made, effects=[pc.effects.Motor(joint=1, sinusoid=wave)])


def starts(n: int, count: int) -> Array:
    """Return the first so many random starts, rad, (count, n)."""
    drawn: Array = pc.sampling.uniform(-np.pi, np.pi, (count, n), seed=1)
    return drawn


# ---- pendcore


def by_ensemble(method: str, workers: int | None) -> Callable[..., Callable[[], Array]]:
    def prepare(case: Case, q0: Array, tolerance: float) -> Callable[[], Array]:
        made = scene(case)

        def solve() -> Array:
            found = pc.ensemble(
                made, q0=q0, t_span=(0.0, T_END), method=method, rtol=tolerance, atol=tolerance,
                workers=workers, progress=False,
            )  # fmt: skip
            return found.q

        return solve

    return prepare


def by_loop(case: Case, q0: Array, tolerance: float) -> Callable[[], Array]:
    made = scene(case)

    def solve() -> Array:
        return np.array([
            pc.simulate(
                made, q0=start, t_span=(0.0, T_END), rtol=tolerance, atol=tolerance, store="end"
            ).q[-1]
            for start in q0
        ])  # fmt: skip

    return solve


# ---- heyoka


def equations(case: Case) -> list[tuple[Any, Any]]:
    import heyoka

    names = [f"{kind}{i}" for kind in ("q", "w") for i in range(case.n)]
    variables = [heyoka.expression(name) for name in names]
    amplitude, frequency = MOTOR
    drive = amplitude * heyoka.sin(frequency * heyoka.time) if has_motor(case) else 0.0
    found = accelerations(case, heyoka.sin, heyoka.cos, drive)(*variables)
    return list(zip(variables, [*variables[case.n :], *found], strict=True))


def by_batch(size: int) -> Callable[..., Callable[[], Array]]:
    """A batch is propagated to the end, and then the next."""

    def prepare(case: Case, q0: Array, tolerance: float) -> Callable[[], Array]:
        import heyoka

        n = case.n
        taylor = heyoka.taylor_adaptive_batch(
            equations(case), np.zeros((2 * n, size)), tol=tolerance, fast_math=True
        )
        blocks = q0.reshape(-1, size, n).transpose(0, 2, 1).copy()

        def solve() -> Array:
            ends = np.empty((len(blocks), n, size))
            for block, end in zip(blocks, ends, strict=True):
                taylor.set_time(0.0)
                taylor.state[:n] = block
                taylor.state[n:] = 0.0
                taylor.propagate_until(T_END)
                end[:] = taylor.state[:n]
            return ends.transpose(0, 2, 1).reshape(-1, n)

        return solve

    return prepare


def by_heyoka_ensemble(case: Case, q0: Array, tolerance: float) -> Callable[[], Array]:
    """Use the ensemble of batches that heyoka has, in one thread."""
    import heyoka

    size, n = heyoka.recommended_simd_size(), case.n
    taylor = heyoka.taylor_adaptive_batch(
        equations(case), np.zeros((2 * n, size)), tol=tolerance, fast_math=True
    )
    blocks = q0.reshape(-1, size, n).transpose(0, 2, 1).copy()

    def begin(one: Any, i: int) -> Any:
        one.set_time(0.0)
        one.state[:n] = blocks[i]
        one.state[n:] = 0.0
        return one

    def solve() -> Array:
        found = heyoka.ensemble_propagate_until_batch(
            taylor, T_END, len(blocks), begin, max_workers=1
        )
        return np.array([one[0].state[:n] for one in found]).transpose(0, 2, 1).reshape(-1, n)

    return solve


def truth(case: Case, q0: Array) -> Array:
    """Return the angles at the end from heyoka in long double, rounded, (k, n)."""
    import heyoka

    taylor = heyoka.taylor_adaptive(
        equations(case), np.zeros(2 * case.n, dtype=np.longdouble), fp_type=np.longdouble
    )
    ends = []
    for start in q0:
        taylor.time = np.longdouble(0)
        taylor.state[: case.n] = start
        taylor.state[case.n :] = 0
        taylor.propagate_until(np.longdouble(T_END))
        ends.append(np.array(taylor.state[: case.n], dtype=np.float64))
    return np.array(ends)


# ---- SciPy


def by_scipy(case: Case, q0: Array, tolerance: float) -> Callable[[], Array]:
    from contenders.scipy_solvers import by_numba
    from scipy.integrate import solve_ivp

    if has_motor(case):
        raise Unsupported("its right-hand side has no motor")
    function, _, _ = by_numba(case)
    rest = np.zeros(case.n)

    def solve() -> Array:
        return np.array([
            solve_ivp(
                function, (0.0, T_END), np.concatenate([start, rest]), method="DOP853",
                rtol=tolerance, atol=tolerance,
            ).y[: case.n, -1]
            for start in q0
        ])  # fmt: skip

    return solve


def contenders() -> list[Contender]:
    import heyoka

    loose = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
    tight = (*loose[1:], 1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 1e-14)
    ours = [
        Contender(
            name=method, label=f"pc.ensemble {method}", prepare=by_ensemble(method, 1),
            tolerances=loose if method == "dopri5" else tight, ours=True,
        )
        for method in ("dopri5", "dop853", "taylor")
    ]  # fmt: skip
    size = heyoka.recommended_simd_size()
    orders = tuple(10.0**-k for k in range(3, 16, 2))  # each is compiled, which takes seconds
    batches = [
        Contender(
            name=f"batch_{k}", label=f"heyoka, batches of {k}", prepare=by_batch(k),
            tolerances=orders,
        )
        for k in sorted({size, 2 * size})
    ]  # fmt: skip
    return [
        *ours,
        Contender(
            name="loop", label="loop of pc.simulate", prepare=by_loop, tolerances=tight[::2],
            members=FEW["loop"],
        ),
        *batches,
        Contender(
            name="heyoka_ensemble", label="heyoka ensemble_propagate_until_batch",
            prepare=by_heyoka_ensemble, tolerances=orders[::2],
        ),
        Contender(
            name="scipy", label="SciPy DOP853, numba", prepare=by_scipy, tolerances=tight[::3],
            members=FEW["scipy"],
        ),
    ]  # fmt: skip


def measured(name: str, *, quick: bool, rounds: int) -> Record:
    """Measure one scene."""
    case = case_of(name)
    members = 512 if quick else MEMBERS
    q0 = starts(case.n, members)
    known = truth(case, q0[: 64 if quick else KNOWN])
    runs: dict[tuple[str, float], PythonRun[Array]] = {}
    points: dict[tuple[str, float], Record] = {}
    taking_part = contenders()
    for one in taking_part:
        few = q0[: min(one.members, members)]
        for tolerance in one.tolerances[:: 3 if quick else 1]:
            try:
                solve = one.prepare(case, few, tolerance)
            except Unsupported:
                continue
            ends = solve()
            count = min(len(known), len(few))
            errors = distances(ends[:count], known[:count], np.array(case.lengths))
            key = (one.name, tolerance)
            runs[key] = PythonRun(solve, _unused)
            points[key] = {"setting": tolerance, "error": float(np.median(errors))}
    turns = tqdm(range(rounds), desc=name, unit="round", disable=None)
    taken = interleave(runs, turns, BURST_SECONDS)
    by_name = {one.name: min(one.members, members) for one in taking_part}
    for (who, tolerance), timing in taken.items():
        points[who, tolerance] |= {
            "minimum_us": 1e6 * timing.minimum / by_name[who],
            "median_us": 1e6 * timing.median / by_name[who],
        }
    return {
        "case": name,
        "label": SCENES[name],
        "members": members,
        "known": len(known),
        "contenders": [
            {
                "name": one.name,
                "label": one.label,
                "ours": one.ours,
                "sides": [PYTHON],
                "points": [points[key] for key in points if key[0] == one.name],
            }
            for one in taking_part
        ],
        "threads": threads(case, q0, rounds) if name == "bare" else None,
    }


def threads(case: Case, q0: Array, rounds: int) -> Record:
    """Compare two threads with one, and two processes of a bare loop with one, in turns."""
    one, two = (by_ensemble("taylor", k)(case, q0, 1e-9) for k in (1, 2))
    count = 3_000_000
    with ProcessPoolExecutor(2) as pool:
        list(pool.map(spin, [1, 1]))
        runs = {
            "one thread": PythonRun(one, _unused),
            "two threads": PythonRun(two, _unused),
            "one loop": PythonRun(lambda: list(pool.map(spin, [count])), _unused),
            "two loops": PythonRun(lambda: list(pool.map(spin, [count, count])), _unused),
        }
        taken = interleave(runs, range(rounds), BURST_SECONDS)
    ensemble = taken["one thread"].minimum / taken["two threads"].minimum
    loops = 2 * taken["one loop"].minimum / taken["two loops"].minimum
    return {"ensemble": ensemble, "loops": loops}


def spin(count: int) -> int:
    """Compute for a while: a bare loop, which shares nothing."""
    total = 0
    for k in range(count):
        total += k & 3
    return total


def _unused(_: object) -> Any:
    raise NotImplementedError


def measure(*, quick: bool, rounds: int) -> Record:
    """Measure all scenes; return the record as JSON holds it."""
    begin = time.perf_counter()
    turns = 2 if quick else max(3, rounds // 6)
    scenes = [measured(name, quick=quick, rounds=turns) for name in SCENES]
    return {
        "comparison": "ensembles",
        **circumstances(begin, turns, BURST_SECONDS),
        "scenes": scenes,
    }
