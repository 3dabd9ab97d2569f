"""The method of a run that names none: what the rule takes where, and that it is taken once."""

from __future__ import annotations

import inspect
import json
import pickle
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx

DOCS = Path(__file__).parents[2] / "docs"
sys.path.append(str(DOCS / "generators"))
import default_method  # noqa: E402

BOOK = pc.Scene.textbook()
START = [0.8, 1.0]
ROD = pc.Link(mass=1.0, length=1.0)
DRAG = fx.RodDrag(link=2, drag_coefficient=1.2, diameter=0.03)
STRIBECK = fx.DryJointFriction(joint=1, coulomb=0.1, static=0.2)
OWN = fx.User(lambda t, q, qd: -0.1 * qd)
SMOOTH = [
    fx.ViscousJoint(joint=1, damping=0.3, damping2=0.1),
    fx.TorsionalSpring(joint=2, stiffness=8.0),
    fx.Motor(joint=1, pd=fx.PD(kp=20.0, kd=3.0, reference=0.5), limit=4.0),
    fx.DryJointFriction(joint=2, coulomb=0.1),
    fx.DrivenPivot(y=fx.Sinusoid(0.02, 5.0)),
]
DAMPER = fx.ViscousJoint(joint=2, damping=1e6 / 3)
SPRING = fx.TorsionalSpring(joint=2, stiffness=1e8, rest_angle=0.2)
CONTROLLER = fx.Motor(joint=2, pd=fx.PD(kp=1e6, kd=1e3, reference=0.2))
CLIPPED = fx.Motor(joint=2, pd=fx.PD(kp=1e7, kd=1e5, reference=0.5), limit=30.0)


def default(scene: pc.Scene, t_end: float = 0.1, **how: Any) -> pc.Solution:
    n = len(scene.links)
    return pc.simulate(
        scene, q0=START[0] if n == 1 else np.linspace(*START, n), t_span=(0, t_end), **how
    )


def with_(*effects: Any) -> pc.Scene:
    return BOOK.replace(effects=list(effects))


def chain(n: int, *effects: Any) -> pc.Scene:
    return pc.Scene(links=[ROD] * n, effects=list(effects))


def test_to_name_no_method_is_to_name_the_rule() -> None:
    assert inspect.signature(pc.simulate).parameters["method"].default == "auto"
    named, unnamed = (default(BOOK, **how) for how in ({"method": "auto"}, {}))
    assert named.method == unnamed.method
    assert np.array_equal(named.y, unnamed.y)


@pytest.mark.parametrize(
    ("scene", "how", "method"),
    [
        (BOOK, {}, "taylor-radau5"),
        (BOOK, {"rtol": 1e-3, "atol": 1e-6}, "taylor-radau5"),
        (BOOK, {"ledger": True, "compensated": True}, "taylor-radau5"),
        (with_(*SMOOTH), {}, "taylor-radau5"),
        (chain(30), {}, "taylor-radau5"),
        (with_(DAMPER), {}, "taylor-radau5"),
        (chain(1), {}, "dop853-radau5"),
        (with_(DRAG), {}, "dop853-radau5"),
        (with_(STRIBECK), {}, "dop853-radau5"),
        (with_(OWN), {}, "dop853-radau5"),
        (BOOK, {"step": 1e-2}, "dopri5"),
        (BOOK, {"step": 1e-2, "rtol": 1e-3, "atol": 1e-3}, "dopri5"),
        (chain(1), {"step": 1e-2, "rtol": 1e-3}, "dopri5"),
        (with_(DRAG), {"step": 1e-2}, "dopri5"),
        (with_(DRAG), {"rtol": 9e-7}, "dop853-radau5"),
        (with_(DRAG), {"rtol": [1e-3, 1e-3, 1e-3, 1e-9]}, "dop853-radau5"),
        (with_(DRAG), {"rtol": 1e-6}, "dopri5-radau5"),
        (with_(DRAG), {"atol": 1e-4}, "dopri5-radau5"),
        (chain(1), {"rtol": 1e-3}, "dopri5-radau5"),
    ],
)
def test_each_branch_of_the_rule(scene: pc.Scene, how: dict[str, Any], method: str) -> None:
    sol = default(scene, **how)
    assert sol.success
    assert sol.method == method
    again = default(scene, **how | {"method": method})
    assert np.array_equal(sol.y, again.y)


