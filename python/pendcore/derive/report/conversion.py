"""Markdown made into a page of HTML and into a PDF, by the converters that a machine has.

pandoc makes a page of HTML that needs no other file and no network: equations are MathML, and the
page holds the figures. Where there is a LaTeX engine too, pandoc also makes a PDF.
"""

from __future__ import annotations

import base64
import os
import re
import shutil
import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory

from pendcore.derive.document import Document, Reader
from pendcore.derive.report.pictures import save
from pendcore.plotting import css_variables

ENGINES = ("xelatex", "lualatex", "pdflatex")
"""LaTeX engines, in the order in which they are tried."""

ACCENTS = {"\N{COMBINING DOT ABOVE}": "\N{DOT ABOVE}", "\N{COMBINING DIAERESIS}": "\N{DIAERESIS}"}
"""Dots over letters: pandoc writes combining ones, which browsers draw beside their letter."""

_STRETCHED = r'<mo stretchy="true" form="{}fix">'
LOW_BRACKETS = re.compile(
    f"<mrow>{_STRETCHED.format('pre')}\\(</mo>"
    r'((?:(?!<mfrac|<mtable|<mo stretchy="true").)*?)'
    f"{_STRETCHED.format('post')}\\)</mo></mrow>"
)
"""Brackets around what is no higher than a letter: they need not stretch, and are set closer."""

STYLE = Path(__file__).with_name("page.css")
PREAMBLE = r"""
\usepackage{amsmath,amssymb,float,graphicx}
\usepackage[a4paper,margin=24mm]{geometry}
\usepackage[labelformat=empty,font=small]{caption}
\floatplacement{figure}{!htbp}
\renewcommand\topfraction{0.9}\renewcommand\bottomfraction{0.8}
\renewcommand\textfraction{0.08}\renewcommand\floatpagefraction{0.75}
\raggedbottom
\setkeys{Gin}{width=0.8\linewidth,height=0.36\textheight,keepaspectratio}
\setlength{\parindent}{0pt}\setlength{\parskip}{6pt}
\AtBeginDocument{\ifdefined\symbf\renewcommand\boldsymbol[1]{\symbf{#1}}\fi}
\newcommand\needroom[1]{\par\begingroup\dimen0=#1\relax\dimen2=\pagegoal\relax
  \advance\dimen2 by -\pagetotal\relax
  \ifdim\dimen0>\dimen2\relax\ifdim\dimen2>0pt\relax\newpage\fi\fi\endgroup}
\IfFileExists{placeins.sty}{\usepackage{placeins}}{\newcommand\FloatBarrier{}}
\let\headingofpart\subsection
\renewcommand\subsection{\FloatBarrier\needroom{12\baselineskip}\headingofpart}
\let\headingofstep\subsubsection
\renewcommand\subsubsection{\needroom{9\baselineskip}\headingofstep}
"""


def latex_engine() -> str | None:
    """Return the LaTeX engine that this machine has."""
    return next((engine for engine in ENGINES if shutil.which(engine)), None)


def page(document: Document, path: Path) -> None:
    """Write a document as one page of HTML; raise a RuntimeError if pandoc fails."""
    style = f"<style>\n{css_variables(when_dark='')}{STYLE.read_text('utf-8')}</style>\n"
    with TemporaryDirectory() as place:
        made = _pandoc(document, Reader.HTML, Path(place), style, "--to=html5", "--mathml")
        text = made.read_text("utf-8")

        def embedded(found: re.Match[str]) -> str:
            picture = base64.b64encode((made.parent / found[1]).read_bytes()).decode()
            return f'src="data:image/svg+xml;base64,{picture}"'

        whole = re.sub(r'src="([\w-]+\.svg)"', embedded, _for_browsers(text))
        path.write_text(whole, encoding="utf-8")


def _for_browsers(text: str) -> str:
    """Adapt MathML to what browsers make of it: dots, brackets, functions, commas."""
    for combining, spacing in ACCENTS.items():
        text = text.replace(f">{combining}</mo>", f">{spacing}</mo>")
    known = ""
    while known != text:  # from the inside out
        known, text = text, LOW_BRACKETS.sub(
            r'<mrow><mo stretchy="false">(</mo>\1<mo stretchy="false">)</mo></mrow>', text
        )  # fmt: skip
    function = r'<mo lspace=".17em" rspace="{}">\1</mo>'
    text = re.sub(r"<mo>(sin|cos)</mo>(?=<mrow><mo)", function.format("0"), text)
    text = re.sub(r"<mo>(sin|cos)</mo>", function.format(".17em"), text)
    return re.sub(r"</math>(?=[,.;:])", "</math>\N{WORD JOINER}", text)


def pdf(document: Document, engine: str, path: Path) -> None:
    """Write a document as a PDF; raise a RuntimeError if pandoc or the engine fails."""
    with TemporaryDirectory() as place:
        options = "--to=latex", f"--pdf-engine={engine}"
        shutil.copyfile(_pandoc(document, Reader.PDF, Path(place), PREAMBLE, *options), path)


def _pandoc(document: Document, reader: Reader, folder: Path, header: str, *options: str) -> Path:
    """Let pandoc write into a folder where the figures are; return the file."""
    for drawing in document.drawings:
        save(drawing, folder / drawing.file(reader))
    source, head = folder / "report.md", folder / "header"
    made = folder / f"report.{'html' if reader is Reader.HTML else 'pdf'}"
    source.write_text(document.markdown(reader), encoding="utf-8")
    head.write_text(header, encoding="utf-8")
    command = [
        "pandoc", "--standalone", "--from=markdown", "--columns=1000",
        f"--metadata=pagetitle:{document.title}", f"--metadata=title:{document.title}",
        "--metadata=lang:en", f"--include-in-header={head}", f"--output={made}", *options,
        str(source),
    ]  # fmt: skip
    surroundings = {**os.environ, "LC_ALL": "C.UTF-8"}
    done = subprocess.run(command, capture_output=True, text=True, cwd=folder, env=surroundings)
    if done.returncode:
        raise RuntimeError(f"pandoc: {done.stderr.strip() or 'failed without a word'}")
    return made
