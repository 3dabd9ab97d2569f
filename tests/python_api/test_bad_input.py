"""Messages of refused input name the field, its value, the range and the remedy."""

from __future__ import annotations

import re
import warnings
from fractions import Fraction

import numpy as np
import pendcore as pc
import pytest

nan, inf = float("nan"), float("inf")
ROD = pc.Link(mass=1, length=1)


def simulate(**changes):
    given = {"scene": pc.Scene.textbook(), "q0": [1, 2], "qd0": [0, 0], "t_span": (0, 1)}
    return pc.simulate(**{**given, **changes})


NO_NUMBERS = ["1", "ab", b"1", True, None, 1j, {}, np.datetime64(1, "s"), [[1], [2, 3]]]
NO_VECTORS = [
    *NO_NUMBERS,
    ["1", "2"],
    [True, False],
    [None, None],
    [1j, 2j],
    np.array([1, 2], dtype=object),
    np.array(["1", "2"]),
]


@pytest.mark.parametrize("name", ["q0", "qd0", "rtol", "atol"])
@pytest.mark.parametrize("value", NO_VECTORS, ids=repr)
def test_what_is_no_real_number_is_refused(name, value):
    with pytest.raises((TypeError, ValueError), match=rf"^{name}\b"):
        simulate(**{name: value})


@pytest.mark.parametrize("value", [x for x in NO_VECTORS if x is not None], ids=repr)
def test_times_that_are_no_real_numbers_are_refused(value):
    with pytest.raises((TypeError, ValueError), match=r"^t_eval\b"):
        simulate(t_eval=value)


@pytest.mark.parametrize("value", NO_NUMBERS, ids=repr)
def test_a_span_that_is_no_real_number_is_refused(value):
    for t_span in ((value, 1), (0, value)):
        with pytest.raises((TypeError, ValueError), match=r"^t_span\b"):
            simulate(t_span=t_span)


@pytest.mark.parametrize("name", ["max_step", "first_step", "step", "time_limit", "max_steps"])
@pytest.mark.parametrize("value", [x for x in NO_NUMBERS if x is not None], ids=repr)
def test_a_setting_that_is_no_real_number_is_refused(name, value):
    with pytest.raises((TypeError, ValueError), match=rf"^{name}\b"):
        simulate(**{name: value})


@pytest.mark.parametrize("name", ["q0", "qd0"])
@pytest.mark.parametrize("shape", [(1,), (3,), (0,)])
def test_a_start_of_the_wrong_shape_is_refused_with_the_right_one(name, shape):
    with pytest.raises(ValueError, match=rf"^{name}\b.*\b2\b"):
        simulate(**{name: np.zeros(shape)})


@pytest.mark.parametrize("name", ["rtol", "atol"])
@pytest.mark.parametrize("shape", [(2,), (3,), (0,)])
def test_a_tolerance_of_the_wrong_shape_is_refused_with_the_right_one(name, shape):
    with pytest.raises(ValueError, match=rf"^{name}\b.*\b4\b"):
        simulate(**{name: np.full(shape, 1e-9)})


@pytest.mark.parametrize("name", ["q0", "qd0", "rtol", "atol", "t_eval"])
@pytest.mark.parametrize("shape", [(2, 1), (1, 2), (4, 1), (0, 2), (1, 1, 1)])
def test_more_axes_than_one_are_refused_with_the_right_shape(name, shape):
    right = {"q0": "(2,)", "qd0": "(2,)", "t_eval": "(k,)"}.get(name, "a number or (4,)")
    with pytest.raises(ValueError, match=re.escape(f"{name}: shape {shape}: must be {right}")):
        simulate(**{name: np.ones(shape)})


@pytest.mark.parametrize("bad", [nan, inf, -inf], ids=str)
@pytest.mark.parametrize("name", ["q0", "qd0"])
def test_a_start_that_is_not_finite_is_named_with_its_place(name, bad):
    with pytest.raises(ValueError, match=rf"^{name}\[1\] = -?(nan|inf): must be finite \(rad"):
        simulate(**{name: [0.0, bad]})
    with pytest.raises(ValueError, match=rf"^{name}.* = -?(nan|inf): must be finite \(rad"):
        simulate(**{name: bad})


