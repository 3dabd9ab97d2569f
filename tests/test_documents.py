"""What the documents say is what the project does."""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path

import matplotlib as mpl
import pytest

ROOT = Path(__file__).parent.parent
DOCUMENTS = [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")]
COMPARISON = ROOT / "docs/comparison/textbook.json"

sys.path.append(str(ROOT / "bench/compare"))
import excerpts  # noqa: E402


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_links_lead_somewhere(path):
    for target in re.findall(r"\]\(([^)#]+)[^)]*\)", path.read_text()):
        if not target.startswith("https://"):
            assert (path.parent / target).exists(), f"{path.name} links to {target}"


def test_the_readmes_dozen_lines_run(tmp_path, monkeypatch):
    mpl.use("Agg")
    monkeypatch.chdir(tmp_path)
    (code,) = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)
    names: dict[str, object] = {}
    exec(code, names)
    assert names["longer"].t[-1] == 10.0
    assert (tmp_path / "run.npz").exists()


@pytest.mark.parametrize("document", excerpts.EXCERPTS)
def test_quoted_figures_are_those_of_the_record(document):
    name, excerpt = excerpts.EXCERPTS[document]
    text = (ROOT / document).read_text()
    assert f"<!-- {name}: begin -->" in text
    assert excerpts.insert(text, name, excerpt(json.loads(COMPARISON.read_text()))) == text


def test_an_excerpt_takes_the_place_of_the_one_before():
    text = "a\n<!-- x: begin -->\nold\n<!-- x: end -->\nb\n"
    assert excerpts.insert(text, "x", "new\n") == text.replace("old", "new")
