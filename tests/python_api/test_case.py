"""A case survives being written and read, and says what is wrong with it, and on which line."""

from __future__ import annotations

import copy
import pickle
import re
from math import pi

import numpy as np
import pendcore as pc
import pytest
from hypothesis import given
from hypothesis import strategies as st
from test_scene import scenes

TEXTBOOK = """\
name = "double pendulum, section 2.1"
gravity = 9.807
[[link]]
mass = 1.0
length = 1.0
[[link]]
mass = 1.0
length = 1.0
[start]
q = [0.7853981633974483, 1.0471975511965976]
qd = [0.0, 0.0]
[run]
t_start = 0.0
t_end = 5.0
method = "dopri5"
rtol = 1e-9
"""
finite = st.floats(allow_nan=False, allow_infinity=False)
options = st.fixed_dictionaries(
    {},
    optional={
        "method": st.text(),
        "rtol": finite | st.lists(finite),
        "t_eval": st.lists(finite),
        "max_step": st.floats(allow_nan=False),
        "max_steps": st.integers(1, 10**18),
        "progress": st.booleans(),
    },
)


@st.composite
def cases(draw):
    scene = draw(scenes)
    q = st.lists(finite, min_size=len(scene.links), max_size=len(scene.links))
    return pc.Case(
        name=draw(st.text()),
        scene=scene,
        q0=draw(q),
        qd0=draw(q),
        t_span=(draw(finite), draw(finite)),
        options=draw(options),
    )


@given(cases())
def test_a_case_comes_back_from_toml_to_the_last_bit(case):
    assert pc.read_case(case.to_toml()) == case


@pytest.mark.parametrize(
    "name", ['"', "\\", "\n", "\0\x1f\x7f\x80", "\u2028", "\U0001d11e", "#[=]"]
)
def test_a_name_may_have_any_characters(name):
    case = pc.Case(scene=pc.Scene.textbook(), q0=0, t_span=(0, 1), name=name)
    assert pc.read_case(case.to_toml()) == case


@given(cases())
def test_a_case_comes_back_from_its_repr(case):
    names = {"Case": pc.Case, "Scene": pc.Scene, "Link": pc.Link, "inf": float("inf")}
    assert eval(repr(case), names) == case


def test_the_textbooks_case_is_that_of_the_documents():
    read = pc.read_case(TEXTBOOK)
    assert (read.scene, read.q0, read.t_span) == (
        pc.Scene.textbook(),
        (pi / 4, pi / 3),
        (0.0, 5.0),
    )
    assert read.options == {"method": "dopri5", "rtol": 1e-9}
    assert np.array_equal(read.simulate().y, pc.Case.textbook().simulate().y)


