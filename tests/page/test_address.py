"""A case in an address is data: it has known keys and numbers, or is refused as a whole."""

from __future__ import annotations

import ast
import json
import shutil
import subprocess
import tomllib
from copy import deepcopy
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import quote

import numpy as np
import pendcore as pc
import pytest
from pendcore.options import OPTIONS
from pendcore.page import html

NODE = shutil.which("node")
HERE = Path(__file__).parent
pytestmark = pytest.mark.unsanitized

FX = pc.effects
EFFECTS = [
    FX.ViscousJoint(joint=1, damping=0.1),
    FX.JointStop(joint=1, range=(-np.inf, 2.0), restitution=0.5),
    FX.RodDrag(link=2, drag_coefficient=1.2, diameter=0.05, wind=(1.0, 0.0)),
    FX.Motor(joint=2, sinusoid=FX.Sinusoid(amplitude=1.0, angular_frequency=6.0)),
    FX.Motor(joint=1, table=FX.Table(t=[0.0, 5.0], torque=[0.0, 1.0])),
]
SCENE = pc.Scene.textbook().replace(effects=EFFECTS)
HOSTILE_KEY = 'x=0) or __import__("os").system("id"), pc.Link(mass'
LINES = "a = 1\n[run]\nt_end = 9\n#"


def run():
    return pc.simulate(
        SCENE, q0=[0.8, 1.0], t_span=(0, 4), rtol=[1e-7] * 4, t_eval=[1.0, 2.0], store="dense"
    )


@pytest.fixture(scope="module")
def page():
    """Return what the page of a run is given."""
    text = html.page_of(run())
    return json.loads(text.partition('id="data">')[2].partition("</script>")[0])


