"""The report and the worksheet of a case say what is true, with units, and are whole."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import handed_out_cases as given
import pendcore as pc
import pytest
from handed_out_cases import AIRY, BUSY, CASES, LEVEL, SHAKEN
from pendcore.derive import Derivation, line_breaks
from pendcore.derive.document import (
    Blank,
    Displayed,
    Document,
    Heading,
    Paragraph,
    Reader,
    Table,
    written,
)
from pendcore.derive.report import conversion, motion
from pendcore.derive.report.quantities import number
from symbolic_scenes import derivation

pytestmark = pytest.mark.unsanitized
needs_pandoc = pytest.mark.skipif(shutil.which("pandoc") is None, reason="pandoc is not installed")
needs_latex = pytest.mark.skipif(
    shutil.which("pandoc") is None or conversion.latex_engine() is None,
    reason="pandoc or a LaTeX engine is not installed",
)
fx = pc.effects


@pytest.fixture(scope="module", params=CASES)
def handed_out(request: pytest.FixtureRequest) -> tuple[pc.Case, Derivation, Document, Document]:
    case = CASES[request.param]
    return case, derivation(case.scene), given.reported(case), given.asked(case)


def displayed(document: Document) -> list[Displayed]:
    return [block for block in document.blocks if isinstance(block, Displayed)]


def test_every_step_of_the_derivation_is_in_it_and_fits_its_lines(handed_out: Any) -> None:
    _, derived, whole, blank = handed_out
    for document in (whole, blank):
        text = document.markdown()
        for step in derived.steps:
            assert f"### {step.number}. {step.title}\n" in text
    numbers = (e.number for s in derived.steps for e in s.equations if e.number)
    shown = displayed(whole)
    assert [block.number for block in shown if block.number] == list(dict.fromkeys(numbers))
    for block in shown:
        assert block.latex.count("{") == block.latex.count("}")
        rows = block.latex.split(r"\\" + "\n")
        assert len(rows) <= 26  # a page must be able to end
        for row in rows:
            inside = re.sub(r"\\(begin|end){aligned}|&", "", row)
            if "vmatrix" not in row:
                assert line_breaks.width(inside) < line_breaks.LINE + 6, inside


def test_the_textbooks_report_has_its_numbers_and_units() -> None:
    text = given.reported(CASES["textbook"]).markdown()
    assert re.findall(r"\\tag{(.*?)}", text) == [f"2.{k}" for k in range(1, 12)]
    for told in (
        r"q_{1}(0) &= 0.785398\;\text{rad} = 45^\circ",
        r"I_{C_{1}} &= \frac{m_{1} L_{1}^{2}}{12} = 0.0833333\;\text{kg}\,\text{m}^{2}",
        r"M_{12} &= 0.5 \cos{\left(q_{1} - q_{2} \right)}\;\text{kg}\,\text{m}^{2}",
        r"| $\ddot{q}_{1}$ | $10.811$ | $10.811$ | $\text{rad}/\text{s}^{2}$ |",
        "| $5$ | $62.055$ | $30.852$ |",
        r"| $g$ | acceleration of gravity | $9.807$ | $\text{m}/\text{s}^{2}$ |",
    ):
        assert told in text, told


ACCELERATION = r"\ddot{x}_{A} = -0.9 \sin {3 t}\;\text{m}/\text{s}^{2}"
LOCKED = [
    *(r"\mathbf{f} + \boldsymbol{\lambda}", r"$\lambda_{1} = -\Lambda_{2}$"),
    "the condition that a locked joint does not turn",
]


@pytest.mark.parametrize(
    ("effect", "told"),
    [
        (fx.DrivenPivot(x=fx.Sinusoid(0.1, 3.0)), [ACCELERATION]),
        (fx.RodDrag(link=2, drag_coefficient=1.2, diameter=0.1), [r"F_{d,2} &= -\frac{0.0245"]),
        (fx.Motor(joint=1, constant=2.0), [r"\tau_{1} = 2\;\text{N}\,\text{m}"]),
        (fx.Lock(joint=2), LOCKED),
    ],
    ids=["pivot", "drag", "motor", "lock"],
)
def test_every_symbol_of_f_has_its_numbers_where_f_has_them(effect: Any, told: list[str]) -> None:
    effects = [effect, fx.Payload(mass=0.5, inertia=0.01)]
    scene = pc.Scene(links=[pc.Link(mass=1.0, length=1.0)] * 2, effects=effects)
    case, derived = pc.Case(scene=scene, q0=(0.3, 0.4), t_span=(0, 2)), derivation(scene)
    text = given.reported(case).markdown()
    text = text.split("### The equations of motion with numbers\n")[1].split("\n##")[0]
    for words in told:
        assert words in text, text
    s, write = derived.symbols, derived.symbols.latex
    free = set().union(*(x.free_symbols for x in derived.named.entries.values()))
    left = free - {s.t, *s.q, *s.qd, *derived.values}
    assert all(re.search(re.escape(write(x)) + " &?= ", text) for x in left)


def test_what_the_derivation_says_of_the_start_is_what_the_core_says(handed_out: Any) -> None:
    case, derived, *_ = handed_out
    rows = given.at_start(case)
    assert len(rows) == 3 * derived.n + len(derived.equations.locked) + 2
    scale = max(abs(core) for *_, core in rows)
    for name, _, own, core in rows:
        assert abs(own - core) <= 1e-13 * scale, name


def test_free_bodies_have_the_couples_of_the_equations(handed_out: Any) -> None:
    """A joint's couple acts on the link that begins there, and reversed on the link before."""
    case, derived, *_ = handed_out
    sheets = given.drawn("free_bodies", case.scene, case.q0).axes
    shown = [text.get_text() for axes in sheets for text in axes.texts]
    for joint in range(1, derived.n + 1):
        couple = derived.equations.joint_couple(joint)
        if couple != 0:
            times = shown.count(f"${derived.symbols.latex(couple)}$")
            assert times == (1 if joint == 1 else 2), couple


