"""A mistake in a case file is told with file, line and remedy."""

from __future__ import annotations

import re

import pendcore as pc
import pytest
from test_case import DAMPED, LINK, MOTOR, TEXTBOOK

Q = "q = [0.7853981633974483, 1.0471975511965976]\n"
QD = "qd = [0.0, 0.0]\n"
SECOND_MASS = "mass = 1.0\nlength = 1.0\n[start]"
VISCOUS = '"viscous_joint"'
SINUSOID = "{amplitude = 1.0, angular_frequency = 6.0}"
HUGE, ENDLESS = f"1{400 * '0'}", f"1{5000 * '0'}"
MISTAKES = [
    ("length = 1.0\n[start]", "lenght = 1.0\n[start]",
     "line 8: unknown key 'lenght' in [link]: did you mean 'length'?"),
    ("rtol", "rtoll", "line 16: unknown key 'rtoll' in [run]: did you mean 'rtol'?"),
    ("qd =", "omega =", "line 11: unknown key 'omega' in [start]: known are q, q_deg, qd"),
    ("qd =", "qd_deg =", "line 11: unknown key 'qd_deg' in [start]: give qd, in rad/s"),
    ("gravity", "gravty", "line 2: unknown key 'gravty': did you mean 'gravity'?"),
    ("[start]", "[begin]", "line 9: unknown key 'begin': known are "),
    ("[start]", "[strat]", "line 9: unknown key 'strat': did you mean 'start'"),
    ('method = "dopri5"', "gravity = 9.8",
     "line 15: unknown key 'gravity' in [run]: it belongs above all tables"),
    ("gravity = 9.807", "t_end = 5.0", "line 2: unknown key 't_end': it belongs in [run]"),
    (QD, Q, "(at line 11, column"),
    ("mass = 1.0\nlength = 1.0\n[[link]]", "mass = one\n[[link]]", "(at line 4, column"),
    ("mass = 1.0\n", "", "line 3: link 1 needs mass"),
    (2 * LINK, "", "links are needed: a table [["),
    (2 * LINK, LINK.replace("[[link]]", "[link]"), "line 3: [link] is one table: write [[link]]"),
    (2 * LINK, 2 * LINK.replace("[[link]]", "[link]"), "[[link]], in two brackets"),
    (Q, "", "line 9: [start] needs q"),
    (QD, "q_deg = [0.0, 0.0]\n", "line 9: [start] needs q"),
    ("t_end = 5.0\n", "", "line 12: [run] needs t_end (s)"),
    ("gravity = 9.807", 'gravity = "9.8"', "line 2: gravity = '9.8': must"),
    ("mass = 1.0", "mass = true", "line 4: mass = True: must be a"),
    (QD, 'qd = "0"\n', "line 11: qd = '0': must be a number or"),
    (QD, 'qd = [0.0, "0"]\n', "line 11: qd = [0.0, '0']: must be a number"),
    (Q, "q_deg = [45, nan]\n", "line 10: q_deg[1] = nan: must be finite (deg)"),
    (Q, "q_deg = [45, 60, 75]\n", "line 10: q_deg: shape (3,): must be (2,) (deg)"),
    ("gravity = 9.807", f"gravity = {HUGE}", "line 2: gravity: is too"),
    (QD, f"qd = [0, {HUGE}]\n", "line 11: qd: is too large"),
    ("gravity = 9.807", f"gravity = {ENDLESS}", "case.toml: "),
    ('"double pendulum, section 2.1"', "2.1", "line 1: name = 2.1: must be"),
    ("rtol = 1e-9", "rtol = 2020-01-01", "line 16: rtol = "),
    ("rtol = 1e-9", "rtol = [2020-01-01]", "line 16: rtol = "),
    (SECOND_MASS, SECOND_MASS.replace("mass = 1.0", "mass = -1.0"), "line 7: link 2: mass = -1"),
    (QD, "qd = [0.0, nan]\n", "line 11: qd[1] = nan: must be"),
    ("9.807", "inf", "line 2: gravity = inf: must be finite"),
    (QD, "qd = [0.0, 0.0, 0.0]\n", "line 11: qd: shape (3,): must be"),
    ("rtol = 1e-9", "t_eval = {start = 0, stop = 2, count = 1}",
     "count = 1: must be a whole number from 2"),
    ("rtol = 1e-9", "t_eval = {start = 0, stop = 2, count = 1000001}",
     "t_eval.count = 1000001: must be a whole number from 2 to 1,000,000"),
    ("rtol = 1e-9", "t_eval = {begin = 0.0, stop = 2.0}", "a table with start, stop"),
    # The effects stand at lines 17 and 21.
    (VISCOUS, '"viscus_joint"',
     "line 18: kind = 'viscus_joint': is no effect: did you mean 'viscous_joint'?"),
    (VISCOUS, '"ViscousJoint"',
     "line 18: kind = 'ViscousJoint': is no effect: did you mean 'viscous_joint'?"),
    (VISCOUS, '"xyz"',
     "line 18: kind = 'xyz': is no effect: known are viscous_joint, dry_joint_friction, "),
    (f"kind = {VISCOUS}\n", "",
     "line 17: effect 1 needs kind: viscous_joint, dry_joint_friction, "),
    (VISCOUS, "5", "line 18: kind = 5: must be one of viscous_"),
    (VISCOUS, '["a"]', "line 18: kind = ['a']: must be one of"),
    (VISCOUS, '"user"',
     "line 18: kind = 'user': is a function, which a file cannot hold: add it to the scene in"),
    (VISCOUS, '"compiled_user"',
     "line 18: kind = 'compiled_user': is a function, which a file cannot hold"),
    ("damping = 0.1", "dampning = 0.1",
     "line 20: unknown key 'dampning' in [effect]: did you mean 'damping'?"),
    ("damping = 0.1", "stiffness = 0.1",
     "line 20: unknown key 'stiffness' in [effect]: known are kind, joint, damping, damping2"),
    ("damping = 0.1", "length = 0.1",
     "line 20: unknown key 'length' in [effect]: it belongs in [link]"),
    (QD, "joint = 1\n", "line 11: unknown key 'joint' in [start]: it belongs in [effect]"),
    ("damping = 0.1\n", "",
     "line 17: effect 1 (viscous_joint): damping is missing: linear coefficient"),
    ("damping = 0.1", "damping = nan",
     "line 20: effect 1 (viscous_joint): damping = nan: must be finite (N m s/rad)"),
    ("damping = 0.1", 'damping = "0.1"',
     "line 20: effect 1 (viscous_joint): damping = '0.1': must be a real number (N m s/rad)"),
    ("joint = 1", "joint = true",
     "line 19: effect 1 (viscous_joint): joint = True: must be a whole number"),
    ("joint = 1", "joint = 3", "line 19: effect 1 (viscous_joint): joint = 3: must be 1 to 2"),
    ("amplitude", "amplitudes",
     "line 24: effect 2 (motor): sinusoid has no parameter 'amplitudes': did you mean"),
    ("amplitude = 1.0, ", "", "line 24: effect 2 (motor): sinusoid.amplitude is missing"),
    ("amplitude = 1.0", "amplitude = inf",
     "line 24: effect 2 (motor): sinusoid.amplitude = inf: must be finite"),
    (SINUSOID, "5.0",
     "line 24: effect 2 (motor): sinusoid = 5.0: must be a table with amplitude, angular_freq"),
    ("joint = 2", "joint = 2\nconstant = 1.0", "line 21: effect 2 (motor): "),
    (DAMPED + MOTOR, DAMPED.replace("[[effect]]", "[effect]"),
     "line 17: effects are tables [[effect]], one for each"),
]  # fmt: skip


