"""The charts of a page draw any quantity over any other, and tell what a pointer reads."""

from __future__ import annotations

import numpy as np
import pendcore as pc
import pytest

pytestmark = [pytest.mark.unsanitized, pytest.mark.usefixtures("core")]


def drawn(page):
    """Return the curves of the chart whose quantities are chosen."""
    return page.ask("pendcorePage.curves.chosen.curves.map(({ name, x, y }) => ({ name, x, y }))")


def choose(page, menu, label):
    page.enter(f"#{menu}", label)
    assert page.ask(f"document.getElementById('{menu}').value") == label


def test_any_quantity_is_drawn_over_any_other(page, sol):
    phase = drawn(page)
    t = np.array(page.ask("pendcorePage.curves.times"))
    assert set(sol.t) <= set(t)  # the run's own steps, and times between them
    states = sol(t)
    beside = pc.simulate(sol.scene, q0=[0.8, 1.0], t_span=(0, 8), t_eval=t)
    assert [one["name"] for one in phase] == ["link 1", "link 2"]
    for i, one in enumerate(phase):
        np.testing.assert_allclose(one["x"], states[i], atol=1e-10)
        np.testing.assert_allclose(one["y"], states[2 + i], atol=1e-10)
    choose(page, "across", "t (s)")
    choose(page, "up", "force at joint 2 (N)")
    (one,) = drawn(page)
    np.testing.assert_allclose(one["x"], t, atol=1e-12)
    forces = np.linalg.norm(beside.reactions()[:, 1], axis=-1)
    np.testing.assert_allclose(one["y"], forces, rtol=1e-8)
    choose(page, "across", "tip x (m)")
    choose(page, "up", "tip y, down (m)")
    (path,) = drawn(page)
    tip = beside.positions()[:, -1]
    np.testing.assert_allclose(path["x"], tip[:, 0], atol=1e-10)
    np.testing.assert_allclose(path["y"], tip[:, 1], atol=1e-10)


def test_a_choice_survives_a_run_and_goes_with_its_link(page):
    choose(page, "up", "q\u0307₂ (rad/s)")
    page.do("pendcorePage.given.start.q[0] = 0.5; pendcorePage.changed()")
    assert page.ask("document.getElementById('up').value") == "q\u0307₂ (rad/s)"
    choose(page, "across", "kinetic energy (J)")
    page.do(
        "const { given } = pendcorePage; given.link.pop(); given.effect = [];"
        "given.start.q.pop(); given.start.qd.pop(); pendcorePage.changed()"
    )
    assert page.ask("document.getElementById('up').value") == "q\u0307 (rad/s)"
    assert page.ask("document.getElementById('across').value") == "kinetic energy (J)"


def test_what_does_not_change_is_drawn_too(opened):
    """Without gravity, the kinetic energy of one rod changes in its last bit alone."""
    free = pc.Scene(links=[pc.Link(mass=1, length=1)], gravity=0.0)
    page = opened(pc.simulate(free, q0=[0.3], qd0=[4.0], t_span=(0, 2)))
    choose(page, "across", "kinetic energy (J)")
    choose(page, "up", "potential energy (J)")
    (one,) = drawn(page)
    assert np.ptp(one["x"]) < 1e-14
    left, right = page.ask("pendcorePage.curves.chosen.box.slice(0, 2)")
    assert right - left > 1e-9
    assert page.complaints() == []


def test_a_phase_portrait_has_angles_within_a_turn_and_ends_where_the_run_is_wrong(opened):
    chaotic = pc.simulate(pc.Scene.textbook(), q0=0.0, t_span=(0, 30))
    page = opened(chaotic)
    page.wait("pendcorePage.run.until !== null")
    until = page.ask("pendcorePage.run.until")
    for i, one in enumerate(page.ask("pendcorePage.curves.chosen.curves")):
        x = np.array([np.nan if value is None else value for value in one["x"]])
        assert np.nanmax(np.abs(x)) <= np.pi
        t = np.array(page.ask("pendcorePage.curves.times"))
        right = t[t <= until]
        assert np.isfinite(x).sum() == len(right) < 0.9 * len(t)
        apart = x[np.isfinite(x)] - chaotic(right)[i]
        assert np.abs(np.angle(np.exp(1j * apart))).max() < 1e-6
        assert np.nanmax(np.abs(np.diff(x))) < np.pi  # gaps, where the angle jumps by a turn


