"""The lines of pages and notebooks run, and print what stands beside or below them."""

from __future__ import annotations

import ast
import contextlib
import doctest
import functools
import io
import itertools
import json
import re
import warnings
from pathlib import Path

import matplotlib.image
import matplotlib.pyplot as plt
import mpmath
import numpy as np
import pendcore as pc
import pytest

ROOT = Path(__file__).parents[2]
DOCUMENTS = [*ROOT.glob("*.md"), *sorted((ROOT / "docs").rglob("*.md"))]
BLOCK = re.compile(r"```python\n(.*?)```(?:\n\n```text\n(.*?)```)?", re.DOTALL)
RUN_ELSEWHERE = {
    *("accuracy_cost", "horizon", "long_runs", "see_it"),
    *("add_an_effect", "derive_engineer", "derive_student", "derive_teacher"),
}
"""Pages whose lines have tests of their own, or take long and run where the site is built.

Those of docs/effects have their own too; README.md there must not be taken for the one above.
"""
BLOCKS = {
    str(path.relative_to(ROOT)): blocks
    for path in DOCUMENTS
    if path.stem not in RUN_ELSEWHERE and path.parent.name != "effects"
    if (blocks := BLOCK.findall(path.read_text()))
}
NOTEBOOKS = sorted((ROOT / "examples/notebooks").glob("*.ipynb"))
FLAGS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE


@pytest.fixture(autouse=True)
def style_of_a_page():
    """A page may set matplotlib's style, for itself alone."""
    with matplotlib.rc_context():
        yield


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
        shown = re.match(r"(?:print\(.*)?\) +# (?=[\[({'\d-]|True|stopped)(.*)", line)
        assert not shown or shown[1].startswith(out.getvalue().strip()), f"{line}\n{told}"
    return told


@pytest.mark.parametrize("page", BLOCKS)
def test_the_lines_of_a_page_run_and_print_what_it_shows(page):
    names = {}
    for code, shown in BLOCKS[page]:
        told = printed(code, names)
        assert not shown or doctest.OutputChecker().check_output(shown, told, FLAGS), told


def blocks_of(page):
    return [code for code, _ in BLOCKS[page]]


def test_a_ledger_is_as_good_as_its_steps_and_trust_says_how_good(capsys):
    code = blocks_of("docs/background/trust.md")[-1]
    exec(code, {})
    residuals = [float(line.split()[1]) for line in capsys.readouterr().out.splitlines()]
    (told,) = re.findall(r"# (.*)$", code, re.MULTILINE)
    for residual, order in zip(residuals, re.findall(r"([\de-]+) J", told), strict=True):
        assert float(order) / 2 < residual < 2 * float(order)


def test_the_page_by_hand_has_the_numbers_of_its_formulas():
    """In 25 digits, without the core; what the core prints is the last two."""
    page = (ROOT / "docs/tutorials/by_hand.md").read_text()
    told = re.findall(r"\| (-?[\d.]+) \|$", page, re.MULTILINE)
    with mpmath.workdps(25):
        q1, q2 = mpmath.radians(45), mpmath.radians(60)
        c = mpmath.cos(q1 - q2)
        m1, m2 = (x * mpmath.mpf("9.807") / 2 for x in (3 * mpmath.cos(q1), mpmath.cos(q2)))
        d = mpmath.mpf(4) / 9 - c * c / 4
        found = [c, m1, m2, d, (m1 / 3 - c * m2 / 2) / d, (4 * m2 / 3 - c * m1 / 2) / d]
    for value, digits in zip(found, told, strict=True):
        decimals = len(digits.partition(".")[2])
        assert abs(value - mpmath.mpf(digits)) <= mpmath.mpf(10) ** -decimals / 2
    assert page.rstrip("`\n").endswith(f"# [{told[-2]} {told[-1]}]")


def test_the_hard_case_of_the_first_steps_draws_its_figure_and_grey_is_exact_rest():
    code, names = blocks_of("docs/tutorials/first_steps.md")[1], {}
    exec(code, names)
    drawn, kept = map(
        matplotlib.image.imread, ("stick_slip.png", ROOT / "docs/figures/stick_slip.png")
    )
    assert drawn.shape == kept.shape
    assert np.abs(drawn - kept).mean() < 0.01  # another font changes less than that
    # At first the motor of 10 sin t has to overcome 5 N m; later the second joint stops when
    # hybrid_chain.py says, and the first lets go when it no longer holds motor and weights.
    slow = names["slow"]
    resting = np.flatnonzero((slow.qd == 0).all(axis=1))
    first, later = (resting[np.abs(slow.t[resting] - t) < 1] for t in (0, 6))
    assert (np.diff(first) == 1).all()
    assert (np.diff(later) == 1).all()
    q1, q2 = slow(5.8)[:2]
    held = 5.0 - 9.807 * (1.5 * np.cos(q1) + 0.5 * np.cos(q2))
    ends = [0.0, np.arcsin(0.5), 5.5431723449428, 2 * np.pi + np.arcsin(held / 10)]
    assert slow.t[[*first[[0, -1]], *later[[0, -1]]]] == pytest.approx(ends, abs=1e-10)
    assert (slow.q[first] == np.pi / 2).all()
    assert (slow(np.linspace(5.55, 6.04, 50)) == slow(5.8)[:, None]).all()


def test_the_three_pendulums_of_the_gallery_part_when_it_says():
    text = (ROOT / "examples/gallery/three_starts.py").read_text()
    assert "For seven seconds they are one" in " ".join(text.split())
    names = {}
    exec(text.partition("sol.to_video")[0], names)
    t = np.linspace(7.0, 12.0, 500)
    tips = [np.exp(1j * run(t)[:2]).sum(axis=0) for run in (names["sol"], *names["others"])]
    apart = np.max([abs(one - other) for one, other in itertools.combinations(tips, 2)], axis=0)
    assert apart[0] < 0.05
    assert apart[t >= 7.1].min() > 0.2


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
