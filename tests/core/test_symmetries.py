"""A motion told in other units, seen in a mirror, run backward, or turned, is the same motion.

Where nothing but signs and powers of two change, it is the same to the last bit.
"""

from __future__ import annotations

import numpy as np
import pendcore as pc
import pytest
from drawn_motions import (
    LOSSLESS,
    SMOOTH,
    UNDAMPED,
    motion_of_seed,
    motions,
    stopped_motion_of_seed,
    stopped_motions,
)
from fuzz.drawn_run import Drawn
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from pendcore import _core
from pendcore.effects import KINDS
from symmetries import (
    MIRRORED,
    Units,
    backward,
    in_units,
    left_to_right,
    turned_once,
    upside_down,
    with_effects,
    without_strength,
)

ADAPTIVE = [method["name"] for method in _core.methods() if method["error_order"] > 0]
WITH_FRICTION = (*SMOOTH, "dry_joint_friction")

pytestmark = pytest.mark.filterwarnings("ignore::pendcore.PendcoreWarning")


def as_given(values: tuple[float, ...]) -> list[float]:
    """Return powers of two."""
    return [2.0**k for k in values]


powers = st.tuples(*[st.integers(-30, 30)] * 3).map(as_given)


def same_steps(one: pc.Solution, other: pc.Solution, signs: float = 1.0, s: float = 1.0) -> None:
    """Compare to the last bit, with angles and rates times a sign and times in another unit."""
    n = len(one.scene.links)
    assert other.status == one.status
    assert other.stats.accepted == one.stats.accepted
    assert np.array_equal(other.t, one.t * s)
    assert np.array_equal(other.y[:n], one.y[:n] * signs)
    assert np.array_equal(other.y[n:], one.y[n:] * signs / s)


# To the last bit ------------------------------------------------------------------------------


@pytest.mark.parametrize("method", ADAPTIVE)
@given(run=motions(WITH_FRICTION), powers=powers)
def test_other_units_of_mass_and_length_change_no_bit(
    method: str, run: Drawn, powers: list[float]
) -> None:
    """Neither the equations nor the step control have a mass or a length of their own."""
    kg, m, _ = powers
    same_steps(run.simulate(method=method), in_units(run, Units(kg, m)).simulate(method=method))


@pytest.mark.parametrize("method", ADAPTIVE)
@given(run=motions(WITH_FRICTION), powers=powers)
def test_other_units_of_time_change_no_bit(method: str, run: Drawn, powers: list[float]) -> None:
    """The first step is given, as Hairer's rule compares rates of angles with rates of rates."""
    run.options |= {"first_step": 2.0**-10, "method": method, "ledger": True}
    kg, m, s = powers
    one, other = run.simulate(), in_units(run, Units(kg, m, s)).simulate()
    same_steps(one, other, s=s)
    joule = kg * (m / s) ** 2
    for name, entry in one._run.ledger.items():
        assert np.array_equal(other._run.ledger[name], entry * joule), name


@pytest.mark.parametrize("method", ADAPTIVE)
@settings(max_examples=40)
@given(run=stopped_motions(WITH_FRICTION), powers=powers)
def test_other_units_change_no_bit_of_impacts_and_contact(
    method: str, run: Drawn, powers: list[float]
) -> None:
    """Undriven joints' speed is compared with 1 rad/s, which is a unit of time of its own."""
    kg, m, s = powers if run.scene.gravity else (*powers[:2], 1.0)
    run.options |= {"first_step": 2.0**-10, "method": method}
    same_steps(run.simulate(), in_units(run, Units(kg, m, s)).simulate(), s=s)


@pytest.mark.parametrize("method", ADAPTIVE)
@given(run=motions(()))
def test_four_times_the_gravity_is_half_the_time(method: str, run: Drawn) -> None:
    run.options |= {"first_step": 2.0**-10, "method": method}
    fast = in_units(run, Units(s=0.5))
    assert fast.scene == run.scene.replace(gravity=4 * run.scene.gravity)
    same_steps(run.simulate(), fast.simulate(), s=0.5)


@pytest.mark.parametrize("method", ADAPTIVE)
@given(run=motions(MIRRORED))
def test_upside_down_changes_no_bit(method: str, run: Drawn) -> None:
    run.options |= {"method": method}
    same_steps(run.simulate(), upside_down(run).simulate(), signs=-1.0)


