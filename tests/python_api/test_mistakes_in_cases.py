"""A mistake in a case file is told with file, line and remedy, and no file takes long to refuse."""

from __future__ import annotations

import re
import time
from pathlib import Path

import pendcore as pc
import pytest
from fuzz.readers import MOST_SECONDS, finding
from pendcore._cases import case_file
from pendcore._cases.toml_text import MOST_NESTED
from test_case import DAMPED, LINK, MOTOR, TEXTBOOK

Q = "q = [0.7853981633974483, 1.0471975511965976]\n"
QD = "qd = [0.0, 0.0]\n"
SECOND_MASS = "mass = 1.0\nlength = 1.0\n[start]"
VISCOUS = '"viscous_joint"'
SINUSOID = "{amplitude = 1.0, angular_frequency = 6.0}"
HUGE, ENDLESS = f"1{400 * '0'}", f"1{5000 * '0'}"
DAMPING, GRAVITY, RTOL = "damping = 0.1", "gravity = 9.807", "rtol = 1e-9"
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
    (GRAVITY, "t_end = 5.0", "line 2: unknown key 't_end': it belongs in [run]"),
    (QD, Q, "(at line 11, column"),
    ("mass = 1.0\nlength = 1.0\n[[link]]", "mass = one\n[[link]]", "(at line 4, column"),
    ("mass = 1.0\n", "", "line 3: link 1 needs mass"),
    (2 * LINK, "", "links are needed: a table [["),
    (2 * LINK, LINK.replace("[[link]]", "[link]"), "line 3: [link] is one table: write [[link]]"),
    (2 * LINK, 2 * LINK.replace("[[link]]", "[link]"), "[[link]], in two brackets"),
    (Q, "", "line 9: [start] needs q"),
    (QD, "q_deg = [0.0, 0.0]\n", "line 9: [start] needs q"),
    ("t_end = 5.0\n", "", "line 12: [run] needs t_end (s)"),
    (GRAVITY, 'gravity = "9.8"', "line 2: gravity = '9.8': must"),
    ("mass = 1.0", "mass = true", "line 4: mass = True: must be a"),
    (QD, 'qd = "0"\n', "line 11: qd = '0': must be a number or"),
    (QD, 'qd = [0.0, "0"]\n', "line 11: qd = [0.0, '0']: must be a number"),
    (Q, "q_deg = [45, nan]\n", "line 10: q_deg[1] = nan: must be finite (deg)"),
    (Q, "q_deg = [45, 60, 75]\n", "line 10: q_deg: shape (3,): must be (2,) (deg)"),
    (GRAVITY, f"gravity = {HUGE}", "line 2: gravity: is too"),
    (QD, f"qd = [0, {HUGE}]\n", "line 11: qd: is too large"),
    (GRAVITY, f"gravity = {ENDLESS}", "case.toml: "),
    ('"double pendulum, section 2.1"', "2.1", "line 1: name = 2.1: must be"),
    (RTOL, "rtol = 2020-01-01", "line 16: rtol = "),
    (RTOL, "rtol = [2020-01-01]", "line 16: rtol = "),
    (SECOND_MASS, SECOND_MASS.replace("mass = 1.0", "mass = -1.0"), "line 7: link 2: mass = -1"),
    (QD, "qd = [0.0, nan]\n", "line 11: qd[1] = nan: must be"),
    ("9.807", "inf", "line 2: gravity = inf: must be finite"),
    (QD, "qd = [0.0, 0.0, 0.0]\n", "line 11: qd: shape (3,): must be"),
    (RTOL, "t_eval = {start = 0, stop = 2, count = 1}", "count = 1: must be a whole number from 2"),
    (RTOL, "t_eval = {start = 0, stop = 2, count = 1000001}",
     "t_eval.count = 1000001 ... 2 to 1,000,000"),
    (RTOL, "t_eval = {begin = 0.0, stop = 2.0}", "a table with start, stop"),
    # The effects stand at lines 17 and 21.
    (VISCOUS, '"viscus_joint"', "line 18: kind = 'viscus_joint' ... did you mean 'viscous_joint'?"),
    (VISCOUS, '"ViscousJoint"', "line 18: kind = 'ViscousJoint' ... did you mean 'viscous_joint'?"),
    (VISCOUS, '"xyz"', "line 18: kind = 'xyz' ... known are viscous_joint, dry_joint_friction, "),
    (f"kind = {VISCOUS}\n", "", "line 17: effect 1 needs kind: viscous_joint, "),
    (VISCOUS, "5", "line 18: kind = 5: must be one of viscous_"),
    (VISCOUS, '["a"]', "line 18: kind = ['a']: must be one of"),
    (VISCOUS, '"user"', "line 18: kind = 'user': is a function ... add it to the scene in"),
    (VISCOUS, '"compiled_user"', "line 18: kind = 'compiled_user': is a function"),
    (DAMPING, "dampning = 0.1",
     "line 20: unknown key 'dampning' in [effect]: did you mean 'damping'?"),
    (DAMPING, "stiffness = 0.1",
     "line 20: unknown key 'stiffness' ... kind, joint, damping, damping2"),
    (DAMPING, "length = 0.1", "line 20: unknown key 'length' ... it belongs in [link]"),
    (QD, "joint = 1\n", "line 11: unknown key 'joint' in [start]: it belongs in [effect]"),
    ("damping = 0.1\n", "",
     "line 17: effect 1 (viscous_joint): damping is missing: linear coefficient"),
    (DAMPING, "damping = nan", "line 20: effect 1 ... damping = nan: must be finite (N m s/rad)"),
    (DAMPING, 'damping = "0.1"', "line 20: effect 1 ... damping = '0.1': must be a real number ("),
    ("joint = 1", "joint = true", "line 19: effect 1 ... joint = True: must be a whole number"),
    ("joint = 1", "joint = 3", "line 19: effect 1 (viscous_joint): joint = 3: must be 1 to 2"),
    ("amplitude", "amplitudes",
     "line 24: effect 2 ... sinusoid has no parameter 'amplitudes': did you"),
    ("amplitude = 1.0, ", "", "line 24: effect 2 (motor): sinusoid.amplitude is missing"),
    ("amplitude = 1.0", "amplitude = inf",
     "line 24: effect 2 ... sinusoid.amplitude = inf: must be finite"),
    (SINUSOID, "5.0", "line 24: effect 2 (motor): sinusoid = 5.0: must be a table with amplitude,"),
    ("joint = 2", "joint = 2\nconstant = 1.0", "line 21: effect 2 (motor): "),
    (DAMPED + MOTOR, DAMPED.replace("[[effect]]", "[effect]"),
     "line 17: effects are tables [[effect]], one for each"),
]  # fmt: skip


