"""What a reader of a page touches does what it says: joints, keys, sliders, effects, methods."""

from __future__ import annotations

import re

import numpy as np
import pendcore as pc
import pytest

pytestmark = [pytest.mark.unsanitized, pytest.mark.usefixtures("core")]


def tip(page, t):
    """Return where the tip is at a time, in pixels of the window."""
    return page.ask(
        "(() => { const { view, run } = pendcorePage;"
        f" const [x, y] = run.at({t}).places[2];"
        " const { left, top } = view.canvas.getBoundingClientRect();"
        " return [left + view.center[0] + x * view.pixels,"
        " top + view.center[1] + y * view.pixels] })()"
    )


@pytest.mark.parametrize("size", ["desktop", "phone"])
def test_dragging_the_tip_starts_the_run_elsewhere(sol, opened, sized, size):
    sized(size)
    page = opened(sol)
    page.do("pendcorePage.go(0)")
    page.do("pendcorePage.view.canvas.scrollIntoView()")
    x, y = tip(page, 0)
    page.drag((x, y), (x - 70, y - 20))
    moved = page.ask("pendcorePage.given.start.q")
    assert moved[0] == 0.8
    metre = page.ask("pendcorePage.view.pixels")
    wanted = np.arctan2(np.sin(1.0) - 20 / metre, np.cos(1.0) - 70 / metre)
    assert moved[1] == pytest.approx(wanted, abs=0.05)
    run = pc.simulate(sol.scene, q0=moved, t_span=(0, 8))
    assert page.ask("pendcorePage.hash") == run._run.fingerprint


def test_keys_play_step_and_go_home(page, browser):
    from selenium.webdriver.common.keys import Keys

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


def test_the_picture_is_enlarged_moved_and_fitted_again(page, browser):
    page.do("pendcorePage.play(false); pendcorePage.go(0)")
    view = "(() => { const { view } = pendcorePage; return [view.pixels, ...view.center] })()"
    start = page.ask("[...pendcorePage.given.start.q]")
    fitted = page.ask(view)
    scene = browser.find_element("id", "scene")
    scene.send_keys("+")
    assert page.ask(view) == pytest.approx([1.25 * fitted[0], *fitted[1:]])
    scene.send_keys("-")
    assert page.ask(view) == pytest.approx(fitted)

    left, top = page.ask(
        "(() => { const { view } = pendcorePage; view.canvas.scrollIntoView();"
        " const { left, top } = view.canvas.getBoundingClientRect(); return [left, top] })()"
    )
    page.drag((left + 15, top + 15), (left + 45, top + 35))
    assert page.ask(view) == pytest.approx([fitted[0], fitted[1] + 30, fitted[2] + 20])
    assert page.ask("[...pendcorePage.given.start.q]") == start

    def turn_the_wheel(ctrl):
        page.do(
            "pendcorePage.view.canvas.dispatchEvent(new WheelEvent('wheel', { deltaY: -100,"
            f" ctrlKey: {ctrl}, cancelable: true, clientX: {left} + 40, clientY: {top} + 50 }}))"
        )

    place = "pendcorePage.view.metres(40, 50)"
    before = page.ask(place)
    turn_the_wheel("false")
    assert page.ask(view)[0] == pytest.approx(fitted[0])
    turn_the_wheel("true")
    assert page.ask(view)[0] == pytest.approx(fitted[0] * np.exp(0.2))
    assert page.ask(place) == pytest.approx(before, abs=0.02)
    scene.send_keys("0")
    assert page.ask(view) == pytest.approx(fitted)


def test_every_control_has_a_name(page):
    nameless = page.ask(
        "[...document.querySelectorAll('button, input, select, canvas')].filter((one) =>"
        " !(one.getAttribute('aria-label') || one.labels?.length || one.textContent.trim()))"
        ".map((one) => one.outerHTML)"
    )
    assert nameless == []