@pytest.mark.parametrize("kind", sorted(MIRRORED & set(KINDS)))
def test_every_kind_of_effect_has_its_mirror_images(kind: str) -> None:
    """The seeds also reach what hypothesis seldom meets, such as one of the modes of a motor."""
    for seed in range(25):
        run = motion_of_seed(f"{kind}/{seed}", kind)
        n = len(run.q0)
        same_steps(run.simulate(), upside_down(run).simulate(), signs=-1.0)
        if kind in SMOOTH:
            near(np.pi - at_five_times(left_to_right(run))[:n], at_five_times(run)[:n])


@pytest.mark.parametrize("method", ADAPTIVE)
@given(run=motions(LOSSLESS) | stopped_motions(LOSSLESS, (1.0,)))
def test_without_losses_the_past_is_the_future_of_the_reversed_start(
    method: str, run: Drawn
) -> None:
    n = len(run.q0)
    one, other = run.simulate(method=method), backward(run).simulate(method=method)
    assert np.array_equal(other.t, -one.t)
    assert np.array_equal(other.y[:n], one.y[:n])
    assert np.array_equal(other.y[n:], -one.y[n:])


# To rounding ----------------------------------------------------------------------------------


def near(found: np.ndarray, wanted: np.ndarray) -> None:
    """Compare within the tolerances of two runs whose errors grew for a second."""
    assert_allclose(found, wanted, rtol=0, atol=1e-6 * max(1.0, np.abs(wanted).max()))


def at_five_times(run: Drawn, **changes: object) -> np.ndarray:
    """Return the states at fifths of the span; the run must get there."""
    sol = run.simulate(**changes)
    assert sol.status in ("finished", "stuck", "at_rest"), sol.message
    return sol(np.linspace(0, 1, 6) * sol._run.t_reached)


@pytest.mark.parametrize("method", ADAPTIVE)
@given(run=motions())
def test_left_to_right_is_the_mirrored_motion(method: str, run: Drawn) -> None:
    n = len(run.q0)
    one, image = (at_five_times(x, method=method) for x in (run, left_to_right(run)))
    near(np.pi - image[:n], one[:n])
    near(-image[n:], one[n:])


@pytest.mark.parametrize("seed", range(100))
def test_left_to_right_impacts_and_contact_are_the_mirrored_ones(method: str, seed: int) -> None:
    """The motions are the same each time, because one in thousands meets two stops within rounding.

    The impact that comes first then decides what follows, and the mirror image may round otherwise.
    """
    run = stopped_motion_of_seed(f"stopped/{seed}")
    n = len(run.q0)
    one, image = (at_five_times(x, method=method) for x in (run, left_to_right(run)))
    near(np.pi - image[:n], one[:n])
    near(-image[n:], one[n:])


@pytest.mark.parametrize("method", ADAPTIVE)
@given(run=motions())
def test_a_turn_more_in_every_angle_is_the_same_motion(method: str, run: Drawn) -> None:
    n = len(run.q0)
    one, turned = (at_five_times(x, method=method) for x in (run, turned_once(run)))
    near(turned[:n] - 2 * np.pi, one[:n])
    near(turned[n:], one[n:])


@pytest.mark.parametrize("method", ADAPTIVE)
@given(run=motions(UNDAMPED))
def test_there_and_back_is_where_it_began(method: str, run: Drawn) -> None:
    n = len(run.q0)
    there = run.simulate(method=method)
    assert there.status == "finished", there.message
    end = there._run.y_reached
    back = Drawn(run.scene, end[:n], end[n:], run.t_span[::-1], run.options)
    near(back.simulate(method=method)._run.y_reached, [*run.q0, *run.qd0])


@pytest.mark.parametrize("method", ADAPTIVE)
@given(run=motions(sorted(MIRRORED - {"lock"})))
def test_effects_of_no_strength_are_as_good_as_absent(method: str, run: Drawn) -> None:
    idle = [without_strength(effect) for effect in run.scene.effects]
    with_idle = Drawn(with_effects(run.scene, idle), run.q0, run.qd0, run.t_span, run.options)
    bare = Drawn(with_effects(run.scene, []), run.q0, run.qd0, run.t_span, run.options)
    near(at_five_times(with_idle, method=method), at_five_times(bare, method=method))
