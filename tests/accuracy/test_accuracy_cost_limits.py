"""`pc.accuracy_cost` keeps its time limit, measures what fits, and names what it could not."""

from __future__ import annotations

import math
import re
import time

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
    reached = [p.error for p in found if not p.failure]
    assert len(reached) > 10
    assert max(reached) < math.inf
    assert found.best(1e-4).error < 1e-4


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
