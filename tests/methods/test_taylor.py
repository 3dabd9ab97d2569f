"""Taylor series: their order, the rounding limit, the scenes that they carry, and their work."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pendcore as pc
import pytest
from pendcore import _core
from pendcore import effects as fx
from pendcore._run.work import series_work
from pendcore._scene.effect_class import OwnEffect
from reference.trajectories import trajectory

sys.path.append(str(Path(__file__).parents[2] / "docs/generators"))
from series_work import EFFECTS, NOT_CARRIED, TOGETHER, scenes

EPS = 2.0**-53
BOOK = pc.Scene.textbook()
START = [np.pi / 4, np.pi / 3]
FINEST = {"method": "taylor", "rtol": 2.3e-15, "atol": 1e-18}
CASES = (
    "textbook", "textbook_long", "horizontal_rest", "high_energy", "unequal", "heavy_tip",
    "light_tip", "fast_spin", "no_gravity", "single_rod", "damped_textbook", "three_links",
    "ten_links",
)  # fmt: skip


# Order ------------------------------------------------------------------------------------------

AT_ENDS = [2, 4, 6, 8, 10], [5, 10, 15, 20, 25, 30], 0.9  # times, counts of steps, tolerance
# Each time lies at the same share of a step, 0.2, 0.4, 0.6 or 0.8, in all runs.
BETWEEN = [1, 2, 3, 4, 6, 7, 8, 9], [18, 28, 38, 48], 0.6


@pytest.mark.parametrize(
    ("rtol", "order", "places"),
    [
        (1e-2, 8, AT_ENDS), (1e-3, 10, AT_ENDS), (1e-5, 12, AT_ENDS),
        (1e-2, 8, BETWEEN), (1e-3, 10, BETWEEN),
    ],
)  # fmt: skip
def test_the_error_falls_at_the_order_that_the_tolerance_calls_for(rtol, order, places):
    """Over half a second, in the three finest steps whose error is above rounding."""
    case, (rows, counts, within) = trajectory("textbook"), places
    exact = np.hstack([case.q, case.qd])[rows].T
    how = {"method": "taylor", "rtol": rtol, "atol": rtol, "compensated": True}
    runs = [pc.simulate(BOOK, (0, 0.5), START, step=0.5 / n, **how) for n in counts]
    errors = np.array([np.abs(run(case.t[rows]) - exact).max() for run in runs])
    kept = np.flatnonzero(errors > 2e-14)[-3:]
    assert len(kept) == 3
    slope = -np.polyfit(np.log(np.array(counts)[kept]), np.log(errors[kept]), 1)[0]
    assert slope == pytest.approx(order, abs=within)


def test_orders_go_from_8_to_26_by_the_tolerances():
    orders = [
        pc.simulate(BOOK, (0, 0.01), START, method="taylor", rtol=tol, atol=0)._run.dense_degree
        for tol in [0.5, *(10.0**-k for k in range(1, 18)), 1e-300]
    ]
    assert orders == sorted(orders)
    assert (orders[0], orders[-1]) == (8, 26)


# Rounding ---------------------------------------------------------------------------------------


def growth_of_small_changes(scene, case):
    """Return how much a change of the start grows, at most, over the times of the case."""
    size, start = 1e-9, np.concatenate([case.q0, case.qd0])
    how = {"method": "taylor", "rtol": 1e-13, "atol": 1e-15, "t_eval": case.t}
    changed = start + np.vstack([np.zeros(len(start)), size * np.eye(len(start))])
    runs = [pc.simulate(scene, (0, case.t[-1]), *np.split(one, 2), **how).y for one in changed]
    return max(float(np.abs(run - runs[0]).max()) for run in runs[1:]) / size


@pytest.mark.parametrize("name", CASES)
def test_the_references_are_met_to_what_their_conditioning_allows(name):
    case = trajectory(name)
    scene = case.scene
    run = pc.simulate(scene, (0, case.t[-1]), case.q0, case.qd0, t_eval=case.t, **FINEST)
    assert run.success
    exact = np.hstack([case.q, case.qd]).T
    # A rounding error of each step, which the motion lets grow.
    growth = growth_of_small_changes(scene, case) * np.sqrt(run.stats.accepted)
    assert np.abs(run.y - exact).max() < 4 * EPS * np.abs(exact).max() * growth
    if name == "textbook":
        assert np.abs(run.q - case.q).max() < 2e-14


def run_to(t_end, q0=START, qd0=0.0, start=0.0):
    how = {"store": "end", "compensated": True, **FINEST}
    return pc.simulate(BOOK, (start, t_end), q0, qd0, **how)


def drift(run, start):
    """Return the change of the energy in shares of that of two rods upright against hanging."""
    first = pc.simulate(BOOK, (0, 0), start, store="end").energy().total[0]
    return (run.energy().total[-1] - first) / (2 * 9.807)


def test_there_and_back_over_a_minute():
    there = run_to(60)
    back = run_to(0, *np.split(there.y[:, -1], 2), start=60)
    assert np.abs(back.y[:, -1] - [*START, 0, 0]).max() < 1e-11


def test_over_a_million_steps_energy_wanders_no_faster_than_their_root():
    run, drifts, steps = run_to(1), [], []
    for t in (10.0, 100.0, 1e3, 1e4, 7.5e4):
        run = run.resume(t)
        drifts.append(abs(drift(run, START)))
        steps.append(run.stats.accepted)
    assert steps[-1] > 1e6
    # The state has a rounding error at the end, each step half a one in a random walk, of which
    # three times the spread are next to certain.
    assert np.all(drifts < 8 * EPS + 3 * 0.5 * EPS * np.sqrt(steps))


def test_energies_from_many_starts_walk_by_half_a_rounding_a_step():
    """The starts are so low that no link can turn over, and motions are alike; 1e5 steps each."""
    walks = []
    for start in START + np.random.default_rng(1).uniform(-0.1, 0.1, (24, 2)):
        run = run_to(7500, start)
        assert run.stats.accepted > 1e5
        walks.append(drift(run, start) / (EPS * np.sqrt(run.stats.accepted)))
    assert np.sqrt(np.mean(np.square(walks))) < 0.5


# Scenes -----------------------------------------------------------------------------------------


def smooth(n):
    """Every effect that has a series."""
    return [
        fx.ViscousJoint(joint=1, damping=0.1, damping2=0.2, damping3=0.05),
        fx.TorsionalSpring(joint=n, stiffness=3.0, rest_angle=0.3),
        fx.RotorInertia(joint=1, armature=0.2),
        fx.RotorInertia(joint=n, armature=0.1),
        fx.Payload(mass=0.4, inertia=0.1),
        fx.DrivenPivot(x=fx.Sinusoid(0.1, 3.0), y=fx.Sinusoid(0.05, 7.0, phase=0.3)),
        fx.Motor(joint=n, sinusoid=fx.Sinusoid(1.0, 5.0)),
        fx.Motor(joint=1, table=fx.Table(t=[0.0, 1.0, 3.0], torque=[0.0, 2.0, 1.0])),
        fx.Motor(joint=1, pd=fx.PD(kp=5.0, kd=0.3, reference=0.1)),
        *([fx.Lock(joint=3)] if n > 3 else []),
    ]


def changing(n):
    """For two links this is the closed form's own series: no driven pivot, nothing held long."""
    return [
        fx.Motor(joint=1, sinusoid=fx.Sinusoid(1.0, 6.0), limit=0.7),
        fx.Motor(joint=n, pd=fx.PD(kp=5.0, kd=0.3, reference=0.5), limit=1.5),
        fx.ViscousJoint(joint=n, damping=0.05, damping2=0.1, damping3=0.02),
        fx.Motor(joint=n, table=fx.Table(t=[0.0, 1.0, 4.0], torque=[0.0, 1.0, -1.0])),
    ]


