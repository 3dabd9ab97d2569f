"""A run is never trusted for longer than it is right; references in many digits show this."""

from __future__ import annotations

import pickle
from fractions import Fraction

import numpy as np
import pendcore as pc
import pytest
from chaotic_starts import EACH, GRAVITY, T_END, ChaoticStart, chaotic_starts, times
from pendcore._accuracy import estimate
from reference.taylor_series import RodChain, motion
from reference.trajectories import trajectory

E = pc.effects
LIMIT = 0.1
METHODS = [m["name"] for m in pc._core.methods() if m["name"] in ("dopri5", "dop853", "taylor")]


def solved(case: ChaoticStart, method: str, rtol: float) -> pc.Solution:
    return pc.simulate(
        case.scene,
        q0=case.q0,
        qd0=case.qd0,
        t_span=(0, T_END),
        method=method,
        rtol=rtol,
        atol=1e-3 * rtol,
    )


def test_by_default_fifty_chaotic_runs_are_never_trusted_too_long() -> None:
    cases = chaotic_starts()
    assert len(cases) == 50
    runs = [pc.simulate(case.scene, q0=case.q0, qd0=case.qd0, t_span=(0, T_END)) for case in cases]
    valid = np.array([run.valid_until(LIMIT) for run in runs])
    right = np.array([case.last_right(run, LIMIT) for case, run in zip(cases, runs, strict=True)])
    assert (right < T_END).all()  # every run is wrong in the end
    assert (valid < right + 1 / EACH).all()  # the next known state is already wrong
    assert np.median(valid / right) >= 0.7
    assert (valid / right).min() >= 0.5


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("rtol", [1e-4, 1e-6, 1e-8, 1e-11, 1e-13, 1e-15])
def test_at_any_tolerance_runs_are_never_trusted_too_long(method: str, rtol: float) -> None:
    cases = chaotic_starts()[:: 1 if rtol > 1e-7 else 5]
    runs = [solved(case, method, rtol) for case in cases]
    valid = np.array([run.valid_until(LIMIT) for run in runs])
    right = np.array([case.last_right(run, LIMIT) for case, run in zip(cases, runs, strict=True)])
    assert (valid < right + 1 / EACH).all()  # the next known state is already wrong
    assert np.median(valid / right) >= 0.7


@pytest.mark.parametrize("limit", [1e-6, 1e-3, 1.0])
def test_other_limits(limit: float) -> None:
    for case in chaotic_starts()[::5]:
        run = solved(case, "dopri5", 1e-9)
        assert run.valid_until(limit) < case.last_right(run, limit) + 1 / EACH


@pytest.mark.parametrize("case", chaotic_starts()[1:16:7], ids=lambda case: str(case.q0))
def test_the_record_is_what_its_script_makes(case: ChaoticStart) -> None:
    """The first three seconds come out alike with other digits, hence other orders and steps."""
    chain = RodChain(case.masses, case.lengths, GRAVITY)
    grid = [Fraction(k, EACH) for k in range(0, 3 * EACH + 1, EACH)]
    made = motion(chain, case.q0, case.qd0, grid, digits=30)
    n = len(case.q0)
    exact = np.array([[float(x) for x in row[:n]] for row in made])
    assert np.array(case.q)[: 3 * EACH + 1 : EACH] == pytest.approx(exact, abs=1e-9)


@pytest.mark.parametrize("name", ["textbook", "damped_textbook", "three_links", "fast_spin"])
def test_the_series_agree_with_the_trajectories_of_another_program(name: str) -> None:
    known = trajectory(name)
    chain = RodChain(
        known.masses.tolist(), known.lengths.tolist(), known.gravity, known.damping.tolist()
    )
    few = known.t[:40:13]
    made = motion(chain, known.q0.tolist(), known.qd0.tolist(), few.tolist(), digits=24)
    n = len(known.q0)
    states = np.array([[float(x) for x in row] for row in made])
    assert states[:, :n] == pytest.approx(known.q[:40:13], rel=4e-16)
    assert states[:, n:] == pytest.approx(known.qd[:40:13], rel=4e-16)


