"""`pc.accuracy_cost` keeps its time limit, measures what fits, and names what it could not."""

from __future__ import annotations

import math
import re
import time

import numpy as np
import pendcore as pc
import pytest
from pendcore.cost.sweep import RTOL

BOOK = pc.Scene.textbook()
E = pc.effects
STIFF = BOOK.replace(effects=[E.ViscousJoint(joint=2, damping=1e5)])
SWING = ([1.5, 1.5], 0)


def test_without_time_for_repeats_it_says_so():
    slow = BOOK.replace(effects=[E.User(lambda t, q, qd: -0.1 * qd)])
    found = pc.accuracy_cost(slow, q0=[0.7, 1.0], t_span=(0, 1), repeats=1000, time_limit=1.5)
    assert any("the time was up" in remark for remark in found.remarks)
    assert min(p.repeats for p in found if not p.failure) < 1000


@pytest.mark.parametrize("span", [(0, 1e7), (1e7, 0), (-3.0, 1e9)], ids=str)
@pytest.mark.unsanitized
def test_a_span_too_long_for_its_time_is_cut_and_says_so(span):
    begin = time.monotonic()
    found = pc.accuracy_cost(BOOK, q0=[1.5, 1.5], t_span=span, time_limit=1.0)
    assert time.monotonic() - begin < 2
    assert found.asked_t_span == span
    assert found.t_span[0] == span[0]
    assert 10 < abs(found.t_span[1] - found.t_span[0]) < abs(span[1] - span[0]) / 100
    assert "a time_limit of 1 s is too little for more of this span: until" in found.remarks[0]
    assert found.best(1e-4).error < 1e-4
    assert len([p for p in found if not p.failure]) > 10


def test_a_long_stiff_span_is_cut_too():
    found = pc.accuracy_cost(STIFF, (0, 1e6), *SWING, time_limit=2.0)
    assert "too little for more" in found.remarks[0]
    assert found.best(1e-3).method not in ("dopri5", "dop853", "taylor", "rk4")


def test_a_span_that_cannot_be_run_to_its_end_is_cut_with_the_reason():
    ends = E.User(lambda t, q, qd: [math.nan if t > 3 else 0.0, 0.0])
    scene = BOOK.replace(effects=[ends])
    found = pc.accuracy_cost(scene, (0, 10), *SWING, time_limit=60.0, rtol=[1e-3, 1e-6], repeats=1)
    assert 2.5 < found.t_span[1] <= 3
    assert "got no farther: the motion stopped being finite" in found.remarks[0]


def test_what_cannot_be_run_at_all_says_why():
    scene = BOOK.replace(effects=[E.User(lambda t, q, qd: [math.nan, 0.0])])
    with pytest.raises(ValueError, match=r"no two methods got beyond .* stopped being finite"):
        pc.accuracy_cost(scene, (0, 10), *SWING)


def test_a_cut_span_has_a_grid_that_ends_with_it():
    found = pc.accuracy_cost(BOOK, q0=[0.7, 1.0], t_span=(0, 1e6), time_limit=0.5)
    assert found.times >= 2
    reached = [p.error for p in found if not p.failure]
    assert all(math.isfinite(error) for error in reached)
    assert min(reached) < 1e-2


def test_what_was_not_tried_for_want_of_time_is_named():
    slow = BOOK.replace(effects=[E.User(lambda t, q, qd: -0.1 * qd)])
    found = pc.accuracy_cost(slow, (0, 0.5), *SWING, time_limit=1e-3, methods=["dopri5", "rk4"])
    (remark,) = [x for x in found.remarks if "before these were tried" in x]
    assert remark.endswith("a larger time_limit than 0.001 s includes them")
    tried = [p.rtol for p in found if p.method == "dopri5"]
    loosest = next(r for r in RTOL if r not in tried)
    assert f"tried: dopri5 at rtol {loosest:.3g} and below" in remark
    for point in found:
        if point.failure:
            assert re.fullmatch(r"took more than the \S+ s left for it of the .*", point.failure)


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        ({"methods": ["euler"]}, "methods: 'euler' is none: known are dopri5"),
        ({"methods": "euler"}, "methods: 'euler' is none: known are dopri5"),
        ({"methods": ["auto"]}, "methods: 'auto' is a rule that chooses one: known are dopri5"),
        ({"methods": []}, "methods: is empty: must name a method, or be left out"),
        ({"methods": 3}, "methods = 3: must be names of methods"),
        ({"rtol": [1e-3, -1]}, "rtol = "),
        ({"rtol": []}, "rtol = "),
        ({"rtol": [2]}, r"rtol = \[2\]: must be > 0 and < 1"),
        ({"rtol": 1.0}, r"rtol = 1.0: must be > 0 and < 1"),
        ({"atol": "small"}, "atol = 'small': must be a real number"),
        ({"step": 0}, "step = 0: must be numbers > 0"),
        ({"time_limit": 0}, r"time_limit = 0.0: must be > 0 \(s\)"),
        ({"time_limit": -1}, "time_limit = -1.0: must be > 0"),
        ({"time_limit": np.nan}, "time_limit = nan: must be > 0"),
        ({"time_limit": "long"}, "time_limit = 'long': must be a real number"),
        ({"points": 1}, "points = 1: must be >= 2"),
        ({"points": -1}, "points = -1: must be >= 2"),
        ({"points": 2.5}, "points = 2.5: must be a whole number"),
        ({"repeats": 0}, "repeats = 0: must be >= 1"),
        ({"t_span": (0, 0)}, r"t_span = \(0, 0\): must be two different times"),
        ({"t_span": 5}, "t_span = 5: must be "),
        ({"t_span": (0, 1, 2)}, r"t_span = \(0, 1, 2\): must be \(t_start, t_end\)"),
        ({"t_span": (0, np.inf)}, r"t_span\[1\] = inf: must be finite"),
        ({"t_span": "ab"}, "t_span = 'ab': must be "),
        ({"method": 1}, "did you mean 'methods'"),
        ({"q0": [1, 2, 3]}, "q0: shape"),
    ],
)
def test_what_cannot_be_measured_is_named(options, complaint):
    given = {"q0": [0.7, 1.0], "t_span": (0, 5)} | options
    with pytest.raises((ValueError, TypeError), match=complaint):
        pc.accuracy_cost(BOOK, **given)


def test_one_method_may_be_given_by_its_name():
    few = {"rtol": [1e-3, 1e-6], "repeats": 1}
    found = pc.accuracy_cost(BOOK, q0=[0.7, 1.0], t_span=(0, 1), methods="DOP853", **few)
    assert {p.method for p in found} == {"dop853"}


@pytest.mark.parametrize("error", [0, -1, np.nan])
def test_no_error_is_none_to_ask_for(error):
    found = pc.accuracy_cost(
        BOOK, q0=[0.7, 1.0], t_span=(0, 1), methods="dop853", rtol=1e-6, repeats=1
    )
    for asked in (found.best, found.sentence):
        with pytest.raises(ValueError, match="must be > 0, a share of the total length"):
            asked(error)


@pytest.mark.parametrize("limit", [0, -1, np.nan])
def test_an_estimate_of_the_error_checks_its_limit_too(limit):
    sol = pc.simulate(BOOK, q0=[0.7, 1.0], t_span=(0, 1))
    with pytest.raises(ValueError, match=r"time_limit = .*: must be > 0 \(s\)"):
        sol.estimate_error(time_limit=limit)
