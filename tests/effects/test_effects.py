"""The classes of effects have what their descriptions promise, and say in words what is wrong."""

from __future__ import annotations

import copy
import inspect
from dataclasses import FrozenInstanceError
from fractions import Fraction

import numpy as np
import pendcore as pc
import pytest
from pendcore import _core
from pendcore import effects as fx

CLASSES = {**fx.kinds()}
SINE = fx.Sinusoid(amplitude=1.0, angular_frequency=6.0)


def test_every_kind_of_the_core_has_its_class_under_its_names():
    told = _core.effect_descriptors()
    assert [*CLASSES] == [row["kind"] for row in told] + ["user"]
    for row in told:
        assert CLASSES[row["kind"]] is getattr(fx, row["name"])
        assert CLASSES[row["kind"]].kind == row["kind"]
    fx.kinds().clear()  # a copy
    assert fx.kinds() == CLASSES


@pytest.mark.parametrize(
    ("name", "remedy"),
    [
        ("ViscusJoint", r"did you mean 'ViscousJoint'\?"),
        ("torsional_spring", r"did you mean 'TorsionalSpring'\?"),
        ("Xyz", r"known are PD, CompiledUser, "),
    ],
)
def test_an_unknown_effect_is_told_with_the_nearest_known_one(name, remedy):
    with pytest.raises(AttributeError, match=rf"^pendcore\.effects has no '{name}': {remedy}"):
        getattr(fx, name)
    assert not hasattr(fx, "__path__")


@pytest.mark.parametrize("kind", CLASSES)
def test_a_class_shows_its_parameters_in_signature_docstring_and_match_args(kind):
    cls = CLASSES[kind]
    names = [parameter.name for parameter in cls.description.parameters]
    signature = inspect.signature(cls)
    assert [*signature.parameters] == names == [*cls.__match_args__]
    assert cls.__module__ == "pendcore.effects"
    assert "\nRaises\n------\nValueError, TypeError\n" in cls.__doc__
    for parameter in cls.description.parameters:
        assert f"\n{parameter.name} : " in cls.__doc__
        argument = signature.parameters[parameter.name]
        assert (argument.default is argument.empty) == parameter.required


def test_values_come_by_place_or_by_name():
    effect = fx.ViscousJoint(1, 0.1, damping3=0.2)
    assert effect == fx.ViscousJoint(joint=1, damping=0.1, damping2=0.0, damping3=0.2)
    match effect:
        case fx.ViscousJoint(joint, damping):
            assert (joint, damping) == (1, 0.1)


@pytest.mark.parametrize(
    "number", [2, 2.0, np.float32(2), np.int8(2), Fraction(2), np.longdouble(2)]
)
def test_any_real_number_is_kept_as_a_float(number):
    effect = fx.TorsionalSpring(joint=np.int64(1), stiffness=number)
    assert (effect.joint, effect.stiffness) == (1, 2.0)
    assert (type(effect.joint), type(effect.stiffness)) == (int, float)


@pytest.mark.parametrize("make", [list, tuple, np.array])
def test_arrays_are_kept_as_tuples_of_floats(make):
    table = fx.Table(t=make([0, 1, 2]), torque=make([1, 2, 3]))
    assert (table.t, table.torque) == ((0.0, 1.0, 2.0), (1.0, 2.0, 3.0))
    assert fx.RodDrag(1, 1.2, 0.1, wind=make([1, 2])).wind == (1.0, 2.0)


def test_repr_shows_what_is_not_as_by_default_and_nothing_else():
    assert repr(fx.ViscousJoint(1, 0.0)) == "ViscousJoint(joint=1, damping=0.0)"
    assert repr(fx.Motor(joint=2, sinusoid=SINE, limit=np.inf)) == (
        "Motor(joint=2, sinusoid=Sinusoid(amplitude=1.0, angular_frequency=6.0))"
    )


