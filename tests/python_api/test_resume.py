"""A run goes on from where it ended; impossible requests are refused by name."""

from __future__ import annotations

import traceback

import numpy as np
import pendcore as pc
import pytest
from pendcore import _core
from pendcore import effects as fx

BOOK = pc.Scene.textbook()
Q0 = [0.8, 1.0]


def begun(t_end=5.0, t_start=0.0, **options):
    return pc.simulate(BOOK, q0=Q0, t_span=(t_start, t_end), **options)


def same(a, b):
    return np.array_equal(a.t, b.t) and np.array_equal(a.y, b.y)


def capped(**options):
    return begun(**options, on_failure="ignore")


WAY = "s: this run goes back in time$"
BACK = begun(2, 3, t_eval=[2.5, 2.0])
LATER = capped(t_start=3, t_end=1, t_eval=[1.5], max_steps=2)
POINT = begun(0.0, t_eval=[0.0])
CAPPED = capped(t_eval=[1, 2, 3, 4, 5], max_steps=30)
REFUSED = [
    (lambda: begun().resume(4), r"t_end = 4\.0: must be .* at or beyond the end reached, 5\.0 s"),
    (lambda: BACK.resume(2.5), rf"t_end = 2\.5: .* at or before .* 2\.0 {WAY}"),
    (lambda: BACK.resume(1.0, [2.0, 1.5]), rf"t_eval\[0\] = 2\.0: must be before .* 2\.0 {WAY}"),
    (lambda: LATER.resume(1.75), rf"t_end = 1\.75: .* at or before .* 1\.5 {WAY}"),
    (lambda: CAPPED.resume(3), r"t_end = 3\.0: must be at or beyond the last time"),
    (lambda: POINT.resume(5, [0, 1]), r"t_eval\[0\] = 0\.0: must be beyond the last"),
    (lambda: begun(t_eval=[0, 1]).resume(10, [2, 6]),
     r"t_eval\[0\] = 2\.0: must be within .*5\.0 to 10\.0"),
    (lambda: begun(t_eval=[0, 5]).resume(10, [5, 6]),
     r"t_eval\[0\] = 5\.0: must be beyond the last .* 5\.0"),
    *[(lambda store=store: begun(store=store).resume(10, t_eval=[6, 7]),
       r"t_eval: this run was not asked for times") for store in ("dense", "steps", "end")],
]  # fmt: skip


@pytest.mark.parametrize("row", REFUSED, ids=lambda row: row[1][:40])
def test_what_cannot_follow_is_refused_by_the_users_own_index(row):
    call, words = row
    with pytest.raises(ValueError, match=f"^{words}"):
        call()


def test_times_that_are_asked_for_go_on_where_they_ended():
    assert BACK.resume(1.0, [1.5]).t.tolist() == [2.5, 2.0, 1.5]
    assert CAPPED.status == "max_steps"
    assert CAPPED.resume(5).t.tolist() == [1, 2, 3, 4, 5]
    assert same(CAPPED.resume(5), begun(t_eval=[1, 2, 3, 4, 5]))
    assert POINT.resume(5, t_eval=[1, 5]).t.tolist() == [0, 1, 5]
    assert POINT.resume(-5, t_eval=[-1, -5]).t.tolist() == [0, -1, -5]
    resumed = begun(t_eval=[0, 1]).resume(10, t_eval=[5, 6, 7])
    assert same(resumed, begun(10, t_eval=[0, 1, 5, 6, 7]))
    assert np.array_equal(resumed.y, begun(10)([0, 1, 5, 6, 7]))


SATURATED = fx.Sinusoid(amplitude=2, angular_frequency=3, phase=np.pi / 6)
PIECES = {
    "table": fx.Motor(joint=1, table=fx.Table(t=[-1, 0, 1], torque=[1, 0, 2])),
    "spline": fx.DrivenPivot(spline=fx.Spline(t=[-1, 0, 1], x=[0, 0.3, 0], y=[0.2, 0, 0])),
    "at its limit": fx.Motor(joint=1, sinusoid=SATURATED, limit=1.0),
}


