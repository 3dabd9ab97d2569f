"""Tables, splines and clipped waves: the times at which they change are stepped on, not over.

One uniform rod of mass 3 and length 1 on a fixed pivot without gravity, unless a test says
otherwise: its moment of inertia about the pivot is 1, so that torques are accelerations.
"""

from __future__ import annotations

import numpy as np
import pendcore as pc
import pytest
from described_scenes import rig_of, scene_of
from pendcore import effects as fx
from reference.arithmetic import multiple_precision
from reference.newton_euler import Body
from unit_rods import rod

FORTY = multiple_precision(40)


def impulse(angle, amplitude):
    """Integrate amplitude sin(x), clipped to +-1, from x = 0 to an angle, in closed form.

    It has the sine's symmetries: even, of period 2 pi, and even about pi. To pi/2 it is
    amplitude (1 - cos x) up to the edge x = asin(1/amplitude), and grows by 1 from there.
    """
    x = np.abs(np.remainder(angle + np.pi, 2 * np.pi) - np.pi)
    edge = np.arcsin(1 / amplitude)
    up_to_edge = amplitude * (1 - np.cos(edge))

    def rising(x):
        return np.where(x < edge, amplitude * (1 - np.cos(x)), up_to_edge + x - edge)

    return np.where(x < np.pi / 2, rising(x), 2 * rising(np.pi / 2) - rising(np.pi - x))


def edges(amplitude, frequency, phase, t_end):
    """Times at which amplitude sin(frequency t + phase) meets +-1: sin x is +-1/amplitude."""
    turns = np.arange(-3, frequency * t_end / np.pi + 3)
    edge = np.arcsin(1 / amplitude)
    times = (np.concatenate([np.pi * turns + edge, np.pi * turns - edge]) - phase) / frequency
    return np.sort(times[(times > 0) & (times < t_end)])


def clipped(amplitude, frequency, phase=0.0):
    wave = fx.Sinusoid(amplitude=amplitude, angular_frequency=frequency, phase=phase)
    return fx.Motor(joint=1, sinusoid=wave, limit=1.0)


@pytest.mark.few_cases
@pytest.mark.parametrize("span", [(0.0, 10.0), (10.0, 0.0)], ids=["forward", "backward"])
@pytest.mark.parametrize("rtol", [1e-3, 1e-6, 1e-9])
def test_no_step_however_long_jumps_over_where_a_sinusoid_is_clipped(rtol, span):
    """Where it is clipped a step of any length has no error, so that nothing but edges ends it.

    On a sine, each step may err by rtol of the state, which is below 10, and two half periods err
    in opposite directions. A million sin(7 t) clipped to +-1 is a square wave.
    """
    drawn = np.random.default_rng(7).uniform([0.01, 0.5, -3], [2, 2.5, 3], (60, 3))
    waves = [(10**amplitude, 10**frequency, phase) for amplitude, frequency, phase in drawn]
    for amplitude, frequency, phase in [*waves, (1e6, 7.0, 0.0)]:
        how = {"rtol": rtol, "first_step": 0.45, "max_steps": 100_000}
        sol = pc.simulate(rod(clipped(amplitude, frequency, phase)), span, 0, **how)
        assert sol.status == "finished"
        first, last = impulse(frequency * np.array(span) + phase, amplitude) / frequency
        within = 10 * rtol if amplitude < 1e6 else 1e-6  # of a constant torque there is no error
        assert abs(sol.qd[-1, 0] - (last - first)) < within
        times = np.linspace(*span, 50)
        rates = impulse(frequency * times + phase, amplitude) / frequency - first
        np.testing.assert_allclose(sol(times)[1], rates, atol=10 * within)
        for edge in edges(amplitude, frequency, phase, 10.0):
            assert np.abs(sol.t - edge).min() < 1e-10
    assert sol.stats.accepted < 400
    if span[0] == 0:  # twenty half periods of a square wave are ten triangles of the rate
        half = np.pi / 7
        assert sol(20 * half)[0] == pytest.approx(20 * half**2 / 2, rel=1e-5)


KNOTS = np.cumsum([0.0, *np.random.default_rng(8).uniform(0.003, 0.03, 1500)])
CHANGING = {
    "knots": [fx.Motor(joint=1, table=fx.Table(t=KNOTS, torque=np.sin(KNOTS)))],
    "edges and reversals": [clipped(2.0, 31.0), fx.ViscousJoint(1, 0.1, damping2=0.1)],
}


@pytest.mark.parametrize("at", CHANGING)
def test_a_fixed_step_stays_fixed_where_it_lands_on_changes(at):
    """A step is cut where the law changes, and the next is whole again.

    Hairer's rule lets the step before a landing be a hundredth longer, and none after it.
    """
    sol = pc.simulate(rod(*CHANGING[at]), (0, 12), 0, step=0.01, max_steps=10_000)
    assert sol.status == "finished"
    steps = np.diff(sol.t)
    assert len(steps) > 1000
    assert steps.max() <= 0.0101 + 1e-14
    assert sol.stats.max_step <= 0.0101
    if at == "knots":
        free = ~np.isin(sol.t[1:], [*KNOTS, 12.0])
        assert free.sum() > 500
        np.testing.assert_allclose(steps[free], 0.01, rtol=1e-11)


def test_a_table_of_many_points_takes_one_step_each():
    """Six right-hand sides: the last of a step is the first of the next, and one is made anew."""
    t = np.arange(20_001.0)
    motor = fx.Motor(joint=1, table=fx.Table(t=t, torque=np.sin(t)))
    sol = pc.simulate(rod(motor), (0, t[-1]), 0, rtol=1e-3, max_steps=100_000)
    assert sol.status == "finished"
    assert np.isin(t, sol.t).all()
    assert sol.stats.accepted <= len(t) + 20  # the first, short ones
    assert sol.stats.nfev <= 8 * len(t)