def test_an_effect_cannot_be_changed_and_can_be_varied():
    effect = fx.Motor(joint=1, sinusoid=SINE)
    with pytest.raises(FrozenInstanceError):
        effect.joint = 2
    with pytest.raises((FrozenInstanceError, TypeError, AttributeError)):
        effect.color = "red"
    assert effect.replace(joint=2).replace(joint=1) == copy.copy(effect) == effect
    assert effect.replace(sinusoid=None, constant=2.0) == fx.Motor(joint=1, constant=2.0)
    with pytest.raises(TypeError, match="'joints'"):
        effect.replace(joints=3)
    others = [fx.ViscousJoint(1, 0.1), fx.ViscousJoint(2, 0.1), fx.TorsionalSpring(1, 0.1)]
    assert len({*others}) == len({*map(repr, others)}) == 3


VALUES = {
    "ViscousJoint(joint=1, damping=nan)": r"damping = nan: must be finite \(N m s/rad\)",
    "RotorInertia(1, armature=-1)": r"armature = -1\.0: must be finite and >= 0 \(kg m\^2\)",
    "DryJointFriction(1, 1, stribeck_velocity=0)":
        r"stribeck_velocity = 0\.0: must be finite and > 0 \(rad/s\)",
    "DryJointFriction(1, 1, exponent=0.5)": r"exponent = 0\.5: must be finite and >= 1$",
    "DryJointFriction(1, 2, static=1)": r"static = 1\.0: must be at least coulomb = 2\.0 \(N m\)",
    "Motor(1, constant=1, limit=nan)": r"limit = nan: must be > 0, inf for no limit \(N m\)",
    "Table(t=[0, 1], torque=[1, nan])": r"torque\[1\] = nan: must be finite \(N m\)",
    "RodDrag(1, 1, 1, wind=(inf, 0))": r"wind\[0\] = inf: must be finite \(m/s\)",
    "RodDrag(1, 1, 1, wind=3.0)": r"wind: shape \(\): must be \(2,\), 2 numbers \(m/s\)",
    "Table(t=[[0, 1]], torque=[1, 2])": r"t: shape \(1, 2\): must be \(k,\) \(s\)",
    "Table(t=[0, 1, 0.5], torque=[1, 2, 3])":
        r"t\[2\] = 0\.5: must be above the time before, 1\.0 \(s\)$",
    "Table([0, 1, 1, 2], [0, 1, 2, 3], hold=True)":
        r"t\[2\] = 1.0: must be above the time before, 1.0 \(s\): with hold = ",
    "Table([0, 1, 1, 1, 2], [0, 1, 2, 3, 4])":
        r"t\[3\] = 1.0: must be above .*: a time may stand twice, for a step",
    "Table([0, 0, 1], [0, 1, 2])": r"t\[1\] = 0.0: must .* between",
    "Table([0, 1, 1], [0, 1, 2])": r"t\[2\] = 1.0: must .* between",
    "Spline([0, 1, 1], [0, 0, 0], [0, 0, 0])": r"t\[2\] = 1.0: must be above",
    "Spline([0], [0], [0])": r"t: has 1 time",
    "Spline([0, 1], [0, 1], [0])": r"y: has 1 number.*must have 2, one for each time",
    "Sinusoid(inf, 1)": r"amplitude = inf: must be finite \(N m or m\)",
    "User(print, breaks=[1, 1])": r"breaks\[1\] = 1.0: must be above the time before, 1.0 \(s\)$",
    "User(print, breaks=[inf])": r"breaks\[0\] = inf: must be finite \(s\)$",
    "CompiledUser(4096, breaks=[1, 0])": r"breaks\[1\] = 0.0: must be above the time before, 1.0 ",
    "CompiledUser(0)": r"address = 0: must be the add",
    "CompiledUser(-1)": r"address = -1: m",
    "ViscousJoint(0, 1)": r"joint = 0: .* 1 or more",
    "ViscousJoint(2**31, 1)": r"joint: is too l",
    "ViscousJoint(1, 10**400)": r"damping: is to",
    "Motor(joint=1)": r".*one of constant, sinusoid, table",
    "Motor(1, constant=1, sinusoid=SINE)": r".*one of",
    "DrivenPivot()": r".*give x, y or both",
}  # fmt: skip
TYPES = {
    "Lock(joint=1.0)": r"joint = 1\.0: must be a whole number",
    "Lock(joint=True)": r"joint = True: must be a whole number",
    "ViscousJoint(1, '0.1')": r"damping = '0\.1': must be a real number \(N m s/rad\)",
    "ViscousJoint(1, True)": r"damping = True: must",
    "ViscousJoint(1, None)": r"damping = None: must",
    "Table([0, 1], ['a', 'b'])": r"torque: holds text: must",
    "Table([0, 1], [0, 1], hold=1)": r"hold = 1: must be True or False$",
    "Motor(1, sinusoid=5)": r"sinusoid = 5: must be a pendcore\.effects\.Sinusoid",
    "Motor(1, sinusoid=PD(1, 2, 3))":
        r"sinusoid = PD\(.*\): must be a pendcore\.effects\.Sinusoid",
    "User(5)": r"function = 5: must be a function of t",
    "CompiledUser('f')": r"address = 'f': must be an address, a ctypes function or a numba cfunc",
}  # fmt: skip
NAMES = {**vars(fx), "nan": np.nan, "inf": np.inf, "SINE": SINE}


