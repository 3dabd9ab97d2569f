"""A page of a run opens from disk, asks for nothing, and is the run, bit by bit."""

from __future__ import annotations

import json
import re
from urllib.parse import quote

import numpy as np
import pendcore as pc
import pytest
from browser_cases import CASES, START, STARTS, scene_in_python
from pendcore.page import html

pytestmark = [pytest.mark.unsanitized, pytest.mark.usefixtures("core")]
MOST_BYTES = 900_000


def test_a_page_is_one_small_file_that_names_no_other(sol, tmp_path):
    page = sol.to_html(tmp_path / "run.html", title="A <swing> & more").read_text()
    assert len(page.encode()) < MOST_BYTES
    assert "<title>A &lt;swing&gt; &amp; more</title>" in page
    assert not re.search(r"(src|href)=(?!\"data:,\")|https?://|@import|url\(", page)


def test_it_opens_from_disk_and_asks_for_nothing(page, browser):
    page.wait("pendcorePage.run.until !== null")
    page.do("document.getElementById('neighbours').click()")
    page.wait("pendcorePage.neighbours?.count === 1000")
    assert page.complaints() == []
    log = [json.loads(one["message"])["message"] for one in browser.get_log("performance")]
    sent = [one["params"] for one in log if one["method"] == "Network.requestWillBeSent"]
    asked = [one["request"]["url"] for one in sent]
    assert [url for url in asked if not url.startswith(("file:", "blob:"))] == []
    assert sum(url.startswith("file:") for url in asked) == 1


@pytest.mark.parametrize("name", CASES)
def test_the_core_in_the_page_has_the_bits_of_python(name, opened):
    effects, options = CASES[name]
    start = STARTS.get(name, START)
    run = pc.simulate(
        scene_in_python(effects), q0=start["q0"], qd0=start["qd0"],
        t_span=(start["t0"], start["t_end"]), on_failure="ignore", **options,
    )  # fmt: skip
    page = opened(run)
    told = page.text("bits")
    assert told == f"the bits of Python: hash {run._run.fingerprint} = {run._run.fingerprint}"
    states = [page.state("run", t) for t in (1.7, 3.9)]
    assert np.array_equal(states, run([1.7, 3.9]).T)


def test_a_hash_that_is_not_pythons_is_told(sol, opened, monkeypatch):
    plain = html._plain_case
    monkeypatch.setattr(html, "_plain_case", lambda *_: {**plain(*_), "gravity": 9.8})
    told = opened(sol).text("bits")
    assert told.startswith("not the bits of Python: hash ")
    assert told.endswith(f"Python's {sol._run.fingerprint}")


def test_what_is_kept_at_times_has_the_bits_of_python_too(sol, opened):
    run = pc.simulate(sol.scene, q0=0.5, t_span=(0, 5), t_eval=np.linspace(0, 5, 11))
    assert opened(run).text("bits").endswith(f"= {run._run.fingerprint}")


def test_the_case_is_copied_as_toml_as_python_and_as_a_link(page, sol, opened, tmp_path):
    page.click("tab-setup")
    page.do("pendcorePage.given.gravity = 3.7; pendcorePage.changed()")
    (tmp_path / "case.toml").write_text(page.copied("copy-toml"))
    again = pc.read_case(tmp_path / "case.toml").simulate()
    assert again._run.fingerprint == page.ask("pendcorePage.hash")
    assert again.scene.gravity == 3.7
    made = {}
    exec(page.copied("copy-python"), made)
    assert made["sol"]._run.fingerprint == again._run.fingerprint
    link = page.copied("copy-link")
    other = opened(sol, "#" + link.partition("#")[2])
    assert other.ask("pendcorePage.hash") == again._run.fingerprint


def test_an_address_that_is_refused_shows_the_run_of_the_page(sol, opened):
    case = opened(sol).ask("structuredClone(pendcorePage.given)")
    case["link"][0]["mass"] = -1.0
    page = opened(sol, "#case=" + quote(json.dumps(case)))
    assert page.text("message").startswith("The address holds a run that is refused: link 1: mass")
    assert page.text("bits").startswith("the bits of Python")
    case["link"][0] = {"mass": 1, "x=0) or print(1), pc.Link(mass": 1}
    for nonsense, told in (
        ("{}", "link: must be a list of one or more"),
        ("[1", "it is damaged, or was cut short"),
        (json.dumps(case), 'link 1: there is no "x=0) or print(1), pc.Link(mass"'),
    ):
        page = opened(sol, "#case=" + quote(nonsense))
        assert page.text("bits").startswith("the bits of Python"), nonsense
        assert page.text("message") == f"The address holds a run that is refused: {told}"
    page = opened(sol)
    page.do("location.hash = 'case=null'")
    page.wait("message.textContent !== ''")
    assert page.text("bits").startswith("the bits of Python")


