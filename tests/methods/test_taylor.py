"""Taylor series: their order, the rounding limit, and the scenes that they carry."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pendcore as pc
import pytest
from reference.trajectories import Trajectory, trajectory

EPS = 2.0**-53
BOOK = pc.Scene.textbook()
START = [np.pi / 4, np.pi / 3]
FINEST = {"method": "taylor", "rtol": 2.3e-15, "atol": 1e-18}
CASES = (
    "textbook",
    "textbook_long",
    "horizontal_rest",
    "high_energy",
    "unequal",
    "heavy_tip",
    "light_tip",
    "fast_spin",
    "no_gravity",
    "single_rod",
    "damped_textbook",
    "three_links",
    "ten_links",
)


def errors_at_fixed_steps(rtol: float, counts: list[int], inside: bool) -> np.ndarray:
    """Return the largest error over half a second, at steps' ends or between them."""
    case = trajectory("textbook")
    rows = [1, 2, 3, 4, 6, 7, 8, 9] if inside else [2, 4, 6, 8, 10]
    exact = np.hstack([case.q, case.qd])[rows].T
    how = {"method": "taylor", "rtol": rtol, "atol": rtol, "compensated": True}
    runs = [
        pc.simulate(BOOK, q0=START, qd0=0, t_span=(0, 0.5), step=0.5 / n, **how) for n in counts
    ]
    return np.array([np.abs(run(case.t[rows]) - exact).max() for run in runs])


def slope_of_error(rtol: float, counts: list[int], inside: bool) -> float:
    """Return the slope over the three finest steps whose error is above rounding."""
    errors = errors_at_fixed_steps(rtol, counts, inside)
    kept = np.flatnonzero(errors > 2e-14)[-3:]
    assert len(kept) == 3
    return float(-np.polyfit(np.log(np.array(counts)[kept]), np.log(errors[kept]), 1)[0])


@pytest.mark.parametrize(("rtol", "order"), [(1e-2, 8), (1e-3, 10), (1e-5, 12)])
def test_the_error_falls_at_the_order_that_the_tolerance_calls_for(rtol, order):
    slope = slope_of_error(rtol, [5, 10, 15, 20, 25, 30], inside=False)
    assert slope == pytest.approx(order, abs=0.9)


@pytest.mark.parametrize(("rtol", "order"), [(1e-2, 8), (1e-3, 10)])
def test_the_dense_output_has_the_order_of_the_method(rtol, order):
    # Each time lies at the same share of a step, 0.2, 0.4, 0.6 or 0.8, in all runs.
    slope = slope_of_error(rtol, [18, 28, 38, 48], inside=True)
    assert slope == pytest.approx(order, abs=0.6)


def scene_of(case: Trajectory) -> pc.Scene:
    rods = zip(case.masses, case.lengths, strict=True)
    damping = [
        pc.effects.ViscousJoint(joint=j, damping=b) for j, b in enumerate(case.damping, 1) if b
    ]
    links = [pc.Link(mass=m, length=length) for m, length in rods]
    return pc.Scene(links=links, gravity=case.gravity, effects=damping)


def growth_of_small_changes(case: Trajectory, options: dict[str, object]) -> float:
    """Return how much a change of the start grows, at most, over the times of the case."""
    size = 1e-9
    n = len(case.q0)
    runs = []
    for change in np.vstack([np.zeros(2 * n), size * np.eye(2 * n)]):
        start = np.concatenate([case.q0, case.qd0]) + change
        run = pc.simulate(
            scene_of(case),
            q0=start[:n],
            qd0=start[n:],
            t_span=(0, case.t[-1]),
            t_eval=case.t,
            **options,
        )
        runs.append(run.y)
    return max(float(np.abs(run - runs[0]).max()) for run in runs[1:]) / size


@pytest.mark.parametrize("name", CASES)
def test_the_references_are_met_to_what_their_conditioning_allows(name):
    case = trajectory(name)
    run = pc.simulate(
        scene_of(case), q0=case.q0, qd0=case.qd0, t_span=(0, case.t[-1]), t_eval=case.t, **FINEST
    )
    assert run.success
    growth = growth_of_small_changes(case, {"method": "taylor", "rtol": 1e-13, "atol": 1e-15})
    exact = np.hstack([case.q, case.qd]).T
    size = np.abs(exact).max()
    # A rounding error of each step, which the motion lets grow.
    allowed = 4 * EPS * size * growth * np.sqrt(run.stats.accepted)
    assert np.abs(run.y - exact).max() < allowed
    if name == "textbook":
        assert np.abs(run.q - case.q).max() < 2e-14


