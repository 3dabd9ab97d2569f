"""The files written from the descriptions of effects are up to date, and their code runs."""

from __future__ import annotations

import inspect
import re
import sys
from dataclasses import MISSING, fields
from pathlib import Path
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from pendcore._scene.effect_description import effects, parts

ROOT = Path(__file__).parents[2]
sys.path.append(str(ROOT / "docs/generators"))
import write_effects  # noqa: E402

KINDS = pc.effects.kinds()
HEAD = "[[link]]\nmass = 1\nlength = 1\n[[link]]\nmass = 1\nlength = 1\n"
TAIL = "[start]\nq = 0.5\n[run]\nt_end = 1.0\n"


def test_the_files_are_what_would_be_written_and_no_page_is_left_over():
    written, pages = write_effects.written(), ROOT / "docs/effects"
    for path, text in written.items():
        assert path.read_text() == text, f"{path}: run: python docs/generators/write_effects.py"
    assert {*pages.iterdir()} == {path for path in written if path.parent == pages}


def shown(kind: str, language: str) -> list[str]:
    page = (ROOT / f"docs/effects/{kind}.md").read_text()
    return re.findall(rf"```{language}\n(.*?)```", page, re.DOTALL)


def run(kind: str) -> dict[str, Any]:
    """Run what a page shows, from top to bottom, and return its names."""
    names: dict[str, Any] = {}
    for code in shown(kind, "python"):
        exec(code, names)
    return names


@pytest.mark.parametrize("kind", KINDS)
def test_the_examples_of_a_page_run_and_book_what_it_says(kind, capsys):
    names, cls = run(kind), KINDS[kind]
    booked = {*names["sol"].energy().ledger} - {"residual", "wind"}
    assert booked == {cls.description.account} - {"none"}
    assert "residual" in capsys.readouterr().out
    assert names["sol"].success
    if kind != "compiled_user":  # whose example needs the lines before it
        assert {type(example) for example in write_effects.examples(cls)} == {cls}
    tables = [table for code in shown(kind, "toml") for table in code.split("\n\n")]
    assert bool(tables) == ("user" not in kind)
    for table in tables:
        scene = pc.read_case(f"{HEAD}{table}\n{TAIL}").scene
        assert [effect.kind for effect in scene.effects] == [kind]


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


def test_the_classes_are_what_the_core_describes():
    described = {told.name: told for told in (*effects(), *parts())}
    classes = {cls.__name__: cls for cls in (*KINDS.values(), *pc.effects.parts().values())}
    assert [*KINDS] == [told.kind for told in effects()]
    assert (
        {*classes} == {*described} == {*pc.effects.__all__} - {"Effect", "Part", "kinds", "parts"}
    )
    for name, told in described.items():
        assert getattr(pc.effects, name) is classes[name]
        assert [(one.name, one.default) for one in fields(classes[name])] == [
            (one.name, MISSING if one.required else one.default) for one in told.parameters
        ]
        source = inspect.getsource(classes[name])
        assert f'"""{told.sentence}"""' in source
