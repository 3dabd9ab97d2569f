"""Every notebook runs from top to bottom, and holds no outputs of another time."""

from __future__ import annotations

import json
import warnings
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import pytest

FOLDER = Path(__file__).parents[2] / "examples/notebooks"
PAGES = Path(__file__).parents[2] / "docs/site/notebook_pages.py"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))


@pytest.fixture(autouse=True)
def no_figure_left_over() -> Any:
    yield
    plt.close("all")


def test_there_are_notebooks() -> None:
    assert len(NOTEBOOKS) == 3
    for path in NOTEBOOKS:  # each has a page
        assert f'"{path.stem}"' in PAGES.read_text()


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs_from_top_to_bottom(path: Path) -> None:
    notebook = json.loads(path.read_text())
    assert (notebook["nbformat"], notebook["nbformat_minor"]) == (4, 5)
    cells = notebook["cells"]
    assert cells[0]["cell_type"] == "markdown"
    assert len({cell["id"] for cell in cells}) == len(cells)
    names: dict[str, Any] = {}
    for cell in cells:
        if cell["cell_type"] != "code":
            continue
        assert cell["outputs"] == []
        assert cell["execution_count"] is None
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            exec("".join(cell["source"]), names)
    run = names.get("run") or names["swing"]
    assert run.success


def test_the_rig_sticks_and_hits_its_stops() -> None:
    """The words of that notebook are true of its run."""
    cells = json.loads((FOLDER / "friction_and_stops.ipynb").read_text())["cells"]
    names: dict[str, Any] = {}
    for cell in cells[:6]:
        if cell["cell_type"] == "code":
            exec("".join(cell["source"]), names)
    assert names["run"].status == "at_rest"
    assert names["run"].energy().ledger.impact[-1] > 0
