"""Values that are allowed but look wrong give a warning with the reason, at the user's line."""

from __future__ import annotations

import pickle
import warnings
from contextlib import contextmanager

import pendcore as pc
import pytest
from pendcore import effects as fx

ROD = pc.Link(mass=1.0, length=1.0)
SCENE = pc.Scene(links=[ROD, ROD])
TABLE = fx.Motor(1, table=fx.Table([0.0, 1.0], [0.0, 1.0]))
SPLINE = fx.DrivenPivot(spline=fx.Spline([0.5, 1.0], [0.0, 1.0], [0.0, 0.0]))
WAVE = fx.Motor(1, sinusoid=fx.Sinusoid(1, 1))

SCENES = {
    "inertia of no mass within the link": (
        {"links": [pc.Link(mass=1, length=1, inertia=0.5)]},
        r"link 1: inertia = 0\.5: no mass between its joints has more than .* = 0\.25 kg m\^2"),
    "inertia about another mass centre": (
        {"links": [ROD, pc.Link(mass=1, length=1, center=0.4, inertia=0.26)]},
        r"link 2: inertia = 0\.26: .* = 0\.24 kg"),
    "mass in grams": (
        {"links": [ROD, pc.Link(mass=200.0, length=0.05)]},
        r"link 2: mass = 200\.0: a cube of osmium .* has .* kg: is the mass in g"),
    "mass centre beyond the link": (
        {"links": [pc.Link(mass=1, length=1, center=1.5)]},
        r"link 1: center = 1\.5: is not between the joints, 0 to 1\.0 m"),
    "damping that feeds": (
        {"effects": [fx.Payload(1.0), fx.ViscousJoint(1, 0.1, damping3=-0.1)]},
        r"effect 2 \(viscous_joint\): a negative damping coefficient feeds"),
    "a lock in degrees": (
        {"effects": [fx.Lock(1, angle=90)]},
        r"effect 1 \(lock\): angle = 90\.0 rad: that is 5157 degrees: angles are in radians"),
    "a stop in degrees": (
        {"effects": [fx.JointStop(1, range=(0.0, 90.0))]},
        r"effect 1 \(joint_stop\): range = 90\.0 rad: .* in radians"),
    "a spring in degrees": (
        {"effects": [fx.Payload(1.0), fx.TorsionalSpring(1, 1.0, rest_angle=-15)]},
        r"effect 2 \(torsional_spring\): rest_angle = -15\.0 rad: .* in radians"),
    "a controller in degrees": (
        {"effects": [fx.Motor(1, pd=fx.PD(40, 2, reference=720))]},
        r"effect 1 \(motor\): pd\.reference = 720\.0 rad: .* in radians"),
}  # fmt: skip
RUNS = {
    "degrees": ({"q0": [45, 60]}, [],
        r"q0\[0\] = 45\.0 rad: that is 2578 degrees: angles are in radians"),
    "degrees, one of them zero": ({"q0": [0, -90]}, [], r"q0\[1\] = -90\.0 rad: .* in radians"),
    "degrees, small ones": ({"q0": [5, 15]}, [], r"q0\[1\] = 15\.0 rad: .* in radians"),
    "degrees, two turns": ({"q0": 720}, [], r"q0\[0\] = 720\.0 rad: .* in radians"),
    "a table that ends before the run": ({"t_span": (0, 2)}, [TABLE],
        r"effect 1 \(motor\): its table goes from 0\.0 to 1\.0 s, the run from 0\.0 to 2\.0 s"),
    "a table that begins after the run": ({"t_span": (0, 1)}, [fx.Payload(1), SPLINE],
        r"effect 2 \(driven_pivot\): its spline goes from 0\.5 to 1\.0 s, the run from 0\.0"),
}  # fmt: skip


@contextmanager
def warned(message: str):
    """Expect one warning, at a line of this file."""
    with pytest.warns(pc.PendcoreWarning, match=f"^{message}") as caught:
        yield
    assert [warning.filename for warning in caught] == [__file__]


@contextmanager
def not_warned():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        yield


@pytest.mark.parametrize("case", SCENES)
def test_an_implausible_scene_is_warned_of_where_it_is_made(case):
    described, message = SCENES[case]
    with warned(message):
        scene = pc.Scene(**{"links": [ROD], **described})
    with warned(message):
        scene.replace(gravity=1.0)
    with not_warned():
        assert pickle.loads(pickle.dumps(scene)) == scene  # it was warned of when made


@pytest.mark.parametrize("case", RUNS)
def test_an_implausible_run_is_warned_of_where_it_is_asked_for(case):
    asked, effects, message = RUNS[case]
    asked = {"q0": [0.5, 1.0], "t_span": (0, 1), **asked}
    scene = SCENE.replace(effects=effects)
    with warned(message):
        pc.simulate(scene, **asked, on_failure="ignore")
    described = pc.Case(scene=scene, **asked)
    with warned(message):
        described.simulate(on_failure="ignore")
    with not_warned(), pytest.raises(pc.PendcoreWarning):  # an error stops it before it begins
        pc.simulate(scene, **asked, max_step=1e-9)


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
        ([TABLE], {"t_span": (0, 1)}),
        ([TABLE], {"t_span": (1, 0)}),
        ([WAVE], {"t_span": (-5, 5)}),
    ],
)
def test_what_may_well_be_meant_is_not_warned_of(effects, asked):
    with not_warned():
        asked = {"q0": [0.5, 1.0], "t_span": (0, 1), **asked}
        assert pc.simulate(SCENE.replace(effects=effects), **asked).success


def test_as_much_inertia_as_a_mass_may_have_and_none_at_all_are_not_warned_of():
    with not_warned():
        pc.Scene(links=[ROD, pc.Link(mass=1, length=1, inertia=0.25)])
        pc.Scene(links=[ROD, pc.Link(mass=1e-3, length=10, center=0.1, inertia=0)])
        pc.Scene(links=[ROD, pc.Link.point_mass(mass=1, length=0.1)])


@pytest.mark.parametrize("angle", [0.0, 10.0, -10.0, 16.0, 725.0, 12.566370614359172])
def test_angles_of_effects_that_may_well_be_meant_are_not_warned_of(angle):
    servo = fx.Motor(2, pd=fx.PD(40, 2, reference=angle))
    with not_warned():
        SCENE.replace(effects=[fx.Lock(1, angle), fx.TorsionalSpring(2, 1.0, angle), servo])


def test_a_run_under_a_table_ends_where_that_does():
    with pytest.warns(pc.PendcoreWarning):
        run = pc.simulate(SCENE.replace(effects=[TABLE]), q0=[0.5, 1.0], t_span=(0, 2))
    assert run.t[-1] == 1.0
    assert not run.success
    assert "table" in run.message
