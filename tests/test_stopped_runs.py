"""Dry friction slides and does not stick, and a run at rest is over: all who ask are told."""

from __future__ import annotations

import pydoc
from pathlib import Path

import pendcore as pc
import pytest
from pendcore import effects as fx
from pendcore.views.summary import facts, text

ROOT = Path(__file__).parents[1]
ROD = pc.Link(mass=1.0, length=1.0)
RUBBED = pc.Scene(links=[ROD], gravity=0.0, effects=[fx.DryJointFriction(1, coulomb=0.5)])
START = {"q0": 0.3, "qd0": 2.0, "t_span": (0, 5)}


def test_its_help_and_its_page_say_that_friction_does_not_stick():
    told = " ".join(pydoc.plain(pydoc.render_doc(fx.DryJointFriction)).replace("|", "").split())
    page = (ROOT / "docs/effects/dry_joint_friction.md").read_text()
    for said in (told, page):
        assert "Friction slides, and does not stick yet." in said
        assert 'status "stuck"' in said
    assert "does not stick" not in (fx.ViscousJoint.__doc__ or "")


def test_explanation_and_summary_say_that_sticking_is_not_simulated():
    told = RUBBED.explain()
    assert "sticking" in {absence.kind for absence in told.not_simulated}
    printed = " ".join(repr(told).split())
    assert "Sticking: a joint that dry friction holds while others move." in printed
    said = text(facts(pc.simulate(RUBBED, **START)))
    assert "sticking" in said.partition("not simulated")[2].partition("What came")[0]
    smooth = RUBBED.replace(effects=[fx.ViscousJoint(1, 0.5)])
    assert "sticking" not in {absence.kind for absence in smooth.explain().not_simulated}


def test_a_time_after_rest_is_refused_with_where_it_came_to_rest():
    sol = pc.simulate(RUBBED, **START)
    assert (sol.status, sol.success) == ("at_rest", True)
    rest = sol.t[-1]
    assert rest == pytest.approx(2.0 / 1.5)
    message = rf"^t = 2\.0: the run came to rest at t = {rest} s, and all stays as it is"
    for t in (2.0, [0.5, 2.0]):
        with pytest.raises(ValueError, match=message):
            sol(t)
    with pytest.raises(ValueError, match=r"^t = -1\.0: must be within the run"):
        sol(-1.0)
    assert sol(rest)[1] == 0.0
    assert sol([]).shape == (2, 0)


def test_times_asked_for_after_rest_are_not_there_as_the_documents_say():
    sol = pc.simulate(RUBBED, **START, t_eval=[0.5, 1.0, 2.0, 4.0])
    assert [*sol.t] == [0.5, 1.0]
    assert "those after it came to rest" in " ".join((pc.simulate.__doc__ or "").split())
    trust = " ".join((ROOT / "docs/trust.md").read_text().split())
    assert "which is then shorter than `t_eval`" in trust


def test_a_sign_of_the_users_own_never_gets_past_rest_as_the_documents_say():
    def law(t, q, qd):
        return -0.5 * (qd > 0) + 0.5 * (qd < 0)

    scene = RUBBED.replace(effects=[fx.User(law)])
    sol = pc.simulate(scene, **START, max_steps=2000)
    assert not sol.success
    assert sol._run.t_reached < 1.4  # it came to rest at 4/3 s
    trust = " ".join((ROOT / "docs/trust.md").read_text().split())
    assert "never gets past rest" in trust