@pytest.mark.parametrize(("right", "wrong", "words"), MISTAKES, ids=lambda x: x[:40])
def test_a_mistake_is_told_with_file_line_and_remedy(right, wrong, words, tmp_path):
    text = TEXTBOOK + DAMPED + MOTOR
    assert text.count(right)
    path = tmp_path / "case.toml"
    path.write_text(text.replace(right, wrong, 1))
    pattern = ".*".join(re.escape(part) for part in words.split(" ... "))
    with pytest.raises(ValueError, match=pattern) as error:
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


def test_lines_are_counted_through_comments_strings_and_lists():
    for text, words in (
        (LISTED, "case, line 21: unknown key 'rtoll'"),
        (NO_TABLE, "case, line 2: start = 1: must be a table"),
        (AFTER_QUOTES, "case, line 4: unknown key 'mas'"),
    ):
        with pytest.raises(ValueError, match=f"^{words}"):
            pc.read_case(text)


def test_a_file_that_is_not_text_is_named(tmp_path):
    path = tmp_path / "case.toml"
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ValueError, match=r"case\.toml: is not a text file in UTF-8"):
        pc.read_case(path)


BOOK = pc.Case.textbook().to_toml()
BELOW_THE_NAME = BOOK.partition("\n")[2]
BLANKS = " " * 100_000
SLOW = {
    "blanks in a line": BOOK + BLANKS + "\n=",
    "blanks before a key": BOOK + BLANKS + "rtl = 1e-9\n",
    "blanks within a key": BOOK + "r " + BLANKS + "= 1\n",
    "blanks where a table stands twice": BOOK + BLANKS + "\n[start]\n",
    "quotes that do not end": BOOK + '"""\\' * 30_000,
    "texts that do not end": BOOK + "'''" + "\n'" * 50_000,
    "a long word": BOOK + "a" * 500_000 + "\n",
    "dots": BOOK + "a." * 50_000 + "a = 1\n",
    "dots with blanks": BOOK + "a . " * 50_000 + "a = 1\n",
    "dots between quotes": BOOK + '"a".' * 50_000 + "a = 1\n",
    "dots in a header": BOOK + "[" + "a." * 50_000 + "a]\n",
    "dots in a table in a line": BOOK + "x = {" + "a." * 50_000 + "a = 1}\n",
    "dots after quotes": BOOK + 'x = {y = """z"""", ' + "a." * 50_000 + "a = 1}\n",
    "arrays": "x = " + "[" * 100_000 + "\n" + BOOK,
    "arrays that end": "x = " + "[" * 2_000 + "]" * 2_000 + "\n" + BOOK,
    "tables": "x = " + "{a = " * 2_000 + "\n" + BOOK,
    "a number of many digits": BOOK.replace("9.807", "9" * 500_000),
    "a number in hexadecimal": BOOK.replace("9.807", "0x" + "f" * 500_000),
    "many keys": BOOK + "".join(f"k{i} = 1\n" for i in range(30_000)),
    "a name of many letters": BOOK.replace("[run]", "[run]\n" + "m" * 200_000 + " = 1"),
}