@pytest.mark.parametrize("call", [*VALUES, *TYPES])
def test_a_mistake_is_told_with_class_parameter_value_and_remedy(call):
    name, error = call.partition("(")[0], TypeError if call in TYPES else ValueError
    with pytest.raises(error, match=f"^{name}: {(VALUES | TYPES)[call]}"):
        eval(call, NAMES)


RODS = [pc.Link(mass=1, length=1)] * 2
STOPS = r"effect 2 \(joint_stop\): range = .*: must overlap .* joint 1"
NO_LIST = r"must be a list of pendcore\.effects"
NO_PLACE = [
    ([fx.Lock(1), fx.ViscousJoint(3, 1)], r"effect 2 \(viscous_joint\): joint = 3: must be 1 to 2"),
    ([fx.Lock(1), fx.RodDrag(5, 1, 1)], r"effect 2 \(rod_drag\): link = 5: must be 1 to 2"),
    ([fx.Lock(1), fx.Lock(1)], r"effect 2 \(lock\): joint 1 is locked already"),
    ([fx.JointStop(1, range=(-1, 0)), fx.JointStop(1, range=(0.5, 1))], STOPS),
    ([fx.JointStop(1, range=(-1, 0)), fx.JointStop(1, range=(0.0, 1))], STOPS),
]
NO_EFFECTS = [
    (fx.Lock(1), rf"effects = Lock\(joint=1\): {NO_LIST}"),
    (5, r"effects = 5: must be a list"),
    ([fx.Lock(1), "drag"], rf"effect 2 = 'drag': {NO_LIST}"),
    ([SINE], rf"effect 1 = Sinusoid\(.*: {NO_LIST}"),
    ([print], r"effect 1 = .*: is a function: give pendcore\.effects\.User\(f\)"),
    ([fx.Lock], r"effect 1 = Lock: must be a pendcore\.effects object.* got the class itself"),
]


def test_a_scene_refuses_what_its_chain_has_no_place_for_and_what_is_no_effect():
    for error, table in ((ValueError, NO_PLACE), (TypeError, NO_EFFECTS)):
        for effects, message in table:
            with pytest.raises(error, match=f"^{message}"):
                pc.Scene(links=RODS, effects=effects)
    stops = [fx.JointStop(1, range=(-1, 0)), fx.JointStop(1, range=(-0.5, 1))]
    assert pc.Scene(links=RODS, effects=stops)