def rubbed(n):
    return [*changing(n), fx.DryJointFriction(joint=n, coulomb=0.4)]


CARRIED = [(smooth, n) for n in (1, 2, 3, 5, 9)]
CARRIED += [(effects, n) for effects in (changing, rubbed) for n in (1, 2, 3)]


@pytest.mark.parametrize("case", CARRIED, ids=lambda case: f"{case[0].__name__}-{case[1]}")
def test_chains_with_every_effect_that_has_a_series_move_as_other_methods_say(case):
    effects, n = case
    links = [pc.Link(mass=1.0, length=1.0)] * n
    start, t_end, rtol, within = 0.8, 4, 1e-12, 1e-9
    if effects is smooth:
        links = [pc.Link(mass=1.0 / k, length=0.3 + 0.1 * k) for k in range(1, n + 1)]
        start, t_end, rtol, within = np.linspace(0.1, 1.0, n), 3, 1e-13, 1e-11
    scene, how = pc.Scene(links=links, effects=effects(n)), {"rtol": rtol, "atol": rtol / 10}
    one, other, bare = (
        pc.simulate(scene, (0, t_end), start, method=method, ledger=ledger, **how)
        for method, ledger in (("taylor", True), ("dop853", True), ("taylor", False))
    )
    assert np.array_equal(one.y, bare.y)  # a ledger changes no bit of the motion
    times = np.linspace(0, t_end, 81)
    # The ledger's polynomials between the steps are of order 8 where those of the state are more.
    assert np.abs(one(times) - other(times))[: 2 * n].max() < within
    for run in (one, other):
        ledger = run.energy().ledger
        exchanged = 1.0
        if effects is smooth:
            exchanged = sum(np.abs(getattr(ledger, f)).max() for f in ("motor", "drive"))
        assert np.abs(ledger.residual).max() < within * exchanged