def read(page, *texts):
    """Return what the page makes of cases in its address."""
    if NODE is None:
        pytest.skip("node is missing (Debian: nodejs)")
    given = {
        "known": {name: page[name] for name in ("kinds", "options")},
        "addresses": ["#case=" + text for text in texts],
    }
    done = subprocess.run(
        [str(NODE), HERE / "address.mjs"], input=json.dumps(given), text=True, capture_output=True,
        check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def address(case):
    return quote(json.dumps(case), safe="")


def test_the_case_of_a_page_comes_back_from_its_address(page):
    (found,) = read(page, address(page["case"]))
    assert json.loads(found["text"]) == page["case"]
    assert read(page, found["again"].removeprefix("#case=")) == [found]
    assert pc.read_case(found["toml"]).simulate()._run.fingerprint == run()._run.fingerprint
    made = {}
    exec(found["python"], made)
    assert made["sol"]._run.fingerprint == run()._run.fingerprint


def test_every_option_and_effect_that_a_page_can_have_is_known(page):
    assert {one["name"] for one in page["options"]} == set(OPTIONS) - html.LEFT_OUT
    case = deepcopy(page["case"])
    case["run"] = {
        "t_start": 0.0, "t_end": 3.0, "method": "rk4", "step": 0.1, "max_step": "inf", "atol": 1e-9,
        "rtol": 1e-9, "t_eval": [1.0], "store": "times", "max_steps": 9, "time_limit": 5.0,
        "ledger": True, "compensated": False, "first_step": None,
    }  # fmt: skip
    case["effect"] = [{"kind": kind, **one} for kind, one in page["defaults"].items()]
    (found,) = read(page, address(case))
    case["run"].pop("first_step")
    assert json.loads(found["text"]) == case


@pytest.mark.parametrize("name", ["inf", "-inf"])
def test_a_name_is_no_number(page, name):
    (found,) = read(page, address({**page["case"], "name": name}))
    assert json.loads(found["text"])["name"] == name
    assert pc.read_case(found["toml"]).name == name


def changed(case, path, value):
    """Return a case with another value at the end of a path."""
    made = {"case": deepcopy(case)}
    place = made
    *way, last = ("case", *path)
    for key in way:
        place = place[key]
    place[last] = value
    return made["case"]


HOSTILE = [
    (("link", 0, HOSTILE_KEY), 1, "link 1: there is no"),
    ((LINES,), 1, "there is no"),
    (("effect", 0, HOSTILE_KEY), 1, "effect 1: there is no"),
    (("effect", 3, "sinusoid", HOSTILE_KEY), 1, "effect 4: sinusoid: there is no"),
    (("run", HOSTILE_KEY), 1, "run: there is no"),
    (("run", "events"), [], "run: there is no"),
    (("start", LINES), 1, "start: there is no"),
    (("__proto__",), {"link": [{}]}, "there is no"),
    (("link", 0, "__proto__"), {"mass": 1}, "link 1: there is no"),
    (("link", 0, "constructor"), 1, "link 1: there is no"),
    (("effect", 0, "kind"), "user", "effect 1: kind: is none"),
    (("effect", 0, "kind"), "", "effect 1: kind: is none"),
    (("effect", 0, "kind"), "toString", "effect 1: kind: is none"),
    (("effect", 0, "kind"), ["viscous_joint"], "effect 1: kind: is none"),
    (("effect", 0, "joint"), "1, damping=print(1)", "effect 1: joint: must be a"),
    (("effect", 0, "joint"), 1.5, "effect 1: joint: must be a whole number"),
    (("effect", 0, "damping"), {"__class__": 1}, "effect 1: damping: must be a n"),
    (("effect", 0, "damping"), None, "effect 1: damping is missing"),
    (("effect", 1, "range"), ["print(1)", 1], "effect 2: range: must be two"),
    (("effect", 1, "range"), [0, 1, 2], "effect 2: range: must be two numbers"),
    (("effect", 3, "sinusoid"), 3, "effect 4: sinusoid: must be a table"),
    (("effect", 3, "sinusoid"), [{}], "effect 4: sinusoid: must be a table"),
    (("effect", 4, "table", "t"), ["a"], "effect 5: table: t: must be a list of n"),
    (("effect", 0), None, "effect 1: kind: is none"),
    (("effect",), {"length": 0}, "effect: must be a list"),
    (("gravity",), "9.8) or print(1", "gravity: must be a number"),
    (("gravity",), [9.8], "gravity: must be a number"),
    (("name",), 5, "name: must be text"),
    (("name",), "half \ud83d of a pair", "name: must be text"),
    (("link",), "ab", "link: must be a list"),
    (("link",), {"length": 2}, "link: must be a list"),
    (("link",), [], "link: must be a list"),
    (("link",), [None, None], "link 1: must be a table"),
    (("link",), [[], 3], "link 1: must be a table"),
    (("link", 0, "mass"), True, "link 1: mass: must be a number"),
    (("link", 0), {}, "link 1: mass is missing"),
    (("start", "q"), [1], "start: q: must be 2 finite numbers"),
    (("start", "q"), ["inf", 1], "start: q: must be 2 finite numbers"),
    (("start", "qd"), "ab", "start: qd: must be 2 finite numbers"),
    (("start",), None, "start is missing"),
    (("run", "t_end"), "inf", "run: t_end: must be a finite number"),
    (("run", "t_start"), "0", "run: t_start: must be a finite number"),
    (("run", "method"), 'auto", x=print(1), y="', "run: method: must be one of"),
    (("run", "method"), {"a": 1}, "run: method: must be one of"),
    (("run", "store"), "disk", "run: store: must be one of"),
    (("run", "rtol"), ["1e-9"], "run: rtol: must be a number, or a list"),
    (("run", "ledger"), 1, "run: ledger: must be true or false"),
    (("run",), [], "run: must be a table"),
]
"""Where a case is changed, to what, and what is said of it."""


def test_a_hostile_case_is_refused_as_a_whole_and_told_why(page):
    rows = [*HOSTILE, *(((), whole, "link: must be a list") for whole in (None, 5, "case", [], {}))]
    cases = [changed(page["case"], path, value) for path, value, _ in rows]
    wanted = [told for _, _, told in rows]
    for found, told in zip(read(page, *map(address, cases)), wanted, strict=True):
        assert found.keys() == {"refused"}, (found, told)
        assert found["refused"].startswith(told)
        assert len(found["refused"]) < 200


def test_a_damaged_address_is_refused_and_one_without_a_case_has_none(page):
    whole = address(page["case"])
    cut = [whole[:k] for k in range(1, len(whole), 97)]
    for found in read(page, *cut, "%", "%ff", "[1", "1e999", '{"link":1}'):
        assert found.keys() == {"refused"}
    assert read(page, "") == [None]


def with_infinities(value):
    """Return a case with numbers in the place of the words for them."""
    if isinstance(value, dict):
        return {key: with_infinities(one) for key, one in value.items()}
    if isinstance(value, list):
        return [*map(with_infinities, value)]
    return float(value) if value in ("inf", "-inf") else value


def places(value, path=()):
    """Yield the way to every value in a case."""
    yield path
    if isinstance(value, dict | list):
        for key, one in value.items() if isinstance(value, dict) else enumerate(value):
            yield from places(one, (*path, key))


def test_what_is_let_in_is_never_more_than_calls_of_known_names(page):
    """Every value of a case, each in turn, is something else, or has a neighbour."""
    strange = [
        'x") or print(1)', "inf", -0.0, 1e308, -5, 0, True, None, [], {}, [None], [1, "2"],
        {HOSTILE_KEY: 1}, [[[]]], "\n[run]\n", '"""', "\x7f\x00\u2028", "\ud800",
    ]  # fmt: skip
    case = page["case"]
    cases = [changed(case, path, value) for path in places(case) for value in strange]
    found = read(page, *map(address, cases))
    let_in = [one for one in found if "refused" not in one]
    assert len(cases) > 1000
    assert 20 < len(let_in) < len(cases) / 2
    for one in let_in:
        check_python(one["python"])
        text = with_infinities(json.loads(one["text"]))
        assert {"effect": []} | tomllib.loads(one["toml"]) == text


def check_python(text):
    """Assert that a program imports pendcore, and calls its names with numbers and text alone."""
    first, scene, sol = ast.parse(text).body
    assert ast.unparse(first) == "import pendcore as pc"
    for statement, name in ((scene, "pc.Scene"), (sol, "pc.simulate")):
        assert isinstance(statement, ast.Assign)
        assert isinstance(statement.value, ast.Call)
        assert ast.unparse(statement.value.func) == name
        for node in ast.walk(statement.value):
            if isinstance(node, ast.Call):
                called = ast.unparse(node.func)
                known = called.removeprefix("pc.effects.") in dir(pc.effects)
                assert known or called in ("pc.Scene", "pc.Link", "pc.simulate", "float"), called
            else:
                assert isinstance(
                    node,
                    ast.Constant | ast.keyword | ast.List | ast.Tuple | ast.UnaryOp | ast.USub
                    | ast.Name | ast.Attribute | ast.Load,
                ), ast.dump(node)  # fmt: skip
            if isinstance(node, ast.Name):
                assert node.id in ("pc", "float", "scene")


class Tags(HTMLParser):
    """The tags of a page, each with its attributes, and the text of its data."""

    def __init__(self, page):
        super().__init__()
        self.tags = []
        self.data, self._inside = "", False
        self.feed(page)

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, [name for name, _ in attrs]))
        self._inside = ("id", "data") in attrs

    def handle_data(self, data):
        self.data += data if self._inside else ""

    def handle_endtag(self, tag):
        self._inside = False


NAME = "</script><script>alert(1)</script><!--<img src=x onerror='alert(2)'>"
NAME += '" x="&quot;\u2028@SCRIPT@'


def test_a_name_is_text_in_every_page_and_table():
    plain, named = run(), run()
    plain.name, named.name = "a name", NAME
    before, after = Tags(html.page_of(plain)), Tags(html.page_of(named))
    assert before.tags == after.tags
    assert json.loads(after.data)["case"]["name"] == NAME
    assert Tags(html.page_of(plain, NAME)).tags == before.tags
    frames = [Tags(one.page()._repr_html_()).tags for one in (plain, named)]
    assert frames[0] == frames[1] == [("iframe", ["srcdoc", "style", "title"])]
    assert Tags(named._repr_html_()).tags == Tags(plain._repr_html_()).tags