@pytest.mark.parametrize("name", SLOW)
def test_a_text_that_is_no_case_is_refused_in_a_moment(name):
    """The slowest took hours; a moment is 50 times what they take on an idle machine."""

    def read():
        with pytest.raises(ValueError, match=r"."):
            pc.read_case(SLOW[name])

    assert finding(read) is None


def test_blanks_are_allowed():
    assert pc.read_case(SLOW["blanks in a line"][:-1]) == pc.Case.textbook()
    text = SLOW["blanks before a key"].replace("rtl", "rtol")
    assert pc.read_case(text).options["rtol"] == 1e-9


@pytest.mark.parametrize(
    "text", ["x = " + "[" * 33 + "\n", "a." * 32 + "a = 1\n", "[" + "a." * 32 + "a]\n"]
)
def test_what_is_nested_too_deeply_is_told_with_its_line_and_bound(text):
    told = rf"case, line 2: is nested too deeply: at most {MOST_NESTED} arrays, tables or names"
    with pytest.raises(ValueError, match=told):
        pc.read_case('name = "x"\n' + text + BOOK)


MANY = "[{" * 50 + "." * 50 + "a" * 3


@pytest.mark.parametrize("text", ['"{}"', "'{}'", '"""{}"""', "'''{0}\n{0}'''", '"""{}"""""'])
def test_brackets_and_dots_in_texts_and_comments_are_no_nesting(text):
    case = pc.read_case(f"# {MANY}\nname = {text.format(MANY)} # {MANY}\n{BELOW_THE_NAME}")
    assert MANY in case.name


def test_a_million_even_times_are_read_in_a_moment():
    times = "t_eval = {start = 0, stop = 5, count = 1_000_000}"
    begin = time.process_time()
    case = pc.read_case(BOOK.replace("[run]", f"[run]\n{times}"))
    assert len(case.options["t_eval"]) == 1_000_000
    assert time.process_time() - begin < MOST_SECONDS


def test_a_case_file_is_read_up_to_its_bound(tmp_path, monkeypatch):
    if Path("/dev/zero").exists():  # a device without an end
        with pytest.raises(ValueError, match=r"/dev/zero: is too large .*: at most 67,108,864"):
            pc.read_case("/dev/zero")
    monkeypatch.setattr(case_file, "MOST_BYTES", 1000)
    path = tmp_path / "long.toml"
    path.write_text(BOOK + "#" * (1000 - len(BOOK)))
    assert pc.read_case(path) == pc.Case.textbook()
    path.write_text(BOOK + "#" * (1001 - len(BOOK)))
    with pytest.raises(ValueError, match=r"long\.toml: is too large for a case: at most 1,000 byt"):
        pc.read_case(path)
