"""Runs that come to rest, are stopped or do not get to their end: how they end, and who is told."""

from __future__ import annotations

import pickle
import re
import warnings

import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx

ROD = pc.Link(mass=1.0, length=1.0)
BOOK = pc.Scene.textbook()
RUBBED = pc.Scene(links=[ROD], gravity=0.0, effects=[fx.DryJointFriction(1, coulomb=0.5)])
START = {"q0": 0.3, "qd0": 2.0, "t_span": (0, 5)}


def same(one, other):
    return one.t.tobytes() == other.t.tobytes() and one.y.tobytes() == other.y.tobytes()


def under(law, links=1):
    return pc.Scene(links=[ROD] * links, gravity=0.0, effects=[fx.User(law)])


def test_a_run_at_rest_goes_on_as_it_is_to_the_end_and_says_since_when():
    sol = pc.simulate(RUBBED, **START)
    assert (sol.status, sol.success) == ("at_rest", True)
    assert (sol.t[-1], sol.qd[-1, 0]) == (5.0, 0.0)
    assert sol.t[-2] == pytest.approx(2.0 / 1.5)
    assert f"at t = {sol.t[-2]} s" in sol.message
    for t in (sol.t[-2], 2.0, 5.0):
        np.testing.assert_array_equal(sol(t), sol.y[:, -1])
    sampled = pc.simulate(RUBBED, **START, t_eval=[0.5, 1.0, 2.0, 4.0])
    assert [*sampled.t] == [0.5, 1.0, 2.0, 4.0]
    assert sampled.q[2, 0] == sampled.q[3, 0]
    longer = sol.resume(9.0)
    assert longer.status == "at_rest"
    assert same(longer, pc.simulate(RUBBED, **START | {"t_span": (0, 9)}))


@pytest.mark.parametrize("t_end", [1e-320, 1e-160, 1e300])
@pytest.mark.parametrize("options", [{}, {"ledger": True}, {"compensated": True}])
def test_the_step_at_rest_may_have_any_length(method, t_end, options):
    sol = pc.simulate(RUBBED, q0=0.3, t_span=(0, t_end), method=method, **options)
    assert (sol.status, sol.t[-1]) == ("at_rest", t_end)
    np.testing.assert_array_equal(sol.y[:, -1], [0.3, 0.0])
    np.testing.assert_array_equal(sol(0.5 * t_end), [0.3, 0.0])


def test_a_sign_of_the_users_own_never_gets_past_rest():
    scene = under(lambda t, q, qd: -0.5 * (qd > 0) + 0.5 * (qd < 0))
    sol = pc.simulate(scene, **START, max_steps=2000, on_failure="ignore")
    assert not sol.success
    assert sol._run.t_reached < 1.4  # it came to rest at 4/3 s


def test_a_run_that_is_not_finite_says_which_rate_and_whose_force(method):
    def of_root(t, q, qd):
        return np.array([0.0, 0.0 * np.sqrt(max(0.5 - q[1], 0.0)) if q[1] <= 0.5 else np.nan])

    drag = fx.ViscousJoint(joint=2, damping=0.1)
    scene = pc.Scene(links=[ROD, ROD], gravity=0.0, effects=[drag, fx.User(of_root)])
    start = {"q0": 0, "qd0": [0.0, 1.0], "t_span": (0, 3)}
    sol = pc.simulate(scene, **start, method=method, on_failure="ignore")
    assert sol.status == "non_finite"
    assert sol.q[-1, 1] == pytest.approx(0.5, abs=1e-9)
    assert re.search(r"qd_[12], by effect 2 \(\w*user\)\)", sol.message)


@pytest.mark.parametrize("span", [(0, 1e-12), (1, 1 + 4e-16), (0, 1), (1, -1)])
def test_the_right_hand_side_is_never_asked_outside_the_interval(method, span):
    asked = []

    def note(t, q, qd):
        asked.append(t)
        return np.zeros(1)

    scene = under(note).replace(gravity=9.807)
    assert pc.simulate(scene, q0=0.3, t_span=span, method=method).success
    assert min(span) <= min(asked) <= max(asked) <= max(span)


def test_a_run_shorter_than_its_first_guess_goes_on_as_one_that_is_longer(method):
    """The first step then depends on the end, so that a continued run begins anew."""
    how = {"q0": (np.pi / 4, np.pi / 3), "method": method}
    short = pc.simulate(BOOK, t_span=(0, 1e-13), **how)
    assert same(short.resume(2e-12).resume(1.0), pc.simulate(BOOK, t_span=(0, 1), **how))


