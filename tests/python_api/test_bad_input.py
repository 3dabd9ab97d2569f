"""Messages of refused input name the field, its value, the range and the remedy."""

from __future__ import annotations

import re
from fractions import Fraction
from functools import partial

import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx
from pendcore.options import OPTIONS

nan, inf = float("nan"), float("inf")
ROD = pc.Link(mass=1, length=1)
BOOK = pc.Scene.textbook()
MANY = np.broadcast_to(1.0, 10**7)


def simulate(**changes):
    given = {"scene": BOOK, "q0": [1, 2], "qd0": [0, 0], "t_span": (0, 1)}
    return pc.simulate(**{**given, **changes})


def refused(call, words, errors=(ValueError, TypeError)):
    """Require a refusal that begins with whole words; anything may stand at each " ... "."""
    pattern = ".*".join(re.escape(part) for part in words.split(" ... "))
    with pytest.raises(errors, match=rf"^{pattern}(?!(?<=\w)\w)"):
        call()


NO_NUMBERS = {
    repr(x): x for x in ["1", "ab", b"1", True, None, 1j, {}, np.datetime64(1, "s"), [[1], [2, 3]]]
}
NO_VECTORS = NO_NUMBERS | {
    "texts": ["1", "2"],
    "truths": [True, False],
    "nothings": [None, None],
    "complex numbers": [1j, 2j],
    "objects": np.array([1, 2], dtype=object),
    "an array of texts": np.array(["1", "2"]),
    "a generator": (x for x in (0.25, 1.0)),
    "a set": {0.25, 1.0},
    "records": np.array([(1.0, 2.0)], dtype=[("a", float), ("b", float)]),
    "times of a clock": np.array([1, 2], "m8[s]"),
    "a text without axes": np.array("x"),
    "a list of itself": [],
}
NO_VECTORS["a list of itself"].append(NO_VECTORS["a list of itself"])


@pytest.mark.parametrize("name", ["q0", "qd0", "rtol", "atol", "t_eval"])
@pytest.mark.parametrize("value", NO_VECTORS)
def test_what_is_no_real_number_is_refused(name, value):
    if (name, value) != ("t_eval", "None"):
        refused(lambda: simulate(**{name: NO_VECTORS[value]}), name)


RUN = simulate()
OPTIONAL = ["max_step", "first_step", "step", "time_limit", "max_steps"]
SINGLE = {name: [lambda x, name=name: simulate(**{name: x})] for name in OPTIONAL} | {
    "t_span": [lambda x: simulate(t_span=(x, 1)), lambda x: simulate(t_span=(0, x))],
    "t": [lambda x: BOOK.accelerations(x, [1, 2], [0, 0]), RUN],
    "q": [lambda x: BOOK.accelerations(0, x, [0, 0])],
    "qd": [lambda x: BOOK.accelerations(0, [1, 2], x)],
}


@pytest.mark.parametrize("name", SINGLE)
@pytest.mark.parametrize("value", [*NO_NUMBERS.values(), ["a", "b"], [None, 1]], ids=repr)
def test_neither_is_it_taken_for_settings_times_or_states(name, value):
    for call in SINGLE[name]:
        if value is not None or name not in OPTIONAL:
            refused(partial(call, value), name)


@pytest.mark.parametrize("name", ["mass", "length", "center", "inertia"])
@pytest.mark.parametrize("value", ["1", True, 1j, [1], np.ones(1)], ids=repr)
def test_a_link_of_no_real_numbers_is_refused(name, value):
    link = {"mass": 1, "length": 1, name: value}
    refused(lambda: pc.Link(**link), f"{name} = ... : must be a real number (", TypeError)


@pytest.mark.parametrize("value", [2, np.float32(2), np.int8(2), Fraction(2), np.longdouble(2)])
def test_any_real_number_makes_a_link(value):
    assert pc.Link(mass=value, length=value) == pc.Link(mass=2.0, length=2.0)
    assert BOOK.mass_matrix([10**20, 0]).shape == (2, 2)


RIGHT_SHAPES = {"q0": "(2,)", "qd0": "(2,)", "rtol": "a number or (4,)", "atol": "a number or (4,)"}


COUNTS = {"q0": [2], "qd0": [2], "rtol": [1, 4], "atol": [1, 4]}
SHAPES = [(0,), (1,), (2,), (3,), (2, 1), (1, 2), (4, 1), (0, 2), (1, 1, 1)]


WRONG = [
    (name, shape)
    for name in (*RIGHT_SHAPES, "t_eval")
    for shape in SHAPES
    if len(shape) > 1 or (name != "t_eval" and shape[0] not in COUNTS[name])
]