def test_a_case_is_read_from_a_file(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(TEXTBOOK)
    assert pc.read_case(path) == pc.read_case(str(path)) == pc.read_case(TEXTBOOK)


def test_what_is_left_out_has_the_defaults_of_scene_and_simulate():
    read = pc.read_case("[[link]]\nmass = 1\nlength = 2\n[start]\nq = [1]\n[run]\nt_end = 3\n")
    assert read == pc.Case(scene=pc.Scene(links=[pc.Link(mass=1, length=2)]), q0=1, t_span=(0, 3))
    assert read.scene.gravity == 9.807
    assert read.qd0 == (0.0,)


def test_the_start_may_be_given_in_degrees():
    read = pc.read_case(TEXTBOOK.replace("q = [0.7853981633974483, 1.0471", "q_deg = [45, 60] # "))
    assert read.q0 == (pi / 4, pi / 3)


@pytest.mark.parametrize(("key", "value"), [("q", "1"), ("q_deg", "45.0"), ("qd", "0.5")])
def test_one_number_holds_for_every_link(key, value):
    both = [f"{key} = {value}", f"{key} = [{value}, {value}]"]
    others = "q = 1\n" * (key == "qd")
    links = 2 * "[[link]]\nmass = 1\nlength = 1\n"
    one, two = (
        pc.read_case(f"{links}[start]\n{others}{line}\n[run]\nt_end = 1\n") for line in both
    )
    assert one == two


def test_a_byte_order_mark_is_no_part_of_the_text(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(TEXTBOOK, encoding="utf-8-sig")
    assert pc.read_case(path) == pc.read_case("\ufeff" + TEXTBOOK) == pc.read_case(TEXTBOOK)


@given(cases())
def test_a_case_hashes_and_comes_back_from_pickle(case):
    again = pickle.loads(pickle.dumps(case))
    assert again == copy.deepcopy(case) == case
    assert hash(again) == hash(case)


def test_options_cannot_be_changed():
    with pytest.raises(TypeError):
        pc.read_case(TEXTBOOK).options["rtol"] = 1e-3


def test_tables_may_be_written_inline():
    inline = """
        link = [{mass = 1.0, length = 1.0},
                {mass = 1.0, length = 1.0}]   # two
        start = {q = [0.7853981633974483, 1.0471975511965976]}
        run = {t_end = 5.0}
        """
    assert pc.read_case(inline).scene == pc.Scene.textbook()


def test_options_are_simulates_keywords():
    t = np.linspace(0, 5, 11)
    case = pc.Case(
        scene=pc.Scene.textbook(),
        q0=1,
        t_span=(0, 5),
        options={"t_eval": t, "rtol": np.float64(1e-6)},
    )
    assert case.options == {"t_eval": tuple(t.tolist()), "rtol": 1e-6}
    assert np.array_equal(case.simulate().t, t)
    with pytest.raises(TypeError, match=r"no keyword 'tolerance': known are method, rtol"):
        pc.Case(scene=pc.Scene.textbook(), q0=1, t_span=(0, 5), options={"tolerance": 1})


def test_a_python_function_cannot_be_written():
    case = pc.Case(scene=pc.Scene.textbook(), q0=1, t_span=(0, 5), options={"progress": print})
    with pytest.raises(TypeError, match=r"^progress = .* cannot be written as TOML"):
        case.to_toml()


MISTAKES = {
    "unknown key, near a known one": (
        ("length = 1.0\n[start]", "lenght = 1.0\n[start]"),
        "line 8: unknown key 'lenght' in [link]: did you mean 'length'?",
    ),
    "unknown key in [run]": (
        ("rtol", "rtoll"),
        "line 16: unknown key 'rtoll' in [run]: did you mean 'rtol'?",
    ),
    "unknown key in [start]": (
        ("qd =", "omega ="),
        "line 11: unknown key 'omega' in [start]: known are q, q_deg, qd",
    ),
    "unknown key above the tables": (
        ("gravity", "gravty"),
        "line 2: unknown key 'gravty': did you mean 'gravity'?",
    ),
    "unknown table": (("[start]", "[begin]"), "line 9: unknown key 'begin': known are "),
    "misspelt table": (("[start]", "[strat]"), "line 9: unknown key 'strat': did you mean 'start'"),
    "key in the wrong table": (
        ('method = "dopri5"', "gravity = 9.8"),
        "line 15: unknown key 'gravity' in [run]: it belongs above all tables",
    ),
    "key above its table": (
        ("gravity = 9.807", "t_end = 5.0"),
        "line 2: unknown key 't_end': it belongs in [run]",
    ),
    "key twice": (("qd = [0.0, 0.0]", "q = [0.0, 0.0]"), "(at line 11, column"),
    "not TOML": (("mass = 1.0", "mass = one"), "(at line 4, column"),
    "mass missing": (("mass = 1.0\n", ""), "line 3: link 1 needs mass"),
    "no links": (("[[link]]\nmass = 1.0\nlength = 1.0\n", ""), "links are needed: a table [["),
    "links as one table": (
        ("[[link]]\nmass = 1.0\nlength = 1.0\n[[link]]", "[link]"),
        "line 3: [link] is one table: write [[link]], once for each link",
    ),
    "no start": (("q = [0.7853981633974483, 1.0471975511965976]\n", ""), "line 9: [start] needs q"),
    "two starts": (("qd = [0.0, 0.0]", "q_deg = [0.0, 0.0]"), "line 9: [start] needs q"),
    "no end": (("t_end = 5.0\n", ""), "line 12: [run] needs t_end (s)"),
    "text for a number": (("gravity = 9.807", 'gravity = "9.8"'), "line 2: gravity = '9.8': must"),
    "truth for a number": (("mass = 1.0", "mass = true"), "line 4: mass = True: must be a"),
    "text for a list": (("qd = [0.0, 0.0]", 'qd = "0"'), "line 11: qd = '0': must be a number or"),
    "text in a list": (("[0.0, 0.0]", '[0.0, "0"]'), "line 11: qd = [0.0, '0']: must be a number"),
    "bad degrees": (
        ("q = [0.7853981633974483, 1.0471975511965976]", "q_deg = [45, nan]"),
        "line 10: q_deg[1] = nan: must be finite (deg)",
    ),
    "too many degrees": (
        ("q = [0.7853981633974483, 1.0471975511965976]", "q_deg = [45, 60, 75]"),
        "line 10: q_deg: shape (3,): must be (2,) (deg)",
    ),
    "rates in degrees": (
        ("qd =", "qd_deg ="),
        "line 11: unknown key 'qd_deg' in [start]: give qd, in rad/s",
    ),
    "huge number": (("gravity = 9.807", f"gravity = 1{400 * '0'}"), "line 2: gravity: is too"),
    "huge in a list": (("[0.0, 0.0]", f"[0, 1{400 * '0'}]"), "line 11: qd: is too large"),
    "endless number": (("gravity = 9.807", f"gravity = 1{5000 * '0'}"), "case.toml: "),
    "number for text": (('"double pendulum, section 2.1"', "2.1"), "line 1: name = 2.1: must be"),
    "date in [run]": (("rtol = 1e-9", "rtol = 2020-01-01"), "line 16: rtol = "),
    "date in a list": (("rtol = 1e-9", "rtol = [2020-01-01]"), "line 16: rtol = "),
    "negative mass": (("mass = 1.0\nlength = 1.0\n[start]", "mass = -1.0\nlength = 1.0\n[start]"),
                      "line 7: link 2: mass = -1"),
    "not a number": (("qd = [0.0, 0.0]", "qd = [0.0, nan]"), "line 11: qd[1] = nan: must be"),
    "infinite gravity": (("9.807", "inf"), "line 2: gravity = inf: must be finite"),
    "too many angles": (("[0.0, 0.0]", "[0.0, 0.0, 0.0]"), "line 11: qd: shape (3,): must be"),
}  # fmt: skip


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_is_told_with_file_line_and_remedy(mistake, tmp_path):
    (right, wrong), message = MISTAKES[mistake]
    assert right in TEXTBOOK
    count = 2 if mistake == "no links" else 1
    path = tmp_path / "case.toml"
    path.write_text(TEXTBOOK.replace(right, wrong, count))
    with pytest.raises(ValueError, match=re.escape(message)) as error:
        pc.read_case(path)
    assert str(error.value).startswith(str(path))


def test_lines_are_counted_through_comments_strings_and_lists():
    text = '''\
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
    with pytest.raises(ValueError, match=r"^case, line 21: unknown key 'rtoll'"):
        pc.read_case(text)


def test_a_number_for_a_table_is_told():
    text = "link = [{mass = 1, length = 1}]\nstart = 1\nrun = {t_end = 5}\n"
    with pytest.raises(ValueError, match=r"^case, line 2: start = 1: must be a table"):
        pc.read_case(text)


def test_a_file_that_is_not_text_is_named(tmp_path):
    path = tmp_path / "case.toml"
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ValueError, match=r"case\.toml: is not a text file in UTF-8"):
        pc.read_case(path)


@pytest.mark.parametrize(
    ("name", "value"), [("q0", [1, 2, 3]), ("qd0", [[0, 0]]), ("t_span", 5), ("t_span", (0, 1, 2))]
)
def test_wrong_shapes_are_told_by_name(name, value):
    given_rightly = {"scene": pc.Scene.textbook(), "q0": 1, "t_span": (0, 1)}
    with pytest.raises(ValueError, match=rf"^{name}: shape"):
        pc.Case(**{**given_rightly, name: value})