def test_there_and_back_over_a_minute():
    there = pc.simulate(
        BOOK, q0=START, qd0=0, t_span=(0, 60), store="end", compensated=True, **FINEST
    )
    q, qd = np.split(there.y[:, -1], 2)
    back = pc.simulate(BOOK, q0=q, qd0=qd, t_span=(60, 0), store="end", compensated=True, **FINEST)
    assert np.abs(back.y[:, -1] - [*START, 0, 0]).max() < 1e-11


def test_over_a_million_steps_energy_wanders_no_faster_than_their_root():
    scale = 2 * 9.807  # J, of two rods upright against hanging
    seconds, drifts, steps = [10.0, 100.0, 1e3, 1e4, 7.5e4], [], []
    run = pc.simulate(BOOK, q0=START, qd0=0, t_span=(0, 1), store="end", compensated=True, **FINEST)
    start = pc.simulate(BOOK, q0=START, qd0=0, t_span=(0, 0), store="end").energy().total[0]
    for t in seconds:
        run = run.resume(t)
        drifts.append(abs(run.energy().total[-1] - start) / scale)
        steps.append(run.stats.accepted)
    assert steps[-1] > 1e6
    # The state has a rounding error at the end, each step half a one in a random walk, of which
    # three times the spread are next to certain.
    assert np.all(drifts < 8 * EPS + 3 * 0.5 * EPS * np.sqrt(steps))


def test_energies_from_many_starts_walk_by_half_a_rounding_a_step():
    """The starts are so low that no link can turn over, and motions are alike; 1e5 steps each."""
    scale = 2 * 9.807  # J, as above
    walks = []
    for start in START + np.random.default_rng(1).uniform(-0.1, 0.1, (24, 2)):
        begin = pc.simulate(BOOK, q0=start, qd0=0, t_span=(0, 0), store="end").energy().total[0]
        run = pc.simulate(
            BOOK, q0=start, qd0=0, t_span=(0, 7500), store="end", compensated=True, **FINEST
        )
        assert run.stats.accepted > 1e5
        drift = (run.energy().total[-1] - begin) / scale
        walks.append(drift / (EPS * np.sqrt(run.stats.accepted)))
    assert np.sqrt(np.mean(np.square(walks))) < 0.5


def test_a_scene_that_has_no_series_is_refused_by_the_effect():
    drag = pc.effects.RodDrag(link=1, drag_coefficient=1.0, diameter=0.1)
    scene = pc.Scene(links=BOOK.links, effects=[pc.effects.ViscousJoint(joint=1, damping=1), drag])
    message = r'method = "taylor": effect 2 \(rod_drag\) has no Taylor series'
    with pytest.raises(ValueError, match=message):
        pc.simulate(scene, q0=START, t_span=(0, 1), method="taylor")


@pytest.mark.parametrize("n", [1, 2, 3, 5, 9])
def test_chains_with_every_effect_that_has_a_series_move_as_other_methods_say(n):
    effects = pc.effects
    sinusoid = effects.Sinusoid
    scene = pc.Scene(
        links=[pc.Link(mass=1.0 / k, length=0.3 + 0.1 * k) for k in range(1, n + 1)],
        effects=[
            effects.ViscousJoint(joint=1, damping=0.1, damping2=0.2, damping3=0.05),
            effects.TorsionalSpring(joint=n, stiffness=3.0, rest_angle=0.3),
            effects.RotorInertia(joint=1, armature=0.2),
            effects.RotorInertia(joint=n, armature=0.1),
            effects.Payload(mass=0.4, inertia=0.1),
            effects.DrivenPivot(x=sinusoid(0.1, 3.0), y=sinusoid(0.05, 7.0, phase=0.3)),
            effects.Motor(joint=n, sinusoid=sinusoid(1.0, 5.0)),
            effects.Motor(joint=1, table=effects.Table(t=[0.0, 1.0, 3.0], torque=[0.0, 2.0, 1.0])),
            effects.Motor(joint=1, pd=effects.PD(kp=5.0, kd=0.3, reference=0.1)),
            *([effects.Lock(joint=3)] if n > 3 else []),
        ],
    )
    start = np.linspace(0.1, 1.0, n)
    runs = [
        pc.simulate(scene, q0=start, t_span=(0, 3), method=m, rtol=1e-13, atol=1e-14, ledger=True)
        for m in ("taylor", "dop853")
    ]
    times = np.linspace(0, 3, 40)
    # The ledger's polynomials between the steps are of order 8 where those of the state are more.
    assert np.abs(runs[0](times) - runs[1](times)).max() < 1e-11
    for run in runs:
        exchanged = sum(np.abs(getattr(run.energy().ledger, f)).max() for f in ("motor", "drive"))
        assert np.abs(run.energy().ledger.residual).max() < 1e-11 * exchanged