def test_another_address_in_the_same_page_is_followed(page):
    case = page.ask("structuredClone(pendcorePage.given)")
    case["gravity"] = 1.62
    page.do(f"location.hash = 'case=' + encodeURIComponent({json.dumps(json.dumps(case))})")
    page.wait("pendcorePage.given.gravity === 1.62")
    page.enter("#method select", "dop853")
    assert page.ask("pendcorePage.given.run.method") == "dop853"
    page.wait("location.hash.includes('dop853')")


def test_what_the_worker_runs_is_freed(page):
    """A thousand runs take no more memory than a few, here as in the worker."""
    page.do(
        "window.bytes = () => pendcorePage.core.exports.memory.buffer.byteLength;"
        "for (let k = 0; k < 50; ++k) pendcorePage.changed();"
        "window.few = bytes(); for (let k = 0; k < 300; ++k) pendcorePage.changed();"
    )
    assert page.ask("bytes() - few") <= 2**20


def test_a_run_with_events_has_a_hash_of_its_own(sol, opened):
    """The page knows no events, and does not claim their bits."""
    down = pc.events.LinkAngle(1, np.pi / 2)
    run = pc.simulate(sol.scene, q0=[0.8, 1.0], t_span=(0, 8), events=[down])
    page = opened(run)
    assert re.fullmatch("hash [0-9a-f]{16}", page.text("bits"))
    assert page.ask("pendcorePage.hash") == sol._run.fingerprint


def test_a_backward_run_is_trusted_backward(opened):
    run = pc.simulate(pc.Scene.textbook(), q0=0.8, t_span=(5, 0))
    page = opened(run)
    page.wait("pendcorePage.run.until !== null")
    assert page.ask("pendcorePage.run.until") == pytest.approx(0.0, abs=1e-9)
    assert page.text("trust") == "right to 0.1 rad to the end"


def test_a_blow_up_and_a_rest_are_told_as_python_tells_them(opened):
    feeds = pc.effects.ViscousJoint(joint=2, damping=0.0, damping3=-50.0)
    with pytest.warns(pc.PendcoreWarning, match="feeds energy"):
        wild = pc.Scene.textbook().replace(effects=[feeds])
    blown = pc.simulate(wild, q0=[0.8, 1.0], qd0=[0, 5], t_span=(0, 4), on_failure="ignore")
    assert not blown.success
    assert opened(blown).text("message") == blown.message
    stuck = pc.Scene.textbook().replace(
        effects=[pc.effects.DryJointFriction(joint=j, coulomb=40.0) for j in (1, 2)]
    )
    resting = pc.simulate(stuck, q0=[1.5, 1.6], t_span=(0, 4))
    assert resting.status == "at_rest"
    page = opened(resting)
    assert page.ask("pendcorePage.run.message") == resting.message
    assert page.text("bits").startswith("the bits of Python")


def test_it_is_pale_past_the_time_until_which_it_is_right(opened):
    chaotic = pc.simulate(pc.Scene.textbook(), q0=0.0, t_span=(0, 30))
    page = opened(chaotic)
    page.wait("pendcorePage.run.until !== null")
    assert page.ask("pendcorePage.run.until") == pytest.approx(chaotic.valid_until(), abs=3.0)
    until = page.ask("pendcorePage.run.until")
    page.do("pendcorePage.go(1)")
    assert page.text("trust") == f"right to 0.1 rad until {until:.4g} s"
    page.do("pendcorePage.go(29)")
    assert page.text("trust") == f"not right any more, since {until:.4g} s"
    page.enter("#compare", "the last link 0.001 rad further")
    page.wait("pendcorePage.other.until !== null")
    beside = page.ask("pendcorePage.other.until")
    assert beside < 30.0
    first = min(until, beside)
    assert page.text("trust") == f"not both right any more, since {first:.4g} s"
    page.do("pendcorePage.go(1)")
    assert page.text("trust") == f"both right to 0.1 rad until {first:.4g} s"
    page.do("pendcorePage.other.until = 0.5; pendcorePage.draw()")
    assert page.text("trust") == "not both right any more, since 0.5000 s"


def test_the_ghost_starts_a_billionth_of_a_radian_away(page):
    page.do("document.getElementById('ghost').click()")
    away = np.array(page.state("ghost", 0)) - [0.8, 1.0, 0, 0]
    assert away == pytest.approx([0, 1e-9, 0, 0], abs=1e-15)