@pytest.mark.parametrize("effect", PIECES.values(), ids=PIECES.keys())
@pytest.mark.parametrize("t_end", [-1.0, 1.0])
def test_a_run_of_no_length_goes_on_as_one_made_that_way(effect, t_end):
    """At a time where a law changes, the law of the side to which the run goes holds."""
    scene = BOOK.replace(effects=[effect])
    direct = pc.simulate(scene, q0=Q0, qd0=1.0, t_span=(0, t_end), max_steps=10_000)
    resumed = pc.simulate(scene, q0=Q0, qd0=1.0, t_span=(0, 0)).resume(t_end, max_steps=10_000)
    assert (resumed.status, resumed.t[-1]) == (direct.status, t_end) == ("finished", t_end)
    assert same(resumed, direct)
    times = np.linspace(0, t_end, 20)
    assert np.array_equal(resumed(times), direct(times))


@pytest.mark.parametrize("rate", [0.0, 1.0])
def test_a_run_of_no_length_with_dry_friction_goes_forward_alone(rate):
    friction = fx.DryJointFriction(joint=1, coulomb=0.1)
    scene = pc.Scene(links=[pc.Link(mass=1, length=1)], gravity=0, effects=[friction])

    def run(t_end):
        return pc.simulate(scene, q0=0, qd0=rate, t_span=(0, t_end))

    for call in (lambda: run(-1), lambda: run(0).resume(-1)):
        with pytest.raises(ValueError, match=r"backward.*dry_joint_friction.*run it forward"):
            call()
    assert np.array_equal(run(0).resume(1).y, run(1).y)


def test_a_leg_has_limits_and_progress_of_its_own():
    def fails_in_here(fraction):
        raise LookupError("enough")

    part = begun(0.1, max_steps=1000)
    leg = part.resume(3, max_steps=5, on_failure="ignore")
    assert (leg.status, part.t[-1] <= leg.t[-1] < 3) == ("max_steps", True)
    with pytest.raises(LookupError) as caught:
        part.resume(1e9, time_limit=10, progress=fails_in_here)
    assert caught.value.solution.t[-1] > 0.1 == part.t[-1]
    names = [frame.name for frame in traceback.extract_tb(caught.value.__traceback__)]
    assert "fails_in_here" in names
    assert "(at t = " in caught.value.solution.message


STATE = begun()._run.__getstate__()


NO_DENSE = ("dense_start", "dense_start_low", "dense_h", "dense_coefficients")
DAMAGE = [
    {name: [] for name in NO_DENSE}, {"dense_start": STATE["dense_start"] + 1.0}, {"t": [0.0]},
    {"dense_degree": 3}, {"t_start": -1.0}, {"t_reached": np.nan}, {"links": [1.0, 1.0, 0.5]},
    {"status": "splendid"}, {"statistics_accepted": 2**62}, {"position_nfev": -(2**63)},
    {"position_stiff_hits": -1}, {"position_log2_error_before": 1e300},
]  # fmt: skip


@pytest.mark.parametrize("damage", DAMAGE)
def test_a_damaged_solution_is_refused(damage):
    run = _core.Run.__new__(_core.Run)
    with pytest.raises(ValueError, match=r"do not fit|four numbers|status|splendid"):
        run.__setstate__(STATE | damage)


def test_a_blow_up_is_told_alike_whether_the_run_goes_on_or_never_stopped():
    """The ledger's rate overflows a step before the motion does."""
    damped = fx.ViscousJoint(joint=1, damping=0.5, damping2=0.375)
    scene = pc.Scene(links=[pc.Link(mass=1.0, length=0.6)] * 2, effects=[damped])
    how = {"method": "rk4", "step": 0.003, "ledger": True, "on_failure": "ignore"}
    whole = pc.simulate(scene, q0=1.0, qd0=2.0, t_span=(0, -2.5), **how)
    assert whole.status == "non_finite"
    leg = pc.simulate(scene, q0=1.0, qd0=2.0, t_span=(0, -1.0), **how)
    assert leg.resume(-2.5, on_failure="ignore").message == whole.message
