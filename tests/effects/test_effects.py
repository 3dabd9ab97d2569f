"""The classes of effects have what their descriptions promise, and say in words what is wrong."""

from __future__ import annotations

import copy
import ctypes
import inspect
from dataclasses import FrozenInstanceError
from fractions import Fraction

import numpy as np
import pendcore as pc
import pytest
from pendcore import _core
from pendcore import effects as fx

nan, inf = float("nan"), float("inf")
ROD = pc.Link(mass=1, length=1)
CLASSES = {**fx.kinds()}
SINE = fx.Sinusoid(amplitude=1.0, angular_frequency=6.0)
FORCES = ctypes.CFUNCTYPE(
    None, ctypes.c_double, ctypes.c_int, *3 * [ctypes.POINTER(ctypes.c_double)], ctypes.c_void_p
)


def test_every_kind_of_the_core_has_its_class_under_its_names():
    told = _core.effect_descriptors()
    assert [*CLASSES] == [row["kind"] for row in told] + ["user"]
    for row in told:
        assert CLASSES[row["kind"]] is getattr(fx, row["name"])
        assert CLASSES[row["kind"]].kind == row["kind"]


@pytest.mark.parametrize(
    ("name", "remedy"),
    [
        ("ViscusJoint", r"did you mean 'ViscousJoint'\?"),
        ("torsional_spring", r"did you mean 'TorsionalSpring'\?"),
        ("Xyz", r"known are Effect, Part, kinds, "),
    ],
)
def test_an_unknown_effect_is_told_with_the_nearest_known_one(name, remedy):
    with pytest.raises(AttributeError, match=rf"^pendcore\.effects has no '{name}': {remedy}"):
        getattr(fx, name)
    assert not hasattr(fx, "__path__")


def test_kinds_can_be_changed_by_nobody():
    fx.kinds().clear()
    assert fx.kinds() == CLASSES


