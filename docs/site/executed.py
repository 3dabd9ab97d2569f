"""Executes the Python of every page while the site is built.

The blocks of a page run from top to bottom in one namespace, in an empty folder. What a block
prints stands below it. If the page itself shows an output there, it must be the same but for spaces
and what "..." stands for. Figures that a block leaves open stand below it, too. A block that
raises an error is a warning of the build, which `make site` makes an error, and so is another
output; a page that shows an error on purpose prints it. A case file that the page shows stands in
the folder under its name. A page whose Python is parts of files says that it is not executed.
"""

from __future__ import annotations

import ast
import contextlib
import doctest
import io
import sys
import tempfile
import tomllib
import traceback
import warnings
from pathlib import Path
from typing import Any
from unittest.mock import patch

import matplotlib as mpl
import matplotlib.pyplot as plt
from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util import logging

logger = logging.getLogger(__name__)
NOT_EXECUTED = "not executed for the site"
RUN_ELSEWHERE = ("gallery/", "reference/python/")
"""Pages whose Python is run as a file by gallery_pages.py, or as doctests by the tests."""


def execute_page(app: Sphinx, doctree: nodes.document) -> None:
    page = app.env.docname
    blocks = [b for b in doctree.findall(nodes.literal_block) if b.get("language") == "python"]
    if not blocks or page.startswith(RUN_ELSEWHERE):
        return
    if NOT_EXECUTED in Path(app.env.doc2path(page)).read_text():
        return
    mpl.use("Agg")
    names: dict[str, Any] = {"__name__": "__main__"}
    if page.startswith("examples/"):
        names["__file__"] = str(app.srcdir.parent / f"{page}.py")
    with (
        tempfile.TemporaryDirectory() as folder,
        contextlib.chdir(folder),
        patch.object(sys, "path", [folder, *sys.path]),
        mpl.rc_context(),
    ):
        write_cases(doctree)
        for number, block in enumerate(blocks, start=1):
            where = f"{page}, block {number}"
            printed, value = run(block.astext(), names, where)
            html = shown(value, block.astext()) if page.startswith("notebooks/") else ""
            figures = [saved(app, plt.figure(k), page, number, k) for k in plt.get_fignums()]
            plt.close("all")
            add_below(block, printed, figures, where, html)


def write_cases(doctree: nodes.document) -> None:
    """Write the case files that a page shows, each under the name that it gives itself."""
    for block in doctree.findall(nodes.literal_block):
        if block.get("language") == "toml":
            with contextlib.suppress(tomllib.TOMLDecodeError, KeyError):
                name = tomllib.loads(block.astext())["name"]
                Path(f"{name}.toml").write_text(block.astext())


def run(text: str, names: dict[str, Any], where: str) -> tuple[str, Any]:
    """Run a block, and return what it printed, and the value of its last line if that is one."""
    printed, value = io.StringIO(), None
    try:
        body = ast.parse(text, where)
        last_line = None
        if body.body and isinstance(body.body[-1], ast.Expr):
            last_line = ast.Expression(body.body.pop().value)
        quiet = contextlib.redirect_stderr(io.StringIO())
        with contextlib.redirect_stdout(printed), quiet, warnings.catch_warnings():
            warnings.simplefilter("ignore")
            exec(compile(body, where, "exec"), names)
            if last_line:
                value = eval(compile(last_line, where, "eval"), names)
    except Exception:
        logger.warning("%s raised\n%s", where, traceback.format_exc(limit=-1))
    return printed.getvalue(), value


def shown(value: Any, text: str) -> str:
    """Return the HTML that a notebook shows of the value of a last line; none if ";" ends it."""
    is_silent = text.rstrip().endswith(";") or not hasattr(value, "_repr_html_")
    return "" if is_silent else str(value._repr_html_())


def saved(app: Sphinx, figure: Any, page: str, number: int, k: int) -> str:
    """Save a figure where Sphinx finds it, and return its path from the folder of all pages."""
    folder = Path(app.srcdir) / "executed"
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{page.replace('/', '_')}_{number}_{k}.png"
    figure.savefig(path, dpi=110)
    return "/" + str(path.relative_to(app.srcdir))


def is_shown(output: str, printed: str) -> bool:
    flags = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
    return doctest.OutputChecker().check_output(f"{output}\n", printed, flags)


def add_below(
    block: nodes.literal_block, printed: str, figures: list[str], where: str, html: str
) -> None:
    parent = block.parent
    at = parent.index(block) + 1
    follows = parent[at] if at < len(parent) else None
    shows_output = isinstance(follows, nodes.literal_block) and follows.get("language") in {
        "text", "none", "default",
    }  # fmt: skip
    if shows_output and not is_shown(follows.astext(), printed):
        logger.warning("%s prints\n%sand the page shows\n%s", where, printed, follows.astext())
    added: list[nodes.Node] = []
    if printed.strip() and not shows_output:
        added.append(nodes.literal_block(printed, printed, language="text", classes=["output"]))
    added += [nodes.image(uri=path, alt="the figure that these lines draw") for path in figures]
    if html:
        added.append(nodes.raw("", f"<div class='shown'>{html}</div>", format="html"))
    parent.insert(at, added)
