"""What the documents say is what the project does."""

from __future__ import annotations

import itertools
import json
import re
import runpy
import sys
from pathlib import Path
from typing import Any

import matplotlib as mpl
import matplotlib.image
import mpmath
import numpy as np
import pendcore as pc
import pytest

ROOT = Path(__file__).parents[2]
DOCUMENTS = [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")]
COMPARISON = ROOT / "docs/records/comparison/textbook.json"

sys.path.append(str(ROOT / "bench/compare"))
import excerpts  # noqa: E402
from page_part import with_part  # noqa: E402


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_links_lead_somewhere(path):
    for target in re.findall(r"\]\(([^)#]+)[^)]*\)", path.read_text()):
        if not target.startswith("https://"):
            assert (path.parent / target).exists(), f"{path.name} links to {target}"


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_a_page_imports_what_its_lines_use(path):
    """The lines of a page can be pasted, from the top."""
    above = ""
    for code in re.findall(r"```python\n(.*?)```", path.read_text(), re.DOTALL):
        above += code
        for name, module in (("np", "numpy"), ("pc", "pendcore")):
            if re.search(rf"\b{name}\.", code):
                assert f"import {module} as {name}\n" in above


def blocks_of(document: str) -> list[str]:
    return re.findall(r"```python\n(.*?)```", (ROOT / document).read_text(), re.DOTALL)


def run_blocks(document: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """Run the lines of a page one after the other; return the names that they leave."""
    mpl.use("Agg")
    monkeypatch.chdir(folder)
    names: dict[str, Any] = {}
    for block in blocks_of(document):
        exec(block, names)
    return names


def test_the_readmes_lines_run(tmp_path, monkeypatch):
    names = run_blocks("README.md", tmp_path, monkeypatch)
    assert names["longer"].t[-1] == 10.0
    assert (tmp_path / "run.npz").exists()


def test_the_lines_of_the_first_steps_run(tmp_path, monkeypatch, capsys):
    mpl.use("Agg")
    monkeypatch.chdir(tmp_path)
    chains, rubbed, at_once = blocks_of("docs/tutorials/first_steps.md")
    names: dict[str, object] = {}
    exec(chains, names)
    assert names["run"].success
    ledger = names["run"].energy().ledger
    assert [*ledger] == ["viscous", "drag", "motor", "wind", "user", "residual"]
    assert abs(ledger.residual).max() < 1e-6
    assert "PD(kp=20.0" in capsys.readouterr().out
    assert rubbed == hard_case()
    names = {}
    exec(at_once, names)
    alone = pc.simulate(pc.Scene.textbook(), q0=names["starts"][3], t_span=(0, 5))
    assert np.array_equal(names["many"].q[3], alone.q[-1])


def test_the_lines_of_many_runs_at_once_run(tmp_path, monkeypatch, capsys):
    names = run_blocks("docs/tutorials/many_at_once.md", tmp_path, monkeypatch)
    told = capsys.readouterr().out
    assert "1.6 True" in told
    assert "q0[1] = nan: must be finite (rad)" in told
    assert names["turned"].success.all()


def test_the_lines_of_large_ensembles_run(tmp_path, monkeypatch, capsys):
    for name in ("zarr", "xarray"):
        pytest.importorskip(name, exc_type=ImportError)
    run_blocks("docs/how_to/large_ensembles.md", tmp_path, monkeypatch)
    told = capsys.readouterr().out
    for line in (
        "{'finished': 2000}",
        "(2000, 2, 4) finished",
        "('member_0', 'extreme', 'component') rad",
        "True",
        "57 GB for 1000000000 members",
    ):
        assert line in told


SAYS_WHAT_TO_INSTALL = [
    *DOCUMENTS,
    *(path for name in ("python", "examples") for path in (ROOT / name).rglob("*.py")),
]


def test_nobody_is_told_to_get_pendcore_from_an_index_where_it_is_not():
    for path in SAYS_WHAT_TO_INSTALL:
        asked = re.search(r"pip install \"?pendcore\b", path.read_text())
        assert not asked, f"{path}: {asked}"


def test_the_pendulums_of_the_film_part_when_the_caption_says():
    film = runpy.run_path(str(ROOT / "docs/generators/film.py"))
    runs = film["runs"]()
    readme = (ROOT / "README.md").read_text()
    assert "a ten-thousandth of a radian apart part for good after seven seconds" in readme
    assert film["APART"] == 1e-4

    def farthest(t):  # of two tips, m
        y = [run(t) for run in runs]
        tips = [[np.cos(x[:2]).sum(axis=0), np.sin(x[:2]).sum(axis=0)] for x in y]
        pairs = itertools.combinations(np.array(tips), 2)
        return np.max([np.hypot(*(one - other)) for one, other in pairs], axis=0)

    assert farthest(np.array([7.0])) < 0.05
    assert farthest(np.linspace(7.1, film["UNTIL"], 500)).min() > 0.2


def test_the_page_on_asked_errors_quotes_the_measured_work():
    page = " ".join((ROOT / "docs/how_to/ask_for_an_error.md").read_text().split())
    measured = (ROOT / "docs/background/accuracy_cost.md").read_text()
    (row,) = re.findall(r"^\| work of all that it took / best \| (.*?) \|  \|", measured, re.M)
    _, median, tenth, _, worst = map(float, row.split(" | "))
    assert (
        f"half took more than {median:.1f} times the work of the cheapest run that keeps the "
        f"error, one in ten more than {tenth:.0f} times, and the worst {worst:.0f} times" in page
    )


def test_the_page_by_hand_has_the_numbers_of_its_formulas(capsys):
    """The formulas are worked out in 25 digits without the core; it prints the last two."""
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
    (code,) = blocks_of("docs/tutorials/by_hand.md")
    exec(code, {})
    printed, commented = capsys.readouterr().out.strip(), code.strip().rpartition("# ")[2]
    assert printed == commented == f"[{told[-2]} {told[-1]}]"


def test_the_readmes_counts_are_those_of_the_records():
    readme = " ".join((ROOT / "README.md").read_text().split())
    hard = (ROOT / "docs/background/hard_cases.md").read_text()
    (told,) = re.findall(r"^Right, of (\d+) cases: (.*)\.$", hard, re.MULTILINE)
    right = dict(re.findall(r"(pendcore|SciPy|MuJoCo|Boost\.odeint) (\d+)", told[1]))
    assert f"Of [{told[0]} cases that break simulators]" in readme
    assert (
        f"pendcore gets {right['pendcore']} right, SciPy {right['SciPy']}, "
        f"MuJoCo {right['MuJoCo']} and Boost.odeint {right['Boost.odeint']}." in readme
    )
    families = json.loads((ROOT / "docs/records/true_error.json").read_text())["families"].values()
    assert f"In [{sum(one['scenes'] for one in families):,} random scenes]" in readme
    assert f"could not tell of {sum(one['no_reference'] for one in families)} runs" in readme
    assert sum(one["above"] for one in families) == 0


def hard_case() -> str:
    """Return the lines of the first steps that draw their hard case."""
    blocks = blocks_of("docs/tutorials/first_steps.md")
    return next(block for block in blocks if "stick_slip.png" in block)


def test_ten_lines_draw_the_hard_case_of_the_first_steps(tmp_path, monkeypatch):
    """The lines draw the picture on the page, and the grey in it is exact rest."""
    mpl.use("Agg")
    monkeypatch.chdir(tmp_path)
    lines = [line for line in hard_case().splitlines() if line.strip()]
    assert len(lines) <= 10
    assert lines[-1].endswith('.savefig("stick_slip.png")')
    names: dict[str, Any] = {}
    exec(hard_case(), names)
    drawn, kept = (
        matplotlib.image.imread(path)
        for path in (tmp_path / "stick_slip.png", ROOT / "docs/figures/stick_slip.png")
    )
    assert drawn.shape == kept.shape
    assert np.abs(drawn - kept).mean() < 0.01  # another font changes less than that
    # At first the motor of 10 sin t has to overcome 5 N m; later the second joint stops when
    # hybrid_chain.py says, and the first lets go when it no longer holds motor and weights.
    slow = names["slow"]
    resting = np.flatnonzero((slow.qd == 0).all(axis=1))
    first, later = (
        [i for i in resting if low <= slow.t[i] <= high] for low, high in ((0, 1), (5, 7))
    )
    assert first == [*range(first[-1] + 1)]
    assert later == [*range(later[0], later[-1] + 1)]
    assert slow.t[first[-1]] == pytest.approx(np.arcsin(0.5), abs=1e-12)
    assert slow.t[later[0]] == pytest.approx(5.5431723449428, abs=1e-10)
    q1, q2 = slow(5.8)[:2]
    held = 5.0 - 9.807 * (1.5 * np.cos(q1) + 0.5 * np.cos(q2))
    assert slow.t[later[-1]] == pytest.approx(2 * np.pi + np.arcsin(held / 10), abs=1e-10)
    assert (slow.q[first] == np.pi / 2).all()
    assert (slow.q[later] == (q1, q2)).all()
    assert (slow(np.linspace(5.55, 6.04, 50)) == slow(5.8)[:, None]).all()


def test_a_ledger_is_as_good_as_its_steps_and_trust_says_how_good(capsys):
    *_, code = blocks_of("docs/background/trust.md")
    exec(code, {})
    residuals = [float(line.split()[1]) for line in capsys.readouterr().out.splitlines()]
    (told,) = re.findall(r"# (.*)$", code, re.MULTILINE)
    for residual, order in zip(residuals, re.findall(r"([\de-]+) J", told), strict=True):
        assert float(order) / 2 < residual < 2 * float(order)


def test_events_are_what_their_page_says(capsys):
    (code,) = blocks_of("docs/how_to/events.md")
    names: dict[str, object] = {}
    exec(code, names)
    (told,) = re.findall(r"# (stopped at .*)$", code, re.MULTILINE)
    assert capsys.readouterr().out.startswith(told + "\n<Found: t = ")
    assert names["longer"].status == "event"


@pytest.mark.parametrize("document", excerpts.EXCERPTS)
def test_quoted_figures_are_those_of_the_record(document):
    name, excerpt = excerpts.EXCERPTS[document]
    text = (ROOT / document).read_text()
    assert with_part(text, name, excerpt(json.loads(COMPARISON.read_text()))) == text