def test_the_ledger_changes_no_bit_of_the_motion():
    scene = pc.Scene(links=BOOK.links, effects=[pc.effects.ViscousJoint(joint=1, damping=0.3)])
    runs = [
        pc.simulate(scene, q0=START, t_span=(0, 3), method="taylor", ledger=on)
        for on in (False, True)
    ]
    assert np.array_equal(runs[0].y, runs[1].y)


@pytest.mark.parametrize("with_friction", [False, True])
@pytest.mark.parametrize("n", [1, 2, 3])
def test_laws_that_change_along_the_run_are_those_in_force(n, with_friction):
    # For two links this is the closed form's own series: no driven pivot, nothing held for long.
    effects = pc.effects
    laws = [
        effects.Motor(joint=1, sinusoid=effects.Sinusoid(1.0, 6.0), limit=0.7),
        effects.Motor(joint=n, pd=effects.PD(kp=5.0, kd=0.3, reference=0.5), limit=1.5),
        effects.ViscousJoint(joint=n, damping=0.05, damping2=0.1, damping3=0.02),
        effects.Motor(joint=n, table=effects.Table(t=[0.0, 1.0, 4.0], torque=[0.0, 1.0, -1.0])),
    ]
    if with_friction:
        laws.append(effects.DryJointFriction(joint=n, coulomb=0.4))
    scene = pc.Scene(links=[pc.Link(mass=1.0, length=1.0)] * n, effects=laws)
    runs = [
        pc.simulate(scene, q0=0.8, t_span=(0, 4), method=m, rtol=1e-12, atol=1e-13, ledger=True)
        for m in ("taylor", "dop853")
    ]
    times = np.linspace(0, 4, 81)
    assert np.abs(runs[0](times)[: 2 * n] - runs[1](times)[: 2 * n]).max() < 1e-9
    for run in runs:
        assert np.abs(run.energy().ledger.residual).max() < 1e-9


def test_orders_are_those_that_the_pages_tell():
    orders = [
        pc.simulate(
            BOOK, q0=START, qd0=0, t_span=(0, 0.01), method="taylor", rtol=tol, atol=0
        )._run.dense_degree
        for tol in [0.5, *(10.0**-k for k in range(1, 18)), 1e-300]
    ]
    assert orders == sorted(orders)
    told = f"order {orders[0]} to {orders[-1]} by the tolerances"
    page = Path(__file__).parents[2] / "docs/background/trust.md"
    assert told in page.read_text().replace("\n", " ")


def test_dense_output_is_finite_where_powers_of_the_step_overflow() -> None:
    """A locked rod rests in one step of 1e123 s: 0 (h/sigma)^k is 0, though the power overflows."""
    scene = pc.Scene.textbook().replace(
        links=[pc.Link(mass=1.0, length=1.0)], effects=[pc.effects.Lock(joint=1)]
    )
    times = [0.0, 7e121, 1.2e123, 1.6e123]
    sol = pc.simulate(scene, q0=0.5, t_span=(0.0, 1.6e123), method="taylor", t_eval=times)
    assert sol.q[:, 0].tolist() == [0.5] * 4
    assert not sol.qd.any()


def continued_with_unit_of_time(factor):
    begun = pc.simulate(pc.Scene.textbook(), q0=[0.8, 1.0], t_span=(0, 1), method="taylor")
    state = begun._run.__getstate__()
    (unit,) = state["position_stepper"]
    state["position_stepper"] = [factor * unit]
    run = pc._core.Run.__new__(pc._core.Run)
    run.__setstate__(state)
    return run.resume(2.0, None, 1000, None, None)


@pytest.mark.parametrize("factor", [3.0, 1.5, -1.0, 0.0, np.nan, np.inf])
def test_a_unit_of_time_that_no_run_wrote_is_refused(factor):
    """Its inverse is taken by its exponent: another number would give a wrong series."""
    assert continued_with_unit_of_time(2.0).success
    with pytest.raises(ValueError, match=r"unit of time of the Taylor series = .* must be a power"):
        continued_with_unit_of_time(factor)