def test_curves_are_of_the_forces_that_the_derivation_names(handed_out: Any) -> None:
    case, derived, *_ = handed_out
    curves = motion.reactions(derived, given.solved(case)).figure.axes
    rows = {name: own for name, _, own, _ in given.at_start(case)}
    for axis, names in zip(curves, derived.equations.forces, strict=True):
        assert axis.get_ylabel().endswith("(N)")
        for line, name in zip(axis.lines, names, strict=False):
            begins = rows[derived.symbols.latex(name)]
            assert line.get_ydata()[0] == pytest.approx(begins, rel=1e-12, abs=1e-12)
    assert curves[-1].get_xlabel() == "t (s)"


def test_a_worksheet_gives_nothing_away(handed_out: Any) -> None:
    case, _, whole, blank = handed_out
    text = blank.markdown()
    works = any(effect.description.account != "none" for effect in case.scene.effects)
    assert ("keep the balance" in text) is works
    for name, _, own, _ in given.at_start(case):
        if own and name not in ("T", "V"):
            assert f"${number(own)}$" in whole.markdown()
            assert f"${number(own)}$" not in text
    assert "free bodies" in whole.markdown()
    assert {drawing.name for drawing in blank.drawings} == {"mechanism", "links", "axes"}
    assert "links" not in {drawing.name for drawing in whole.drawings}  # both share a folder


def test_no_left_side_of_a_worksheet_is_the_answer_to_a_blank(handed_out: Any) -> None:
    _, derived, _, blank = handed_out
    blanks = [one.latex for one in blank.blocks if isinstance(one, Blank) and one.latex]
    named_again = [
        equation
        for step in derived.steps
        for k, equation in enumerate(step.equations)
        if not equation.number and equation.lhs in [one.lhs for one in step.equations[:k]]
    ]
    assert "M" in [str(one.lhs) for one in named_again]  # with its value: it has a blank already
    assert len(blanks) == sum(len(step.equations) for step in derived.steps) - len(named_again)
    for left in blanks:
        assert not re.search(r"\\(sin|cos)\b|\\frac{[^\\]", left), left


@pytest.mark.parametrize(
    ("case", "words"),
    [
        (BUSY, r"Viscous damping at joint 2 is the couple $-b_{2} \dot{\varphi}_{2}$"),
        (BUSY, r"A motor at joint 1 is the couple $\tau_{M,1} \sin {\Omega_{1} t}$"),
        (BUSY, r"at joint 3 is the couple $-k_{3} \left(\varphi_{3} - \varphi_{0,3}\right)$"),
        (BUSY, r"its moment of inertia about its mass centre is $I_{p}$"),
        (AIRY, r"J_{1} \ddot{\varphi}_{1}"),
        (AIRY, r"Joint 2 is locked: a couple $\Lambda_{2}$"),
        (AIRY, r"$w_{0,2}$ where the link begins, $w_{1,2}$ where the link ends"),
        (AIRY, r"the wind $(v_{x,2}, 0)$"),
        (SHAKEN, r"$\left(0, \hat{y}_{A} \sin {\Omega_{y} t}\right)$"),
        (LEVEL, "Nothing acts on the chain but gravity and the joint that holds it."),
    ],
)
def test_a_worksheet_states_what_acts_and_what_its_symbols_are(case: pc.Case, words: str) -> None:
    text = given.asked(case).markdown().partition("## Derivation")[0]
    assert words in text
    assert r"\varepsilon" not in text