def test_a_scene_that_has_no_series_is_refused_by_the_effect():
    drag = fx.RodDrag(link=1, drag_coefficient=1.0, diameter=0.1)
    scene = BOOK.replace(effects=[fx.ViscousJoint(joint=1, damping=1), drag])
    message = r'method = "taylor": effect 2 \(rod_drag\) has no Taylor series'
    with pytest.raises(ValueError, match=message):
        pc.simulate(scene, (0, 1), START, method="taylor")


def test_dense_output_is_finite_where_powers_of_the_step_overflow():
    """A locked rod rests in one step of 1e123 s: 0 (h/sigma)^k is 0, though the power overflows."""
    scene = BOOK.replace(links=BOOK.links[:1], effects=[fx.Lock(joint=1)])
    times = [0.0, 7e121, 1.2e123, 1.6e123]
    sol = pc.simulate(scene, (0.0, 1.6e123), 0.5, method="taylor", t_eval=times)
    assert sol.q[:, 0].tolist() == [0.5] * 4
    assert not sol.qd.any()


def continued_with_unit_of_time(factor):
    state = pc.simulate(BOOK, (0, 1), [0.8, 1.0], method="taylor")._run.__getstate__()
    (unit,) = state["position_stepper"]
    run = _core.Run.__new__(_core.Run)
    run.__setstate__(state | {"position_stepper": [factor * unit]})
    return run.resume(2.0, None, 1000, None, None)


@pytest.mark.parametrize("factor", [3.0, 1.5, -1.0, 0.0, np.nan, np.inf])
def test_a_unit_of_time_that_no_run_wrote_is_refused(factor):
    """Its inverse is taken by its exponent: another number would give a wrong series."""
    assert continued_with_unit_of_time(2.0).success
    with pytest.raises(ValueError, match=r"unit of time of the Taylor series = .* must be a power"):
        continued_with_unit_of_time(factor)


# Work -------------------------------------------------------------------------------------------
# docs/generators/series_work.py measures what a series costs with every kind of effect.

KINDS = pc.effects.kinds()


@pytest.mark.parametrize("kind", [k for k, c in KINDS.items() if not issubclass(c, OwnEffect)])
def test_the_cost_of_a_series_is_measured_with_every_kind_of_effect_that_has_one(kind):
    """An effect that is added goes into EFFECTS of docs/generators/series_work.py, which is run."""
    assert EFFECTS[kind].kind == kind
    assert (kind in TOGETHER) != (kind in NOT_CARRIED)
    scene = pc.Scene(links=[pc.Link(mass=1, length=1)] * 2, effects=[EFFECTS[kind]])
    if kind in TOGETHER:
        assert pc.simulate(scene, (0, 0.1), [0.7, 0.8], method="taylor").success
    else:
        with pytest.raises(ValueError, match="taylor"):
            pc.simulate(scene, (0, 0.1), [0.7, 0.8], method="taylor")


@pytest.mark.parametrize(("name", "scene"), list(scenes()))
def test_the_series_is_forecast_to_take_longer_for_more_digits_and_where_links_are_many(
    name, scene
):
    """A rotor between links, though it weighs nothing, calls for the series of any chain."""
    works = [series_work(scene, rtol) for rtol in (1e-2, 1e-6, 1e-10, 1e-14)]
    assert works == sorted(set(works)), name
    assert works[0] > 1, name
    if 3 <= len(scene.links) <= 4:
        weightless = fx.RotorInertia(joint=2, armature=0.0)
        own, of_any_chain = (
            pc.simulate(scene.replace(effects=effects), (0, 1), 0.5, method="taylor").y[:, -1]
            for effects in (scene.effects, [*scene.effects, weightless])
        )
        has_its_own = not np.array_equal(own, of_any_chain)
        assert (series_work(scene, 1e-3) < 10) == has_its_own, name
