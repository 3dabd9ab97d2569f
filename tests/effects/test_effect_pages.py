"""The files written from the descriptions of effects are up to date, and their code runs."""

from __future__ import annotations

import ast
import re
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pendcore as pc
import pytest

ROOT = Path(__file__).parents[2]
sys.path.append(str(ROOT / "docs/generators"))
import effect_pages  # noqa: E402
import effect_stub  # noqa: E402
import write_effects  # noqa: E402

WRITTEN = write_effects.written()
PAGES = {kind: ROOT / f"docs/effects/{kind}.md" for kind in pc.effects.kinds()}
HEAD = "[[link]]\nmass = 1\nlength = 1\n[[link]]\nmass = 1\nlength = 1\n"
TAIL = "[start]\nq = 0.5\n[run]\nt_end = 1.0\n"


@pytest.mark.parametrize("path", WRITTEN, ids=lambda path: str(path.relative_to(ROOT)))
def test_a_file_is_what_would_be_written(path):
    assert path.read_text() == WRITTEN[path], "run: python docs/generators/write_effects.py"


def test_every_effect_has_a_page_and_nothing_else_has():
    there = {path.name for path in (ROOT / "docs/effects").iterdir()}
    assert there == {path.name for path in PAGES.values()} | {"README.md"}


def run(kind: str) -> dict[str, Any]:
    """Run what a page shows, from top to bottom, and return its names."""
    names: dict[str, Any] = {}
    for code in re.findall(r"```python\n(.*?)```", PAGES[kind].read_text(), re.DOTALL):
        exec(code, names)
    return names


@pytest.mark.parametrize("kind", PAGES)
def test_the_example_of_a_page_runs_and_books_what_it_says(kind, capsys):
    names = run(kind)
    account = pc.effects.kinds()[kind].description.account
    booked = {*names["sol"].energy().ledger} - {"residual", "wind"}
    assert booked == {account} - {"none"}
    assert "residual" in capsys.readouterr().out
    assert names["sol"].success


def test_a_spring_towed_by_a_function_is_the_spring_while_its_end_is_held():
    names = run("torsional_spring")
    (towed,), q, qd = names["towed"].effects, np.array([0.5, 1.3]), np.zeros(2)
    free = pc.Scene(links=names["scene"].links)
    spring = pc.effects.TorsionalSpring(joint=2, stiffness=30.0, rest_angle=0.2 * 3.0)
    without, held = (
        scene.accelerations(3.0, q, qd) for scene in (free, free.replace(effects=[spring]))
    )
    forces = free.mass_matrix(q) @ (held - without)
    assert towed.function(3.0, q, qd) == pytest.approx(forces, rel=1e-12)


def test_impacts_are_counted_as_their_page_says():
    names = run("joint_stop")
    sol, k = names["sol"], names["k"]
    phi, rates = (np.diff(x, axis=1)[:, 0] for x in (sol.q, sol.qd))
    assert len(k) >= 3
    assert np.minimum(abs(phi[k] + 0.5), abs(phi[k] - 0.8)).max() < 1e-15
    assert rates[k + 1] == pytest.approx(-0.4 * rates[k], rel=1e-12)


@pytest.mark.parametrize("kind", PAGES)
def test_the_tables_of_a_page_are_read(kind):
    found = re.findall(r"```toml\n(.*?)```", PAGES[kind].read_text(), re.DOTALL)
    if "user" in kind:
        assert found == []
        return
    for table in found[0].split("\n\n"):
        scene = pc.read_case(f"{HEAD}{table}\n{TAIL}").scene
        assert [effect.kind for effect in scene.effects] == [kind]


@pytest.mark.parametrize("kind", PAGES)
def test_a_page_has_law_source_and_every_parameter(kind):
    told, page = pc.effects.kinds()[kind].description, PAGES[kind].read_text()
    assert f"\n    {told.law}\n" in page
    assert told.source in page
    for parameter in told.parameters:
        assert f"| `{parameter.name}` |" in page
        assert parameter.sentence in page


def test_every_kind_has_an_example():
    for kind, cls in pc.effects.kinds().items():
        assert cls.description.calls, kind
        if kind != "compiled_user":  # whose example needs the lines before it
            assert {type(shown) for shown in effect_pages.examples(cls)} == {cls}


def test_the_stub_has_the_names_of_the_module():
    declared = {
        node.name
        for node in ast.parse(effect_stub.stub()).body
        if isinstance(node, ast.ClassDef | ast.FunctionDef)
    }
    assert declared | {"Effect", "Part"} == set(pc.effects.__all__)
