"""Values that are allowed but look wrong give a warning with the reason, at the user's line."""

from __future__ import annotations

import pickle
import warnings

import numpy as np
import pendcore as pc
import pytest
from hypothesis import given, reject
from hypothesis import strategies as st
from pendcore import effects as fx

ROD = pc.Link(mass=1.0, length=1.0)
SCENE = pc.Scene(links=[ROD, ROD])
TABLE = fx.Table([0.0, 1.0], [0.0, 1.0])
SPLINE = fx.Spline([0.5, 1.0], [0.0, 1.0], [0.0, 0.0])

SCENES = {
    "inertia of no mass within the link": (
        [pc.Link(mass=1, length=1, inertia=0.5)],
        [],
        r"link 1: inertia = 0\.5: no mass between its joints has more than .* = 0\.25 kg m\^2",
    ),
    "mass in grams": (
        [ROD, pc.Link(mass=200.0, length=0.05)],
        [],
        r"link 2: mass = 200\.0: a cube of osmium .* has .* kg: is the mass in g",
    ),
    "mass centre beyond the link": (
        [pc.Link(mass=1, length=1, center=1.5)],
        [],
        r"link 1: center = 1\.5: is not between the joints, 0 to 1\.0 m",
    ),
    "damping that feeds": (
        [ROD],
        [fx.Payload(1.0), fx.ViscousJoint(1, 0.1, damping3=-0.1)],
        r"effect 2 \(viscous_joint\): a negative damping coefficient feeds",
    ),
    "a lock in degrees": (
        [ROD],
        [fx.Lock(1, angle=90)],
        r"effect 1 \(lock\): angle = 90\.0 rad: that is 5157 degrees: angles are in radians",
    ),
    "a stop in degrees": (
        [ROD],
        [fx.JointStop(1, range=(0.0, 90.0))],
        r"effect 1 \(joint_stop\): range = 90\.0 rad: .* in radians",
    ),
    "a spring in degrees": (
        [ROD],
        [fx.Payload(1.0), fx.TorsionalSpring(1, 1.0, rest_angle=-15)],
        r"effect 2 \(torsional_spring\): rest_angle = -15\.0 rad: .* in radians",
    ),
    "a controller in degrees": (
        [ROD],
        [fx.Motor(1, pd=fx.PD(40, 2, reference=720))],
        r"effect 1 \(motor\): pd\.reference = 720\.0 rad: .* in radians",
    ),
}
RUNS = {
    "degrees": (
        [],
        {"q0": [45, 60]},
        r"q0\[0\] = 45\.0 rad: that is 2578 degrees: angles are in radians",
    ),
    "degrees, one of them zero": ([], {"q0": [0, -90]}, r"q0\[1\] = -90\.0 rad: .* in radians"),
    "degrees, small ones": ([], {"q0": [5, 15]}, r"q0\[1\] = 15\.0 rad: .* in radians"),
    "degrees, two turns": ([], {"q0": 720}, r"q0\[0\] = 720\.0 rad: .* in radians"),
    "a table that ends before the run": (
        [fx.Motor(1, table=TABLE)],
        {"t_span": (0, 2)},
        r"effect 1 \(motor\): its table goes from 0\.0 to 1\.0 s, the run from 0\.0 to 2\.0 s",
    ),
    "a table that begins after the run": (
        [fx.Payload(1), fx.DrivenPivot(spline=SPLINE)],
        {"t_span": (0, 1)},
        r"effect 2 \(driven_pivot\): its spline goes from 0\.5 to 1\.0 s, the run from 0\.0",
    ),
}


@pytest.mark.parametrize("case", SCENES)
def test_an_implausible_scene_is_warned_of_where_it_is_made(case):
    links, effects, message = SCENES[case]
    with pytest.warns(pc.PendcoreWarning, match=f"^{message}") as caught:
        scene = pc.Scene(links=links, effects=effects)
    assert [warning.filename for warning in caught] == [__file__]
    with pytest.warns(pc.PendcoreWarning, match=f"^{message}") as caught:
        scene.replace(gravity=1.0)
    assert [warning.filename for warning in caught] == [__file__]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert pickle.loads(pickle.dumps(scene)) == scene  # it was warned of when made


@pytest.mark.parametrize("case", RUNS)
def test_an_implausible_run_is_warned_of_where_it_is_asked_for(case):
    effects, asked, message = RUNS[case]
    scene = SCENE.replace(effects=effects)
    given = {"q0": [0.5, 1.0], "t_span": (0, 1), **asked}
    with pytest.warns(pc.PendcoreWarning, match=f"^{message}") as caught:
        run = pc.simulate(scene, **given, on_failure="ignore")
    assert [warning.filename for warning in caught] == [__file__]
    assert run is not None
    case = pc.Case(scene=scene, **given)
    with pytest.warns(pc.PendcoreWarning, match=f"^{message}") as caught:
        case.simulate(on_failure="ignore")
    assert [warning.filename for warning in caught] == [__file__]


def test_a_warning_that_is_an_error_stops_the_run_before_it_begins():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(pc.PendcoreWarning, match=r"^q0\[0\] = 45"):
            pc.simulate(SCENE, q0=[45, 60], t_span=(0, 1e9))