@pytest.mark.parametrize("pair", WRONG, ids=str)
def test_a_start_of_the_wrong_shape_is_refused_with_the_right_one(pair):
    name, shape = pair
    words = f"{name}: shape {shape}: must be {RIGHT_SHAPES.get(name, '(k,)')}"
    if len(shape) == 1:
        words = f"{name} ... {COUNTS[name][-1]}"
    refused(lambda: simulate(**{name: np.full(shape, 1e-9)}), words, ValueError)


@pytest.mark.parametrize("bad", [nan, inf, -inf], ids=str)
@pytest.mark.parametrize("name", ["q0", "qd0"])
def test_a_start_that_is_not_finite_is_named_with_its_place(name, bad):
    refused(lambda: simulate(**{name: [0.0, bad]}), f"{name}[1] = {bad}: must be finite (rad")
    refused(lambda: simulate(**{name: bad}), f"{name} ... = {bad}: must be finite (rad")


def below(range):
    """Return a number below the least of a range that is told in words."""
    return int(re.search(r"\d+", range)[0]) - 1


OPTIONS_OF_A_RUN = [
    ({"t_span": (nan, 1)}, "start of the run = nan: must be finite (s)"),
    ({"t_span": (0, inf)}, "end of the run = inf: must be finite (s)"),
    ({"t_span": 5}, "t_span = 5: must be (t_start, t_end)"),
    ({"t_span": (0, 1, 2)}, "t_span = (0, 1, 2): must be (t_start, t_end)"),
    ({"t_span": ()}, "t_span = (): must be (t_start, t_end)"),
    ({"t_span": None}, "t_span = None: must be (t_start, t_end), in s"),
    ({"rtol": 0}, "rtol = 0.0: must be finite and > 0"),
    ({"rtol": nan}, "rtol = nan: must be finite and > 0"),
    ({"rtol": [1e-9, 1e-9, 0, 1e-9]}, "rtol ... = 0.0: must be finite and > 0"),
    ({"rtol": 10**400}, "rtol: is too large"),
    ({"atol": inf}, "atol = inf: must be finite and >= 0"),
    ({"max_step": 0}, "max_step = 0.0: must be > 0, inf for no limit (s)"),
    ({"max_step": nan}, "max_step = nan: must be > 0, inf for no limit (s)"),
    ({"first_step": 0}, "first_step = 0.0: must be finite and > 0 (s)"),
    ({"step": 0}, "step = 0.0: must be finite and > 0 (s)"),
    ({"step": inf}, "step = inf: must be finite and > 0 (s)"),
    ({"step": 0.1, "first_step": 0.1}, "first_step: a fixed step is given as"),
    ({"step": 0.1, "max_step": 0.01}, "step = 0.1: must be <= max_step = 0.01"),
    ({"max_steps": 10**30}, "max_steps: is too large"),
    ({"time_limit": 0}, "time_limit = 0.0: must be > 0, inf for no limit"),
    ({"time_limit": nan}, "time_limit = nan: must be > 0, inf for no limit"),
    ({"t_eval": []}, "t_eval: is empty: must hold a time (s), or be left out"),
    ({"t_eval": [0.5, 0.2]}, "t_eval[1] = 0.2: must be beyond t_eval[0] = 0.5 ... sort the times"),
    ({"t_eval": [0.5, 0.5]}, "t_eval[1] = 0.5: must be beyond ... each once"),
    ({"t_eval": [-0.5]}, "t_eval[0] = -0.5: must be within the run, 0.0 to 1.0 s"),
    ({"t_eval": [0.5, 2]}, "t_eval[1] = 2.0: must be within the run, 0.0 to 1.0 s"),
    ({"t_eval": [nan]}, "t_eval[0] = nan: must"),
    ({"t_eval": [0.5], "store": "end"}, 'store = "end": ... t_eval ... : must be'),
    ({"t_eval": [0.2, 0.5], "t_span": (1, 0)}, "t_eval[1] = 0.5: must ... swap the ends of t_span"),
    ({"method": "dopri6"}, 'method = "dopri6": must be one of ... dopri5'),
    ({"method": 5}, "method = 5: "),
    ({"method": "s\udcff"}, r"method = 's\udcff': must be"),
    ({"store": "all"}, """store = 'all': must be "dense", "steps", "times" or "end\""""),
    ({"store": 1}, "store = 1: "),
    ({"q0": [1, 2, 0, 0]}, "q0: has 4 numbers: must have 2, ... angles are q0, rates qd0"),
    ({"store": "s\udcff"}, r"store = 's\udcff': must be"),
    ({"store": "times"}, 't_eval: none given: store = "times" keeps'),
    ({"scene": "textbook"}, "scene = 'textbook': must be a pendcore.Scene"),
    ({"scene": 5, "t_span": 5}, "scene = 5: must be a pendcore.Scene"),
    ({"scene": pc.Case.textbook()}, "scene: is a Case: ... case.simulate()"),
    ({"progress": 3}, "progress = 3: must be None, True, False, or"),
    ({"rtoll": 1e-6}, "simulate has no parameter 'rtoll': did you mean 'rtol'?"),
    ({"tspan": (0, 1)}, "simulate has no parameter 'tspan': did you mean 't_span'?"),
    ({"tend": 3}, "simulate has no parameter 'tend': did you mean 't_span'?"),
    ({"dense_output": True}, "simulate ... 'dense_output': did you mean 'store'?"),
    *[({name: below(one.range)}, f"{name} = {below(one.range)} ... : must be {one.range}")
      for name, one in OPTIONS.items() if one.range],
    ({"xyzzy": 1}, "simulate has no parameter 'xyzzy': known are scene, t_span, q0, qd0, "),
]  # fmt: skip


