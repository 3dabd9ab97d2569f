"""Runs that come to rest: how they end, and who is told."""

from __future__ import annotations

import pydoc
import re
from pathlib import Path
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx

ROOT = Path(__file__).parents[2]
ROD = pc.Link(mass=1.0, length=1.0)
RUBBED = pc.Scene(links=[ROD], gravity=0.0, effects=[fx.DryJointFriction(1, coulomb=0.5)])
START = {"q0": 0.3, "qd0": 2.0, "t_span": (0, 5)}


def test_its_help_and_its_page_say_how_friction_sticks():
    told = " ".join(pydoc.plain(pydoc.render_doc(fx.DryJointFriction)).replace("|", "").split())
    page = " ".join((ROOT / "docs/effects/dry_joint_friction.md").read_text().split())
    for said in (told, page):
        assert "A joint that friction brings to rest sticks" in said
        assert 'status "at_rest"' in said
    assert "sticks" not in (fx.ViscousJoint.__doc__ or "")


def test_a_run_at_rest_goes_on_as_it_is_to_the_end_and_says_since_when():
    sol = pc.simulate(RUBBED, **START)
    assert (sol.status, sol.success) == ("at_rest", True)
    assert sol.t[-1] == 5.0
    assert sol.t[-2] == pytest.approx(2.0 / 1.5)
    assert f"at t = {sol.t[-2]} s" in sol.message
    for t in (sol.t[-2], 2.0, 5.0):
        np.testing.assert_array_equal(sol(t), sol.y[:, -1])
    assert sol.qd[-1, 0] == 0.0
    with pytest.raises(ValueError, match=r"^t = 6\.0: must be within the run"):
        sol(6.0)


def test_times_asked_for_after_rest_are_there():
    sol = pc.simulate(RUBBED, **START, t_eval=[0.5, 1.0, 2.0, 4.0])
    assert [*sol.t] == [0.5, 1.0, 2.0, 4.0]
    assert sol.q[2, 0] == sol.q[3, 0]


def test_a_run_at_rest_that_goes_on_is_at_rest():
    sol = pc.simulate(RUBBED, **START)
    longer = sol.resume(9.0)
    assert longer.status == "at_rest"
    once = pc.simulate(RUBBED, **START | {"t_span": (0, 9)})
    np.testing.assert_array_equal(longer.t, once.t)
    np.testing.assert_array_equal(longer.y, once.y)


@pytest.mark.parametrize("t_end", [1e-320, 1e-160, 1e300])
@pytest.mark.parametrize("options", [{}, {"ledger": True}, {"compensated": True}])
def test_the_step_at_rest_may_have_any_length(method: str, t_end: float, options: dict[str, bool]):
    sol = pc.simulate(RUBBED, q0=0.3, t_span=(0, t_end), method=method, **options)
    assert (sol.status, sol.t[-1]) == ("at_rest", t_end)
    np.testing.assert_array_equal(sol.y[:, -1], [0.3, 0.0])
    np.testing.assert_array_equal(sol(0.5 * t_end), [0.3, 0.0])


def test_a_sign_of_the_users_own_never_gets_past_rest_as_the_documents_say():
    def law(t, q, qd):
        return -0.5 * (qd > 0) + 0.5 * (qd < 0)

    scene = RUBBED.replace(effects=[fx.User(law)])
    sol = pc.simulate(scene, **START, max_steps=2000, on_failure="ignore")
    assert not sol.success
    assert sol._run.t_reached < 1.4  # it came to rest at 4/3 s
    trust = " ".join((ROOT / "docs/background/trust.md").read_text().split())
    assert "never gets past rest" in trust


def test_a_run_that_is_not_finite_says_which_rate_and_whose_force(method: str):
    def of_root(t: float, q: np.ndarray, qd: np.ndarray) -> np.ndarray:
        return np.array([0.0, 0.0 * np.sqrt(max(0.5 - q[1], 0.0)) if q[1] <= 0.5 else np.nan])

    drag = fx.ViscousJoint(joint=2, damping=0.1)
    scene = pc.Scene(links=[ROD, ROD], gravity=0.0, effects=[drag, fx.User(of_root)])
    sol = pc.simulate(
        scene, q0=0, qd0=[0.0, 1.0], t_span=(0, 3), method=method, on_failure="ignore"
    )
    assert sol.status == "non_finite"
    assert sol.q[-1, 1] == pytest.approx(0.5, abs=1e-9)
    assert re.search(r"qd_[12], by effect 2 \(\w*user\)\)", sol.message)


