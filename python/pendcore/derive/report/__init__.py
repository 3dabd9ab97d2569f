"""The report: the derivation of a user's scene as a document to hand in or to teach from.

It states the problem with its figure, goes through the steps of the derivation, puts the numbers
in, solves, draws angles and reactions, and checks the energy. The worksheet has the same problem
with blanks.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import NamedTuple

from pendcore import Case
from pendcore.derive.algebra import Algebra
from pendcore.derive.document import Document, Reader
from pendcore.derive.report import conversion, motion
from pendcore.derive.report.contents import report, worksheet
from pendcore.derive.report.drawing import save
from pendcore.messages import Progress, callback, close, warn, whole_file


class Report(NamedTuple):
    """The files that were written, a complaint about the run, and the files that could not be."""

    files: list[Path]
    complaint: str
    left_out: list[Path]


def write_report(
    derivation: Algebra,
    case: Case,
    folder: Path,
    *,
    with_worksheet: bool = False,
    progress: Progress = None,
) -> Report:
    """Write the report of a case, and its worksheet, in every form that this machine can make.

    The parameters are those of `Derivation.report`, but the folder has to exist. The report is the
    first file: Markdown always, HTML where there is pandoc, PDF where there is a LaTeX engine too.
    """
    told = callback(progress, "deriving") or (lambda fraction: None)
    try:
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
        files, left_out = _written(documents, folder, lambda share: told(0.4 + 0.6 * share))
        return Report(files, complaint, left_out)
    finally:
        close(told)


def _written(
    documents: dict[str, Document], folder: Path, told: Callable[[float], object]
) -> tuple[list[Path], list[Path]]:
    """Write every file that can be written; return these, and the others."""
    figures = {one.name: one for document in documents.values() for one in document.drawings}
    writers: list[tuple[Path, Callable[[Path], object]]] = [
        *(one for name, document in documents.items() for one in _texts(document, folder, name)),
        *((folder / one.file(Reader.PEOPLE), partial(save, one)) for one in figures.values()),
    ]
    files: list[Path] = []
    failures: dict[Path, Exception] = {}
    for k, (path, write) in enumerate(writers, start=1):
        try:
            with whole_file(path) as unfinished:
                write(unfinished)
            files.append(path)
        except Exception as failure:  # whatever it is, the others are written
            failures[path] = failure
        told(k / len(writers))
    if not files:
        raise failures[path]
    for path, why in failures.items():
        warn(f"{path.name} is not written: {why}")
    return files, [*failures]


def _texts(
    document: Document, folder: Path, name: str
) -> Iterator[tuple[Path, Callable[[Path], object]]]:
    """Yield every form of a document that the machine can make, and what writes it."""
    yield folder / f"{name}.md", partial(_write, document.markdown)
    if conversion.has_pandoc():
        yield folder / f"{name}.html", partial(_write, partial(conversion.page, document))
        if (engine := conversion.latex_engine()) is not None:
            yield folder / f"{name}.pdf", partial(conversion.pdf, document, engine)


def _write(text: Callable[[], str], path: Path) -> None:
    path.write_text(text(), encoding="utf-8")