@pytest.mark.parametrize(("changes", "words"), OPTIONS_OF_A_RUN, ids=str)
def test_an_option_out_of_range_is_told_with_the_range(changes, words):
    refused(lambda: simulate(**changes), words)


def rod_and(**changes):
    return pc.Scene(links=[ROD, pc.Link(**{"mass": 1, "length": 1, **changes})])


def accelerations(**changes):
    return BOOK.accelerations(**{"t": 0, "q": [1, 2], "qd": [0, 0], **changes})


def case(**changes):
    return pc.Case(**{"scene": BOOK, "q0": 1, "t_span": (0, 5), **changes})


LOCKED = pc.Scene(links=[ROD, ROD], effects=[fx.Lock(2, angle=0.0)])
THREE = np.zeros((2, 3))
TYPE_ERRORS = [
    ("scene = 'textbook': must be a pendcore.Scene", lambda: pc.ensemble("textbook", (0, 1), 0.5)),
    (" ... tolerance", lambda: simulate(tolerance=1e-9)),
    (" ... massa", lambda: pc.Link(mass=1, length=1, massa=1)),
    (" ... 'm'", lambda: pc.Link(mass=1, length=1, m=1)),
    (" ... Mass", lambda: pc.Link(mass=1, length=1, Mass=1)),
    ("simulate() missing ... required ... 'q0'", lambda: pc.simulate(BOOK)),
    ("simulate() missing ... required ... 'q0'", lambda: pc.simulate(BOOK, (0, 1))),
    ("links = Link( ... ): must be a list of pendcore.Link", lambda: pc.Scene(links=ROD)),
    ("links = 5: must be a list of pendcore.Link", lambda: pc.Scene(links=5)),
    ("link 2 = (1, 1): must be a list of pendcore.Link", lambda: pc.Scene(links=[ROD, (1, 1)])),
    ("link 2 = Link: must be a pendcore.Link object, such as Link(mass=1.0, length=1.0); got the "
     "class itself", lambda: pc.Scene(links=[ROD, pc.Link])),
    ("effect 1 = ViscousJoint: must be a pendcore.effects object, such as ViscousJoint(joint=1, "
     "damping=0.1); got the class itself",
     lambda: pc.Scene(links=[ROD], effects=[fx.ViscousJoint])),
    ("gravity = 'g': must be a real number", lambda: pc.Scene(links=[ROD], gravity="g")),
    ("theta: holds text: must hold real numbers (rad)", lambda: pc.angles_from_vertical(["1"])),
    ("name = None: must be a text", lambda: case(name=None)),
    ("name = b'a': must be a text", lambda: case(name=b"a")),
    ("name = 5: must be a text", lambda: setattr(RUN, "name", 5)),
    (" ... no keyword 'tolerance': known are method, rtol", lambda: case(options={"tolerance": 1})),
    ("progress = ... cannot be written as TOML",
     lambda: case(options={"progress": print}).to_toml()),
]  # fmt: skip
VALUE_ERRORS = [
    ("link 1: mass = 0.0: must be finite and > 0",
     lambda: pc.Scene(links=[pc.Link(mass=0, length=1)])),
    ("q[0] = nan: must be finite (rad)", lambda: pc.angles_to_vertical([nan])),
    *[(f'zero = {zero!r}: must be "hanging" or "upright"', partial(turn, 0.0, zero=zero))
      for turn in (pc.angles_from_vertical, pc.angles_to_vertical)
      for zero in ("up", "Upright", "", None, 1, ["upright"])],
    ("q: shape (3,): must be (2,)", lambda: BOOK.explain(q=[1, 2, 3])),
    ("t = nan: must be finite", lambda: BOOK.explain(t=nan)),
    *[(f"{name}: has 10000000 numbers: must have", partial(simulate, **{name: MANY}))
      for name in ("q0", "qd0", "rtol", "atol")],
    ("q0: shape", lambda: case(q0=[1, 2, 3])),
    ("qd0: shape", lambda: case(qd0=[[0, 0]])),
    ("t_span: shape", lambda: case(t_span=5)),
    ("t_span: shape", lambda: case(t_span=(0, 1, 2))),
    ("links", lambda: pc.Scene(links=[])),
    ("link 2: mass = -1.0: must be finite and > 0 (kg)", lambda: rod_and(mass=-1)),
    ("link 2: mass = 0.0: must be finite and > 0 (kg)", lambda: rod_and(mass=0)),
    ("link 2: mass = nan: must be finite and > 0 (kg)", lambda: rod_and(mass=nan)),
    ("link 2: mass = inf: must be finite and > 0 (kg)", lambda: rod_and(mass=inf)),
    ("link 2: length = 0.0: must be finite and > 0 (m)", lambda: rod_and(length=0)),
    ("link 2: length = -2.0: must be finite and > 0 (m)", lambda: rod_and(length=-2)),
    ("link 2: center = nan: must be finite (m", lambda: rod_and(center=nan)),
    ("link 2: inertia = -1.0: must be finite and >= 0 (kg m", lambda: rod_and(inertia=-1)),
    ("link 2: inertia = inf: must be finite and >= 0", lambda: rod_and(inertia=inf)),
    ("link 1: inertia about its joint, with what it carries, = inf: must be finite (kg m^2)",
     lambda: pc.Scene(links=[pc.Link(mass=1, length=1e160, center=0, inertia=1), ROD])),
    *[(f"{name}: is too large: must be below 1.8e308 (", partial(rod_and, **{name: 10**size}))
      for name in ("mass", "length", "center", "inertia") for size in (400, 5000)],
    *[(f"gravity = {value}: must be finite (m/s", partial(BOOK.replace, gravity=value))
      for value in (nan, inf, -inf)],
    ("q: is too large: must be below 1.8e308 (rad)", lambda: BOOK.mass_matrix(10**400)),
    ("q: is too large: must be below 1.8e308 (rad)", lambda: BOOK.mass_matrix([1, 10**5000])),
    *[(f"{name}: shape {np.shape(x)}: must be (..., 2)", partial(accelerations, **{name: x}))
      for name in ("q", "qd") for x in (1, [1], [1, 2, 3], THREE)],
    ("t, q, qd: shapes (3,), (2, 2), (2,): must", lambda: accelerations(t=[0] * 3, q=THREE[:, :2])),
    ("q[1][0] = nan: must be finite (rad)", lambda: BOOK.mass_matrix([[0, 0], [nan, 0]])),
    ("t = inf: must be finite (s)", lambda: accelerations(t=inf)),
    ("qd[0] = nan: must be finite", lambda: accelerations(qd=[nan, 0])),
    ("q: is too large", lambda: accelerations(q=[10**400, 0])),
    ("t", lambda: RUN(nan)),
    ("t", lambda: RUN([[0.5]])),
    ("t = -0.001 ... must be within the run, 0.0 to 1.0 s", lambda: RUN(-0.001)),
    ("t = 1.001 ... must be within the run, 0.0 to 1.0 s", lambda: RUN(1.001)),
    ("t ... = 5.0 ... must be within the run, 0.0 to 1.0 s", lambda: RUN([0.5, 5])),
    *[(f"ViscousJoint: joint = {joint}: must be a whole number, 1 or more",
       partial(fx.ViscousJoint, joint, damping=0.1)) for joint in (0, -3)],
    ("q0: angle of joint 2 = 0.5: must be 0.0 rad, as effect 1 (lock) says: start there",
     lambda: pc.simulate(LOCKED, q0=[0.5, 1.0], t_span=(0, 1))),
]  # fmt: skip
OTHERS = [(*row, TypeError) for row in TYPE_ERRORS] + [(*row, ValueError) for row in VALUE_ERRORS]


@pytest.mark.parametrize(("words", "call", "error"), OTHERS, ids=[words for words, *_ in OTHERS])
def test_what_else_is_given_wrongly_is_told_by_name(words, call, error):
    refused(call, words, error)
