"""A report of a run that ends early is laid over the time that the run took."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pendcore as pc
import pytest
from pendcore.derive import Derivation
from pendcore.derive.report import motion, report

pytestmark = pytest.mark.unsanitized

ROD = pc.Link(mass=1.0, length=1.0)
DAMPED = pc.Scene(links=[ROD], effects=[pc.effects.ViscousJoint(joint=1, damping=0.1)])
PASSED = pc.events.LinkAngle(link=1, value=0.8, terminal=True)


@pytest.mark.parametrize("t_span", [(0, 500), (3, -500)])
@pytest.mark.parametrize("options", [{"events": [PASSED]}, {"max_steps": 2}])
def test_a_run_that_ends_early_is_drawn_as_far_as_it_went(options: Any, t_span: Any) -> None:
    case = pc.Case(scene=DAMPED, q0=0.5, t_span=t_span, options=options)
    solution = motion.solved(case)
    assert solution.status in ("event", "max_steps")
    assert len(solution.t) == motion.POINTS
    assert solution.t[-1] == solution._run.t_reached != t_span[1]
    text = report(Derivation(DAMPED), case, solution).markdown()
    assert "| change of $T + V$ | $0$ |" not in text
    ledger = solution.energy().ledger
    assert ledger is not None
    assert ledger["viscous"][-1] != 0


def test_a_run_that_does_not_leave_its_start_has_no_curves(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", "")
    case = pc.Case(scene=DAMPED, q0=0.5, t_span=(0, 5), options={"time_limit": 1e-9})
    with pytest.warns(pc.PendcoreWarning) as told:
        files = Derivation(DAMPED).report(case, tmp_path, worksheet=True)
    assert [str(x.message)[:23] for x in told] == ["the run is not complete"]
    assert {path.stem for path in files if path.suffix == ".png"} == {
        "mechanism", "free_bodies", "links", "axes"}  # fmt: skip
    text = (tmp_path / "report.md").read_text()
    assert "It ends where it starts: there are no curves to draw." in text
    assert "from start to end" not in text