@pytest.mark.parametrize("first_step", [1e-300, 1e-160, 1e-7, 1e300])
def test_any_first_step_leads_to_the_end(method, first_step):
    how = {"q0": [0.5, 0.6], "t_span": (0, 1)}
    exact = pc.simulate(BOOK, **how, rtol=1e-12, atol=1e-13).q[-1]
    sol = pc.simulate(BOOK, **how, first_step=first_step, method=method)
    assert sol.success
    np.testing.assert_allclose(sol.q[-1], exact, atol=1e-5)


def rubbed_chain(n):
    rub = [fx.DryJointFriction(joint=j, coulomb=1.0) for j in range(1, n + 1)]
    return pc.Scene(links=[ROD] * n, effects=rub)


def test_a_run_is_broken_off_where_it_finds_out_which_joints_begin_to_slide():
    """The search for joints of a long chain that hold takes long."""
    how = {"time_limit": 0.01, "on_failure": "ignore"}
    sol = pc.simulate(rubbed_chain(300), q0=0.3, t_span=(0, 1), **how)
    assert (sol.status, sol.t.tolist()) == ("time_limit", [0.0])
    assert sol.stats.nfev == 0  # no right-hand side of a step: the laws come first
    assert np.isfinite(sol.y).all()


# A step of radau5 looks at the clock in the elimination of long chains.
DAMPED = pc.Scene(
    links=[pc.Link(mass=1, length=0.1)] * 60, effects=[fx.ViscousJoint(joint=60, damping=1e3)]
)
IMPLICIT = {"method": "radau5", "rtol": 1e-4, "atol": 1e-4}
# For each the scene, its end, how it is run, the first time limit, and the fewest stops.
LEGS = {
    "sliding": (rubbed_chain(150), 0.02, {}, 2e-4, 4),
    "implicit": (DAMPED, 0.3, IMPLICIT, 2e-3, 1),
}


@pytest.mark.parametrize("case", LEGS)
def test_an_attempt_that_is_given_up_at_any_place_leaves_no_trace(case):
    scene, t_end, how, limit, least = LEGS[case]
    whole = pc.simulate(scene, q0=0.3, t_span=(0, t_end), **how)
    silent = {"on_failure": "ignore"}
    sol = pc.simulate(scene, q0=0.3, t_span=(0, t_end), time_limit=limit, **silent, **how)
    stops = 0
    while sol.status == "time_limit":
        stops += 1
        limit *= 1.3  # what begins anew each time is to get through in the end
        sol = sol.resume(t_end, time_limit=limit, **silent)
    assert stops >= least
    assert sol.status == whole.status == "finished"
    assert same(sol, whole)
    assert sol.stats == whole.stats or case == "sliding"


SWING = {"q0": [np.pi / 4, np.pi / 3], "t_span": (0, 5)}
SPINNING = pc.Scene(links=[ROD], gravity=0.0)
OVER = [pc.events.LinkAngle(1, 0.0, every_turn=True)]


def undefined(t, q, qd):
    return np.full(2, np.nan if t > 1 else 0.0)


UNFINISHED = {
    "max_steps": {"scene": BOOK, **SWING, "max_steps": 5},
    "time_limit": {"scene": BOOK, **SWING, "t_span": (0, 1e9), "store": "end", "time_limit": 0.01},
    "max_turns": {
        "scene": SPINNING, "q0": 0.5, "qd0": 1e300, "t_span": (0, 1), "step": 1.0, "events": OVER,
    },
    "step_too_small": {"scene": BOOK, "q0": 0.3, "t_span": (1e17, 1e17 + 1000)},
    "not_converged": {
        "scene": BOOK, "q0": (2.0, 2.5), "qd0": (0, 8), "t_span": (0, 99), "method": "radau5",
        "step": 50.0,
    },
    "non_finite": {"scene": BOOK.replace(effects=[pc.effects.User(undefined)]), **SWING},
}  # fmt: skip


@pytest.mark.parametrize("status", UNFINISHED)
def test_a_run_that_does_not_get_to_its_end_warns_raises_or_says_nothing(status):
    run = UNFINISHED[status]
    with pytest.warns(pc.PendcoreWarning) as told:
        sol = pc.simulate(**run)
    (warning,) = told
    said = str(warning.message)
    t_end = run["t_span"][1]
    assert sol.status == status
    assert said.startswith(f"the run ended before t_end = {t_end:.6g} s, with status {status}: ")
    assert f"t = {sol._run.t_reached!r} s" in said
    assert sol.message.removeprefix(f"{status}: ") in said
    assert ("resume" in said) == (status in ("max_steps", "time_limit", "max_turns"))
    assert 'on_failure="raise"' in said
    assert warning.filename == __file__  # the user's own line
    with pytest.raises(pc.RunError, match=f"with status {status}: ") as end:
        pc.simulate(**run, on_failure="raise")
    assert end.value.solution.status == status
    assert "on_failure" not in str(end.value)
    assert pc.simulate(**run, on_failure="ignore").status == status


