"""`pendcore derive` writes every form to the screen or a file, and tells mistakes in a line."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pendcore as pc
import pytest
from pendcore.cli import main
from pendcore.derive import Derivation
from symbolic_scenes import derivation

pytestmark = pytest.mark.unsanitized

FORMS = {
    "text": Derivation.__str__,
    "latex": Derivation.latex,
    "octave": Derivation.to_octave,
    "inline": Derivation.to_octave_inline,
    "python": Derivation.to_python,
    "cpp": Derivation.to_cpp,
}
TEXTBOOK = derivation(pc.Scene.textbook())


@pytest.fixture(autouse=True)
def _in_a_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(pc.derive, "Derivation", derivation)  # a scene is derived once


@pytest.mark.parametrize("form", FORMS)
def test_a_form_is_printed_or_written(form: str, capsys: pytest.CaptureFixture[str]) -> None:
    expected = FORMS[form](TEXTBOOK)
    assert main(["derive", "--to", form]) == 0
    assert capsys.readouterr() == (expected, "")
    assert main(["derive", "--to", form, "-o", "a/RR.m"]) == 0
    assert capsys.readouterr() == ("", "written to a/RR.m\n")
    assert Path("a/RR.m").read_text(encoding="utf-8") == expected


def test_steps_are_printed_by_default_and_a_case_of_one_s_own_is_derived(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["derive"]) == 0
    assert capsys.readouterr().out == str(TEXTBOOK)
    swing = pc.Case(scene=pc.Scene(links=[pc.Link(mass=2.0, length=1.5)]), q0=0.1, t_span=(0, 1))
    Path("swing.toml").write_text(swing.to_toml())
    assert main(["derive", "swing.toml", "--to", "octave"]) == 0
    assert capsys.readouterr().out == derivation(swing.scene).to_octave()
    assert main(["derive", "--to", "octave", "-o", "swing.m"]) == 0
    assert "function dx = swing(t,x)" in Path("swing.m").read_text()  # as its file is called


@pytest.mark.parametrize(
    ("command", "message"),
    [
        ("rough.toml --to cpp -o rough.hpp", "cannot be derived in symbols"),
        ("wrong.toml --to cpp -o wrong.hpp", "joint"),
        ("--to octave -o 2_rods.m", "2_rods"),
        ("--worksheet", "--worksheet: belongs to a report: add --to report\n"),
    ],
)
def test_what_is_refused_is_told_in_a_line(
    command: str, message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    friction, damping = "dry_joint_friction", "viscous_joint"
    for name, kind, joint in (("rough", friction, 1), ("wrong", damping, 3)):
        amount = "coulomb" if kind == friction else "damping"
        effect = f'[[effect]]\nkind = "{kind}"\njoint = {joint}\n{amount} = 0.1\n'
        Path(f"{name}.toml").write_text(f"{pc.Case.textbook().to_toml()}\n{effect}")
    assert main(["derive", *command.split()]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("pendcore derive: ")
    assert err.count("\n") == 1
    assert message in err
    assert {path.suffix for path in Path().iterdir()} == {".toml"}


def test_a_report_is_written_into_a_folder(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", "")  # without a converter Markdown and figures are left
    assert main(["derive", "--to", "report"]) == 0
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("written to out/textbook: report.md, ")
    assert main(["derive", "--to", "report", "--worksheet", "-o", "sheets"]) == 0
    names = {path.name for path in Path("sheets").iterdir()}
    assert {"report.md", "worksheet.md", "angles.png"} <= names
    assert {path.suffix for path in Path("sheets").iterdir()} == {".md", ".png"}


CHAOS = pc.Case(scene=pc.Scene(links=[pc.Link(mass=1, length=1)] * 2), q0=(-2, -1),
                t_span=(0, 60), options={"error": 1e-6})  # fmt: skip


@pytest.mark.parametrize(
    ("case", "warning", "told", "runs"),
    [
        (
            pc.Case.textbook().to_toml() + "max_steps = 3\n",
            "the run is not complete",
            "**The run is not complete",
            2,  # the second keeps the times until its end
        ),
        (
            CHAOS.to_toml(),
            "error = 1e-06: not reached: ",
            "**The run is not shown to be as exact as asked for: error = 1e-06: not reached: ",
            1,
        ),
    ],
    ids=["fails", "chaos"],
)
def test_a_report_of_a_run_that_is_not_as_asked_is_written_and_exits_with_1(
    case: str, warning: str, told: str, runs: int,
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    monkeypatch.setenv("PATH", "")
    Path("case.toml").write_text(case)
    made = list[pc.Case]()
    monkeypatch.setattr(pc.Case, "simulate", lambda case, run=pc.Case.simulate, **how: (
        made.append(case), run(case, **how))[1])  # fmt: skip
    assert main(["derive", "case.toml", "--to", "report", "-o", "o"]) == 1
    assert len(made) == runs
    assert f"warning: {warning}" in capsys.readouterr().err
    assert told in Path("o/report.md").read_text()
    assert Path("o/angles.png").exists()


def test_without_sympy_the_command_says_what_to_install() -> None:
    code = "import sys; sys.modules['sympy'] = None; from pendcore.cli import main; "
    done = subprocess.run(
        [sys.executable, "-c", f"{code}sys.exit(main(['derive']))"], capture_output=True, text=True
    )
    assert done.returncode == 2
    assert done.stderr == (
        "pendcore derive: pendcore.derive needs sympy, which is not installed: pip install sympy\n"
    )
