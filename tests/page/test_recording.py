"""A page without the core plays back what Python computed, and says what is missing."""

from __future__ import annotations

import pendcore as pc
import pytest
from pendcore.cli import main
from pendcore.page import html

pytestmark = pytest.mark.unsanitized


@pytest.fixture
def sol():
    return pc.simulate(pc.Scene.textbook(), q0=[0.8, 1.0], t_span=(0, 8))


def test_an_install_without_the_core_plays_back_and_says_what_is_missing(sol, opened, monkeypatch):
    monkeypatch.setattr(html, "core_for_browsers", lambda: None)
    page = opened(sol)
    assert "no core for browsers (make page in a clone builds it" in page.text("notice")
    assert page.text("bits") == f"played back; Python's hash {sol._run.fingerprint}"
    page.do("pendcorePage.go(2)")
    shown = page.ask("pendcorePage.t")
    assert shown == pytest.approx(2, abs=1 / 60)
    assert page.state("run", 2) == pytest.approx([*sol(shown)], abs=1e-5)
    assert page.ask("document.querySelector('[role=tablist]').offsetHeight") == 0
    assert page.complaints() == []
    assert "right to 0.1 rad to the end" in page.text("trust")


def test_the_ledger_of_a_run_is_played_back_where_it_has_one(sol, opened, monkeypatch):
    monkeypatch.setattr(html, "core_for_browsers", lambda: None)
    damped = sol.scene.replace(effects=[pc.effects.ViscousJoint(joint=2, damping=0.05)])
    kept = pc.simulate(damped, q0=[0.8, 1.0], t_span=(0, 8), ledger=True)
    page = opened(kept)
    (work,) = page.ask("pendcorePage.curves.work.curves")
    assert work["name"] == "viscous (lost)"
    assert work["y"][-1] == pytest.approx(kept.energy().ledger.viscous[-1], rel=1e-6)
    assert len(page.state("run", 2)) == 4
    assert opened(sol).ask("document.getElementById('work').hidden") is True


def test_the_command_that_wrote_a_page_without_the_core_says_so(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(html, "core_for_browsers", lambda: None)
    assert main(["show", "-o", str(tmp_path / "run.html")]) == 0
    assert capsys.readouterr().err.endswith(f"run.html\n{html.WITHOUT_CORE}\n")


def test_functions_of_ones_own_are_played_back(opened):
    brake = pc.effects.User(function=lambda t, q, qd: [-0.1 * qd[0], 0.0])
    run = pc.simulate(pc.Scene.textbook().replace(effects=[brake]), q0=0.5, t_span=(0, 4))
    page = opened(run)
    assert "functions of one's own stay in Python" in page.text("notice")
    assert page.state("run", 4) == pytest.approx([*run(4.0)], abs=1e-5)
