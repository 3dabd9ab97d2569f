"""The lines of pages and notebooks run, and print what stands beside or below them."""

from __future__ import annotations

import ast
import contextlib
import doctest
import functools
import io
import json
import re
import warnings
from pathlib import Path

import matplotlib.pyplot as plt
import pendcore as pc
import pytest

ROOT = Path(__file__).parents[2]
DOCUMENTS = [*ROOT.glob("*.md"), *sorted((ROOT / "docs").rglob("*.md"))]
BLOCK = re.compile(r"```python\n(.*?)```(?:\n\n```text\n(.*?)```)?", re.DOTALL)
RUN_ELSEWHERE = {
    *("accuracy_cost", "horizon", "long_runs", "see_it"),
    *("add_an_effect", "derive_engineer", "derive_student", "derive_teacher"),
    *(path.stem for path in (ROOT / "docs/effects").iterdir()),
}
"""Pages whose lines have tests of their own, or take long and run where the site is built."""
BLOCKS = {
    str(path.relative_to(ROOT)): blocks
    for path in DOCUMENTS
    if path.stem not in RUN_ELSEWHERE and (blocks := BLOCK.findall(path.read_text()))
}
NOTEBOOKS = sorted((ROOT / "examples/notebooks").glob("*.ipynb"))
FLAGS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE


@pytest.fixture(autouse=True)
def elsewhere(tmp_path, monkeypatch):
    """Work in an empty folder, where films have few small frames, and close all figures."""
    monkeypatch.chdir(tmp_path)
    few = functools.partialmethod(pc.Solution.to_video, fps=4, size=(160, 90))
    monkeypatch.setattr(pc.Solution, "to_video", few)
    yield
    plt.close("all")


def test_links_lead_somewhere():
    for path in DOCUMENTS:
        for target in re.findall(r"\]\(([^)#]+)[^)]*\)", path.read_text()):
            if not target.startswith("https://"):
                assert (path.parent / target).exists(), f"{path.name} links to {target}"


def printed(code, names):
    """Run lines, and return what they print; what a comment shows beside a line begins with it."""
    told = ""
    for statement in ast.parse(code).body:
        out = io.StringIO()
        with contextlib.redirect_stdout(out):
            exec(compile(ast.Module([statement], []), "the page", "exec"), names)
        told += out.getvalue()
        line = code.splitlines()[(statement.end_lineno or 0) - 1]
        shown = re.match(r"print\(.*\) +# (?=[\[({'\d-])(.*)", line)
        assert not shown or shown[1].startswith(out.getvalue().strip()), f"{line}\n{told}"
    return told


@pytest.mark.parametrize("page", BLOCKS)
def test_the_lines_of_a_page_run_and_print_what_it_shows(page):
    names = {}
    for code, shown in BLOCKS[page]:
        told = printed(code, names)
        assert not shown or doctest.OutputChecker().check_output(shown, told, FLAGS), told


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs_from_top_to_bottom(path):
    names = {}
    for cell in json.loads(path.read_text())["cells"]:
        if cell["cell_type"] == "code":
            assert cell["outputs"] == []
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                exec("".join(cell["source"]), names)
    run = names.get("run") or names["swing"]
    assert run.success
    if path.stem == "friction_and_stops":  # it sticks in the end, and hits its stops before
        assert run.status == "at_rest"
        assert run.energy().ledger.impact[-1] > 0