def test_the_error_over_time_is_what_the_reference_says() -> None:
    known = trajectory("textbook")
    run = pc.simulate(
        pc.Scene.textbook(), q0=known.q0, qd0=known.qd0, t_span=(0, 5), rtol=1e-6, atol=1e-9
    )
    found = run.estimate_error()
    true = np.abs(run(known.t)[:2].T - known.q).max(axis=1)
    near = np.interp(known.t, found.t, found.angle)
    # The estimate is a little above the truth: it includes the times in between and the second
    # runs' own errors.
    assert (true[1:] <= near[1:]).all()
    assert near[1:] == pytest.approx(1.2 * true[1:], rel=0.1, abs=2e-9)
    assert (found.t[0], found.t[-1]) == (0.0, 5.0)
    assert found.is_complete
    assert not found.is_lost
    assert run.valid_until(0.1) == 5.0
    assert 0 < found.position.max() < found.angle.max()


def test_printed_it_is_a_sentence() -> None:
    scene = pc.Scene.textbook()
    found = pc.simulate(
        scene, q0=[1.0, 1.0], t_span=(0, 2), method="dop853", rtol=1e-6
    ).estimate_error()
    assert str(found) == (
        f"error estimated everywhere from t = 0 to 2 s: angles up to {found.angle.max():.1e} "
        f"rad, positions up to {found.position.max():.1e} of the total length, verified by "
        f"taylor at rtol 1e-08 and tighter"
    )
    lost = pc.simulate(scene, q0=[-2.0, -1.0], t_span=(0, 30), rtol=1e-6).estimate_error()
    assert str(lost).endswith("; past that nothing of it is known any more")
    assert f"to {lost.t[-1]:.6g} s" in str(lost)
    short = pc.simulate(scene, q0=[1.0, 1.0], t_span=(0, 5000), max_step=0.05).estimate_error(
        time_limit=0.01
    )
    assert str(short).endswith("; the run goes on past that: it is not known there yet")


def test_position_limits_are_shares_of_the_length() -> None:
    case = chaotic_starts()[1]
    run = solved(case, "dopri5", 1e-7)
    found = run.estimate_error()
    at = run.valid_until(0.05, of="position")
    k = int(np.searchsorted(found.t, at))
    assert found.position[: k + 1].max() <= 0.05
    assert found.position[k + 1] > 0.05
    assert found.position == pytest.approx(
        np.minimum(found.position, 2.0)
    )  # twice the total length, which no two points exceed


def test_past_the_horizon_nothing_is_estimated() -> None:
    case = chaotic_starts()[0]
    found = solved(case, "dopri5", 1e-4).estimate_error()
    assert found.is_lost
    assert found.is_complete
    assert found.t[-1] < T_END
    assert found.angle[-1] >= estimate.LOST > found.angle[:-1].max()
    assert found.valid_until(1e9) == found.t[-2]


def test_both_second_runs_together_are_never_fooled_by_one() -> None:
    """Errors may cancel: a second run that makes the first one's very error estimates none."""
    case = chaotic_starts()[1]
    run = solved(case, "dopri5", 1e-13)
    t, q = times(), np.array(case.q)
    true = np.maximum.accumulate(np.abs(run(t)[: q.shape[1]].T - q).max(axis=1))
    found = run.estimate_error()
    estimated = np.interp(t, found.t, np.maximum.accumulate(found.angle))
    known = (true > 1e-8) & (true < LIMIT)
    assert known.any()
    assert (true <= estimated)[known].all()


def test_what_is_kept_decides_at_what_times() -> None:
    scene, start = pc.Scene.textbook(), [-2.0, -1.0]
    dense = pc.simulate(scene, q0=start, t_span=(0, 20), rtol=1e-6)
    exact = dense.valid_until(LIMIT)
    assert 1 < exact < 20
    few = pc.simulate(scene, q0=start, t_span=(0, 20), rtol=1e-6, t_eval=np.arange(0, 20.5, 0.5))
    assert (
        few.estimate_error().t.tolist()
        == np.arange(0, few.estimate_error().t[-1] + 0.25, 0.5).tolist()
    )
    assert exact - 0.5 <= few.valid_until(LIMIT) <= exact + 0.02
    steps = pc.simulate(scene, q0=start, t_span=(0, 20), rtol=1e-6, store="steps")
    assert steps.valid_until(LIMIT) == pytest.approx(exact, abs=dense.stats.max_step)
    end = pc.simulate(scene, q0=start, t_span=(0, 20), rtol=1e-6, store="end")
    assert end.estimate_error().t.tolist() == [20.0]
    short = pc.simulate(scene, q0=start, t_span=(0, 1), rtol=1e-6, store="end")
    assert short.valid_until(LIMIT) == 1.0


