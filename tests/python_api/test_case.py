"""A case comes back from all that it can be written as; docs/how_to/case_files.md has every key."""

from __future__ import annotations

import copy
import pickle
import re
import tomllib
from math import pi
from pathlib import Path

import numpy as np
import pendcore as pc
import pytest
from drawn_effects import scenes
from hypothesis import given
from hypothesis import strategies as st
from pendcore import effects as fx
from pendcore._cases.case_file import EVENT_KEYS, KEYS
from pendcore.options import RUN_DEFAULTS

LINK = "[[link]]\nmass = 1.0\nlength = 1.0\n"
TEXTBOOK = f"""\
name = "double pendulum, section 2.1"
gravity = 9.807
{LINK}{LINK}[start]
q = [0.7853981633974483, 1.0471975511965976]
qd = [0.0, 0.0]
[run]
t_start = 0.0
t_end = 5.0
method = "dopri5"
rtol = 1e-9
"""
DAMPED = '[[effect]]\nkind = "viscous_joint"\njoint = 1\ndamping = 0.1\n'
MOTOR = """\
[[effect]]
kind = "motor"
joint = 2
sinusoid = {amplitude = 1.0, angular_frequency = 6.0}
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
        "ledger": st.booleans(),
        "compensated": st.booleans(),
    },
)


@st.composite
def cases(draw):
    scene = draw(scenes())
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
@pytest.mark.filterwarnings("ignore::pendcore.PendcoreWarning")
def test_a_case_comes_back_from_toml_repr_pickle_and_copy_to_the_last_bit(case):
    names = {"Case": pc.Case, "Scene": pc.Scene, "Link": pc.Link, "inf": float("inf")}
    written = eval(repr(case), vars(fx) | names)
    for again in (pc.read_case(case.to_toml()), written, pickle.loads(pickle.dumps(case))):
        assert again == copy.deepcopy(again) == case
        assert (hash(again), repr(again)) == (hash(case), repr(case))


def test_the_textbooks_case_is_that_of_the_documents():
    read = pc.read_case(TEXTBOOK)
    told = (read.scene, read.q0, read.t_span, dict(read.options))
    start = (pi / 4, pi / 3), (0.0, 5.0)
    assert told == (pc.Scene.textbook(), *start, {"method": "dopri5", "rtol": 1e-9})
    assert np.array_equal(read.simulate().y, pc.Case.textbook().simulate().y)


def test_what_is_left_out_has_the_defaults_of_scene_and_simulate():
    read = pc.read_case("[[link]]\nmass = 1\nlength = 2\n[start]\nq = [1]\n[run]\nt_end = 3\n")
    assert read == pc.Case(scene=pc.Scene(links=[pc.Link(mass=1, length=2)]), q0=1, t_span=(0, 3))
    assert (read.scene.gravity, read.qd0) == (9.807, (0.0,))


INLINE = """
link = [{mass = 1.0, length = 1.0},
        {mass = 1.0, length = 1.0}]   # two