def test_neither_start_nor_end_has_a_say() -> None:
    begins = [(START, (0, 1e-3)), ([3.0, -3.0], (0, 0)), ([0.0, 0.0], (5, 4))]
    scene = with_(DAMPER)
    runs = [
        pc.simulate(scene, q0=q0, qd0=[1e3, 0], t_span=t_span, max_steps=100, on_failure="ignore")
        for q0, t_span in begins
    ]
    assert {run.method for run in runs} == {"taylor-radau5"}


@pytest.mark.parametrize("scene", [BOOK, with_(DRAG), with_(DAMPER)], ids=["bare", "drag", "stiff"])
def test_what_ran_goes_on_and_runs_again_without_the_rule(scene: pc.Scene) -> None:
    whole = default(scene, 1.0)
    case = whole.case()
    assert case.options["method"] == whole.method != "auto"
    again = case.simulate()
    begun = pickle.loads(pickle.dumps(default(scene, 0.4)))
    resumed = begun.resume(1.0)
    for other in (again, resumed):
        assert other.method == whole.method
        assert np.array_equal(other.t, whole.t)
        assert np.array_equal(other.y, whole.y)
        assert other.stats == whole.stats


@pytest.mark.parametrize(
    ("effects", "q0"),
    [
        ([DAMPER], START),
        ([DAMPER, DRAG], START),
        ([CONTROLLER], START),
        ([CONTROLLER], [0.8, 1.3]),
        ([CONTROLLER, STRIBECK], START),
        ([CLIPPED], [0.8, 1.0]),
    ],
    ids=["damper", "damper and drag", "held", "pulled", "rubbed", "clipped at the start"],
)
def test_stiff_scenes_are_flagged_in_bounded_work(effects: list[Any], q0: list[float]) -> None:
    sol = pc.simulate(with_(*effects), q0=q0, t_span=(0, 5), max_steps=30_000)
    assert sol.success, sol.message
    assert sol.stats.stiff
    assert sol.stats.njev > 0
    assert "stiff: went on with radau5 from t = " in sol.message
    exact = pc.simulate(with_(*effects), q0=q0, t_span=(0, 5), method="radau5", rtol=1e-11)
    assert np.abs(sol.y[:2, -1] - exact.y[:2, -1]).max() < 1e-6


def test_tolerances_have_no_say_in_a_fixed_step() -> None:
    loose, tight = (
        pc.simulate(with_(DRAG), q0=START, t_span=(0, 1), step=1e-2, rtol=rtol)
        for rtol in (1e-3, 1e-12)
    )
    assert np.array_equal(loose.y, tight.y)
    assert loose.method == tight.method == "dopri5"


def test_a_fixed_step_that_is_too_long_is_told_so() -> None:
    sol = pc.simulate(with_(DAMPER), q0=START, t_span=(0, 5), step=1e-2, on_failure="ignore")
    assert sol.status == "non_finite"
    assert 'a shorter one helps, or method="radau5"' in sol.message


def test_in_fixed_steps_a_pair_changes_over_where_it_is_named_and_the_default_does_not() -> None:
    scene = with_(fx.ViscousJoint(joint=2, damping=1e3))
    run = ((0, 0.5), START)
    named = pc.simulate(scene, *run, step=2.5e-4, method="dopri5-radau5")
    unnamed = pc.simulate(scene, *run, step=2.5e-4)
    assert "went on with radau5" in named.message
    assert unnamed.method == "dopri5"
    assert unnamed.success
    assert "went on" not in unnamed.message
    page = " ".join((Path(__file__).parents[2] / "docs/how_to/stiff.md").read_text().split())
    assert "In a fixed `step` the default is `dopri5` and stays that" in page


def test_the_default_stays_with_its_first_method_where_radau5_does_not_pay() -> None:
    """A mode of 5e3 1/s that settles, beside a spring whose swing the steps have to follow."""
    spring = fx.TorsionalSpring(joint=4, stiffness=2000.0, rest_angle=0.3)
    scene = chain(4, spring, fx.ViscousJoint(joint=2, damping=280.0))
    run = ((0, 5), [0.9, 1.0, 1.1, 1.2])
    unnamed, by_name = (pc.simulate(scene, *run, **how) for how in ({}, {"method": "taylor"}))
    assert unnamed.stats.stiff
    assert by_name.stats.stiff
    assert unnamed.stats.accepted <= by_name.stats.accepted
    assert np.array_equal(unnamed.y, by_name.y)
    assert "but radau5 does not pay" in unnamed.message