def test_sliders_change_parameters_and_the_run(page, sol, browser):
    page.click("tab-setup")
    field = browser.find_element("xpath", "//label[.='damping b (N m s/rad)']/..//input")
    page.do(
        "const f = [...document.querySelectorAll('label')].find((one) =>"
        " one.textContent === 'damping b (N m s/rad)').parentElement.querySelector('input');"
        " f.value = '0.5'; f.dispatchEvent(new Event('input'))"
    )
    assert field.get_attribute("value") == "0.5"
    damped = sol.scene.replace(effects=[pc.effects.ViscousJoint(joint=2, damping=0.5)])
    run = pc.simulate(damped, q0=[0.8, 1.0], t_span=(0, 8))
    assert page.ask("pendcorePage.hash") == run._run.fingerprint


@pytest.mark.parametrize(("name", "typed"), [("mass (kg)", "0.8"), ("length (m)", "0.35")])
def test_a_rod_stays_a_rod_while_its_numbers_are_typed(page, browser, name, typed):
    """On the way to 0.8 the field holds 0."""
    from selenium.webdriver.common.keys import Keys

    page.click("tab-setup")
    field = browser.find_element("xpath", f"//label[text()='{name}']/../input[@type='number']")
    field.send_keys(Keys.CONTROL, "a")
    field.send_keys(typed)
    link = page.ask("pendcorePage.given.link[0]")
    made = pc.Link(**{"mass": 1.0, "length": 1.0, name.split()[0]: float(typed)})
    assert link == pytest.approx(
        {x: getattr(made, x) for x in ("mass", "length", "center", "inertia")}
    )
    assert page.text("message") == ""
    field.send_keys(Keys.CONTROL, "a")
    field.send_keys("-2")
    assert field.get_attribute("aria-invalid") == "true"
    assert page.ask("pendcorePage.given.link[0].mass") > 0


def test_a_tap_on_a_joint_starts_there_and_the_page_says_so(page, sol):
    page.do("pendcorePage.play(false); pendcorePage.go(2)")
    page.drag(tip(page, 2))
    q = page.ask("pendcorePage.given.start.q")
    assert q == [*sol(2.0)[:2]]
    assert page.state("run", 0) == [*q, 0, 0]
    assert page.text("bits").startswith("hash ")


def test_a_field_shows_six_digits_and_the_case_keeps_all(opened):
    start = [0.1 + 0.2, 2 / 3]
    page = opened(pc.simulate(pc.Scene.textbook(), q0=0.5, qd0=start, t_span=(0, 1)))
    shown = page.ask("[...document.querySelectorAll('#setup input')].map((one) => one.value)")
    assert {"0.3", "0.666667"} < set(shown)
    assert max(len(value.strip("-").replace(".", "").strip("0")) for value in shown[::2]) == 6
    assert page.ask("pendcorePage.given.start.qd") == start


def test_a_run_that_is_refused_leaves_the_picture_and_says_nothing_of_it(page):
    page.do("pendcorePage.given.link[0].length = -1; pendcorePage.changed()")
    assert page.text("bits") == ""
    assert page.text("trust") == "the picture is that of the last run that was possible"
    page.do("pendcorePage.given.link[0].length = 1; pendcorePage.changed()")
    assert page.text("bits").startswith("the bits of Python")


def test_a_tolerance_for_each_component_is_understood(sol, opened):
    run = pc.simulate(sol.scene, q0=[0.8, 1.0], t_span=(0, 8), rtol=[1e-6, 1e-6, 1e-7, 1e-7])
    page = opened(run)
    page.wait("pendcorePage.run.until !== null")
    assert page.ask("document.querySelector('#method input').value") == "7"
    assert page.text("bits").endswith(f"= {run._run.fingerprint}")


def test_fixed_steps_keep_their_method_until_another_is_chosen(sol, opened):
    run = pc.simulate(sol.scene, q0=0.8, t_span=(0, 4), method="rk4", step=0.01)
    page = opened(run)
    assert page.ask("document.querySelector('#method select').value") == "rk4"
    page.enter("#method select", "dop853")
    assert page.text("message") == ""
    assert page.ask("'step' in pendcorePage.given.run") is False


