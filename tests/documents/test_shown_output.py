"""What the lines of a page print is what the page shows below them, as in the site."""

from __future__ import annotations

import contextlib
import doctest
import io
import re
from pathlib import Path

import pendcore as pc
import pytest

ROOT = Path(__file__).parents[2]
BLOCK = re.compile(r"```python\n(.*?)```(?:\n\n```text\n(.*?)```)?", re.DOTALL)
ALL = {path: BLOCK.findall(path.read_text()) for path in sorted((ROOT / "docs").rglob("*.md"))}
PAGES = {
    str(path.relative_to(ROOT)): blocks
    for path, blocks in ALL.items()
    if any(shown for _, shown in blocks)
}
"""The pages that show an output, with the lines and the output of each block."""
FLAGS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE


@pytest.mark.every_value("page")
@pytest.mark.parametrize("page", PAGES)
def test_the_lines_of_a_page_print_what_stands_below_them(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    for code, shown in PAGES[page]:
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(code, names)
        if shown:
            told = printed.getvalue()
            assert doctest.OutputChecker().check_output(shown, told, FLAGS), f"{code}\n{told}"


def test_pages_that_show_outputs_are_found():
    assert {"docs/reference/conventions.md", "docs/how_to/dry_friction.md"} <= {*PAGES}


def test_what_ensembles_keep_has_the_names_of_the_page():
    page = (ROOT / "docs/tutorials/many_at_once.md").read_text()
    rows = re.findall(r"^\| `(pc\.reducers\..*?)` \| `found\[\"(.*?)\"\]` \|", page, re.MULTILINE)
    over = pc.events.LinkAngle(2, 0.0)
    kept = {name: eval(call, {"pc": pc, "event": over}) for call, name in rows}
    assert {type(one) for one in kept.values()} == {
        getattr(pc.reducers, name) for name in pc.reducers.__all__ if name != "Reducer"
    }
    for name, reducer in kept.items():
        found = pc.ensemble(pc.Scene.textbook(), q0=[[1.0, 1.0]], t_span=(0, 0.1), keep=reducer)
        assert found[name].shape[0] == 1
        with pytest.raises(ValueError, match=f"keep = '{name}': must be"):
            pc.ensemble(pc.Scene.textbook(), q0=[[1.0, 1.0]], t_span=(0, 0.1), keep=name)