@pytest.mark.every_value("words")
@pytest.mark.parametrize(("right", "wrong", "words"), MISTAKES, ids=lambda x: x[:40])
def test_a_mistake_is_told_with_file_line_and_remedy(right, wrong, words, tmp_path):
    text = TEXTBOOK + DAMPED + MOTOR
    assert text.count(right)
    path = tmp_path / "case.toml"
    path.write_text(text.replace(right, wrong, 1))
    with pytest.raises(ValueError, match=re.escape(words)) as error:
        pc.read_case(path)
    assert str(error.value).startswith(str(path))


LISTED = '''\
# [start] is not a table here, nor is mass = 1 a key
name = """
[run]
mass = 1
"""
[[link]]  # [[link]]
"mass" = 1
length = 1  # lenght
[start]
q = [
  1.0,   # = ]
]
[run]
t_end = 1
method = "[dopri5"  # 'no table'
t_eval = [
  [1.0], [
  [2.0],
  ],
]
rtoll = 1e-9
'''
NO_TABLE = "link = [{mass = 1, length = 1}]\nstart = 1\nrun = {t_end = 5}\n"
AFTER_QUOTES = f'name = """a\n"""""\n{LINK.replace("mass", "mas")}[start]\nq = 1\n'


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (LISTED, "case, line 21: unknown key 'rtoll'"),
        (NO_TABLE, "case, line 2: start = 1: must be a table"),
        (AFTER_QUOTES, "case, line 4: unknown key 'mas'"),
    ],
)
def test_lines_are_counted_through_comments_strings_and_lists(text, words):
    with pytest.raises(ValueError, match=f"^{words}"):
        pc.read_case(text)


def test_a_file_that_is_not_text_is_named(tmp_path):
    path = tmp_path / "case.toml"
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ValueError, match=r"case\.toml: is not a text file in UTF-8"):
        pc.read_case(path)