OUT_OF_RANGE = {
    "t_span start": ({"t_span": (nan, 1)}, r"start of the run = nan: must be finite \(s\)"),
    "t_span end": ({"t_span": (0, inf)}, r"end of the run = inf: must be finite \(s\)"),
    "rtol zero": ({"rtol": 0}, r"rtol = 0\.0: must be finite and > 0"),
    "rtol negative": ({"rtol": -1e-9}, r"rtol = -1e-0?9: must be finite and > 0"),
    "rtol nan": ({"rtol": nan}, r"rtol = nan: must be finite and > 0"),
    "one rtol zero": ({"rtol": [1e-9, 1e-9, 0, 1e-9]}, r"rtol.* = 0\.0: must be finite and > 0"),
    "atol negative": ({"atol": -1}, r"atol = -1\.0: must be finite and >= 0"),
    "atol infinite": ({"atol": inf}, r"atol = inf: must be finite and >= 0"),
    "max_step zero": ({"max_step": 0}, r"max_step = 0\.0: must be > 0, inf for no limit \(s\)"),
    "max_step nan": ({"max_step": nan}, r"max_step = nan: must be > 0, inf for no limit \(s\)"),
    "first_step zero": ({"first_step": 0}, r"first_step = 0\.0: must be finite and > 0 \(s\)"),
    "first_step negative": (
        {"first_step": -1},
        r"first_step = -1\.0: must be finite and > 0 \(s\)",
    ),
    "step zero": ({"step": 0}, r"step = 0\.0: must be finite and > 0 \(s\)"),
    "step infinite": ({"step": inf}, r"step = inf: must be finite and > 0 \(s\)"),
    "max_steps zero": ({"max_steps": 0}, r"max_steps = 0: must be a whole number, 1"),
    "max_steps negative": ({"max_steps": -5}, r"max_steps = -5: must be a whole number, 1"),
    "time_limit zero": ({"time_limit": 0}, r"time_limit = 0\.0: must be > 0, inf for no limit"),
    "time_limit nan": ({"time_limit": nan}, r"time_limit = nan: must be > 0, inf for no limit"),
    "t_eval empty": ({"t_eval": []}, r"t_eval: is empty: must hold a time \(s\), or be left out"),
    "two first steps": ({"step": 0.1, "first_step": 0.1}, r"first_step: a fixed step is given as"),
    "step too long": ({"step": 0.1, "max_step": 0.01}, r"step = 0\.1: must be <= max_step = 0\.01"),
    "t_eval not sorted": (
        {"t_eval": [0.5, 0.25]},
        r"t_eval\[1\] = 0\.25: must be beyond t_eval\[0\] = 0\.5 .*: sort the times",
    ),
    "t_eval twice": ({"t_eval": [0.5, 0.5]}, r"t_eval\[1\] = 0\.5: must be beyond .*each once"),
    "t_eval before": (
        {"t_eval": [-0.5]},
        r"t_eval\[0\] = -0\.5: must be within the run, 0\.0 to 1\.0 s",
    ),
    "t_eval after": (
        {"t_eval": [0.5, 2]},
        r"t_eval\[1\] = 2\.0: must be within the run, 0\.0 to 1\.0 s",
    ),
    "t_eval nan": ({"t_eval": [nan]}, r"t_eval\[0\] = nan: must"),
    "times and no place": (
        {"t_eval": [0.5], "store": "end"},
        r'store = "end": .*t_eval.*: must be',
    ),
    "t_eval against the run": (
        {"t_span": (1, 0), "t_eval": [0.2, 0.5]},
        r"t_eval\[1\] = 0.5: must",
    ),
    "method unknown": ({"method": "dopri6"}, r'method = "dopri6": must be one of .*dopri5'),
    "method no text": ({"method": 5}, r"method = 5: "),
    "store unknown": (
        {"store": "all"},
        r"store = 'all': must be \"dense\", \"steps\", \"times\" or \"end\"",
    ),
    "store no text": ({"store": 1}, r"store = 1: "),
    "store no valid text": ({"store": "s\udcff"}, r"store = 's\\udcff': must be"),
    "method no valid text": ({"method": "s\udcff"}, r"method = 's\\udcff': must be"),
    "times without times": ({"store": "times"}, r"t_eval: none given: store = \"times\" keeps"),
    "t_span a number": ({"t_span": 5}, r"t_span = 5: must be \(t_start, t_end\)"),
    "t_span of three": ({"t_span": (0, 1, 2)}, r"t_span = \(0, 1, 2\): must be \(t_start, t_end\)"),
    "t_span missing": ({"t_span": ()}, r"t_span = \(\): must be \(t_start, t_end\)"),
    "t_span left out": (
        {"t_span": None},
        r"t_span is missing: write t_span=\(t_start, t_end\), in s",
    ),
    "no scene": ({"scene": "textbook"}, r"scene = 'textbook': must be a pendcore.Scene"),
    "progress no function": ({"progress": 3}, r"progress = 3: must be None, True, False, or"),
}