def test_effects_are_added_and_removed(page):
    page.click("tab-setup")
    kinds = page.ask("Object.keys(pendcorePage.controls.defaults)")
    assert set(kinds) == {*pc.effects.kinds()} - {"user", "compiled_user"}
    for kind in kinds:
        page.do(
            "const select = document.querySelector('#setup select[aria-label]');"
            f"select.value = {kind!r}; select.nextSibling.nextSibling.click()"
        )
        assert page.ask("pendcorePage.given.effect.at(-1).kind") == kind
        refused = page.text("message")
        assert not refused or "q0" in refused, (kind, refused)  # a lock or a stop elsewhere
        page.do("[...document.querySelectorAll('fieldset button')].at(-2).click()")
        assert page.ask("pendcorePage.given.effect.length") == 1
    assert page.text("message") == ""


IMPOSSIBLE = {
    "gravity = -Infinity": lambda: pc.Scene.textbook().replace(gravity=-np.inf),
    "link[0].length = -1": lambda: pc.Scene(links=[pc.Link(mass=1.0, length=-1.0, center=0.5)]),
    "effect.push({kind: 'joint_stop', joint: 1, range: [1, 0.5], restitution: 0.5})": (
        lambda: pc.effects.JointStop(joint=1, range=(1, 0.5), restitution=0.5)
    ),
}


@pytest.mark.parametrize("change", IMPOSSIBLE)
def test_an_impossible_parameter_is_refused_as_python_refuses_it(page, change):
    with pytest.raises(ValueError, match=r"\w") as refused:
        IMPOSSIBLE[change]()
    page.do(f"pendcorePage.given.{change}; pendcorePage.changed()")
    told = page.text("message")
    assert told.split(": ", 1)[-1].split(": ")[-1] == str(refused.value).split(": ")[-1]


def test_methods_and_tolerances_are_chosen_in_the_page(page, sol):
    page.click("tab-accuracy")
    page.enter("#method select", "dop853")
    page.enter("#method input", "11", "input")
    run = pc.simulate(sol.scene, q0=[0.8, 1.0], t_span=(0, 8), method="dop853", rtol=1e-11)
    assert page.ask("pendcorePage.hash") == run._run.fingerprint


def test_sliders_have_the_size_of_a_small_rig(opened):
    rig = pc.Scene(
        links=[pc.Link(mass=0.05, length=0.1)],
        effects=[
            pc.effects.ViscousJoint(joint=1, damping=2e-5),
            pc.effects.DryJointFriction(joint=1, coulomb=1e-4, static=1e-4, stribeck_velocity=0.01),
            pc.effects.JointStop(joint=1, range=(-np.pi / 3, np.pi / 3), restitution=0.5),
        ],
    )
    page = opened(pc.simulate(rig, q0=[0.3], t_span=(0, 2)))
    page.click("tab-setup")
    sliders = {
        name: (float(low), float(high), float(step))
        for name, low, high, step in page.ask(
            "[...document.querySelectorAll('#setup input[type=range]')].map((one) =>"
            " [one.getAttribute('aria-label').split(',')[0], one.min, one.max, one.step])"
        )
    }
    assert sliders["mass"] == (1e-4, 0.15, 1e-4)
    assert sliders["length"] == (1e-3, 0.3, 1e-3)
    assert sliders["damping"] == (-6e-5, 6e-5, 1e-7)  # some joints feed the motion
    assert sliders["coulomb"] == (0, 3e-4, 1e-6)
    assert sliders["stribeck velocity"][0] == sliders["stribeck velocity"][2] > 0
    assert "joint" not in sliders  # there is one joint
    assert sliders["restitution"] == (0, 1, 1e-3)
    assert sliders["range"] == (-3.15, 3.15, 0.01)  # -pi/3 and three times as much: no odd digits