def test_angles_are_told_from_the_vertical_where_a_teacher_wants_them(page, sol):
    choose(page, "across", "q₂ (rad)")
    before = page.ask("[...pendcorePage.given.start.q, pendcorePage.hash]")
    page.click("vertical")
    assert page.ask("[...pendcorePage.given.start.q, pendcorePage.hash]") == before
    theta = page.ask("pendcorePage.curves.angles.curves[1]")
    assert page.text("angles").startswith("θ (deg)θ₁θ₂")
    wanted = np.degrees(pc.angles_to_vertical(sol(theta["x"])[1]))
    np.testing.assert_allclose(theta["y"], wanted, atol=1e-6)
    across = page.ask("document.getElementById('across').value")
    assert across == "θ₂ (rad)"  # the menus keep what was chosen
    (portrait, _) = drawn(page)
    np.testing.assert_allclose(portrait["y"][-1], -sol(8.0)[2], atol=1e-9)

    field = (
        "[...document.querySelectorAll('label')].find((one) => one.textContent ==="
        " 'angle at the start θ (deg)').parentElement.querySelector('input')"
    )
    assert page.ask(f"{field}.value") == "44.1634"
    page.do(f"const f = {field}; f.value = '30'; f.dispatchEvent(new Event('input'))")
    assert page.ask("pendcorePage.given.start.q[0]") == pytest.approx(np.pi / 3)
    page.do("pendcorePage.go(0)")
    label = page.ask("document.getElementById('scene').getAttribute('aria-label')")
    assert label == "At 0.00 s: θ1 30.0 degrees, θ2 32.7 degrees"


@pytest.mark.parametrize("kind", ["mouse", "touch"])
def test_a_pointer_on_a_chart_reads_time_and_values(page, browser, sol, kind):
    from selenium.webdriver.common.actions.action_builder import ActionBuilder
    from selenium.webdriver.common.actions.pointer_input import PointerInput

    page.do("pendcorePage.play(false); pendcorePage.go(2)")
    choose(page, "across", "q₂ (rad)")
    choose(page, "up", "q₂ (rad)")  # the diagonal, which has a point in the middle

    def read_under_pointer(name, chart):
        """Return what the chart reads in its middle, and after the pointer has gone."""
        canvas = browser.find_element("css selector", f"#{name} canvas")
        browser.execute_script("arguments[0].scrollIntoView({ block: 'center' })", canvas)
        actions = ActionBuilder(browser, mouse=PointerInput(kind, kind))
        pointer = actions.pointer_action
        pointer.move_to(canvas)
        if kind == "touch":
            pointer.pointer_down().move_to(canvas, 4, 0)
        actions.perform()
        there = page.ask(f"pendcorePage.curves.{chart}.reading")
        actions.clear_actions()
        if kind == "touch":
            actions = ActionBuilder(browser, mouse=PointerInput(kind, kind))
            actions.pointer_action.pointer_up()
        else:
            actions.pointer_action.move_to(browser.find_element("id", "tab-setup"))
        actions.perform()
        return there, page.ask(f"pendcorePage.curves.{chart}.reading")

    there, gone = read_under_pointer("angles", "angles")
    assert there[0]["t"] == pytest.approx(4, abs=0.6)
    assert gone[0]["t"] == 2
    for one in (there, gone):
        read = [point["y"] for point in one]
        assert read == pytest.approx(np.degrees(sol(one[0]["t"])[:2]), abs=0.02)
    there, gone = read_under_pointer("phase", "chosen")
    (point,) = there
    assert point["told"] == pytest.approx([sol(point["t"])[1]] * 2, abs=1e-6)
    assert gone == []
