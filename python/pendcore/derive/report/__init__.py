"""The report: the derivation of a user's scene as a document to hand in or to teach from.

It states the problem with its figure, goes through the steps of the derivation, puts the numbers
in, solves, draws angles and reactions, and checks the energy. The worksheet has the same problem
with blanks.
"""

from __future__ import annotations

import shutil
from collections.abc import Callable
from functools import partial
from pathlib import Path

from pendcore import Case
from pendcore.derive.derivation import Derivation
from pendcore.derive.document import Document, Reader
from pendcore.derive.report import conversion, motion
from pendcore.derive.report.contents import report, worksheet
from pendcore.derive.report.pictures import save
from pendcore.messages import Progress, reporting, warn, whole_file


class Report(list[Path]):
    """The files that were written, the report first.

    ``is_whole`` says that the run is as it was asked for, and that no file is left out.
    """

    is_whole = True


def write_report(
    derivation: Derivation, case: Case, folder: Path, *, with_worksheet: bool, progress: Progress
) -> Report:
    """Write a report in every form that this machine can make; `Derivation.report` says more."""
    with reporting(progress, "deriving") as told:
        told(0.0)
        solution, refusal = motion.solved(case)
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
        made = _written(documents, folder, lambda share: told(0.4 + 0.6 * share))
        made.is_whole = made.is_whole and not complaint
        return made


def _written(
    documents: dict[str, Document], folder: Path, told: Callable[[float], object]
) -> Report:
    """Write every file that can be written."""
    engine = conversion.latex_engine()
    writers: dict[str, Callable[[Path], object]] = {}
    for name, document in documents.items():
        writers[f"{name}.md"] = partial(Path.write_text, data=document.markdown(), encoding="utf-8")
        if shutil.which("pandoc"):
            writers[f"{name}.html"] = partial(conversion.page, document)
            writers |= {f"{name}.pdf": partial(conversion.pdf, document, engine)} if engine else {}
    drawings = (one for document in documents.values() for one in document.drawings)
    writers |= {one.file(Reader.PEOPLE): partial(save, one) for one in drawings}
    made = Report()
    failures: dict[str, Exception] = {}
    for k, (name, write) in enumerate(writers.items(), start=1):
        try:
            with whole_file(folder / name) as unfinished:
                write(unfinished)
            made.append(folder / name)
        except Exception as failure:  # whatever it is, the others are written
            failures[name] = failure
        told(k / len(writers))
    if not made:
        raise failures[name]
    for name, why in failures.items():
        warn(f"{name} is not written: {why}")
    made.is_whole = not failures
    return made