def test_a_run_that_is_about_to_ask_goes_on_bit_by_bit() -> None:
    spring = fx.TorsionalSpring(joint=4, stiffness=2000.0, rest_angle=0.3)
    scene = chain(4, spring, fx.ViscousJoint(joint=2, damping=280.0))
    run = ((0, 5), [0.9, 1.0, 1.1, 1.2])
    whole = pc.simulate(scene, *run)
    assert whole.stats.njev > 0
    found = 1
    while not pc.simulate(scene, *run, max_steps=found, on_failure="ignore").stats.stiff:
        found += 1
    asked = []
    for cap in range(found - 1, found + 3):
        begun = pc.simulate(scene, *run, max_steps=cap, on_failure="ignore")
        asked.append(begun.stats.stiff and begun.stats.njev == 0)
        resumed = pickle.loads(pickle.dumps(begun)).resume(5)
        assert np.array_equal(whole.y, resumed.y)
        assert whole.stats == resumed.stats
        assert whole.message == resumed.message
    assert asked == [False, True, False, False]  # one ends between last hit and trial


@pytest.mark.parametrize("method", ["taylor", "dop853"])
def test_a_swing_that_every_method_has_to_follow_is_not_stiff(method: str) -> None:
    spring = fx.TorsionalSpring(joint=2, stiffness=1e5, rest_angle=0.2)
    sol = pc.simulate(with_(spring), q0=[0.8, 1.1], t_span=(0, 20), method=method)
    assert sol.stats.accepted > 3000
    assert not sol.stats.stiff
    assert "a fast mode set" in sol.message


def test_a_method_that_is_none_is_refused_with_the_rule_among_those_there_are() -> None:
    with pytest.raises(ValueError, match="must be one of auto, dopri5, RK45"):
        default(BOOK, method="automatic")
    with pytest.raises(ValueError, match='"auto": must be one of dopri5, RK45'):
        pc._core.tableau("auto")


def test_a_run_of_before_the_rule_is_the_pair_that_it_was() -> None:
    kept = default(BOOK, method="dopri5-radau5")
    state = kept._run.__getstate__()
    again = type(kept._run).__new__(type(kept._run))
    again.__setstate__(state | {"method": "auto"})
    assert again.method == "dopri5-radau5"


def test_the_page_has_the_figures_of_the_record_and_they_bear_out_the_rule() -> None:
    record = json.loads((DOCS / "records/default_method.json").read_text())
    page = (DOCS / "background/accuracy_cost.md").read_text()
    assert default_method.table_of_scenes(record["scenes"]) in page
    assert default_method.table_of_chains(record["chains"]) in page
    old, new = "`dopri5`, rtol 1e-9", default_method.YARDSTICK
    errors, times = (
        {way: [one[what][way] for one in record["scenes"]] for way in (old, new)}
        for what in ("error", "time")
    )
    assert np.mean(np.less(errors[new], errors[old])) == pytest.approx(3 / 4, abs=0.02)
    assert np.median(times[new]) < 0.6 * np.median(times[old])
    right = np.count_nonzero(np.array(errors[new]) < 1e-6)
    assert f"six digits are right in {right} of the {len(record['scenes'])} scenes" in page
    assert np.median(errors[new]) < 1e-9
    single, *longer = record["chains"]
    assert min(single["time"]["taylor"]) > 1
    taylor, dopri5 = (
        np.array([chain["time"][method] for chain in longer]) for method in ("taylor", "dopri5")
    )
    loose, tight = taylor[:, :2], taylor[:, 2:]
    assert tight.mean() < 1
    assert (tight < dopri5[:, 2:]).all()
    # what the page says of each row
    words = " ".join(page.split())
    assert f"a series takes {tight.min():.2f} to {tight.max():.2f} of the time of `dop853`" in words
    loosely = f"it takes {loose.min():.2f} to {loose.max():.2f} of that time"
    assert f"{loosely}, and `dopri5` may take less" in words
    saved = 1 - (dopri5 / taylor)[:, 0]
    assert (saved[1:] > 0).all()  # of three links or more
    assert f"saves up to {100 * saved.max():.0f} %" in words
