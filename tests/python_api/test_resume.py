"""A run goes on from where it ended; impossible requests are refused by name."""

from __future__ import annotations

import traceback

import numpy as np
import pendcore as pc
import pytest
from pendcore import _core

BOOK = pc.Scene.textbook()
Q0 = [0.8, 1.0]


def begun(t_end=5.0, **options):
    return pc.simulate(BOOK, q0=Q0, t_span=(0, t_end), **options)


def test_a_run_that_goes_back_in_time_goes_on_to_earlier_times() -> None:
    back = pc.simulate(BOOK, q0=0.5, t_span=(3, 2), t_eval=[2.5, 2.0])
    way = "s: this run goes back in time$"
    with pytest.raises(ValueError, match=rf"^t_end = 2\.5: .* at or before .* 2\.0 {way}"):
        back.resume(2.5)
    with pytest.raises(ValueError, match=rf"^t_eval\[0\] = 2\.0: must be before .* 2\.0 {way}"):
        back.resume(1.0, [2.0, 1.5])
    later = pc.simulate(BOOK, q0=0.5, t_span=(3, 1), t_eval=[1.5], max_steps=2, on_failure="ignore")
    with pytest.raises(ValueError, match=rf"^t_end = 1\.75: .* at or before .* 1\.5 {way}"):
        later.resume(1.75)
    assert back.resume(1.0, [1.5]).t[-1] == 1.5


def test_times_that_have_passed_are_refused_by_the_users_own_index():
    with pytest.raises(ValueError, match=r"^t_eval\[0\] = 2\.0: must be within .*5\.0 to 10\.0"):
        begun(t_eval=[0, 1]).resume(10, t_eval=[2, 6])
    with pytest.raises(ValueError, match=r"^t_eval\[0\] = 5\.0: must be beyond the last .* 5\.0"):
        begun(t_eval=[0, 5]).resume(10, t_eval=[5, 6])


def test_a_run_of_no_length_goes_on_either_way_and_keeps_its_start_once():
    point = begun(0.0, t_eval=[0.0])
    assert point.resume(5, t_eval=[1, 5]).t.tolist() == [0, 1, 5]
    assert point.resume(-5, t_eval=[-1, -5]).t.tolist() == [0, -1, -5]
    with pytest.raises(ValueError, match=r"^t_eval\[0\] = 0\.0: must be beyond the last"):
        point.resume(5, t_eval=[0, 1])


PIECES = {
    "table": pc.effects.Motor(joint=1, table=pc.effects.Table(t=[-1, 0, 1], torque=[1, 0, 2])),
    "spline": pc.effects.DrivenPivot(
        spline=pc.effects.Spline(t=[-1, 0, 1], x=[0, 0.3, 0], y=[0.2, 0, 0])
    ),
    "at its limit": pc.effects.Motor(
        joint=1,
        sinusoid=pc.effects.Sinusoid(amplitude=2, angular_frequency=3, phase=np.pi / 6),
        limit=1.0,
    ),
}


@pytest.mark.parametrize("effect", PIECES.values(), ids=PIECES.keys())
@pytest.mark.parametrize("t_end", [-1.0, 1.0])
def test_a_run_of_no_length_goes_on_as_one_made_that_way(
    effect: pc.effects.Effect, t_end: float
) -> None:
    """At a time where a law changes, the law of the side to which the run goes holds."""
    scene = pc.Scene(links=BOOK.links, effects=[effect])
    direct = pc.simulate(scene, q0=Q0, qd0=1.0, t_span=(0, t_end), max_steps=10_000)
    resumed = pc.simulate(scene, q0=Q0, qd0=1.0, t_span=(0, 0)).resume(t_end, max_steps=10_000)
    assert (resumed.status, resumed.t[-1]) == (direct.status, t_end) == ("finished", t_end)
    assert np.array_equal(resumed.t, direct.t)
    assert np.array_equal(resumed.y, direct.y)
    times = np.linspace(0, t_end, 20)
    assert np.array_equal(resumed(times), direct(times))


@pytest.mark.parametrize("rate", [0.0, 1.0])
def test_a_run_of_no_length_with_dry_friction_goes_forward_alone(rate: float) -> None:
    friction = pc.effects.DryJointFriction(joint=1, coulomb=0.1)
    scene = pc.Scene(links=[pc.Link(mass=1, length=1)], gravity=0, effects=[friction])
    with pytest.raises(ValueError, match=r"backward.*dry_joint_friction.*run it forward"):
        pc.simulate(scene, q0=0, qd0=rate, t_span=(0, -1))
    point = pc.simulate(scene, q0=0, qd0=rate, t_span=(0, 0))
    with pytest.raises(ValueError, match=r"backward.*dry_joint_friction.*run it forward"):
        point.resume(-1)
    direct = pc.simulate(scene, q0=0, qd0=rate, t_span=(0, 1))
    assert np.array_equal(point.resume(1).y, direct.y)