@pytest.mark.parametrize("what", ["warn", "raise", "ignore"])
def test_a_run_that_gets_to_its_end_is_returned(what):
    sol = pc.simulate(BOOK, **SWING, on_failure=what)
    assert sol.success
    assert sol.resume(6, on_failure=what).success
    ends = [pc.events.LinkAngle(1, 1.0, terminal=True)]
    assert pc.simulate(BOOK, **SWING, events=ends, on_failure=what).status == "event"


def test_a_resumed_run_is_checked_by_what_resume_is_told():
    begun = pc.simulate(BOOK, q0=SWING["q0"], t_span=(0, 1), on_failure="raise")
    with pytest.warns(pc.PendcoreWarning, match=r"before t_end = 3 s, with status max_steps"):
        begun.resume(3, max_steps=2)
    with pytest.raises(pc.RunError) as end:
        begun.resume(3, max_steps=2, on_failure="raise")
    assert end.value.solution.resume(3).success
    assert begun.resume(3, max_steps=2, on_failure="ignore").status == "max_steps"


@pytest.mark.parametrize("options", [{"max_steps": 30}, {"time_limit": 1e-6}])
def test_a_run_for_an_error_is_checked_as_well(options):
    how = SWING | {"error": 1e-6} | options
    (status,) = options
    with pytest.warns(pc.PendcoreWarning, match=f"{status}: .*; its error: asked"):
        pc.simulate(BOOK, **how)
    with pytest.raises(pc.RunError, match=status) as end:
        pc.simulate(BOOK, **how, on_failure="raise")
    assert end.value.solution.accuracy is not None
    assert not end.value.solution.accuracy.reached
    assert pc.simulate(BOOK, **how, on_failure="ignore").status == status


def short(**options):
    return pc.Case(scene=BOOK, **SWING, name="short", options={"max_steps": 5, **options})


def test_where_failures_are_errors_the_run_is_not_lost():
    with pytest.raises(pc.PendcoreWarning, match="with status max_steps") as warned:
        short().simulate()
    with pytest.raises(pc.RunError) as raised:
        short(on_failure="raise").simulate()
    again = pickle.loads(pickle.dumps(raised.value))
    assert str(again) == str(raised.value)
    assert np.array_equal(again.solution.y, raised.value.solution.y)
    for error in (warned.value, raised.value):
        assert (error.solution.status, error.solution.name) == ("max_steps", "short")


def test_a_case_says_what_failure_does_and_whoever_runs_it_another():
    case = short(on_failure="raise")
    assert pc.read_case(case.to_toml()) == case
    sol = case.simulate(on_failure="ignore")
    assert sol.status == "max_steps"
    assert sol.case().options["max_steps"] == 5
    assert "on_failure" not in sol.case().options
    with pytest.raises(pc.RunError):
        short().simulate(on_failure="raise")


@pytest.mark.parametrize("wrong", ["yes", True, None, np.nan])
def test_a_wrong_on_failure_is_refused_before_anything_is_run(wrong):
    endless = {"q0": 0.3, "t_span": (0, 1e12)}
    calls = [
        lambda: pc.simulate(BOOK, **endless, store="end", on_failure=wrong),
        lambda: pc.simulate(BOOK, (0, 1), 0.3).resume(1e12, on_failure=wrong),
    ]
    if wrong is not None:
        case = pc.Case(scene=BOOK, **endless, options={"on_failure": wrong})
        calls += [case.simulate, lambda: case.simulate(on_failure="ignore")]
    words = re.escape(f'on_failure = {wrong!r}: must be "warn", "raise" or "ignore"')
    for call in calls:
        with pytest.raises(ValueError, match=f"^{words}$"):
            call()


def test_what_is_run_on_the_way_to_an_answer_says_nothing():
    """Second runs that time cuts short, and contenders that do not get there."""
    sol = pc.simulate(BOOK, **SWING)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        sol.estimate_error(time_limit=1e-3)
        pc.accuracy_cost(BOOK, q0=SWING["q0"], t_span=(0, 50), time_limit=0.2)