@pytest.mark.parametrize("case", OUT_OF_RANGE)
def test_a_value_out_of_range_is_told_with_the_range(case):
    changes, message = OUT_OF_RANGE[case]
    with pytest.raises((ValueError, TypeError), match=f"^{message}"):
        simulate(**changes)


def test_whoever_simulates_a_case_is_told_how():
    with pytest.raises(TypeError, match=r"^scene: is a Case: .*case\.simulate\(\)"):
        pc.simulate(pc.Case.textbook(), (0, 1), 0.5)


def test_the_scene_is_looked_at_first():
    with pytest.raises(TypeError, match=r"^scene = 5: must be a pendcore\.Scene"):
        pc.simulate(5, 5, 0.5)


@pytest.mark.parametrize("size", [400, 5000])
def test_an_integer_beyond_the_floats_is_refused_by_name(size):
    huge = 10**size
    for name in ("mass", "length", "center", "inertia"):
        with pytest.raises(ValueError, match=rf"^{name}: is too large: must be below 1.8e308 \("):
            pc.Link(**{"mass": 1, "length": 1, name: huge})
    for q in (huge, [1, huge]):
        with pytest.raises(ValueError, match=r"^q: is too large: must be below 1.8e308 \(rad\)"):
            pc.Scene.textbook().mass_matrix(q)
    assert pc.Scene.textbook().mass_matrix([10**20, 0]).shape == (2, 2)


def test_an_unknown_keyword_is_a_type_error():
    with pytest.raises(TypeError, match="tolerance"):
        simulate(tolerance=1e-9)


SCENES = {
    "mass negative": ({"mass": -1}, r"link 2: mass = -1\.0: must be finite and > 0 \(kg\)"),
    "mass zero": ({"mass": 0}, r"link 2: mass = 0\.0: must be finite and > 0 \(kg\)"),
    "mass nan": ({"mass": nan}, r"link 2: mass = nan: must be finite and > 0 \(kg\)"),
    "mass infinite": ({"mass": inf}, r"link 2: mass = inf: must be finite and > 0 \(kg\)"),
    "length zero": ({"length": 0}, r"link 2: length = 0\.0: must be finite and > 0 \(m\)"),
    "length negative": ({"length": -2}, r"link 2: length = -2\.0: must be finite and > 0 \(m\)"),
    "center nan": ({"center": nan}, r"link 2: center = nan: must be finite \(m"),
    "inertia negative": (
        {"inertia": -1},
        r"link 2: inertia = -1\.0: must be finite and >= 0 \(kg m",
    ),
    "inertia infinite": ({"inertia": inf}, r"link 2: inertia = inf: must be finite and >= 0"),
}


@pytest.mark.parametrize("case", SCENES)
def test_a_link_out_of_range_is_told_by_number(case):
    changes, message = SCENES[case]
    with pytest.raises(ValueError, match=f"^{message}"):
        pc.Scene(links=[ROD, pc.Link(**{"mass": 1, "length": 1, **changes})])


def test_a_massless_link_may_carry_another_but_not_be_the_last():
    massless = pc.Link(mass=0, length=1)
    assert pc.simulate(pc.Scene(links=[massless, ROD]), q0=1, t_span=(0, 1)).success
    with pytest.raises(ValueError, match=r"^link 1: mass = 0\.0: must be finite and > 0"):
        pc.Scene(links=[massless])


@pytest.mark.parametrize("name", ["mass", "length", "center", "inertia"])
@pytest.mark.parametrize("value", ["1", True, 1j, [1], np.ones(1)], ids=repr)
def test_a_link_of_no_real_numbers_is_refused(name, value):
    with pytest.raises(TypeError, match=rf"^{name} = .*: must be a real number \("):
        pc.Link(**{"mass": 1, "length": 1, name: value})


