"""Many runs at once: pendcore's ensembles beside heyoka's batches, loops of calls, and SciPy.

Unit rods are released at rest from random angles over the whole circle, and move for 5 s; what is
kept is the state at the end. A contender's time is for one trajectory, on one processor. Its error
is the median over the trajectories of the position error at the end, against heyoka in long double.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pendcore as pc
from cases import Array, Case, read_case
from contenders.contender import PYTHON, Contender, Outcome, PythonRun, Unsupported
from contenders.pendcore_python import scene_of
from machine import circumstances
from measure import interleave
from record import Point, Record
from trajectory_error import distances

MEMBERS = 4096
"""Starts of an ensemble."""
FEW = {"loop": 512, "scipy": 24}
"""Starts of contenders that need as long for one whatever their number."""
KNOWN = 512
"""Starts whose true end is computed."""
SPAN = (0.0, 5.0)
BURST_SECONDS = 0.3
MOTOR = (2.0, 3.0)
"""Amplitude, N m, and angular frequency, rad/s, of the motor in joint 1."""
SCENES = {
    "bare": "two rods",
    "damped": "two rods, damping 0.1 and 0.05 N m s/rad",
    "motor": "two rods, a motor of 2 sin(3 t) N m in joint 1",
    "three_links": "three rods",
}
Solve = Callable[[], Array]
"""A call that returns angles at the end, (k, n)."""


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
    wave = pc.effects.Sinusoid(amplitude=MOTOR[0], angular_frequency=MOTOR[1])
    return replace(made, effects=[pc.effects.Motor(joint=1, sinusoid=wave)])


def starts(n: int, count: int) -> Array:
    """Return the first so many random starts, rad, (count, n)."""
    return pc.sampling.uniform(-np.pi, np.pi, (count, n), seed=1)


def by_ensemble(method: str, workers: int, case: Case, q0: Array, tolerance: float) -> Solve:
    how: dict[str, Any] = {"method": method, "workers": workers, "progress": False}
    call = partial(pc.ensemble, scene(case), q0=q0, t_span=SPAN, rtol=tolerance, atol=tolerance)
    return lambda: call(**how).q


def by_loop(case: Case, q0: Array, tolerance: float) -> Solve:
    how: dict[str, Any] = {"rtol": tolerance, "atol": tolerance, "store": "end"}
    made = scene(case)
    return lambda: np.array([pc.simulate(made, q0=one, t_span=SPAN, **how).q[-1] for one in q0])


def equations(case: Case) -> list[tuple[Any, Any]]:
    import heyoka
    from contenders.heyoka_taylor import system

    amplitude, frequency = MOTOR
    drive = amplitude * heyoka.sin(frequency * heyoka.time) if has_motor(case) else 0.0
    return system(case, drive)


def begin(taylor: Any, q0: Array) -> Any:
    """Set angles and no rates, at the time 0."""
    n = len(q0)
    taylor.set_time(0.0)
    taylor.state[:n], taylor.state[n:] = q0, 0.0
    return taylor


def by_heyoka(size: int, own_loop: bool, case: Case, q0: Array, tolerance: float) -> Solve:
    """Take batches of that size in turn, by a loop or by the ensemble of batches that heyoka has.

    Both run in one thread.
    """
    import heyoka

    n = case.n
    taylor = heyoka.taylor_adaptive_batch(
        equations(case), np.zeros((2 * n, size)), tol=tolerance, fast_math=True
    )
    blocks = q0.reshape(-1, size, n).transpose(0, 2, 1).copy()

    def loop() -> Array:
        ends = np.empty(blocks.shape)
        for block, end in zip(blocks, ends, strict=True):
            begin(taylor, block).propagate_until(SPAN[1])
            end[:] = taylor.state[:n]
        return ends.transpose(0, 2, 1).reshape(-1, n)

    def ensemble() -> Array:
        found = heyoka.ensemble_propagate_until_batch(
            taylor, SPAN[1], len(blocks), lambda one, i: begin(one, blocks[i]), max_workers=1
        )
        return np.array([one[0].state[:n] for one in found]).transpose(0, 2, 1).reshape(-1, n)

    return loop if own_loop else ensemble


def truth(case: Case, q0: Array) -> Array:
    """Return the angles at the end from heyoka in long double, rounded, (k, n)."""
    import heyoka

    real, n = np.longdouble, case.n
    taylor = heyoka.taylor_adaptive(equations(case), np.zeros(2 * n, dtype=real), fp_type=real)
    ends = np.empty(q0.shape)
    for start, end in zip(q0, ends, strict=True):
        taylor.time = real(0)
        taylor.state[:n], taylor.state[n:] = start, 0
        taylor.propagate_until(real(SPAN[1]))
        end[:] = taylor.state[:n]
    return ends


def by_scipy(case: Case, q0: Array, tolerance: float) -> Solve:
    from contenders.scipy_solvers import by_numba
    from scipy.integrate import solve_ivp

    if has_motor(case):
        raise Unsupported("its right-hand side has no motor")
    function, n = by_numba(case)[0], case.n
    starting = np.hstack([q0, np.zeros(q0.shape)])
    how: dict[str, Any] = {"method": "DOP853", "rtol": tolerance, "atol": tolerance}
    return lambda: np.array([solve_ivp(function, SPAN, y, **how).y[:n, -1] for y in starting])


def contenders() -> list[Contender]:
    """List the contenders: `prepare` makes a call from a case, starts (k, n) and a tolerance."""
    import heyoka

    loose = [float(f"1e-{k}") for k in range(2, 9)]
    tight = [float(f"1e-{k}") for k in range(3, 15)]
    orders = [10.0**-k for k in range(3, 16, 2)]  # each is compiled, which takes seconds
    size = heyoka.recommended_simd_size()
    listed: list[tuple[str, str, Callable[..., Solve], list[float]]] = [
        ("dopri5", "pc.ensemble dopri5", partial(by_ensemble, "dopri5", 1), loose),
        ("dop853", "pc.ensemble dop853", partial(by_ensemble, "dop853", 1), tight),
        ("taylor", "pc.ensemble taylor", partial(by_ensemble, "taylor", 1), tight),
        ("loop", "loop of pc.simulate", by_loop, tight[::2]),
        (f"batch_{size}", f"heyoka, batches of {size}", partial(by_heyoka, size, True), orders),
        (
            f"batch_{2 * size}", f"heyoka, batches of {2 * size}",
            partial(by_heyoka, 2 * size, True), orders,
        ),
        (
            "heyoka_ensemble", "heyoka ensemble_propagate_until_batch",
            partial(by_heyoka, size, False), orders[::2],
        ),
        ("scipy", "SciPy DOP853, numba", by_scipy, tight[::3]),
    ]  # fmt: skip
    return [
        Contender(
            name, label, "", prepare, ours="pc.ensemble" in label, settings=lambda _, at=at: at
        )
        for name, label, prepare, at in listed
    ]


def measured(name: str, *, quick: bool, rounds: int) -> tuple[Point, list[Point]]:
    """Measure one scene: its facts and rows."""
    case, members = case_of(name), 512 if quick else MEMBERS
    q0 = starts(case.n, members)
    known = truth(case, q0[: 64 if quick else KNOWN])
    runs: dict[tuple[str, float], PythonRun[Array]] = {}
    rows: dict[tuple[str, float], Point] = {}
    for one in contenders():
        few = q0[: FEW.get(one.name, members)]
        for tolerance in one.settings(1)[:: 3 if quick else 1]:
            try:
                solve = one.prepare(case, few, tolerance)
            except Unsupported:
                continue
            count = min(len(known), len(few))
            errors = distances(solve()[:count], known[:count], np.array(case.lengths))
            runs[one.name, tolerance] = timed(solve)
            row = {"contender": one.name, "case": name, "setting": tolerance}
            rows[one.name, tolerance] = row | {"error": float(np.median(errors))}
    for key, timing in interleave(runs, rounds, BURST_SECONDS, what=name).items():
        rows[key] |= timing.row("us", 1e6 / min(FEW.get(key[0], members), members))
    facts = {"label": SCENES[name], "members": members, "known": len(known)}
    return facts, list(rows.values())


def threads(rounds: int, members: int) -> list[Point]:
    """Compare two threads with one, and two processes of a bare loop with one, in turns."""
    case = case_of("bare")
    q0 = starts(case.n, members)
    one, two = (by_ensemble("taylor", workers, case, q0, 1e-9) for workers in (1, 2))
    count = 3_000_000
    with ProcessPoolExecutor(2) as pool:
        list(pool.map(spin, [1, 1]))
        runs = {
            "one thread": timed(one),
            "two threads": timed(two),
            "one loop": timed(lambda: list(pool.map(spin, [count]))),
            "two loops": timed(lambda: list(pool.map(spin, [count, count]))),
        }
        taken = interleave(runs, rounds, BURST_SECONDS)
    least = {name: timing.minimum for name, timing in taken.items()}
    gains = {
        "ensemble": least["one thread"] / least["two threads"],
        "loops": 2 * least["one loop"] / least["two loops"],
    }
    setting = {"case": case.name, "setting": "two threads"}
    return [{"contender": who, **setting, "gain": gain} for who, gain in gains.items()]


def spin(count: int) -> int:
    """Compute for a while: a bare loop, which shares nothing."""
    total = 0
    for k in range(count):
        total += k & 3
    return total


def timed(solve: Callable[[], Any]) -> PythonRun[Any]:
    return PythonRun(solve, Outcome)


def measure(*, quick: bool, rounds: int, scenes: Iterable[str] = SCENES) -> Record:
    """Measure all scenes."""
    began = time.perf_counter()
    turns = 2 if quick else max(3, rounds // 6)
    found = {name: measured(name, quick=quick, rounds=turns) for name in scenes}
    rows = [row for _, listed in found.values() for row in listed]
    return Record.of(
        {"comparison": "ensembles", **circumstances(began, turns, BURST_SECONDS)},
        {
            one.name: {"label": one.label, "ours": one.ours, "sides": [PYTHON]}
            for one in contenders()
        },
        {name: facts for name, (facts, _) in found.items()},
        rows + threads(turns, 512 if quick else MEMBERS),
    )
