"""What notebooks show: tables with a drawing, the page in a frame, the widget that Python reads."""

from __future__ import annotations

import json
import re
import sys
from html import unescape
from xml.etree import ElementTree

import numpy as np
import pendcore as pc
import pytest
from pendcore._messages.html import drawing
from pendcore.page.html import core_for_browsers


@pytest.fixture(scope="module")
def sol():
    effects = [pc.effects.ViscousJoint(joint=2, damping=0.05), pc.effects.Payload(mass=0.2)]
    scene = pc.Scene.textbook().replace(effects=effects)
    return pc.simulate(scene, q0=[0.8, 1.0], t_span=(0, 8), error=1e-6)


def objects(sol):
    return {
        "solution": sol,
        "scene": sol.scene,
        "explanation": sol.scene.explain(),
        "accuracy": sol.accuracy,
        "ensemble": pc.ensemble(sol.scene, q0=np.zeros((3, 2)), t_span=(0, 1)),
    }


def test_objects_are_shown_by_short_tables_that_are_whole_and_have_units(sol):
    told = {name: one._repr_html_() for name, one in objects(sol).items()}
    for table in told.values():
        ElementTree.fromstring(f"<div>{table}</div>")  # every tag is closed
        assert "<table>" in table
        assert len(table) < 20_000
        assert not re.search(r"\bnan\b|None|object at", table)
    for name, part in (
        ("scene", "9.807 m/s^2"),
        ("scene", "damping=0.05"),
        ("explanation", "frequencies (rad/s)"),
        ("accuracy", "1.0e-06 of the total length"),
        ("accuracy", "kept"),
        ("ensemble", "3 members (3,)"),
        ("solution", "last q"),
    ):
        assert part in told[name]


def test_the_drawing_is_the_chain_with_y_downwards(sol):
    long = pc.simulate(pc.Scene.textbook(), q0=0.0, t_span=(0, 60))
    assert len(long.t) > 450
    for run in (sol, long):
        drawn = re.findall(
            r"<polyline points='([^']+)' fill='none' stroke='(\w+|#\w+)'", run._repr_html_()
        )
        assert [stroke for _, stroke in drawn] == ["#1f5fa8"] + ["currentColor"] * 6
        last = np.array([pair.split(",") for pair in drawn[-1][0].split()], dtype=float)
        true = run.positions()[-1]
        scale = np.hypot(*(last[1] - last[0]))  # a link is 1 m
        assert last - last[0] == pytest.approx(scale * (true - true[0]), abs=0.2)


def test_what_is_not_finite_is_left_out_of_a_drawing():
    wild = np.array([[0.0, 0.0], [np.nan, np.inf], [1.0, 1.0]])
    told = drawing([np.array([[0.0, 0.0], [1.0, 1.0]])], wild)
    assert "nan" not in told
    assert "inf" not in told


def test_a_scene_of_many_links_has_a_short_table():
    told = pc.Scene(links=[pc.Link(mass=1.0, length=0.1)] * 60)._repr_html_()
    assert "and 40 more" in told
    assert told.count("<tr>") < 25


@pytest.mark.unsanitized
def test_the_page_lives_in_a_frame(sol, browser, tmp_path, core):
    shown = tmp_path / "notebook.html"
    shown.write_text(f"<!doctype html><body>{sol.page(height=700)._repr_html_()}</body>")
    assert unescape(shown.read_text()).count("<title>A pendulum</title>") == 1
    browser.get(shown.as_uri())
    browser.switch_to.frame(browser.find_element("tag name", "iframe"))
    try:
        told = waited(browser, "document.getElementById('bits')?.textContent || ''")
        assert told == f"the bits of Python: hash {sol._run.fingerprint} = {sol._run.fingerprint}"
    finally:
        browser.switch_to.default_content()


def waited(browser, expression):
    from selenium.webdriver.support.ui import WebDriverWait

    wait = WebDriverWait(browser, 20, 0.05)
    return wait.until(lambda one: one.execute_script(f"return {expression}"))


@pytest.mark.unsanitized
def test_the_widget_tells_python_what_its_reader_does(sol, browser, tmp_path, core):
    pytest.importorskip("anywidget")
    widget = sol.widget(height=640)
    assert (widget.case, widget.height) == (None, 640)
    (tmp_path / "page.html").write_text(widget.page)
    # A model as notebooks have it; what it is told is handed to the widget below.
    shown = tmp_path / "notebook.html"
    shown.write_text(
        "<!doctype html><body><div id='here'></div><script type='module'>"
        + widget._esm.replace("export default { render };", "")
        + "const values = { page: "
        + json.dumps(widget.page).replace("</", "<\\/")
        + ", height: 640 };"
        "window.values = values;"
        "const model = { get: (name) => values[name], set: (name, x) => { values[name] = x },"
        " save_changes() {} };"
        "render({ model, el: document.getElementById('here') });</script></body>"
    )
    browser.get(shown.as_uri())
    widget.text = waited(browser, "window.values?.text")
    assert widget.case["gravity"] == 9.807
    browser.switch_to.frame(browser.find_element("tag name", "iframe"))
    browser.execute_script("pendcorePage.given.gravity = 1.62; pendcorePage.changed()")
    browser.switch_to.default_content()
    widget.text = waited(browser, "window.values.text.includes('1.62') && window.values.text")
    assert widget.case["gravity"] == 1.62
    assert widget.case["effect"][0] == {"kind": "viscous_joint", "joint": 2, "damping": 0.05}
    widget.text = 'name = "inf"\n[[effect]]\nrange = [-inf, 1]'
    assert widget.case == {"name": "inf", "effect": [{"range": [-np.inf, 1]}]}


def test_a_widget_without_its_package_says_what_is_missing(sol, monkeypatch):
    monkeypatch.setitem(sys.modules, "anywidget", None)
    with pytest.raises(ImportError, match=r"anywidget is missing \(pip: anywidget\)"):
        sol.widget()


def test_the_core_for_browsers_is_small():
    packed = core_for_browsers()
    if packed is None:
        pytest.skip("`make page` builds the core for browsers and installs it")
    assert len(packed) < 450_000