@pytest.mark.parametrize(
    "effects",
    [
        [E.JointStop(joint=2, range=(-1.0, 1.0), restitution=0.5)],
        [E.DryJointFriction(joint=1, coulomb=0.3), E.DryJointFriction(joint=2, coulomb=0.2)],
        [E.Lock(joint=2)],
        [E.User(lambda t, q, qd: [-0.1 * qd[0], -0.1 * qd[1]])],
        [E.Motor(joint=2, pd=E.PD(kp=3e5, kd=3e3, reference=0.5))],
    ],
    ids=["stop", "friction", "lock", "user", "stiff"],
)
def test_scenes_with_jumps_have_an_estimate_too(effects: list[pc.effects.Effect]) -> None:
    links = [pc.Link(mass=1.0, length=1.0)] * 2
    run = pc.simulate(
        pc.Scene(links=links, effects=effects), q0=[0.5, 0.5], t_span=(0, 2), rtol=1e-7
    )
    found = run.estimate_error()
    assert found.is_complete
    assert not found.is_lost
    assert 0 < found.angle.max() < 1e-3
    assert run.valid_until(LIMIT) == 2.0


def test_runs_backward_and_of_no_length() -> None:
    case = chaotic_starts()[3]
    back = pc.simulate(case.scene, q0=case.q0, qd0=case.qd0, t_span=(0, -T_END), rtol=1e-6)
    assert -T_END < back.valid_until(LIMIT) < -1
    assert (np.diff(back.estimate_error().t) < 0).all()
    none = pc.simulate(case.scene, q0=case.q0, qd0=case.qd0, t_span=(2, 2))
    assert none.valid_until(LIMIT) == 2.0


@pytest.mark.parametrize("kept", [{"store": "end"}, {"t_eval": [90.0, 95.0, 100.0]}])
def test_a_run_that_is_wrong_at_the_first_time_it_kept_is_trusted_to_its_start(kept):
    chaotic = pc.simulate(pc.Scene.textbook(), q0=[-1.0, -1.5], t_span=(3, 103), **kept)
    assert chaotic.valid_until(LIMIT) == 3.0
    with pytest.raises(pc.AccuracyError) as refusal:
        pc.simulate(pc.Scene.textbook(), q0=[-1.0, -1.5], t_span=(3, 103), error=1e-3, **kept)
    assert refusal.value.solution.accuracy.until == 3.0


def test_a_run_that_kept_no_time_says_so():
    scene = pc.Scene.textbook()
    run = pc.simulate(
        scene, q0=[1.5, 1.6], t_span=(0, 20), t_eval=[10.0, 20.0], max_steps=8, on_failure="ignore"
    )
    with pytest.raises(ValueError, match="error: the run ended before the first of its t_eval"):
        run.valid_until(LIMIT)


def test_second_runs_may_take_more_steps_than_the_first_was_allowed():
    how = {"method": "dop853", "rtol": 1e-2, "atol": 1e-5, "store": "end"}
    scene = pc.Scene.textbook()
    steps = pc.simulate(scene, q0=[1.5, 1.6], t_span=(0, 200), **how).stats
    capped = how | {"max_steps": steps.accepted + steps.rejected}
    run = pc.simulate(scene, q0=[1.5, 1.6], t_span=(0, 200), **capped)
    assert run.success
    assert run.estimate_error().is_complete


def test_the_second_runs_are_made_once(monkeypatch: pytest.MonkeyPatch) -> None:
    run = pc.simulate(pc.Scene.textbook(), q0=[1.0, 1.0], t_span=(0, 2))
    first = run.estimate_error()
    monkeypatch.setattr("pendcore._accuracy.estimate.error_estimate", None)
    assert run.estimate_error() is first
    assert run.valid_until(0.1) == 2.0
    monkeypatch.undo()
    copied = pickle.loads(pickle.dumps(run))  # the copy is made without the estimate
    assert copied.estimate_error().angle.tolist() == first.angle.tolist()


def test_an_estimate_that_takes_too_long_ends_where_it_is() -> None:
    run = pc.simulate(pc.Scene.textbook(), q0=[1.0, 1.0], t_span=(0, 600), max_step=0.05)
    some = run.estimate_error(time_limit=0.01)
    assert not some.is_complete
    assert some.t[-1] < 5000
    assert some.valid_until(LIMIT) <= some.t[-1]

    def stop(fraction: float) -> None:
        if fraction > 0.6:  # by then the other second run is under way
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt) as raised:
        pc.simulate(pc.Scene.textbook(), q0=[1.0, 1.0], t_span=(0, 2000), rtol=1e-9).estimate_error(
            progress=stop
        )
    assert not raised.value.estimate.is_complete  # type: ignore[attr-defined]
    assert run.estimate_error().is_complete