def test_labels_are_words_with_the_unit_of_what_is_driven(opened):
    turn = pc.effects.Sinusoid(amplitude=0.2, angular_frequency=6.0)
    driven = [pc.effects.Motor(joint=1, sinusoid=turn), pc.effects.DrivenPivot(y=turn)]
    page = opened(pc.simulate(pc.Scene.textbook().replace(effects=driven), q0=0.5, t_span=(0, 1)))
    labels = page.ask("[...document.querySelectorAll('#setup label')].map((x) => x.textContent)")
    assert [x for x in labels if x.startswith("amplitude")] == [
        "amplitude A (N m)",
        "amplitude A (m)",
    ]
    assert labels.count("angular frequency ω (rad/s)") == 2
    assert not [x for x in labels if "_" in x]


def test_the_trace_of_a_fast_link_is_round(opened):
    page = opened(pc.simulate(pc.Scene.textbook(), q0=[0.3, 0.3], qd0=[0.0, 60.0], t_span=(0, 2)))
    page.do(
        "const { view } = pendcorePage; const draw = view.draw.bind(view);"
        "view.draw = (shown) => { window.path = shown.path; draw(shown) }; pendcorePage.go(2)"
    )
    path = np.array(page.ask("window.path"))
    steps = np.linalg.norm(np.diff(path, axis=0), axis=1)
    assert steps.max() < 0.12  # m: a tenth of a turn in rad at 1 m, and what link 1 adds


def test_a_button_says_copied_for_a_while_and_then_its_name(page):
    page.do("document.getElementById('share').open = true")
    page.click("copy-toml")
    page.click("copy-toml")
    page.wait("document.getElementById('copy-toml').textContent === 'Copied'")
    page.wait("document.getElementById('copy-toml').textContent === 'Copy TOML'")


def test_two_runs_are_shown_side_by_side(page, sol):
    assert page.ask("document.getElementById('beside').hidden")
    offered = page.ask("[...document.querySelectorAll('#compare option')].map((one) => one.value)")
    assert offered == [
        "nothing", "without 1: ViscousJoint", "the last link 0.001 rad further",
        "the last link 0.1 rad further", "the run as it was",
    ]  # fmt: skip
    free = pc.simulate(pc.Scene.textbook(), q0=[0.8, 1.0], t_span=(0, 8))
    near, far = (pc.simulate(sol.scene, q0=[0.8, 1.0 + x], t_span=(0, 8)) for x in (0.001, 0.1))
    for name, run in zip(offered[1:], (free, near, far, sol), strict=True):
        page.enter("#compare", name)
        assert page.ask("document.getElementById('beside').hidden") is False
        assert page.text("other-name") == name
        assert page.ask("document.getElementById('own-name').hidden") is False
        assert page.state("other", 8) == run(8.0).tolist()
        curves = page.ask("pendcorePage.curves.angles.curves")
        assert [(one["name"], one["isDashed"]) for one in curves] == [
            ("q₁, this run", False), ("q₂, this run", False),
            (f"q₁, {name}", True), (f"q₂, {name}", True),
        ]  # fmt: skip
        assert curves[3]["y"][-1] == pytest.approx(np.degrees(run(8.0)[1]), rel=1e-12)
    page.do("pendcorePage.given.gravity = 1.6; pendcorePage.changed()")
    assert page.state("other", 8) == sol(8.0).tolist()
    page.enter("#compare", "nothing")
    assert page.ask("document.getElementById('beside').hidden")


def test_laws_are_mathematics(page):
    page.click("tab-setup")
    law = page.ask("document.querySelector('#setup .law').innerHTML")
    assert law == (
        "<i>τ</i> = −(<i>b</i> <i>w</i> + <i>b</i><sub>2</sub> <i>w</i> |<i>w</i>| + "
        "<i>b</i><sub>3</sub> <i>w</i><sup>3</sup>),\u2003<i>w</i> = <i>φ̇</i>"
    )


def test_keys_are_spoken_of_where_there_may_be_some(page):
    is_touched = page.ask("matchMedia('(hover: none)').matches")
    shown = page.ask("getComputedStyle(document.querySelector('.keys')).display")
    assert shown == ("none" if is_touched else "block")