@pytest.mark.parametrize("span", [(0, 1e-12), (1, 1 + 4e-16), (0, 1), (1, -1)])
def test_the_right_hand_side_is_never_asked_outside_the_interval(
    method: str, span: tuple[float, float]
):
    asked: list[float] = []

    def note(t: float, q: np.ndarray, qd: np.ndarray) -> np.ndarray:
        asked.append(t)
        return np.zeros(1)

    scene = pc.Scene(links=[ROD], effects=[fx.User(note)])
    assert pc.simulate(scene, q0=0.3, t_span=span, method=method).success
    assert asked
    assert min(span) <= min(asked)
    assert max(asked) <= max(span)


def test_a_run_shorter_than_its_first_guess_goes_on_as_one_that_is_longer(method: str):
    """The first step then depends on the end, so that a continued run begins anew."""
    book, start = pc.Scene.textbook(), (np.pi / 4, np.pi / 3)
    once = pc.simulate(book, q0=start, t_span=(0, 1), method=method)
    short = pc.simulate(book, q0=start, t_span=(0, 1e-13), method=method)
    longer = short.resume(2e-12).resume(1.0)
    np.testing.assert_array_equal(longer.t, once.t)
    np.testing.assert_array_equal(longer.y, once.y)


@pytest.mark.parametrize("first_step", [1e-300, 1e-160, 1e-7, 1e300])
def test_any_first_step_leads_to_the_end(method: str, first_step: float):
    book = pc.Scene.textbook()
    exact = pc.simulate(book, q0=[0.5, 0.6], t_span=(0, 1), rtol=1e-12, atol=1e-13).q[-1]
    sol = pc.simulate(book, q0=[0.5, 0.6], t_span=(0, 1), first_step=first_step, method=method)
    assert sol.success
    np.testing.assert_allclose(sol.q[-1], exact, atol=1e-5)


def test_an_attempt_that_is_given_up_leaves_no_trace():
    """Within a step of radau5 the clock is looked at, in the elimination of long chains."""
    chain = pc.Scene(
        links=[pc.Link(mass=1, length=0.1)] * 60,
        effects=[fx.ViscousJoint(joint=60, damping=1e3)],
    )
    how: dict[str, Any] = {"method": "radau5", "rtol": 1e-4, "atol": 1e-4}
    once = pc.simulate(chain, q0=0.3, t_span=(0, 0.3), **how)
    legs = pc.simulate(chain, q0=0.3, t_span=(0, 0.3), time_limit=2e-3, on_failure="ignore", **how)
    stops = 0
    while legs.status == "time_limit":
        stops += 1
        legs = legs.resume(0.3, time_limit=2e-3 * (1 + stops / 10), on_failure="ignore")
    assert stops > 0
    np.testing.assert_array_equal(legs.t, once.t)
    np.testing.assert_array_equal(legs.y, once.y)
    assert legs.stats == once.stats


@pytest.mark.parametrize("step", [0.3, 50.0])
def test_a_fixed_step_whose_equations_are_not_solved_says_so(step: float) -> None:
    start = (2.0, 2.5), (0.0, 8.0)
    sol = pc.simulate(
        pc.Scene.textbook(), (0, 100), *start, method="radau5", step=step, on_failure="ignore"
    )
    assert (sol.status, sol.success) == ("not_converged", False)
    assert "use a smaller step" in sol.message
    assert np.isfinite(sol.y).all()


def test_a_law_that_gives_no_number_is_not_called_an_equation_without_solution() -> None:
    def undefined(t: float, q: np.ndarray, qd: np.ndarray) -> np.ndarray:
        return np.full(2, np.nan if t > 0.5 else 0.0)

    scene = pc.Scene(links=pc.Scene.textbook().links, effects=[fx.User(undefined)])
    sol = pc.simulate(scene, q0=1.0, t_span=(0, 1), method="radau5", step=0.01, on_failure="ignore")
    assert sol.status == "non_finite"
