"""The contenders of the comparison solve the case that they are given, and no other."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "bench" / "compare"))

import contenders
import stiff
from cases import read_case
from contenders.contender import Unsupported
from contenders.equations import fill, jacobian, rates
from contenders.pendcore_python import scene_of
from contenders.programs import end_conversations
from dense_chain import DenseChain, joints
from trajectory_error import position_error

BARE, DAMPED, THREE = (read_case(name) for name in ("textbook", "damped_textbook", "three_links"))
LOADED = replace(BARE, damping=(0.3, 2.0), stiffness=(5.0, 11.0), rest=(0.2, -0.4))
CASES = {
    "bare": BARE,
    "damped": DAMPED,
    "loaded": LOADED,
    "controller": replace(LOADED, controller=True),
    "three": THREE,
}
# All are right to a thousandth of the length at a middling setting, so all have the same case.
SETTINGS = {"tolerance": 1e-7, "step": 2e-3}


def dense(case, y):
    """Solve the equations of motion of uniform rods as a linear system: (qd, qdd)."""
    masses, lengths = np.array(case.masses), np.array(case.lengths)
    chain = DenseChain(masses=masses, lengths=lengths, gravity=case.gravity)
    q, qd = np.split(y, 2)
    turned, turning = joints(case.n) @ q, joints(case.n) @ qd
    torques = -np.array(case.stiffness) * (turned - case.rest) - np.array(case.damping) * turning
    qdd = np.linalg.solve(chain.mass_matrix(q), chain.forces(q, qd, torques))
    return np.concatenate([qd, qdd])


@pytest.mark.parametrize("name", CASES)
def test_right_hand_sides_and_jacobians_are_those_of_the_equations_of_motion(name):
    case = CASES[name]
    scene, filled, derivatives = scene_of(case), fill(case, lambda x: x), jacobian(case)
    assert (name == "controller") == all(type(x).__name__ == "Motor" for x in scene.effects or [0])
    out = np.empty(2 * case.n)
    for y in np.random.default_rng(7).uniform(-4, 4, (20, 2 * case.n)):
        expected = dense(case, y)
        filled(out, y)
        np.testing.assert_allclose(rates(case)(0.0, y), expected, rtol=1e-11)
        np.testing.assert_allclose(out, expected, rtol=1e-11)
        core = scene.accelerations(0.0, y[: case.n], y[case.n :])
        np.testing.assert_allclose(core, expected[case.n :], rtol=1e-11)
    assert (derivatives is None) == (case.n == 3)
    for y in np.random.default_rng(8).uniform(-2, 2, (5, 4)) if derivatives else ():
        differences = [
            (dense(case, y + step) - dense(case, y - step)) / 2e-6 for step in 1e-6 * np.eye(4)
        ]
        np.testing.assert_allclose(derivatives(0.0, y), np.transpose(differences), atol=1e-6)


@pytest.mark.parametrize(
    "case",
    [
        replace(BARE, masses=(1.0, 2.0)),
        replace(BARE, lengths=(1.0, 0.5)),
        replace(BARE, gravity=9.81),
        replace(THREE, damping=(0.1, 0.0, 0.0)),
        read_case("single_rod"),
    ],
    ids=["masses", "lengths", "gravity", "damped three", "one rod"],
)
def test_a_case_that_no_closed_form_is_of_is_refused(case):
    with pytest.raises(Unsupported):
        rates(case)


@pytest.fixture(scope="module")
def found():
    """Return all contenders that are installed: at least pendcore's own."""
    entrants, _ = contenders.installed()
    assert any(who.name == "pendcore_dopri5" for who in entrants)
    yield {who.name: who for who in entrants}
    end_conversations()


@pytest.mark.outside_build
@pytest.mark.parametrize("name", ["bare", "damped", "three"])
def test_every_contender_solves_the_case_that_it_is_given(found, name):
    case = CASES[name]
    n, lengths = case.n, np.array(case.lengths)
    for who in found.values():
        states = who.prepare(case, SETTINGS[who.setting]).outcome().states
        assert states.shape == case.reference.shape, who.name
        np.testing.assert_allclose(states[0], case.start, atol=1e-14, err_msg=who.name)
        assert position_error(states[:, :n], case.reference[:, :n], lengths) < 1e-3, who.name
        last, known = states[-1, n:], case.reference[-1, n:]
        np.testing.assert_allclose(last, known, atol=2e-2, err_msg=who.name)


@pytest.mark.outside_build
@pytest.mark.parametrize("name", stiff.LOADS)
def test_contenders_of_stiff_scenes_solve_them(found, name):
    case = stiff.read_scene(name)
    assert case.uncertainty < 1e-9  # better known than what is compared
    implicit = [
        who
        for who in found.values()
        if stiff.takes_part(who.name) and "dopri5" not in who.name and "scipy" not in who.name
    ]
    assert len(implicit) >= 2
    for who in implicit:
        states = who.prepare(case, 1e-5).outcome().states
        assert position_error(states[:, :2], case.reference[:, :2], np.ones(2)) < 2e-3, who.name


@pytest.mark.outside_build
@pytest.mark.parametrize("order", [3, 12, 20])
def test_heyokas_tolerances_are_one_for_each_order(order):
    heyoka = pytest.importorskip("heyoka")
    from contenders.heyoka_taylor import system, tolerance_of

    orders = [
        heyoka.taylor_adaptive(system(BARE), BARE.start, tol=tolerance).order
        for tolerance in (tolerance_of(order), tolerance_of(order) * (1 - 1e-6))
    ]
    assert orders == [order, order + 1]


@pytest.mark.outside_build
def test_a_failed_run_says_why(found):
    for name in found.keys() & {"pendcore_dopri5", "pendcore_dopri5_cpp"}:
        with pytest.raises(RuntimeError, match="the step fell below"):
            found[name].prepare(read_case("high_energy"), 1e-1).outcome()


@pytest.mark.outside_build
def test_one_that_is_missing_is_named_and_the_others_are_there(monkeypatch, tmp_path):
    monkeypatch.setenv("SOLVES_ODEINT", str(tmp_path / "nowhere"))
    monkeypatch.setitem(sys.modules, "contenders.heyoka_taylor", None)
    present, absent = contenders.installed()
    assert "not built" in absent["solves_odeint"]
    assert "heyoka_taylor" in absent
    names = {who.name for who in present}
    assert "pendcore_dopri5" in names
    assert not any(name.startswith(("odeint", "heyoka")) for name in names)


@pytest.mark.outside_build
def test_narrower_instructions_are_labelled_so_and_give_the_same_bits(found):
    wide = {name: who for name, who in found.items() if ", x86-64-v4, " in who.about}
    narrow = {name: who for name, who in found.items() if name.endswith("_v3")}
    assert {f"{name}_v3" for name in wide} == narrow.keys()
    for name, who in wide.items():
        held_back = narrow[f"{name}_v3"]
        assert "(x86-64-v3)" in held_back.label
        assert ", x86-64-v3, " in held_back.about
        both = (each.prepare(BARE, SETTINGS[who.setting]).outcome() for each in (who, held_back))
        np.testing.assert_array_equal(*(outcome.states for outcome in both), err_msg=name)
