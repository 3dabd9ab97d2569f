"""Misspelled names and wrong kinds of objects are refused with a hint at what is meant."""

from __future__ import annotations

import inspect

import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx

ROD = pc.Link(mass=1.0, length=1.0)
SCENE = pc.Scene(links=[ROD])
MISSPELLED = {
    "link": (lambda: pc.Link(mas=1.0, length=1.0), "Link: has no parameter 'mas': did you mean 'm"),
    "point mass": (
        lambda: pc.Link.point_mass(mass=1.0, lenght=1.0),
        "Link.point_mass: has no parameter 'lenght': did you mean 'length'?",
    ),
    "link replaced": (
        lambda: ROD.replace(centre=0.2),
        "Link: has no parameter 'centre': did you mean 'center'?",
    ),
    "scene": (
        lambda: pc.Scene(links=[ROD], effect=[]),
        "Scene: has no parameter 'effect': did you mean 'effects'?",
    ),
    "scene replaced": (
        lambda: SCENE.replace(gravty=1.0),
        "Scene.replace: has no parameter 'gravty': did you mean 'gravity'?",
    ),
    "run": (
        lambda: pc.simulate(SCENE, q0=1.0, tspan=(0, 1)),
        "simulate: has no parameter 'tspan': did you mean 't_span'?",
    ),
    "run, the end alone": (
        lambda: pc.simulate(SCENE, q0=1.0, tend=3),
        "simulate: has no parameter 'tend': did you mean 't_span'?",
    ),
    "run, the end alone, in other words": (
        lambda: pc.simulate(SCENE, q0=1.0, tmax=3),
        "simulate: has no parameter 'tmax': did you mean 't_span'?",
    ),
    "run, nothing near": (
        lambda: pc.simulate(SCENE, q0=1.0, t_span=(0, 1), xyzzy=1),
        "simulate: has no parameter 'xyzzy': known are scene, q0, qd0, t_span, method, rtol",
    ),
    "event": (
        lambda: pc.events.JointAngle(joint=1, val=0.0),
        "JointAngle: has no parameter 'val': did you mean 'value'?",
    ),
    "a method of none": (
        lambda: pc.simulate(SCENE, q0=1.0, t_span=(0, 1)).reactions(joint=1),
        "Solution.reactions: has no parameter 'joint': there are none",
    ),
    "a method of none, by place": (
        lambda: pc.simulate(SCENE, q0=1.0, t_span=(0, 1)).reactions(1),
        "Solution.reactions: takes nothing: Solution.reactions()",
    ),
    "explanation": (lambda: SCENE.explain(q0=1.0), "Scene.explain: has no parameter 'q0'"),
}


@pytest.mark.parametrize("case", MISSPELLED)
def test_a_misspelled_keyword_is_met_with_the_one_that_is_meant(case):
    call, message = MISSPELLED[case]
    with pytest.raises(TypeError) as caught:
        call()
    assert str(caught.value).startswith(message)


def test_signatures_and_documentation_stay():
    assert [*inspect.signature(pc.simulate).parameters][:4] == ["scene", "q0", "qd0", "t_span"]
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