@pytest.mark.parametrize("value", [2, np.float32(2), np.int8(2), Fraction(2), np.longdouble(2)])
def test_any_real_number_makes_a_link(value):
    assert pc.Link(mass=value, length=value) == pc.Link(mass=2.0, length=2.0)


@pytest.mark.parametrize("name", ["massa", "m", "Mass"])
def test_an_unknown_property_of_a_link_is_a_type_error(name):
    with pytest.raises(TypeError, match=name):
        pc.Link(mass=1, length=1, **{name: 1})


@pytest.mark.parametrize(
    ("links", "message"),
    [
        ([], r"links"),
        (ROD, r"links = Link\(.*\): must be a list of pendcore\.Link"),
        (5, r"links = 5: must be a list of pendcore\.Link"),
        ([ROD, (1, 1)], r"link 2 = \(1, 1\): must be a list of pendcore\.Link"),
    ],
)
def test_what_is_no_list_of_links_is_refused(links, message):
    with pytest.raises((ValueError, TypeError), match=f"^{message}"):
        pc.Scene(links=links)


@pytest.mark.parametrize("value", [nan, inf, -inf], ids=str)
def test_gravity_must_be_finite(value):
    with pytest.raises(ValueError, match=r"^gravity = .*: must be finite \(m/s"):
        pc.Scene(links=[ROD], gravity=value)
    with pytest.raises(TypeError, match=r"^gravity = 'g': must be a real number"):
        pc.Scene(links=[ROD], gravity="g")


@pytest.mark.parametrize(
    ("changes", "most"),
    [({"inertia": 0.26}, "0.25"), ({"inertia": 0.26, "center": 0.4}, "0.24")],
    ids=["rod", "center off the middle"],
)
def test_more_inertia_than_a_rod_could_have_is_warned_of_by_name(changes, most):
    with pytest.warns(pc.PendcoreWarning, match=rf"^link 2: inertia = 0\.26: .* = {most} kg"):
        pc.Scene(links=[ROD, pc.Link(**{"mass": 1, "length": 1, **changes})])


def test_what_a_rod_could_be_is_not_warned_of():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for link in (
            pc.Link(mass=1, length=1, inertia=0.25),
            pc.Link.point_mass(mass=1, length=0.1),
            pc.Link(mass=1e-3, length=10, center=0.1, inertia=0),
        ):
            pc.Scene(links=[ROD, link])


SCENE = pc.Scene.textbook()


@pytest.mark.parametrize("name", ["t", "q", "qd"])
@pytest.mark.parametrize(
    "value", ["1", True, 1j, None, ["a", "b"], [None, 1], [[1], [1, 2]]], ids=repr
)
def test_accelerations_of_no_real_numbers_are_refused(name, value):
    with pytest.raises((TypeError, ValueError), match=rf"^{name}: "):
        SCENE.accelerations(**{"t": 0, "q": [1, 2], "qd": [0, 0], name: value})


@pytest.mark.parametrize("name", ["q", "qd"])
@pytest.mark.parametrize("value", [1, [1], [1, 2, 3], np.zeros((2, 3))], ids=repr)
def test_accelerations_of_the_wrong_shape_are_refused(name, value):
    with pytest.raises(ValueError, match=rf"^{name}: shape .*: must be \(\.\.\., 2\)"):
        SCENE.accelerations(**{"t": 0, "q": [1, 2], "qd": [0, 0], name: value})


def test_a_value_that_is_not_finite_is_told_with_its_place():
    with pytest.raises(ValueError, match=r"^q\[1\]\[0\] = nan: must be finite \(rad\)"):
        SCENE.mass_matrix([[0, 0], [nan, 0]])
    with pytest.raises(ValueError, match=r"^t = inf: must be finite \(s\)"):
        SCENE.accelerations(inf, [0, 0], [0, 0])


@pytest.mark.parametrize("t", ["1", True, 1j, nan, [[0.5]], [0.5, "x"]], ids=repr)
def test_a_solution_is_not_evaluated_at_what_is_no_time(t):
    with pytest.raises((TypeError, ValueError), match=r"^t\b"):
        simulate()(t)