def test_neighbours_are_the_runs_beside_this_one(page, sol):
    page.do("document.getElementById('neighbours').click()")
    page.wait("pendcorePage.neighbours?.count === 1000")
    found = page.ask("[...pendcorePage.neighbours.angles.slice(60 * 2000, 60 * 2000 + 8)]")
    q0 = np.array([[0.8, 1.0 + 1e-5 * (k + 1)] for k in range(4)])
    beside = pc.ensemble(sol.scene, q0=q0, t_span=(0, 8), t_eval=[1.0], keep="times", rtol=1e-9)
    assert found == pytest.approx(beside.q.ravel(), abs=1e-6)


def test_work_and_loss_have_a_chart_of_their_own_where_there_are_some(page, sol, opened):
    names = "pendcorePage.curves.{}.curves.map((one) => one.name)"
    assert page.ask(names.format("energy")) == ["kinetic", "potential", "total"]
    assert page.ask(names.format("work")) == ["viscous (lost)"]
    last = "pendcorePage.curves.{}.curves.at(-1).y.at(-1)"
    total, lost = (page.ask(last.format(chart)) for chart in ("energy", "work"))
    at_start, hanging = sol.energy().total[0], sol.scene.energy(0.0, [np.pi / 2] * 2, [0, 0])[1]
    assert total + lost == pytest.approx(at_start - hanging, abs=1e-6)
    hidden = "document.getElementById('work').hidden"
    assert page.ask(hidden) is False
    free = opened(pc.simulate(pc.Scene.textbook(), q0=0.5, t_span=(0, 1)))
    assert free.ask(hidden) is True


def test_the_energies_of_a_small_swing_are_not_flat_lines(opened):
    rod = pc.Scene(links=[pc.Link(mass=0.5, length=1.0)])
    page = opened(pc.simulate(rod, q0=[np.pi / 2 - 0.01], t_span=(0, 4)))
    potential, total = page.ask("pendcorePage.curves.energy.curves.slice(1).map((one) => one.y)")
    assert min(potential) == pytest.approx(0.0, abs=1e-3 * max(potential))
    assert max(potential) == pytest.approx(total[0])
    assert page.text("energy").startswith("energy above hanging at rest (J)")


@pytest.mark.parametrize(("size", "is_beside"), [("desktop", True), ("phone", False)])
def test_the_angles_stay_beside_the_sliders_where_there_is_room(page, sized, size, is_beside):
    sized(size)
    canvas = "document.querySelector('#angles canvas')"
    assert page.ask(f"{canvas}.offsetHeight") > 0
    page.click("tab-setup")
    assert (page.ask(f"{canvas}.offsetHeight") > 0) is is_beside
    page.do("document.querySelector('#setup').lastChild.scrollIntoView()")
    place = page.ask(f"(({{ top, bottom }}) => [top, bottom])({canvas}.getBoundingClientRect())")
    assert (0 <= place[0] < place[1] <= page.ask("innerHeight")) is is_beside


def test_what_accuracy_costs_is_measured(page):
    page.click("tab-accuracy")
    assert page.ask("document.getElementById('cost').hidden") is True
    page.click("measure")
    page.wait("pendcorePage.measured !== undefined", 60)
    assert page.ask("document.getElementById('cost').hidden") is False
    points = page.ask("pendcorePage.measured")
    taylor = [one for one in points if one["method"] == "taylor"]
    errors = [one["error"] for one in sorted(taylor, key=lambda one: -one["tolerance"])]
    assert errors[0] > 1e3 * errors[-1] > 0
    assert all(one["ms"] > 0 for one in points)
    assert {one["method"] for one in points} >= {"dopri5", "dop853", "taylor", "radau5"}


def test_whoever_wants_less_motion_gets_a_page_that_waits(sol, opened, browser):
    def emulate(*features):
        browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [*features]})

    emulate({"name": "prefers-reduced-motion", "value": "reduce"})
    try:
        page = opened(sol)
        assert (page.text("play"), page.ask("pendcorePage.isPlaying")) == ("Play", False)
    finally:
        emulate()
    assert opened(sol).text("play") == "Pause"


def test_the_phase_portrait_of_a_fast_link_has_no_corners(opened):
    page = opened(pc.simulate(pc.Scene.textbook(), q0=[0.3, 0.3], qd0=[0.0, 48.0], t_span=(0, 10)))
    x = np.array(page.ask("pendcorePage.curves.chosen.curves[1].x"), dtype=float)
    assert np.nanmax(np.abs(np.diff(x))) < 0.12  # rad
