"""A report tells of the run what is true: method, end, largest reactions, balance, rest."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from handed_out_cases import reported, solved
from pendcore.derive.report import motion
from pendcore.derive.report.quantities import Scales
from symbolic_scenes import derivation

pytestmark = pytest.mark.unsanitized

fx = pc.effects
ROD = pc.Link(mass=1.0, length=1.0)
DAMPED = pc.Scene(links=[ROD], effects=[fx.ViscousJoint(joint=1, damping=0.1)])
PASSED = pc.events.LinkAngle(link=1, value=0.8, terminal=True)


def case(n: int, *effects: Any, q0: Any = (0.3, 0.4, 0.6), **more: Any) -> pc.Case:
    scene = pc.Scene(links=[ROD] * n, effects=effects)
    return pc.Case(scene=scene, q0=q0[:n], t_span=(0, 2), **more)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({}, "order 8, and by Radau IIA where the equations are stiff, with the tolerances"),
        ({"rtol": 1e-4, "atol": 1e-6}, r"tolerances $r = 0.0001$ and $a = 1 \times 10^{-6}$"),
        ({"method": "ode45"}, "that of MATLAB's `ode45`, with the tolerances"),
        ({"method": "Radau"}, "Radau IIA, an implicit method of order 5, with"),
        ({"method": "rk4", "step": 0.01}, "the classical Runge-Kutta method of order 4, with a"),
    ],
)
def test_the_method_is_told_in_words(options: dict[str, Any], words: str) -> None:
    assert words in motion.how(solved(case(1, options=options)))


@pytest.mark.parametrize("t_span", [(0, 500), (3, -500)])
@pytest.mark.parametrize("options", [{"events": [PASSED]}, {"max_steps": 2}])
def test_a_run_that_ends_early_says_why_and_is_drawn_as_far_as_it_went(
    options: Any, t_span: Any
) -> None:
    of = pc.Case(scene=DAMPED, q0=0.5, t_span=t_span, options=options)
    solution = solved(of)
    assert solution.status in ("event", "max_steps")
    assert len(solution.t) == motion.POINTS
    assert solution.t[-1] == solution.t_reached != solution.t_span[1]
    text = reported(of).markdown()
    assert solution.message in text
    assert "| change of $T + V$ | $0$ |" not in text
    ledger = solution.energy().ledger
    assert ledger is not None
    assert ledger["viscous"][-1] != 0


def test_a_run_that_does_not_leave_its_start_has_no_curves_and_is_warned_of(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", "")
    of = pc.Case(scene=DAMPED, q0=0.5, t_span=(0, 5), options={"time_limit": 1e-9})
    with pytest.warns(pc.PendcoreWarning, match="^the run is not complete") as warned:
        files = derivation(DAMPED).report(of, tmp_path, worksheet=True)
    assert len(warned) == 1
    assert {path.stem for path in files if path.suffix == ".png"} == {
        "mechanism", "free_bodies", "links", "axes"}  # fmt: skip
    text = (tmp_path / "report.md").read_text()
    assert "**The run is not complete" in text
    assert "from start to end" not in text


def test_a_run_that_takes_no_time_is_refused() -> None:
    with pytest.raises(ValueError, match=r"^t_span = \(1\.0, 1\.0\): a report draws curves"):
        motion.solved(pc.Case(scene=DAMPED, q0=0.5, t_span=(1, 1)))


def test_the_balance_of_the_energy_is_that_of_the_run() -> None:
    of = case(2, fx.ViscousJoint(joint=1, damping=0.1), fx.Motor(joint=2, constant=1.0))
    text, energy = reported(of).markdown(), solved(of).energy()
    assert energy.ledger is not None
    for words, value in (
        ("change of $T + V$", energy.total[-1] - energy.total[0]),
        ("lost: viscous", energy.ledger["viscous"][-1]),
        ("work done: motor", energy.ledger["motor"][-1]),
    ):
        assert f"| {words} | ${value:.6g}$ |" in text
    assert r"\sum_k P_k$ to 0" in text


def test_a_run_at_rest_is_said_to_be_one() -> None:
    text = reported(case(2, q0=np.radians([90.0, 90.0]))).markdown()
    assert "$-0.0000$" not in text
    assert r"the largest kinetic energy is $0\;\text{J}$" in text
    assert r"|\mathbf{F}_{01}| = 19.61\;\text{N}$ throughout" in text


def sizes(of: pc.Case, times: Any) -> Any:
    """Return the sizes of the forces at times of the run, (k, n)."""
    options = {**of.options, "t_eval": tuple(times)}
    run = pc.Case(scene=of.scene, q0=of.q0, t_span=of.t_span, options=options).simulate()
    return np.linalg.norm(run.reactions(), axis=-1)


@pytest.mark.parametrize(
    "of",
    [
        pc.Case.textbook(),
        case(3, fx.DrivenPivot(y=fx.Sinusoid(0.02, 80.0)), q0=(-1.4, -1.5, 0.2)),
        case(2, options={"method": "rk4", "step": 1e-3}),
    ],
    ids=["textbook", "shaken", "rk4"],
)
def test_the_largest_reactions_are_those_of_the_curve_to_four_digits(of: pc.Case) -> None:
    solution, text = solved(of), reported(of).markdown()
    t, step = np.linspace(*of.t_span, 40_001, retstep=True)
    found = sizes(of, t)
    for i, peak in enumerate(solution.largest_reactions()):
        assert peak.force >= found[:, i].max()
        k = int(found[:, i].argmax())
        assert abs(peak.t - t[k]) <= step
        near = np.linspace(t[max(k - 1, 0)], t[min(k + 1, len(t) - 1)], 4_001)
        assert peak.force == pytest.approx(sizes(of, near)[:, i].max(), rel=1e-9)
        assert peak.force == pytest.approx(sizes(of, [peak.t])[0, i], rel=1e-13)
        assert rf"= {peak.force:.4g}\;\text{{N}}$ at $t = {peak.t:.4g}\;" in text


def test_what_is_rounding_depends_on_the_size_of_the_mechanism() -> None:
    for size in (1.0, 1e-3):
        rod = pc.Link(mass=size**3, length=size)
        scales = Scales(derivation(pc.Scene(links=[rod], gravity=9.807)))
        moment = 9.807 * size**4
        assert scales.shown(1e-9 * moment, "N m") == 1e-9 * moment
        assert scales.shown(1e-14 * moment, "N m") == 0.0


def test_small_numbers_are_printed_and_rounding_of_0_is_not() -> None:
    rods = [ROD, pc.Link(mass=1e-8, length=1e-3)]
    small = pc.Case(scene=pc.Scene(links=rods), q0=0.3, t_span=(0, 0.01))
    assert (
        r"M_{22} &= 3.33333 \times 10^{-15}"
        in reported(small).markdown().split("### At the start")[1]
    )
    for degrees in ((90.0, 90.0), (180.0, 90.0), (-90.0, -90.0), (90.0, 0.0)):
        text = reported(case(2, q0=np.radians(degrees))).markdown()
        start = text.split("### At the start\n")[1].split("\n##")[0]
        before, after = start.split("The two differ by at most")
        assert not re.search(r"10\^\{-(1[2-9]|[2-9]\d)\}", before), before
        assert "printed as 0" in after