@pytest.mark.parametrize("kind", CLASSES)
def test_a_class_shows_its_parameters_in_signature_docstring_and_match_args(kind):
    cls = CLASSES[kind]
    names = [parameter.name for parameter in cls.description.parameters]
    signature = inspect.signature(cls)
    assert [*signature.parameters] == names == [*cls.__match_args__]
    assert cls.__module__ == "pendcore.effects"
    for parameter in cls.description.parameters:
        assert f"\n{parameter.name} : " in cls.__doc__
        argument = signature.parameters[parameter.name]
        assert (argument.default is argument.empty) == parameter.required
    assert all(len(line) <= 92 for line in cls.__doc__.splitlines())


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
    assert repr(fx.Motor(joint=2, sinusoid=SINE, limit=inf)) == (
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
    with pytest.raises(TypeError, match=r"did you mean 'joint'\?"):
        effect.replace(joints=3)


def test_effects_of_different_kinds_or_values_are_different():
    effects = [fx.ViscousJoint(1, 0.1), fx.ViscousJoint(2, 0.1), fx.TorsionalSpring(1, 0.1)]
    assert len(set(effects)) == len(effects) == len({repr(effect) for effect in effects})


MISTAKES = {
    "not finite": (
        lambda: fx.ViscousJoint(joint=1, damping=nan),
        ValueError,
        r"ViscousJoint: damping = nan: must be finite \(N m s/rad\)",
    ),
    "negative": (
        lambda: fx.RotorInertia(1, armature=-1),
        ValueError,
        r"RotorInertia: armature = -1\.0: must be finite and >= 0 \(kg m\^2\)",
    ),
    "zero": (
        lambda: fx.DryJointFriction(1, 1, stribeck_velocity=0),
        ValueError,
        r"DryJointFriction: stribeck_velocity = 0\.0: must be finite and > 0 \(rad/s\)",
    ),
    "below one": (
        lambda: fx.DryJointFriction(1, 1, exponent=0.5),
        ValueError,
        r"DryJointFriction: exponent = 0\.5: must be finite and >= 1$",
    ),
    "at odds": (
        lambda: fx.DryJointFriction(1, 2, static=1),
        ValueError,
        r"DryJointFriction: static = 1\.0: must be at least coulomb = 2\.0 \(N m\)",
    ),
    "limit": (
        lambda: fx.Motor(1, constant=1, limit=nan),
        ValueError,
        r"Motor: limit = nan: must be > 0, inf for no limit \(N m\)",
    ),
    "in a list": (
        lambda: fx.Table(t=[0, 1], torque=[1, nan]),
        ValueError,
        r"Table: torque\[1\] = nan: must be finite \(N m\)",
    ),
    "in a pair": (
        lambda: fx.RodDrag(1, 1, 1, wind=(inf, 0)),
        ValueError,
        r"RodDrag: wind\[0\] = inf: must be finite \(m/s\)",
    ),
    "no pair": (
        lambda: fx.RodDrag(1, 1, 1, wind=3.0),
        ValueError,
        r"RodDrag: wind: shape \(\): must be \(2,\), 2 numbers \(m/s\)",
    ),
    "no list": (
        lambda: fx.Table(t=[[0, 1]], torque=[1, 2]),
        ValueError,
        r"Table: t: shape \(1, 2\): must be \(k,\) \(s\)",
    ),
    "times backward": (
        lambda: fx.Table(t=[0, 1, 0.5], torque=[1, 2, 3]),
        ValueError,
        r"Table: t\[2\] = 0\.5: must be above the time before, 1\.0 \(s\)",
    ),
    "a single time": (lambda: fx.Spline([0], [0], [0]), ValueError, r"Spline: t: has 1 time"),
    "too few values": (
        lambda: fx.Spline([0, 1], [0, 1], [0]),
        ValueError,
        r"Spline: y: has 1 value.*must have 2, one for each time",
    ),
    "joint zero": (
        lambda: fx.ViscousJoint(0, 1),
        ValueError,
        r"ViscousJoint: joint = 0: .* 1 or more",
    ),
    "joint huge": (lambda: fx.ViscousJoint(2**31, 1), ValueError, r"ViscousJoint: joint: is too l"),
    "no law": (lambda: fx.Motor(joint=1), ValueError, r"Motor: .*one of constant, sinusoid, table"),
    "two laws": (lambda: fx.Motor(1, constant=1, sinusoid=SINE), ValueError, r"Motor: .*one of"),
    "no motion": (lambda: fx.DrivenPivot(), ValueError, r"DrivenPivot: .*give x, y or both"),
    "joint a float": (
        lambda: fx.Lock(joint=1.0),
        TypeError,
        r"Lock: joint = 1\.0: must be a whole number",
    ),
    "joint a truth": (lambda: fx.Lock(joint=True), TypeError, r"Lock: joint = True: must be a who"),
    "text": (
        lambda: fx.ViscousJoint(1, "0.1"),
        TypeError,
        r"ViscousJoint: damping = '0\.1': must be a real number \(N m s/rad\)",
    ),
    "truth": (lambda: fx.ViscousJoint(1, True), TypeError, r"ViscousJoint: damping = True: must"),
    "none": (lambda: fx.ViscousJoint(1, None), TypeError, r"ViscousJoint: damping = None: must"),
    "texts": (lambda: fx.Table([0, 1], ["a", "b"]), TypeError, r"Table: torque: holds text: must"),
    "too large": (lambda: fx.ViscousJoint(1, 10**400), ValueError, r"ViscousJoint: damping: is to"),
    "no part": (
        lambda: fx.Motor(1, sinusoid=5),
        TypeError,
        r"Motor: sinusoid = 5: must be a pendcore\.effects\.Sinusoid",
    ),
    "another part": (
        lambda: fx.Motor(1, sinusoid=fx.PD(1, 2, 3)),
        TypeError,
        r"Motor: sinusoid = PD\(.*\): must be a pendcore\.effects\.Sinusoid",
    ),
    "misspelt": (
        lambda: fx.ViscousJoint(joint=1, dampings=0.1),
        TypeError,
        r"ViscousJoint: has no parameter 'dampings': did you mean 'damping'\?",
    ),
    "unknown": (
        lambda: fx.Lock(joint=1, colour=0.1),
        TypeError,
        r"Lock: has no parameter 'colour': known are joint, angle",
    ),
    "missing": (
        lambda: fx.ViscousJoint(joint=1),
        TypeError,
        r"ViscousJoint: damping is missing: .*\(N m s/rad\)",
    ),
    "twice": (lambda: fx.Lock(1, joint=1), TypeError, r"Lock: joint is given twice"),
    "too many": (lambda: fx.Lock(1, 2, 3), TypeError, r"Lock: takes joint, angle.* given 3 values"),
    "a sine that is none": (
        lambda: fx.Sinusoid(inf, 1),
        ValueError,
        r"Sinusoid: amplitude = inf: must be finite \(N m or m\)",
    ),
    "no function": (lambda: fx.User(5), TypeError, r"User: function = 5: must be a function of t"),
    "null": (lambda: fx.CompiledUser(0), ValueError, r"CompiledUser: address = 0: must be the add"),
    "no address": (
        lambda: fx.CompiledUser("f"),
        TypeError,
        r"CompiledUser: address = 'f': must be an address, a ctypes function or a numba cfunc",
    ),
    "negative address": (lambda: fx.CompiledUser(-1), ValueError, r"CompiledUser: address = -1: m"),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_is_told_with_class_parameter_value_and_remedy(mistake):
    make, kind, message = MISTAKES[mistake]
    with pytest.raises(kind, match=f"^{message}"):
        make()


@pytest.mark.parametrize(
    ("effect", "message"),
    [
        (fx.ViscousJoint(3, 1), r"effect 2 \(viscous_joint\): joint = 3: must be 1 to 2"),
        (fx.RodDrag(5, 1, 1), r"effect 2 \(rod_drag\): link = 5: must be 1 to 2"),
        (fx.Lock(1), r"effect 2 \(lock\): joint 1 is locked already"),
    ],
)
def test_a_scene_refuses_what_its_chain_has_no_place_for(effect, message):
    with pytest.raises(ValueError, match=f"^{message}"):
        pc.Scene(links=[ROD, ROD], effects=[fx.Lock(1), effect])


@pytest.mark.parametrize("lowest", [0.5, 0.0])
def test_a_scene_refuses_stops_that_leave_a_joint_no_room(lowest):
    stops = [fx.JointStop(1, range=(-1, 0)), fx.JointStop(1, range=(lowest, 1))]
    message = rf"effect 2 \(joint_stop\): range = \({lowest}, 1.0\): must overlap .* joint 1"
    with pytest.raises(ValueError, match=f"^{message}"):
        pc.Scene(links=[ROD, ROD], effects=stops)
    assert pc.Scene(links=[ROD], effects=[stops[0], fx.JointStop(1, range=(-0.5, 1))])


@pytest.mark.parametrize(
    ("effects", "message"),
    [
        (fx.Lock(1), r"effects = Lock\(joint=1\): must be a list of pendcore\.effects"),
        (5, r"effects = 5: must be a list"),
        ([fx.Lock(1), "drag"], r"effect 2 = 'drag': must be a list of pendcore\.effects"),
        ([SINE], r"effect 1 = Sinusoid\(.*: must be a list of pendcore\.effects"),
        ([fx.Lock], r"effect 1 = Lock: must be a pendcore\.effects object.* got the class itself"),
    ],
)
def test_what_is_no_list_of_effects_is_refused(effects, message):
    with pytest.raises(TypeError, match=f"^{message}"):
        pc.Scene(links=[ROD], effects=effects)