def test_without_time_an_estimate_makes_one_leg_of_one_second_run() -> None:
    """Legs shorter than the least time of a leg once went on to the end, whatever the limit."""
    run = pc.simulate(pc.Scene.textbook(), q0=[1.0, 1.0], t_span=(0, 600), max_step=0.05)
    some = run.estimate_error(time_limit=1e-9)
    assert not some.is_complete
    assert 0 < some.t[-1] < 600 / 16


@pytest.mark.parametrize(
    "asked",
    [
        lambda run: run.estimate_error(),
        lambda run: run.valid_until(0.1),
        lambda run: run.plot(horizon=0.1),
    ],
    ids=["error", "valid_until", "plot"],
)
def test_interrupted_it_hands_over_the_users_run_and_none_of_its_own(asked) -> None:
    import matplotlib.pyplot as plt

    calls = 0
    last = np.inf

    def law(t: float, q: np.ndarray, qd: np.ndarray) -> np.ndarray:
        nonlocal calls
        calls += 1
        if calls > last:
            raise KeyboardInterrupt
        return 0 * q

    scene = pc.Scene.textbook().replace(effects=[E.User(law)])
    run = pc.simulate(scene, q0=[1.0, 1.0], t_span=(0, 2))
    for more in (3, 500):  # the interrupt comes at once, or within a second run
        last = calls + more
        with pytest.raises(KeyboardInterrupt) as raised:
            asked(run)
        assert raised.value.solution is run  # type: ignore[attr-defined]
    plt.close("all")


@pytest.mark.parametrize(
    ("bad", "message"),
    [
        ({"limit": 0.0}, r"limit = 0.0: must be > 0"),
        ({"limit": float("nan")}, r"limit = nan: must be > 0"),
        ({"limit": "0.1"}, r"limit = '0.1': must be a real number \(rad\)"),
        ({"of": "tip"}, r"of = 'tip': must be \"angle\" \(rad\) or \"position\""),
    ],
)
def test_bad_limits_are_named(bad: dict[str, object], message: str) -> None:
    run = pc.simulate(pc.Scene.textbook(), q0=[1.0, 1.0], t_span=(0, 0.1))
    with pytest.raises((ValueError, TypeError), match=message):
        run.valid_until(**bad)  # type: ignore[arg-type]


@pytest.mark.parametrize("is_known", [False, True])
@pytest.mark.parametrize(
    ("bad", "message"),
    [
        (0, r"time_limit = 0.0: must be > 0 \(s\)"),
        (float("nan"), r"time_limit = nan: must be > 0 \(s\)"),
        ([1.0], r"time_limit = \[1.0\]: must be a real number \(s\)"),
    ],
)
def test_bad_time_limits_are_named(bad: float, message: str, is_known: bool) -> None:
    run = pc.simulate(pc.Scene.textbook(), q0=[1.0, 1.0], t_span=(0, 0.1))
    if is_known:
        run.estimate_error()
    with pytest.raises((ValueError, TypeError), match=message):
        run.estimate_error(time_limit=bad)


@pytest.mark.parametrize(
    ("bad", "message"),
    [
        (-1, r"horizon = -1.0: must be > 0 \(rad\)"),
        (float("nan"), r"horizon = nan: must be > 0"),
        (True, r"horizon = True: must be a real number \(rad\)"),
    ],
)
def test_bad_horizons_are_named(bad: float, message: str) -> None:
    run = pc.simulate(pc.Scene.textbook(), q0=[1.0, 1.0], t_span=(0, 0.1))
    with pytest.raises((ValueError, TypeError), match=message):
        run.plot(horizon=bad)


def test_what_is_past_the_horizon_is_shaded() -> None:
    import matplotlib.pyplot as plt

    case = chaotic_starts()[0]
    run = solved(case, "dopri5", 1e-6)
    for line in run.plot(horizon=LIMIT):
        (shade,) = line.axes.patches
        assert shade.get_x() == pytest.approx(run.valid_until(LIMIT))
        assert shade.get_x() + shade.get_width() == pytest.approx(T_END)
    all_right = pc.simulate(pc.Scene.textbook(), q0=[1.0, 1.0], t_span=(0, 1))
    assert not all_right.plot(horizon=LIMIT)[0].axes.patches
    plt.close("all")
