"""A page of a run opens from disk, asks for nothing, and is the run, bit by bit."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from elsewhere.test_javascript import CASES, START, STARTS, scene_in_python
from pendcore.page import html

Open = Callable[..., Any]
pytestmark = [pytest.mark.unsanitized, pytest.mark.usefixtures("core")]
MOST_BYTES = 900_000


@pytest.fixture(scope="module")
def sol() -> pc.Solution:
    damped = pc.Scene.textbook().replace(effects=[pc.effects.ViscousJoint(joint=2, damping=0.05)])
    return pc.simulate(damped, [0.8, 1.0], t_span=(0, 8))


def test_a_page_is_one_small_file_that_names_no_other(sol: pc.Solution, tmp_path: Path) -> None:
    page = sol.to_html(tmp_path / "run.html", title="A <swing> & more").read_text()
    assert len(page.encode()) < MOST_BYTES
    assert "<title>A &lt;swing&gt; &amp; more</title>" in page
    assert not re.search(r"(src|href)=|https?://|@import|url\(", page)


def test_it_opens_from_disk_and_asks_for_nothing(
    sol: pc.Solution, opened: Open, browser: Any
) -> None:
    page = opened(sol)
    page.wait("pendcorePage.validUntil !== null")
    page.do("document.getElementById('neighbours').click()")
    page.wait("pendcorePage.neighbours?.count === 1000")
    assert page.complaints() == []
    log = [json.loads(one["message"])["message"] for one in browser.get_log("performance")]
    asked = [
        one["params"]["request"]["url"]
        for one in log
        if one["method"] == "Network.requestWillBeSent"
    ]
    assert [url for url in asked if not url.startswith(("file:", "blob:"))] == []
    assert sum(url.startswith("file:") for url in asked) == 1


@pytest.mark.every_value("name")
@pytest.mark.parametrize("name", CASES)
def test_the_core_in_the_page_has_the_bits_of_python(name: str, opened: Open) -> None:
    effects, options = CASES[name]
    start = STARTS.get(name, START)
    run = pc.simulate(
        scene_in_python(effects), start["q0"], start["qd0"], (start["t0"], start["t_end"]),
        check=False, **options,
    )  # fmt: skip
    page = opened(run)
    told = page.text("bits")
    assert told == f"the bits of Python: hash {run.run.fingerprint} = {run.run.fingerprint}"
    states = np.array(page.ask("[1.7, 3.9].map((t) => [...pendcorePage.run.state(t)])"))
    assert np.array_equal(states, pc.simulate(
        run.scene, start["q0"], start["qd0"], (start["t0"], start["t_end"]), check=False, **options
    )([1.7, 3.9]).T)  # fmt: skip


def test_a_hash_that_is_not_pythons_is_told(
    sol: pc.Solution, opened: Open, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(html, "_plain_case", lambda *_: {**plain(*_), "gravity": 9.8})
    told = opened(sol).text("bits")
    assert told.startswith("not the bits of Python: hash ")
    assert told.endswith(f"Python's {sol.run.fingerprint}")


plain = html._plain_case


def test_what_is_kept_at_times_has_the_bits_of_python_too(sol: pc.Solution, opened: Open) -> None:
    run = pc.simulate(sol.scene, 0.5, t_span=(0, 5), t_eval=np.linspace(0, 5, 11))
    assert opened(run).text("bits").endswith(f"= {run.run.fingerprint}")


def test_the_case_is_copied_as_toml_as_python_and_as_a_link(
    sol: pc.Solution, opened: Open, tmp_path: Path
) -> None:
    page = opened(sol)
    page.click("tab-setup")
    page.do("pendcorePage.given.gravity = 3.7; pendcorePage.changed()")
    (tmp_path / "case.toml").write_text(page.copied("copy-toml"))
    again = pc.read_case(tmp_path / "case.toml").simulate()
    assert again.run.fingerprint == page.ask("pendcorePage.hash")
    assert again.scene.gravity == 3.7
    made: dict[str, Any] = {}
    exec(page.copied("copy-python"), made)
    assert made["sol"].run.fingerprint == again.run.fingerprint
    link = page.copied("copy-link")
    other = opened(sol, "#" + link.partition("#")[2])
    assert other.ask("pendcorePage.hash") == again.run.fingerprint


@pytest.mark.parametrize("size", ["desktop", "phone"])
def test_dragging_the_tip_starts_the_run_elsewhere(
    sol: pc.Solution, opened: Open, browser: Any, size: str
) -> None:
    from page.conftest import SIZES
    from selenium.webdriver.common.action_chains import ActionChains

    browser.set_window_size(*SIZES[size])
    try:
        page = opened(sol)
        page.do("pendcorePage.go(0)")
        x, y, left, top = page.ask(
            "(() => { const { view, run } = pendcorePage; const p = run.places(0, run.state(0));"
            " view.canvas.scrollIntoView();"
            " const { left, top } = view.canvas.getBoundingClientRect();"
            " return [p[4] * view.pixels, p[5] * view.pixels,"
            " left + view.center[0], top + view.center[1]] })()"
        )
        drag = ActionChains(browser)
        drag.w3c_actions.pointer_action.move_to_location(round(left + x), round(top + y))
        drag.w3c_actions.pointer_action.pointer_down()
        drag.w3c_actions.pointer_action.move_to_location(round(left + x - 40), round(top + y - 60))
        drag.w3c_actions.pointer_action.pointer_up()
        drag.perform()
        moved = page.ask("pendcorePage.given.start.q")
        assert moved[0] == 0.8
        wanted = np.arctan2(
            y - 60 - page.ask("pendcorePage.view.pixels") * np.sin(0.8),
            x - 40 - page.ask("pendcorePage.view.pixels") * np.cos(0.8),
        )
        assert moved[1] == pytest.approx(wanted, abs=0.05)
        run = pc.simulate(sol.scene, moved, t_span=(0, 8))
        assert page.ask("pendcorePage.hash") == run.run.fingerprint
    finally:
        browser.set_window_size(*SIZES["desktop"])


def test_keys_play_step_and_go_home(sol: pc.Solution, opened: Open, browser: Any) -> None:
    from selenium.webdriver.common.keys import Keys

    page = opened(sol)
    page.do("pendcorePage.play(false); pendcorePage.go(1)")
    scene = browser.find_element("id", "scene")
    scene.send_keys(Keys.ARROW_RIGHT, Keys.ARROW_RIGHT)
    assert page.ask("pendcorePage.t") == pytest.approx(1 + 2 / 60)
    scene.send_keys(Keys.HOME)
    assert page.text("clock") == "0.00 s"
    scene.send_keys(Keys.SPACE)
    assert page.text("play") == "Pause"
    page.wait("pendcorePage.t > 0.2")
    label = page.ask("document.getElementById('scene').getAttribute('aria-label')")
    assert re.fullmatch(r"At \d\.\d\d s: q1 [\d.-]+ degrees, q2 [\d.-]+ degrees", label)


def test_every_control_has_a_name(sol: pc.Solution, opened: Open) -> None:
    page = opened(sol)
    nameless = page.ask(
        "[...document.querySelectorAll('button, input, select, canvas')].filter((one) =>"
        " !(one.getAttribute('aria-label') || one.labels?.length || one.textContent.trim()))"
        ".map((one) => one.outerHTML)"
    )
    assert nameless == []


def test_sliders_change_parameters_and_the_run(
    sol: pc.Solution, opened: Open, browser: Any
) -> None:
    page = opened(sol)
    page.click("tab-setup")
    field = browser.find_element("xpath", "//label[text()='damping (N m s/rad)']/..//input")
    page.do(
        "const f = [...document.querySelectorAll('label')].find((one) =>"
        " one.textContent === 'damping (N m s/rad)').parentElement.querySelector('input');"
        " f.value = '0.5'; f.dispatchEvent(new Event('input'))"
    )
    assert field.get_attribute("value") == "0.5"
    damped = pc.effects.ViscousJoint(joint=2, damping=0.5)
    scene = sol.scene.replace(effects=[damped])
    run = pc.simulate(scene, [0.8, 1.0], t_span=(0, 8))
    assert page.ask("pendcorePage.hash") == run.run.fingerprint


def test_effects_are_added_and_removed(sol: pc.Solution, opened: Open) -> None:
    page = opened(sol)
    page.click("tab-setup")
    kinds = page.ask("Object.keys(pendcorePage.controls.defaults)")
    assert set(kinds) == {*pc.effects.kinds()} - {"user", "compiled_user"}
    for kind in kinds:
        page.do(
            "const select = document.querySelector('#setup select[aria-label]');"
            f"select.value = {kind!r}; select.nextSibling.nextSibling.click()"
        )
        assert page.ask("pendcorePage.given.effect.at(-1).kind") == kind
        refused = page.ask("!message.hidden && message.textContent") or ""
        assert not refused or "q0" in refused, (kind, refused)  # a lock or a stop elsewhere
        page.do("[...document.querySelectorAll('fieldset button')].at(-2).click()")
        assert page.ask("pendcorePage.given.effect.length") == 1
    assert page.ask("message.hidden")


@pytest.mark.parametrize(
    ("change", "scene"),
    [
        ("gravity = -Infinity", lambda: pc.Scene.textbook().replace(gravity=-np.inf)),
        (
            "link[0].length = -1",
            lambda: pc.Scene(links=[pc.Link(mass=1.0, length=-1.0, center=0.5)]),
        ),
        (
            "effect.push({kind: 'joint_stop', joint: 1, range: [1, 0.5], restitution: 0.5})",
            lambda: pc.effects.JointStop(joint=1, range=(1, 0.5), restitution=0.5),
        ),
    ],
)
def test_an_impossible_parameter_is_refused_as_python_refuses_it(
    sol: pc.Solution, opened: Open, change: str, scene: Callable[[], object]
) -> None:
    with pytest.raises(ValueError, match=r"\w") as refused:
        scene()
    page = opened(sol)
    page.do(f"pendcorePage.given.{change}; pendcorePage.changed()")
    assert page.ask("message.hidden") is False
    told = page.text("message")
    assert told.split(": ", 1)[-1].split(": ")[-1] == str(refused.value).split(": ")[-1]


def test_a_blow_up_and_a_rest_are_told_as_python_tells_them(opened: Open) -> None:
    feeds = pc.effects.ViscousJoint(joint=2, damping=0.0, damping3=-50.0)
    with pytest.warns(pc.PendcoreWarning, match="feeds energy"):
        wild = pc.Scene.textbook().replace(effects=[feeds])
    blown = pc.simulate(wild, [0.8, 1.0], [0, 5], (0, 4), check=False)
    assert not blown.success
    assert opened(blown).text("message") == blown.message
    stuck = pc.Scene.textbook().replace(
        effects=[pc.effects.DryJointFriction(joint=j, coulomb=40.0) for j in (1, 2)]
    )
    resting = pc.simulate(stuck, [1.5, 1.6], t_span=(0, 4))
    assert resting.status == "at_rest"
    page = opened(resting)
    assert page.ask("pendcorePage.run.message") == resting.message
    assert page.text("bits").startswith("the bits of Python")


def test_it_is_pale_past_the_time_until_which_it_is_right(opened: Open) -> None:
    chaotic = pc.simulate(pc.Scene.textbook(), 0.0, t_span=(0, 30))
    page = opened(chaotic)
    page.wait("pendcorePage.validUntil !== null")
    assert page.ask("pendcorePage.validUntil") == pytest.approx(chaotic.valid_until(), abs=3.0)
    assert "pale after that" in page.text("trust")


def test_the_ghost_starts_a_billionth_of_a_radian_away(sol: pc.Solution, opened: Open) -> None:
    page = opened(sol)
    page.do("document.getElementById('ghost').click()")
    away = np.array(page.ask("[...pendcorePage.ghost.state(0)]")) - [0.8, 1.0, 0, 0]
    assert away == pytest.approx([0, 1e-9, 0, 0], abs=1e-15)


def test_neighbours_are_the_runs_beside_this_one(sol: pc.Solution, opened: Open) -> None:
    page = opened(sol)
    page.do("document.getElementById('neighbours').click()")
    page.wait("pendcorePage.neighbours?.count === 1000")
    found = page.ask("[...pendcorePage.neighbours.angles.slice(60 * 2000, 60 * 2000 + 8)]")
    q0 = np.array([[0.8, 1.0 + 1e-5 * (k + 1)] for k in range(4)])
    beside = pc.ensemble(sol.scene, q0, t_span=(0, 8), t_eval=[1.0], keep="times", rtol=1e-9)
    assert found == pytest.approx(beside.q.ravel(), abs=1e-6)


def test_the_ledger_is_drawn_beside_the_energies(sol: pc.Solution, opened: Open) -> None:
    page = opened(sol)
    names = page.ask("pendcorePage.charts.energy.curves.map((one) => one.name)")
    assert names == ["kinetic", "potential", "total", "viscous (lost)"]
    total, lost = page.ask("[2, 3].map((k) => pendcorePage.charts.energy.curves[k].y.at(-1))")
    assert total + lost == pytest.approx(sol.energy().total[0], abs=1e-6)


def test_what_accuracy_costs_is_measured(sol: pc.Solution, opened: Open) -> None:
    page = opened(sol)
    page.click("tab-accuracy")
    page.click("measure")
    page.wait("pendcorePage.measured !== undefined", 60)
    points = page.ask("pendcorePage.measured")
    taylor = [one for one in points if one["method"] == "taylor"]
    errors = [one["error"] for one in sorted(taylor, key=lambda one: -one["tolerance"])]
    assert errors[0] > 1e3 * errors[-1] > 0
    assert all(one["ms"] > 0 for one in points)
    assert {one["method"] for one in points} >= {"dopri5", "dop853", "taylor", "radau5"}


def test_methods_and_tolerances_are_chosen_in_the_page(sol: pc.Solution, opened: Open) -> None:
    page = opened(sol)
    page.click("tab-accuracy")
    page.do(
        "const s = document.querySelector('#method select'); s.value = 'dop853';"
        "s.dispatchEvent(new Event('change'));"
        "const f = document.querySelector('#method input'); f.value = '11';"
        "f.dispatchEvent(new Event('input'))"
    )
    run = pc.simulate(sol.scene, [0.8, 1.0], t_span=(0, 8), method="dop853", rtol=1e-11)
    assert page.ask("pendcorePage.hash") == run.run.fingerprint


def test_whoever_wants_less_motion_gets_a_page_that_waits(
    sol: pc.Solution, opened: Open, browser: Any
) -> None:
    browser.execute_cdp_cmd(
        "Emulation.setEmulatedMedia",
        {"features": [{"name": "prefers-reduced-motion", "value": "reduce"}]},
    )
    try:
        page = opened(sol)
        assert (page.text("play"), page.ask("pendcorePage.isPlaying")) == ("Play", False)
    finally:
        browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})
    assert opened(sol).text("play") == "Pause"
