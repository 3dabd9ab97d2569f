"""Misspelled names and wrong kinds of objects are refused with a hint at what is meant."""

from __future__ import annotations

import inspect

import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx

ROD = pc.Link(mass=1.0, length=1.0)
SCENE = pc.Scene(links=[ROD])


@pytest.mark.parametrize(
    ("option", "message"),
    [
        ({"rtoll": 1e-6}, "simulate has no argument 'rtoll': did you mean 'rtol'?"),
        ({"tspan": (0, 1)}, "simulate has no argument 'tspan': did you mean 't_span'?"),
        ({"tend": 3}, "simulate has no argument 'tend': did you mean 't_span'?"),
        ({"xyzzy": 1}, "simulate has no argument 'xyzzy': known are scene, t_span, q0, qd0, "),
    ],
)
def test_a_misspelled_option_is_met_with_the_one_that_is_meant(option, message):
    with pytest.raises(TypeError) as caught:
        pc.simulate(SCENE, (0, 1), 1.0, **option)
    assert str(caught.value).startswith(message)


def test_what_a_run_needs_must_be_given():
    for incomplete in (lambda: pc.simulate(SCENE), lambda: pc.simulate(SCENE, (0, 1))):
        with pytest.raises(TypeError, match=r"simulate\(\) missing .* required .*'q0'"):
            incomplete()


def test_signatures_and_documentation_stay():
    assert [*inspect.signature(pc.simulate).parameters][:4] == ["scene", "t_span", "q0", "qd0"]
    assert [*inspect.signature(pc.Link).parameters] == ["mass", "length", "center", "inertia"]
    assert (pc.simulate.__doc__ or "").startswith("Solve the equations of motion")


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (
            {"links": [ROD], "effects": [fx.ViscousJoint]},
            "effect 1 = ViscousJoint: must be a pendcore.effects object, such as "
            "ViscousJoint(joint=1, damping=0.1); got the class itself",
        ),
        (
            {"links": [ROD, pc.Link]},
            "link 2 = Link: must be a pendcore.Link object, such as "
            "Link(mass=1.0, length=1.0); got the class itself",
        ),
    ],
    ids=["effect", "link"],
)
def test_a_class_in_place_of_an_object_is_told_apart(given, message):
    with pytest.raises(TypeError) as caught:
        pc.Scene(**given)
    assert str(caught.value) == message


@pytest.mark.parametrize("joint", [0, -3])
def test_a_number_of_a_joint_is_told_as_a_whole_number(joint):
    with pytest.raises(ValueError, match=rf"joint = {joint}: must be a whole number, 1 or more$"):
        fx.ViscousJoint(joint=joint, damping=0.1)


def test_a_start_off_its_lock_is_told_by_the_locks_name():
    scene = pc.Scene(links=[ROD, ROD], effects=[fx.Lock(2, angle=0.0)])
    said = r"^q0: angle of joint 2 = 0\.5: must be 0\.0 rad, as effect 1 \(lock\) says: start there"
    with pytest.raises(ValueError, match=said):
        pc.simulate(scene, q0=[0.5, 1.0], t_span=(0, 1))


def test_an_entry_that_the_ledger_has_not_is_told_with_those_that_it_has():
    scene = SCENE.replace(effects=[fx.ViscousJoint(1, 0.1)])
    ledger = pc.simulate(scene, q0=1.0, t_span=(0, 1), ledger=True).energy().ledger
    message = "the ledger has no entry 'viscos': it has viscous, residual"
    with pytest.raises(KeyError, match=message):
        ledger["viscos"]
    with pytest.raises(AttributeError, match=message):
        _ = ledger.viscos
    assert "viscos" not in ledger
    assert ledger.get("viscos") is None


def test_a_run_under_a_function_is_not_saved_and_says_how_to_keep_its_numbers(tmp_path):
    scene = SCENE.replace(effects=[fx.User(lambda t, q, qd: 0 * q)])
    sol = pc.simulate(scene, q0=1.0, t_span=(0, 1))
    with pytest.raises(TypeError, match=r"cannot be saved: .*sol\.to_pandas\(\) or numpy\.savez\("):
        sol.save(tmp_path / "run.npz")
    assert [*tmp_path.iterdir()] == []
    np.savez(tmp_path / "run.npz", t=sol.t, y=sol.y)  # as it says