@pytest.mark.parametrize("store", ["dense", "steps", "end"])
def test_a_run_that_was_not_sampled_is_not_sampled_on(store):
    with pytest.raises(ValueError, match=r"^t_eval: this run was not asked for times"):
        begun(store=store).resume(10, t_eval=[6, 7])


def test_an_end_before_the_times_asked_for_is_refused():
    capped = begun(t_eval=[1, 2, 3, 4, 5], max_steps=30, on_failure="ignore")
    assert capped.status == "max_steps"
    with pytest.raises(ValueError, match=r"^t_end = 3\.0: must be at or beyond the last time"):
        capped.resume(3)
    assert capped.resume(5).t.tolist() == [1, 2, 3, 4, 5]


def test_a_few_attempts_at_a_time_get_past_one_that_the_end_cut_short():
    """The first attempt would go beyond the end, on which the run depends: it is made anew."""
    how = {"method": "dopri5", "first_step": 2.0}
    few = pc.simulate(BOOK, q0=Q0, t_span=(0, 1), max_steps=8, on_failure="ignore", **how)
    whole = pc.simulate(BOOK, q0=Q0, t_span=(0, 1), **how)
    assert np.array_equal(few.resume(1).y, whole.y)
    attempts = whole.stats.accepted + whole.stats.rejected
    same = few
    for _ in range((attempts - 1) // 8):
        assert same.status == "max_steps"
        same = same.resume(1, max_steps=8, on_failure="ignore")
    assert np.array_equal(same.y, whole.y)
    later = few
    while later.status == "max_steps":
        later = later.resume(3, max_steps=8, on_failure="ignore")
    assert np.array_equal(later.y, pc.simulate(BOOK, q0=Q0, t_span=(0, 3), **how).y)


def test_sampled_states_are_those_of_the_motion():
    resumed = begun(t_eval=[0, 1]).resume(10, t_eval=[5, 6, 7])
    whole = pc.simulate(BOOK, q0=Q0, t_span=(0, 10), t_eval=[0, 1, 5, 6, 7])
    assert np.array_equal(resumed.t, whole.t)
    assert np.array_equal(resumed.y, whole.y)


@pytest.mark.parametrize(
    "damage",
    [
        {"dense_start": [], "dense_start_low": [], "dense_h": [], "dense_coefficients": []},
        {"t_start": -1.0},
        {"t_reached": float("nan")},
        {"links": [1.0, 1.0, 0.5]},
        {"status": "splendid"},
        {"dense_degree": 3},
        {"t": [0.0]},
        {"position_nfev": -(2**63)},
        {"statistics_accepted": 2**62},
        {"position_stiff_hits": -1},
        {"position_log2_error_before": 1e300},
    ],
)
def test_a_damaged_solution_is_refused(damage):
    state = begun()._run.__getstate__() | damage
    run = _core.Run.__new__(_core.Run)
    with pytest.raises(ValueError, match=r"do not fit|four numbers|status|splendid"):
        run.__setstate__(state)


def test_a_shifted_dense_output_is_refused():
    state = begun()._run.__getstate__()
    state["dense_start"] = state["dense_start"] + 1.0
    with pytest.raises(ValueError, match="do not fit together"):
        _core.Run.__new__(_core.Run).__setstate__(state)


def test_the_traceback_of_a_users_function_is_kept():
    def fails_in_here(fraction):
        raise LookupError("enough")

    with pytest.raises(LookupError) as caught:
        begun(1e9, store="end", progress=fails_in_here, time_limit=10)
    names = [frame.name for frame in traceback.extract_tb(caught.value.__traceback__)]
    assert "fails_in_here" in names
    assert "(at t = " in caught.value.solution.message


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"step": 0.1, "first_step": 0.1}, "^first_step: a fixed step is given"),
        ({"step": 0.1, "max_step": 0.01}, r"^step = 0\.1: must be <= max_step"),
        ({"t_eval": []}, "^t_eval: is empty"),
        ({"max_steps": 10**30}, "^max_steps: is too large"),
        ({"rtol": 10**400}, "^rtol: is too large"),
        ({"method": "\ud800"}, "^method = "),
    ],
)
def test_options_at_odds_are_refused(options, message):
    with pytest.raises((ValueError, TypeError), match=message):
        begun(**options)


def test_a_blow_up_is_told_alike_whether_the_run_goes_on_or_never_stopped():
    """The ledger's rate overflows a step before the motion does."""
    damped = pc.effects.ViscousJoint(joint=1, damping=0.5, damping2=0.375)
    scene = pc.Scene(links=[pc.Link(mass=1.0, length=0.6)] * 2, effects=[damped])
    how = {"method": "rk4", "step": 0.003, "ledger": True, "on_failure": "ignore"}
    whole = pc.simulate(scene, q0=1.0, qd0=2.0, t_span=(0, -2.5), **how)
    assert whole.status == "non_finite"
    leg = pc.simulate(scene, q0=1.0, qd0=2.0, t_span=(0, -1.0), **how)
    assert leg.resume(-2.5, on_failure="ignore").message == whole.message
