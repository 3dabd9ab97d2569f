"""The report: the derivation of a user's scene as a document to hand in or to teach from.

It states the problem with its figure, goes through the steps of the derivation, puts the numbers
in, solves, draws angles and reactions, and checks the energy. The worksheet has the same problem
with blanks.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

from pendcore import _core
from pendcore._cases.case import Case
from pendcore._cases.whole_file import whole_file
from pendcore._messages import progress as bars
from pendcore._messages.progress import Progress
from pendcore._messages.warning import warn
from pendcore._run.solution import Solution
from pendcore.derive import narration
from pendcore.derive.algebra import Algebra
from pendcore.derive.report import conversion, motion, numbers, problem, steps
from pendcore.derive.report.blanks import concealed
from pendcore.derive.report.document import Block, Document, Heading, Paragraph, Reader, Space
from pendcore.derive.report.figures import Figures


class Report(NamedTuple):
    """The result of writing a report.

    Attributes
    ----------
    files : list of Path
        The files that were written.
    complaint : str
        A complaint about the run that the report shows; empty if there is none.
    left_out : list of Path
        The files that could not be written; a warning says why.
    """

    files: list[Path]
    complaint: str
    left_out: list[Path]


def report(derivation: Algebra, case: Case, solution: Solution, refusal: str = "") -> Document:
    """Return the derivation of a case with its solution.

    Parameters
    ----------
    derivation : Algebra
        The derivation of the case's scene.
    case : Case
        The case, with its start.
    solution : Solution
        The run of the case, as `motion.solved` returns it.
    refusal : str
        What an `AccuracyError` said, if the solution comes from one.
    """
    figures = Figures(derivation, case.q0)
    blocks = [
        *problem.problem(derivation, case, figures),
        Heading(2, "Derivation of the equations of motion"),
        *steps.derivation_steps(derivation, narration.steps(derivation), figures),
        *numbers.numbers_put_in(derivation),
        *numbers.at_the_start(derivation, case),
        *motion.numerical_solution(derivation, solution, figures, refusal),
        *motion.energy_check(derivation, solution, figures),
        Paragraph(f"*Derived with SymPy and solved by pendcore {_core.__version__}.*"),
    ]
    return Document(_title(derivation, case), tuple(blocks))


def worksheet(derivation: Algebra, case: Case, solution: Solution) -> Document:
    """Return the same problem with blanks: right sides, free bodies and curves are to be found."""
    figures = Figures(derivation, case.q0)
    blocks: list[Block] = [
        *problem.problem(derivation, case, figures, by_hand=True),
        Heading(2, "Derivation of the equations of motion"),
        *steps.derivation_steps(derivation, concealed(derivation), figures, blanks=True),
        *_questions(derivation, case, solution, figures),
    ]
    return Document(f"{_title(derivation, case)}: worksheet", tuple(blocks))


def write_report(
    derivation: Algebra,
    case: Case,
    folder: Path,
    *,
    with_worksheet: bool = False,
    progress: Progress = None,
) -> Report:
    """Write the report of a case, and its worksheet, in every form that this machine can make.

    Parameters
    ----------
    derivation : Algebra
        The derivation of the case's scene.
    case : Case
        The case that is derived and solved.
    folder : Path
        Where to write; the folder has to exist.
    with_worksheet : bool
        Whether to write ``worksheet`` beside ``report``.
    progress : None, bool or callable
        As in `pendcore.simulate`.

    Returns
    -------
    Report
        The files, the report first: Markdown always, HTML where there is pandoc, PDF where there is
        a LaTeX engine too; then the figures. Also the complaint about the run.
    """
    told = bars.callback(progress, "deriving") or (lambda fraction: None)
    try:
        return _written(derivation, case, folder, with_worksheet, told)
    finally:
        bars.close(told)


def _written(
    derivation: Algebra,
    case: Case,
    folder: Path,
    with_worksheet: bool,
    told: Callable[[float], object],
) -> Report:
    told(0.0)
    solution, refusal = motion.solved_or_refused(case)
    complaint = refusal
    if not solution.success:
        complaint = f"the run is not complete: {solution.message}"
    if complaint:
        warn(complaint)
    told(0.05)
    documents = {"report": report(derivation, case, solution, refusal)}
    if with_worksheet:
        documents["worksheet"] = worksheet(derivation, case, solution)
    told(0.4)
    figures = {one.name: one for document in documents.values() for one in document.drawings}
    writers = [
        *(one for name, document in documents.items() for one in _texts(document, folder, name)),
        *((one.path(folder, Reader.PEOPLE), one.save) for one in figures.values()),
    ]
    files: list[Path] = []
    failures: dict[Path, Exception] = {}
    for k, (path, write) in enumerate(writers):
        try:
            with whole_file(path) as unfinished:
                write(unfinished)
            files.append(path)
        except Exception as failure:  # whatever it is, the others are written
            failures[path] = failure
        told(0.4 + 0.6 * (k + 1) / len(writers))
    if not files:
        raise failures[path]
    for path, why in failures.items():
        warn(f"{path.name} is not written: {why}")
    return Report(files, complaint, [*failures])


def _texts(
    document: Document, folder: Path, name: str
) -> Iterator[tuple[Path, Callable[[Path], object]]]:
    """Return every form of a document that the machine can make, and what writes it."""

    def markdown(path: Path) -> None:
        path.write_text(document.markdown(), encoding="utf-8")

    def html(path: Path) -> None:
        path.write_text(conversion.page(document), encoding="utf-8")

    def pdf(path: Path) -> None:
        conversion.pdf(document, path, str(engine))

    yield folder / f"{name}.md", markdown
    engine = conversion.latex_engine()
    if conversion.has_pandoc():
        yield folder / f"{name}.html", html
        if engine is not None:
            yield folder / f"{name}.pdf", pdf


def _questions(
    derivation: Algebra, case: Case, solution: Solution, figures: Figures
) -> Iterator[Block]:
    yield Heading(3, "The equations of motion with numbers")
    yield Paragraph("Put the numbers of the table into the equations of motion. Give the units.")
    yield Space(5)
    yield Heading(3, "At the start")
    yield Paragraph(
        "Compute the angular accelerations and the joint reactions at the start. Which way does "
        "each link begin to turn? Which way does each joint push?"
    )
    yield Space(7)
    yield Heading(2, "Numerical solution")
    yield Paragraph("Integrate the first-order system, and draw the angles.")
    yield figures.empty_axes(solution)
    yield Heading(2, "Check by the energy")
    works = any(effect.description.account != "none" for effect in case.scene.effects)
    yield Paragraph(
        "Write down kinetic and potential energy. What is their sum at the start"
        + (
            " and at the end? How much did the effects take or give in between, and how well does "
            "your solution keep the balance?"
            if works
            else ", and how well does your solution keep it?"
        )
    )
    yield Space(6)


def _title(derivation: Algebra, case: Case) -> str:
    names = {1: "Pendulum", 2: "Double pendulum"}
    name = case.name or names.get(derivation.n, f"Chain of {derivation.n} links")
    return name[:1].upper() + name[1:]