name = "double pendulum, section 2.1"
start = {q = [0.7853981633974483, 1.0471975511965976]}
run = {t_end = 5.0, method = "dopri5", rtol = 1e-9}
"""
ANGLES = "q = [0.7853981633974483, 1.0471975511965976]"
RATES = "qd = [0.0, 0.0]"
SAME = {
    "degrees": (TEXTBOOK.replace(ANGLES, "q_deg = [45, 60]"), TEXTBOOK),
    "tables in a line": (INLINE, TEXTBOOK),
    "a byte order mark": ("\ufeff" + TEXTBOOK, TEXTBOOK),
    "one angle": (TEXTBOOK.replace(ANGLES, "q = 1"), TEXTBOOK.replace(ANGLES, "q = [1.0, 1]")),
    "one angle in degrees": (
        TEXTBOOK.replace(ANGLES, "q_deg = 45.0"), TEXTBOOK.replace(ANGLES, "q_deg = [45, 45]")
    ),
    "one rate": (TEXTBOOK.replace(RATES, "qd = 0.5"), TEXTBOOK.replace(RATES, "qd = [0.5, 0.5]")),
    "no rates": (TEXTBOOK.replace(RATES, ""), TEXTBOOK),
    "even times": (
        f"{TEXTBOOK}t_eval = {{start = 0.0, stop = 2.0, count = 5}}\n",
        f"{TEXTBOOK}t_eval = [0, 0.5, 1, 1.5, 2]\n",
    ),
    "parts in tables below": (
        TEXTBOOK + MOTOR.replace("sinusoid = {", "[effect.sinusoid]\n").replace(", ", "\n")[:-2]
        + "\n" + DAMPED,
        TEXTBOOK + MOTOR + DAMPED,
    ),
}  # fmt: skip


@pytest.mark.parametrize("way", SAME)
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_a_case_may_be_written_in_several_ways(way, end, tmp_path):
    one, other = SAME[way]
    path = tmp_path / "case.toml"
    path.write_bytes(one.replace("\n", end).encode())
    assert pc.read_case(path) == pc.read_case(str(path)) == pc.read_case(one)
    assert pc.read_case(path) == pc.read_case(other)


def test_effects_are_tables_of_their_kind_in_their_order_without_what_is_as_by_default():
    payload = '[[effect]]\nkind = "payload"\nmass = 2\n'
    table = "table = {t = [0.0, 1.0], torque = [1.0, 2.0], hold = true}\n"
    held = MOTOR[: MOTOR.index("sinusoid")] + table
    case = pc.read_case(TEXTBOOK + MOTOR + DAMPED + held + payload)
    assert case.scene.effects == (
        fx.Motor(joint=2, sinusoid=fx.Sinusoid(amplitude=1.0, angular_frequency=6.0)),
        fx.ViscousJoint(joint=1, damping=0.1),
        fx.Motor(joint=2, table=fx.Table([0.0, 1.0], [1.0, 2.0], hold=True)),
        fx.Payload(mass=2.0),
    )
    assert f"{MOTOR}\n{DAMPED}\n{held}\n" in case.to_toml()


def test_options_are_simulates_keywords_and_cannot_be_changed():
    t = np.linspace(0, 5, 11)
    options = {"t_eval": t, "rtol": np.float64(1e-6)}
    case = pc.Case(scene=pc.Scene.textbook(), q0=1, t_span=(0, 5), options=options)
    assert case.options == {"t_eval": tuple(t.tolist()), "rtol": 1e-6}
    assert np.array_equal(case.simulate().t, t)
    with pytest.raises(TypeError):
        case.options["rtol"] = 1e-3


REFERENCE = (Path(__file__).parents[2] / "docs/how_to/case_files.md").read_text()
BLOCKS = re.findall(r"```toml\n(.*?)```", REFERENCE, re.DOTALL)


def documented():
    """Kind of table, key and default of every row of the reference."""
    for section in REFERENCE.split("\n## ")[1:]:
        title = section.splitlines()[0].strip("`[]")
        for key, default in re.findall(r"^\| `(\w+)` \| [^|]*\| ([^|]*) \|", section, re.MULTILINE):
            yield "" if title == "Above all tables" else title, key, default


def test_the_reference_has_every_key_and_no_other_and_the_defaults_of_simulate():
    found = [(kind, key) for kind, key, _ in documented()]
    assert found == [(kind, key) for kind, keys in KEYS.items() for key in keys]
    for kind, key, default in documented():
        usual = RUN_DEFAULTS.get(key) if kind == "run" else None
        assert "`None`" not in default, key
        if usual is not None:
            assert tomllib.loads(f"default = {default.strip('`')}")["default"] == usual, key


def test_the_reference_has_the_keys_of_every_event():
    (rows,) = re.findall(r"^\| kind \| keys, and for each.*?\n\n", REFERENCE, re.M | re.DOTALL)
    usual, _, *kinds = (re.findall(r"`(\w+)`", row) for row in rows.strip().splitlines())
    found = {kind: {"kind", *keys, *usual} for kind, *keys in kinds}
    assert found == {kind: set(keys) for kind, keys in EVENT_KEYS.items()}


@pytest.mark.parametrize("tables", BLOCKS[1:])
def test_the_tables_that_the_reference_shows_can_be_added_to_a_case(tables):
    before, start = BLOCKS[0].split("[start]")
    added = pc.read_case(f"{before}{tables}[start]{start}").scene.effects
    assert [effect.kind for effect in added] == re.findall(r'kind = "(\w+)"', tables)


# Names may be any text that a file can hold -----------------------------------------------------

HALF = "swing\udce9"  # what Python makes of a file's name that is not UTF-8
BOOK = pc.Case.textbook()
SHORT = {"scene": BOOK.scene, "q0": BOOK.q0, "t_span": (0.0, 0.2)}
KEPT = {HALF: pc.reducers.EnergyDrift()}
DOORS = {
    "a case": lambda sol, path: pc.Case(**SHORT, name=HALF),
    "a case file": lambda sol, path: pc.read_case(BOOK.to_toml().replace("double pendulum", HALF)),
    "a solution": lambda sol, path: setattr(sol, "name", HALF),
    "the title of a page": lambda sol, path: sol.to_html(path / "a.html", title=HALF),
    "a film": lambda sol, path: sol.to_video(path / "a.gif", sol, names=("a", HALF)),
    "an animation": lambda sol, path: sol.animate(names=(HALF,)),
    "the label in a figure": lambda sol, path: sol.plot(label=HALF),
    "a comparison": lambda sol, path: pc.accuracy_cost(**SHORT, methods="dopri5", name=HALF),
    "a reducer": lambda sol, path: pc.ensemble(**SHORT | {"q0": [BOOK.q0]}, keep=KEPT),
}


@pytest.mark.parametrize("door", DOORS)
def test_half_a_character_is_refused_at_the_door(door, tmp_path):
    sol = pc.Case(**SHORT, name="kept").simulate()
    with pytest.raises(ValueError, match=r"holds '\\udce9', half a character.*: leave it out"):
        DOORS[door](sol, tmp_path)
    assert [*tmp_path.iterdir()] == []
    assert sol.name == "kept"


CONTROLS = ["\n", "\0\x1f\x7f\x80", "\u2028"]
TEXTS = ["θ sweep", "摆", "\U0001f600", "\U0001d11e", 'a "b" \\ c\n</script>\x7f', "#[=]", ""]


@pytest.mark.parametrize("name", [*CONTROLS, *TEXTS])
def test_any_other_name_comes_back_from_a_file(name, tmp_path):
    sol = pc.Case(**SHORT, name=name).simulate()
    sol.save(tmp_path / "run.npz")
    assert pc.load(tmp_path / "run.npz").name == name
    (tmp_path / "case.toml").write_text(sol.case().to_toml(), encoding="utf-8")
    assert pc.read_case(tmp_path / "case.toml").name == name
    assert sol.to_html(tmp_path / "run.html").read_bytes().decode("utf-8")