SPLINE = {"x": [0.0, 0.1, -0.2, 0.1, 0.1], "y": [0.1, 0.0, 0.2, -0.1, 0.3]}


@pytest.mark.few_cases
@pytest.mark.parametrize("n", [1, 2, 3, 5])
@pytest.mark.parametrize("start", [0.0, 5.0, -9.0], ids=["from 0", "after 0", "before 0"])
def test_views_of_rods_in_the_wind_on_a_moving_pivot_are_those_of_the_reference(start, n):
    knots = [start + t for t in (0.0, 0.4, 1.1, 2.3, 3.0)]
    bodies = [Body(1.0 + 0.1 * i, 0.5 + 0.1 * i, 0.3, 0.02) for i in range(n)]
    rod_in_wind = {"drag_coefficient": 1.2, "diameter": 0.3, "wind": (3.0, 1.0)}
    described = [("driven_pivot", {"spline": {"t": knots, **SPLINE}})]
    described += [("rod_drag", {"link": link, **rod_in_wind}) for link in range(1, n + 1)]
    times = sorted([*knots, *np.random.default_rng(n).uniform(knots[0], knots[-1], 10)])
    sol = pc.simulate(
        scene_of(bodies, 9.81, described), (knots[0], knots[-1]),
        np.linspace(0.3, 1.0, n), np.linspace(2.0, -3.0, n), t_eval=times, max_steps=10_000,
    )  # fmt: skip
    rig = rig_of(sol.scene, FORTY)
    energy, accelerations, reactions = sol.energy(), sol.accelerations(), sol.reactions()
    for i, (t, q, qd) in enumerate(zip(sol.t, sol.q, sol.qd, strict=True)):
        motion, exact = rig.motion(t, q, qd), rig.energy(t, q, qd)
        for computed, wanted in (
            (accelerations[i], motion.accelerations),
            (reactions[i], motion.reactions),
            (energy.kinetic[i], exact.kinetic),
            (energy.potential[i], exact.potential),
        ):
            wanted = np.array(wanted, float)
            np.testing.assert_allclose(computed, wanted, rtol=1e-12, atol=1e-10)


def assert_last_views_are(sol, near, row):
    """The views at the end of a run are those at a row of another, and its ledger closes."""
    assert sol.status == "finished"
    for view in ("accelerations", "reactions", "positions"):
        last, other = getattr(sol, view)()[-1], getattr(near, view)()[row]
        np.testing.assert_allclose(last, other, rtol=1e-12, atol=1e-15 * (view == "positions"))
    for what in ("kinetic", "total"):
        last, other = (getattr(run.energy(), what) for run in (sol, near))
        assert last[-1] == pytest.approx(other[row], rel=1e-12)
    assert abs(sol.energy().ledger.residual[-1]) < 1e-6


@pytest.mark.parametrize("links", [1, 2, 3])
@pytest.mark.parametrize("limit", [np.inf, 1.5])
def test_at_its_last_time_a_table_acts_as_one_that_goes_on(limit, links):
    ends, goes_on = (
        pc.simulate(
            rod(fx.Motor(joint=links, table=table, limit=limit), gravity=9.81, links=links),
            (0, 2), 0.3, ledger=True, max_steps=10_000,
        )
        for table in (
            fx.Table(t=[0.0, 1.0, 2.0], torque=[0.5, 2.0, -3.0]),
            fx.Table(t=[0.0, 1.0, 2.0, 3.0], torque=[0.5, 2.0, -3.0, 4.0]),
        )
    )  # fmt: skip
    assert_last_views_are(ends, goes_on, -1)


@pytest.mark.parametrize("links", [1, 2, 3])
@pytest.mark.parametrize("span", [(0.0, 3.0), (3.0, 0.0)], ids=["its last time", "its first time"])
def test_at_an_end_a_spline_moves_the_pivot_as_just_before(span, links):
    """A spline that goes on is another: the limit is taken from within, one bit of time away."""
    spline = fx.Spline(t=[0.0, 0.4, 1.1, 2.3, 3.0], **SPLINE)
    scene = rod(fx.DrivenPivot(spline=spline), gravity=9.81, links=links)
    sol = pc.simulate(scene, span, 0.3, ledger=True, max_steps=10_000)
    before = np.nextafter(span[1], span[0])
    near = pc.simulate(scene, (before, before), sol.q[-1], sol.qd[-1])
    assert_last_views_are(sol, near, 0)


@pytest.mark.parametrize("options", [{}, {"ledger": True}, {"store": "end"}])
def test_a_run_of_no_length_outside_a_table_says_so_whatever_is_kept(options):
    table = fx.Motor(1, table=fx.Table(t=(1.0, 2.0), torque=(1.0, 2.0)))
    scene = rod(fx.Lock(1), table, gravity=9.807)
    with pytest.warns(pc.PendcoreWarning, match="ends where it leaves that span"):
        sol = pc.simulate(scene, (0, 0), 0.5, on_failure="ignore", **options)
    assert sol.status == "non_finite"
    assert "its table goes from 1.0 to 2.0 s, and the run is at t = 0.0 s" in sol.message
    assert pc.simulate(scene, (1, 1), 0.5, **options).status == "finished"
    assert pc.simulate(scene, (1, 2), 0.5, **options).resume(2.0).status == "finished"
