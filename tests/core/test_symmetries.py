"""A motion told in other units, seen in a mirror, run backward, or turned, is the same motion.

Where nothing but signs and powers of two change, it is the same to the last bit.
"""

from __future__ import annotations

from dataclasses import replace

import drawn_motions
import numpy as np
import pendcore as pc
import pytest
import symmetries
from drawn_motions import LOSSLESS, SMOOTH, UNDAMPED, at_fifths, motions, stopped_motions
from fuzz.drawn_run import Drawn
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from pendcore import _core
from pendcore.effects import KINDS
from sweeps import random_examples
from symmetries import MIRRORED, Units, in_units, with_effects

WITH_FRICTION = (*SMOOTH, "dry_joint_friction")

pytestmark = pytest.mark.filterwarnings("ignore::pendcore.PendcoreWarning")

every_method = pytest.mark.parametrize(
    "method", [method["name"] for method in _core.methods() if method["error_order"]]
)
units = st.builds(Units, *[st.integers(-30, 30).map(lambda k: 2.0**k)] * 3)


def same_steps(
    one: Drawn, other: Drawn, method: str | None = None, signs: float = 1.0, s: float = 1.0
) -> tuple[pc.Solution, pc.Solution]:
    """Compare to the last bit, with angles and rates times a sign and times in another unit."""
    how = {"method": method} if method else {}
    found, image = one.simulate(**how), other.simulate(**how)
    n = len(one.q0)
    assert image.status == found.status
    assert image.stats.accepted == found.stats.accepted
    assert np.array_equal(image.t, found.t * s)
    assert np.array_equal(image.y[:n], found.y[:n] * signs)
    assert np.array_equal(image.y[n:], found.y[n:] * signs / s)
    return found, image


# To the last bit ------------------------------------------------------------------------------


@pytest.mark.few_cases
@every_method
@given(run=motions(WITH_FRICTION), units=units)
def test_other_units_of_mass_and_length_change_no_bit(method: str, run: Drawn, units: Units):
    """Neither the equations nor the step control have a mass or a length of their own."""
    same_steps(run, in_units(run, Units(units.kg, units.m)), method)


@pytest.mark.few_cases
@every_method
@settings(max_examples=random_examples(140))
@given(run=motions(WITH_FRICTION) | stopped_motions(WITH_FRICTION), units=units)
def test_other_units_of_mass_length_and_time_change_no_bit(method, run, units) -> None:
    """Nor do they change one of impacts, contact and the ledger.

    The first step is given because Hairer's rule compares rates of angles with rates of rates.
    Undriven joints' speed is compared with 1 rad/s at stops, which is a unit of time of its own.
    """
    run.options |= {"first_step": 2.0**-10, "ledger": True}
    if not run.scene.gravity and any(effect.kind == "joint_stop" for effect in run.scene.effects):
        units = Units(units.kg, units.m)
    one, other = same_steps(run, in_units(run, units), method, s=units.s)
    for name, entry in one._run.ledger.items():
        assert np.array_equal(other._run.ledger[name], entry * units.factor("J")), name


@pytest.mark.few_cases
@every_method
@given(run=motions(MIRRORED))
def test_upside_down_changes_no_bit(method: str, run: Drawn) -> None:
    same_steps(run, symmetries.upside_down(run), method, signs=-1.0)


@pytest.mark.parametrize("kind", sorted(MIRRORED & set(KINDS)))
def test_every_kind_of_effect_has_its_mirror_images(kind: str) -> None:
    """The seeds also reach what hypothesis seldom meets, such as one of the modes of a motor."""
    for seed in range(25):
        run = drawn_motions.motion_of_seed(f"{kind}/{seed}", kind)
        same_steps(run, symmetries.upside_down(run), signs=-1.0)
        if kind in SMOOTH:
            check_mirrored(run)


@pytest.mark.few_cases
@pytest.mark.parametrize("method", [method["name"] for method in _core.methods()])
@given(run=motions(LOSSLESS) | stopped_motions(LOSSLESS, (1.0,)))
def test_without_losses_the_past_is_the_future_of_the_reversed_start(method: str, run: Drawn):
    n, how = len(run.q0), {"method": method, "step": 0.01 if method == "rk4" else None}
    one, other = run.simulate(**how), symmetries.backward(run).simulate(**how)
    assert np.array_equal(other.t, -one.t)
    assert np.array_equal(other.y[:n], one.y[:n])
    assert np.array_equal(other.y[n:], -one.y[n:])
    times = np.linspace(one.t[0], one.t[-1], 33)
    assert np.array_equal(other(-times)[:n], one(times)[:n])


# To rounding ----------------------------------------------------------------------------------


def check_near(found: np.ndarray, wanted: np.ndarray) -> None:
    """Compare within the tolerances of two runs whose errors grew for a second."""
    assert_allclose(found, wanted, rtol=0, atol=1e-6 * max(1.0, np.abs(wanted).max()))


def check_mirrored(run: Drawn, **changes: object) -> None:
    n = len(run.q0)
    one, image = (at_fifths(x, **changes) for x in (run, symmetries.left_to_right(run)))
    check_near(np.pi - image[:n], one[:n])
    check_near(-image[n:], one[n:])


@pytest.mark.few_cases
@every_method
@given(run=motions())
def test_left_to_right_is_the_mirrored_motion(method: str, run: Drawn) -> None:
    check_mirrored(run, method=method)


@pytest.mark.parametrize("seed", range(100))
def test_left_to_right_impacts_and_contact_are_the_mirrored_ones(method: str, seed: int) -> None:
    """The motions are the same each time, because one in thousands meets two stops within rounding.

    The impact that comes first then decides what follows, and the mirror image may round otherwise.
    """
    check_mirrored(drawn_motions.stopped_motion_of_seed(f"stopped/{seed}"), method=method)


@pytest.mark.few_cases
@every_method
@given(run=motions())
def test_a_turn_more_in_every_angle_is_the_same_motion(method: str, run: Drawn) -> None:
    n = len(run.q0)
    one, turned = (at_fifths(x, method=method) for x in (run, symmetries.turned_once(run)))
    check_near(turned[:n] - 2 * np.pi, one[:n])
    check_near(turned[n:], one[n:])


@pytest.mark.few_cases
@every_method
@given(run=motions(UNDAMPED))
def test_there_and_back_is_where_it_began(method: str, run: Drawn) -> None:
    there = run.simulate(method=method)
    assert there.status == "finished", there.message
    q, qd = np.split(there._run.y_reached, 2)
    back = Drawn(run.scene, q, qd, run.t_span[::-1], run.options).simulate(method=method)
    check_near(back._run.y_reached, [*run.q0, *run.qd0])


@pytest.mark.few_cases
@every_method
@given(run=motions(sorted(MIRRORED - {"lock"})))
def test_effects_of_no_strength_are_as_good_as_absent(method: str, run: Drawn) -> None:
    idle = [symmetries.without_strength(effect) for effect in run.scene.effects]
    with_idle, bare = (replace(run, scene=with_effects(run.scene, some)) for some in (idle, []))
    check_near(at_fifths(with_idle, method=method), at_fifths(bare, method=method))