def test_without_converters_there_is_markdown_with_its_figures(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", "")
    files = derivation(LEVEL.scene).report(LEVEL, str(tmp_path / "new"), worksheet=True)
    names = [path.name for path in files]
    assert names[:2] == ["report.md", "worksheet.md"]
    assert sorted(path.name for path in (tmp_path / "new").iterdir()) == sorted(names)
    for name in names[:2]:
        for target in re.findall(r"!\[.*?\]\((.*?)\)", (tmp_path / "new" / name).read_text()):
            assert target in names


@pytest.mark.outside_build
def test_a_converter_that_fails_is_told_of_and_costs_nothing_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    broken = tmp_path / "pandoc"
    broken.write_text("#!/bin/sh\necho out of order >&2\nexit 3\n")
    broken.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.warns(pc.PendcoreWarning, match=r"report\.html is not written: .*out of order"):
        files = derivation(LEVEL.scene).report(LEVEL, tmp_path / "new")
    assert files[0].name == "report.md"
    assert not [path for path in files if path.suffix in (".html", ".pdf")]


@pytest.mark.few_cases
@needs_pandoc
@pytest.mark.outside_build
def test_the_page_needs_no_other_file_and_no_network(handed_out: Any, tmp_path: Path) -> None:
    whole = handed_out[2]
    conversion.page(whole, tmp_path / "report.html")
    text = (tmp_path / "report.html").read_text()
    assert text.count("<math") > len(displayed(whole))
    assert all(
        source.startswith("data:image/svg+xml;base64,")
        for source in re.findall(r'src="(.*?)"', text)
    )
    assert text.count("<img") == len(whole.drawings)
    links = set(re.findall(r"https?://[^\s\"'<]+", re.sub(r"base64,[^\"]*", "", text)))
    assert links <= {"http://www.w3.org/1998/Math/MathML", "http://www.w3.org/1999/xhtml"}
    assert not re.search(r"<(script|link)\b", text)
    for block in displayed(whole):
        if block.number:
            assert f"({block.number})" in text
    unread = re.sub(r"<annotation.*?</annotation>|<style.*?</style>", "", text, flags=re.DOTALL)
    assert not re.search(r"\\[a-zA-Z]+|\$", unread)  # pandoc could read all LaTeX


@needs_latex
@pytest.mark.outside_build
@pytest.mark.parametrize("name", ["textbook", "busy"])
def test_the_pdf_is_made(name: str, tmp_path: Path) -> None:
    engine = conversion.latex_engine()
    assert engine is not None
    conversion.pdf(given.reported(CASES[name]), engine, tmp_path / "report.pdf")
    assert (tmp_path / "report.pdf").read_bytes().startswith(b"%PDF")


def test_a_pdf_is_made_with_the_preamble_and_the_figures(tmp_path, monkeypatch) -> None:
    """What pandoc is told, where there is no LaTeX."""
    made = []

    def pandoc(command: list[str], *, cwd: Path, **how: Any) -> subprocess.CompletedProcess[str]:
        options = dict(word.removeprefix("--").split("=", 1) for word in command if "=" in word)
        made.append((Path(options["include-in-header"]).read_text(), options["pdf-engine"]))
        made.append({path.name for path in cwd.glob("*.pdf")})
        Path(options["output"]).write_bytes(b"%PDF")
        return subprocess.CompletedProcess(command, 0, "", "")

    monkeypatch.setattr(subprocess, "run", pandoc)
    document = given.reported(LEVEL)
    conversion.pdf(document, "lualatex", tmp_path / "report.pdf")
    assert (tmp_path / "report.pdf").read_bytes() == b"%PDF"
    assert made[0] == (conversion.PREAMBLE, "lualatex")
    assert made[1] == {f"{drawing.name}.pdf" for drawing in document.drawings} != set()


def test_every_reader_has_the_figures_and_no_table_is_parted_by_the_end_of_a_page() -> None:
    """Room for a table is asked for before it, or before the paragraph that leads to it."""
    document = given.reported(LEVEL)
    for reader, suffix in ((Reader.PEOPLE, "png"), (Reader.HTML, "svg"), (Reader.PDF, "pdf")):
        found = re.findall(r"!\[.*?\]\((\w+)\.(\w+)\)", document.markdown(reader))
        assert found == [(drawing.name, suffix) for drawing in document.drawings]
    paragraphs = document.markdown(Reader.PDF).split("\n\n")
    tables = [i for i, text in enumerate(paragraphs) if text.startswith("| ")]
    assert len(tables) == sum(isinstance(block, Table) for block in document.blocks) >= 3
    for i in tables:
        room = re.search(r"needroom\{(\d+)", "".join(paragraphs[i - 2 : i]))
        assert room, paragraphs[i]
        assert int(room[1]) > paragraphs[i].count("\n") + 1
    assert "needroom" not in written([Heading(2, "A"), Paragraph("b")], Reader.PDF)
