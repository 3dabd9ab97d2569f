"""The lines of the pages on the derivation run, and say what stands behind them."""

from __future__ import annotations

import re
from pathlib import Path

import matplotlib as mpl
import matplotlib.image
import numpy as np
import pendcore as pc
import pytest
from symbolic_scenes import derivation

pytestmark = pytest.mark.unsanitized

ROOT = Path(__file__).parents[2]
DRAWN = ("mechanism", "free_bodies", "reactions")


def blocks(page: str) -> list[str]:
    text = (ROOT / "docs/tutorials" / page).read_text()
    return re.findall(r"```python\n(.*?)```", text, re.DOTALL)


def test_the_students_lines_run(capsys, tmp_path, monkeypatch):
    mpl.use("Agg")
    monkeypatch.chdir(tmp_path)
    read, check, numbers = blocks("derive_student.md")
    exec(read, {})
    assert "(2.1)" in capsys.readouterr().out.split("11. ")[-1]
    exec(check, {})
    (told,) = re.findall(r"# (-L1.*)$", check, re.MULTILINE)
    assert capsys.readouterr().out == told + "\n"
    exec(numbers, {})
    said = capsys.readouterr().out
    for start in re.findall(r"(-?\d+\.\d+)\.\.\.", numbers):
        assert start in said


def test_the_teachers_lines_run(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PATH", "")  # then only Markdown is written
    sheets, marking = blocks("derive_teacher.md")
    exec(sheets, {})
    for name in ("ada", "emmy"):
        assert (tmp_path / "sheets" / name / "report.md").exists()
        assert (tmp_path / "sheets" / name / "worksheet.md").exists()
    ada, emmy = (
        (tmp_path / "sheets" / name / "worksheet.md").read_text() for name in ("ada", "emmy")
    )
    assert ada != emmy.replace("for emmy", "for ada")
    exec(marking, {})
    assert capsys.readouterr().out == "qdd1 10.8110 rad/s^2\nqdd2 -8.3087 rad/s^2\n"


def test_the_figures_of_the_pages_are_those_of_the_report(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", "")
    case = pc.Case.textbook()
    derivation(case.scene).report(case, tmp_path)
    for name in DRAWN:
        drawn, kept = (
            matplotlib.image.imread(path)
            for path in (tmp_path / f"{name}.png", ROOT / f"docs/figures/derive_{name}.png")
        )
        assert drawn.shape == kept.shape
        assert np.abs(drawn - kept).mean() < 0.01  # another font changes less than that