@pytest.mark.parametrize(
    ("effects", "asked"),
    [
        ([], {"q0": [9, -9]}),
        ([], {"q0": [10, -10]}),  # three half turns on
        ([], {"q0": [16, 22]}),
        ([], {"q0": [45.5, 60]}),
        ([], {"q0": [45, 1.2]}),
        ([], {"q0": [45, 1000]}),  # after many turns
        ([], {"q0": 1e6}),
        ([], {"q0": 12.566370614359172}),
        ([fx.Motor(1, table=TABLE)], {"t_span": (0, 1)}),
        ([fx.Motor(1, table=TABLE)], {"t_span": (1, 0)}),
        ([fx.Motor(1, sinusoid=fx.Sinusoid(1, 1))], {"t_span": (-5, 5)}),
    ],
)
def test_what_may_well_be_meant_is_not_warned_of(effects, asked):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        given = {"q0": [0.5, 1.0], "t_span": (0, 1), **asked}
        assert pc.simulate(SCENE.replace(effects=effects), **given).success


@pytest.mark.parametrize("angle", [0.0, 10.0, -10.0, 16.0, 725.0, 12.566370614359172])
def test_angles_of_effects_that_may_well_be_meant_are_not_warned_of(angle):
    pd = fx.PD(40, 2, reference=angle)
    effects = [fx.Lock(1, angle=angle), fx.TorsionalSpring(2, 1.0, angle), fx.Motor(2, pd=pd)]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert len(SCENE.replace(effects=effects).effects) == 3


def test_a_run_under_a_table_ends_where_that_does():
    scene = SCENE.replace(effects=[fx.Motor(1, table=TABLE)])
    with pytest.warns(pc.PendcoreWarning):
        run = pc.simulate(scene, q0=[0.5, 1.0], t_span=(0, 2))
    assert run.t[-1] == 1.0
    assert not run.success
    assert "table" in run.message


POINT = pc.Link.point_mass(mass=1.0, length=1.0)
EMPTY = pc.Link(mass=0.0, length=1.0)
AT_THE_JOINT = pc.Link(mass=1.0, length=1.0, center=0.0, inertia=0.0)
NEITHER = "has neither mass nor inertia about its joint: the mass matrix is singular when it lines"
SINGULAR = {
    "a mass in its joint": (
        [AT_THE_JOINT],
        [],
        "link 1: inertia about its joint, with what it carries",
    ),
    "a mass in the last joint": ([EMPTY, AT_THE_JOINT], [], "link 2: inertia about its joint"),
    "nothing at all": ([ROD, EMPTY], [], "link 2: mass = 0.0: must be finite and > 0 .kg."),
    "a point on a massless link": ([EMPTY, POINT], [], f"link 1: {NEITHER} up with link 2"),
    "the same further out": ([ROD, EMPTY, POINT], [], f"link 2: {NEITHER}"),
    "massless links in a row": ([EMPTY, EMPTY, ROD], [], f"link 1: {NEITHER}"),
    "a payload on two": ([EMPTY, EMPTY], [fx.Payload(1.0)], f"link 1: {NEITHER}"),
    "a stop that is passed": ([EMPTY, POINT], [fx.JointStop(2, (-1, 1))], f"link 1: {NEITHER}"),
    "friction holds for a while": (
        [EMPTY, POINT],
        [fx.DryJointFriction(2, 1e9)],
        f"link 1: {NEITHER}",
    ),
    "a lock before": ([ROD, EMPTY, POINT], [fx.Lock(1)], f"link 2: {NEITHER}"),
    "beyond a lock that takes the start": ([EMPTY, POINT, EMPTY], [fx.Lock(2)], "link 3: mass ="),
    "a mass that a lock folds into the joint": (
        [EMPTY, POINT],
        [fx.Lock(2, np.pi)],
        "link 1: inertia about its joint",
    ),
    "a rotor between links as long": (
        [EMPTY, POINT],
        [fx.RotorInertia(2, 0.3)],
        f"link 1: {NEITHER}",
    ),
}


@pytest.mark.parametrize("case", SINGULAR)
def test_a_mass_matrix_that_is_not_positive_definite_is_refused_by_link_and_reason(case):
    links, effects, message = SINGULAR[case]
    with pytest.raises(ValueError, match=f"^{message}.*Link.point_mass"):
        pc.Scene(links=links, effects=effects)


heavy = st.builds(
    pc.Link,
    mass=st.just(1.0),
    length=st.just(1.0),
    center=st.sampled_from([0.0, 0.5, 1.0]),
    inertia=st.sampled_from([0.0, 0.05]),
)


@given(
    st.lists(
        heavy | st.just(EMPTY),
        min_size=1,
        max_size=4,
    ),
    st.lists(st.sampled_from([0.3, 0.3 + np.pi, 1.7]), min_size=4, max_size=4),
)
@pytest.mark.filterwarnings("ignore::pendcore.PendcoreWarning")
def test_what_is_accepted_has_a_positive_definite_mass_matrix_also_lined_up(links, q):
    try:
        scene = pc.Scene(links=links)
    except ValueError:
        reject()
    assert np.linalg.eigvalsh(scene.mass_matrix(q[: len(links)]))[0] > 1e-4
