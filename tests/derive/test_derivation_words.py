"""What a derivation says of effects is true for any number of them and on every joint."""

from __future__ import annotations

from typing import Any

import pendcore as pc
import pytest
from pendcore.derive import Derivation
from pendcore.derive.narration.page import Page
from pendcore.derive.report.effect_text import what_acts

pytestmark = pytest.mark.unsanitized

fx = pc.effects
ROD = pc.Link(mass=1.0, length=1.0)
SUM = "the equations of the links that a lock makes turn as one are added"


def derived(n: int, *effects: Any, gravity: float = 9.807) -> Derivation:
    return Derivation(pc.Scene(links=[ROD] * n, effects=effects, gravity=gravity))


def stated(derivation: Derivation) -> list[str]:
    return list(what_acts(derivation, [0.1] * derivation.n))


def step(derivation: Derivation, title: str) -> Any:
    return next(s for s in derivation.steps if s.title.startswith(title))


def test_the_path_of_a_pivot_is_the_sum_of_all_that_move_it() -> None:
    wave = fx.Sinusoid(0.1, 3.0)
    (both,) = stated(derived(1, fx.DrivenPivot(x=wave), fx.DrivenPivot(y=wave)))
    assert "x_{A}(t) = " in both
    assert "y_{A}(t) = " in both
    assert "= 0" not in both
    (along,) = stated(derived(1, fx.DrivenPivot(x=wave), fx.DrivenPivot(x=wave)))
    assert r"\hat{x}_{A} \sin" in along
    assert r" + {\hat{x}_{A}^{(2)}} \sin" in along
    assert along.count("y_{A} = 0") == 1


def test_every_drag_on_a_link_has_the_name_that_the_steps_give_it() -> None:
    drag = fx.RodDrag(link=1, drag_coefficient=1.2, diameter=0.03)
    derivation = derived(1, drag, drag)
    told, page = stated(derivation), Page(derivation)
    names = [page.load(load).latex for load in derivation.equations.loads]
    assert len(set(names)) == 2
    for name, sentences in zip(names, told, strict=True):
        assert f"${name} = " in sentences


@pytest.mark.parametrize(
    ("n", "joints", "told", "not_told"),
    [
        (1, [1], "The link is held by the ground: no equation is needed", "divided"),
        (2, [1, 2], "All links are held by the ground: no equation is needed", "added"),
        (2, [1], "link 1 is held by the ground, and its equation is left out, which", "added"),
        (3, [1, 2], "links 1 and 2 are held by the ground, and their equations are left", "added"),
        (3, [1, 3], f"and its equation is left out; {SUM}, which takes the couples", "links 1"),
        (3, [2], f"; {SUM}, which takes the couple of the lock out of them", "ground"),
        (3, [2, 3], f"; {SUM}, which takes the couples of the locks out of them", "ground"),
    ],
)
def test_a_lock_on_the_ground_leaves_equations_out(
    n: int, joints: list[int], told: str, not_told: str
) -> None:
    text = step(derived(n, *(fx.Lock(joint=j) for j in joints)), "Solution for").text
    assert told in text
    assert not_told not in text


@pytest.mark.parametrize("n", [1, 2, 3])
def test_the_force_and_the_couple_of_a_payload_are_explained_where_they_act(n: int) -> None:
    turning = f"The payload turns with link {n}; the couple that this takes, $I_{{p}}"
    derivation = derived(n, fx.Payload(mass=0.5, inertia=0.1))
    last = step(derivation, f"Newton-Euler equations of link {n}").text
    assert f"F}}_{{p{n}}}$" in last
    assert turning in last
    own = step(derivation, "Newton-Euler equations of the payload")
    assert str(own.equations[-1]) == f"I_p alpha{n} = Tp"
    point = derived(n, fx.Payload(mass=0.5))
    assert turning not in str(point.latex())
    assert len(step(point, "Newton's equations of the payload").equations) == 3


def test_what_does_not_move_is_not_counted() -> None:
    text = step(derived(1, fx.Lock(joint=1)), "Degrees of freedom").text
    assert text.startswith("The link does not move: $n = 0$, ")
    assert "the angle $q_{1}(t)$" in text
    text = step(derived(2, fx.Lock(joint=1), fx.Lock(joint=2)), "Degrees of freedom").text
    assert text.startswith("The links do not move: $n = 0$, ")
    assert "with one degree of freedom:" in step(derived(1), "Degrees of freedom").text


def test_several_payloads_are_several() -> None:
    body = fx.Payload(mass=0.5)
    assert step(derived(1, body), "Effects").text == "A payload is fixed to the tip."
    several = "The payloads are fixed to the tip, and move as one body."
    assert step(derived(1, body, body), "Effects").text == several


def test_gravity_acts_where_there_is_some() -> None:
    gravity_alone = "Nothing acts on the chain but gravity and the joint that holds it."
    assert stated(derived(1)) == [gravity_alone]
    weightless = ["Nothing acts on the chain but the joint that holds it. Gravity is 0."]
    assert stated(derived(1, gravity=0.0)) == weightless
