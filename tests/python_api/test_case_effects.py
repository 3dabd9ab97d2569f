"""Effects in a case file: what is read, and what is told of mistakes, with their line."""

from __future__ import annotations

import re

import pendcore as pc
import pytest
from pendcore import effects as fx
from pendcore._cases.case_file import EFFECT_KEYS, KEYS

HEAD = "[[link]]\nmass = 1.0\nlength = 1.0\n[[link]]\nmass = 1.0\nlength = 1.0\n"
TAIL = "[start]\nq = 0.5\n[run]\nt_end = 1.0\n"
DAMPED = '[[effect]]\nkind = "viscous_joint"\njoint = 1\ndamping = 0.1\n'
MOTOR = """\
[[effect]]
kind = "motor"
joint = 2
sinusoid = {amplitude = 1.0, angular_frequency = 6.0}
"""


def read(*tables):
    return pc.read_case(HEAD + "".join(tables) + TAIL)


def test_effects_are_tables_of_their_kind():
    scene = read(DAMPED, MOTOR, '[[effect]]\nkind = "payload"\nmass = 2\n').scene
    assert scene.effects == (
        fx.ViscousJoint(joint=1, damping=0.1),
        fx.Motor(joint=2, sinusoid=fx.Sinusoid(amplitude=1.0, angular_frequency=6.0)),
        fx.Payload(mass=2.0),
    )
    assert read().scene.effects == ()


def test_parts_may_be_tables_below():
    below = MOTOR.replace("sinusoid = {", "[effect.sinusoid]\n").replace(", ", "\n")
    assert read(below.replace("}", ""), DAMPED) == read(MOTOR, DAMPED)


def test_effects_are_written_in_their_order_without_what_is_as_by_default():
    scene = read(MOTOR, DAMPED).scene
    text = pc.Case(scene=scene, q0=0.5, t_span=(0, 1)).to_toml()
    assert f"{MOTOR}\n{DAMPED}\n[start]" in text


def test_every_kind_has_the_keys_of_its_parameters():
    assert set(EFFECT_KEYS) == set(fx.kinds()) - {"user", "compiled_user"}
    for kind, keys in EFFECT_KEYS.items():
        names = [parameter.name for parameter in fx.kinds()[kind].description.parameters]
        assert [*keys] == ["kind", *names]
    assert KEYS["effect"] == ("kind",)


MISTAKES = {
    "unknown kind, near a known one": (
        ('"viscous_joint"', '"viscus_joint"'),
        "line 8: kind = 'viscus_joint': is no effect: did you mean 'viscous_joint'?",
    ),
    "the name of the class": (
        ('"viscous_joint"', '"ViscousJoint"'),
        "line 8: kind = 'ViscousJoint': is no effect: did you mean 'viscous_joint'?",
    ),
    "unknown kind": (
        ('"viscous_joint"', '"xyz"'),
        "line 8: kind = 'xyz': is no effect: known are viscous_joint, dry_joint_friction, ",
    ),
    "no kind": (
        ('kind = "viscous_joint"\n', ""),
        "line 7: effect 1 needs kind: viscous_joint, dry_joint_friction, ",
    ),
    "a number for a kind": (('"viscous_joint"', "5"), "line 8: kind = 5: must be one of viscous_"),
    "a list for a kind": (('"viscous_joint"', '["a"]'), "line 8: kind = ['a']: must be one of"),
    "a function": (
        ('"viscous_joint"', '"user"'),
        "line 8: kind = 'user': is a function, which a file cannot hold: add it to the scene in",
    ),
    "a compiled function": (
        ('"viscous_joint"', '"compiled_user"'),
        "line 8: kind = 'compiled_user': is a function, which a file cannot hold",
    ),
    "unknown key, near a known one": (
        ("damping = 0.1", "dampning = 0.1"),
        "line 10: unknown key 'dampning' in [effect]: did you mean 'damping'?",
    ),
    "key of another effect": (
        ("damping = 0.1", "stiffness = 0.1"),
        "line 10: unknown key 'stiffness' in [effect]: known are kind, joint, damping, damping2",
    ),
    "key of a link": (
        ("damping = 0.1", "length = 0.1"),
        "line 10: unknown key 'length' in [effect]: it belongs in [link]",
    ),
    "key of an effect elsewhere": (
        ("q = 0.5", "joint = 1"),
        "line 16: unknown key 'joint' in [start]: it belongs in [effect]",
    ),
    "missing key": (
        ("damping = 0.1\n", ""),
        "line 7: effect 1 (viscous_joint): damping is missing: linear coefficient",
    ),
    "out of range": (
        ("damping = 0.1", "damping = nan"),
        "line 10: effect 1 (viscous_joint): damping = nan: must be finite (N m s/rad)",
    ),
    "text for a number": (
        ("damping = 0.1", 'damping = "0.1"'),
        "line 10: effect 1 (viscous_joint): damping = '0.1': must be a real number (N m s/rad)",
    ),
    "truth for a number": (
        ("joint = 1", "joint = true"),
        "line 9: effect 1 (viscous_joint): joint = True: must be a whole number",
    ),
    "no such joint": (
        ("joint = 1", "joint = 3"),
        "line 9: effect 1 (viscous_joint): joint = 3: must be 1 to 2",
    ),
    "unknown key in a part": (
        ("amplitude", "amplitudes"),
        "line 14: effect 2 (motor): sinusoid has no parameter 'amplitudes': did you mean",
    ),
    "missing key in a part": (
        ("amplitude = 1.0, ", ""),
        "line 14: effect 2 (motor): sinusoid.amplitude is missing",
    ),
    "out of range in a part": (
        ("amplitude = 1.0", "amplitude = inf"),
        "line 14: effect 2 (motor): sinusoid.amplitude = inf: must be finite",
    ),
    "a number for a part": (
        ("{amplitude = 1.0, angular_frequency = 6.0}", "5.0"),
        "line 14: effect 2 (motor): sinusoid = 5.0: must be a table with amplitude, angular_freq",
    ),
    "two laws": (("joint = 2", "joint = 2\nconstant = 1.0"), "line 11: effect 2 (motor): "),
    "a single table": (
        ("[[effect]]", "[effect]"),
        "line 7: effects are tables [[effect]], one for each",
    ),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_is_told_with_file_line_and_remedy(mistake, tmp_path):
    (right, wrong), message = MISTAKES[mistake]
    text = HEAD + DAMPED + MOTOR + TAIL
    if mistake == "a single table":
        text = HEAD + DAMPED + TAIL
    assert right in text
    path = tmp_path / "case.toml"
    path.write_text(text.replace(right, wrong))
    with pytest.raises(ValueError, match=re.escape(message)) as error:
        pc.read_case(path)
    assert str(error.value).startswith(f"{path}, ")
