"""The project keeps its house rules, and those that read the code find a breach."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import house_rules as rules
import pendcore
import pytest

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("rule", rules.RULES, ids=lambda rule: rule.__name__)
def test_the_project_keeps_every_house_rule(rule):
    breaches = "\n".join(rule(ROOT))
    assert not breaches, breaches


CORE = "cpp/src"
DOOR = "cpp/include/pendcore"
API = "python/pendcore/_api/ensemble.py"
CASES = "python/pendcore/_cases/archive.py"
LAWS = "python/pendcore/derive/laws.py"
SCENE = '#include "pendcore/scene.hpp"'
WORKFLOW = ".github/workflows/a.yml"
WIDE = "x = " + 85 * "1"
CELLS = json.dumps({"cells": [{"cell_type": "code", "source": ["x = 1\n", WIDE]}]})
# A rule, a file that breaks it and what the file says, and what the rule then says.
BREACHES = [
    (rules.includes_follow_the_flow, f"{CORE}/integrate/a.hpp", SCENE, "(integrate) includes"),
    (
        rules.includes_follow_the_flow,
        f"{CORE}/simulate/a.cpp",
        '#include "a.h"',
        "not by its place",
    ),
    (rules.includes_follow_the_flow, f"{DOOR}/attic.hpp", "", "stands in no folder of the flow"),
    (rules.the_door_is_small, f"{DOOR}/scene.hpp", '#include "scene/a.hpp"', "which is not public"),
    (rules.imports_go_down, CASES, "from pendcore import _api", "(_cases) imports pendcore._api"),
    (rules.imports_go_down, CASES, "from .._run import call", "has a relative import"),
    (rules.imports_go_down, "python/pendcore/__init__.py", "import pendcore.cli", "which is above"),
    (rules.imports_go_down, API, "def f():\n    import pendcore._run", "in a function"),
    (rules.imports_go_down, API, "if TYPE_CHECKING:\n    import pendcore._run", "types alone"),
    (rules.extras_stand_on_public_names, LAWS, "import pendcore._run", "which is private"),
    (rules.imports_form_no_circle, LAWS, "import pendcore.derive.laws", "a circle of imports"),
    (rules.shown_code_is_narrow, "README.md", f"```python\n{WIDE}\n```\n", "88 columns: x = 1"),
    (rules.shown_code_is_narrow, "docs/a/b.md", f"* a list\n\n  ```\n  {WIDE}\n  ```\n", "b.md"),
    (rules.shown_code_is_narrow, "examples/cases/a.toml", WIDE, "a.toml shows more"),
    (rules.shown_code_is_narrow, "examples/notebooks/a.ipynb", CELLS, "a.ipynb shows more"),
    (rules.kernels_call_no_libm, f"{CORE}/dynamics/a.hpp", "auto s = std::sin(q);", "std::sin"),
    (rules.kernels_call_no_libm, f"{CORE}/integrate/a.hpp", "-__builtin_expf (y)", "expf"),
    (rules.matrices_own_memory_of_malloc, f"{CORE}/a.cpp", "Eigen::MatrixXd M;", "MatrixXd"),
    (rules.builds_use_no_flag_that_changes_bits, "CMakePresets.json", '"-Ofast"', "-Ofast"),
    (rules.workflows_are_pinned, WORKFLOW, "- uses: a/b@v4", "not a commit and its version"),
    (rules.workflows_are_pinned, WORKFLOW, "permissions: write-all", "to read alone"),
]


@pytest.mark.parametrize(("rule", "path", "text", "words"), BREACHES)
def test_a_breach_is_found(rule, path, text, words, tmp_path):
    (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
    (tmp_path / path).write_text(text)
    assert [found for found in rule(tmp_path) if words in found]


def test_the_built_core_has_the_version_of_the_project():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert pendcore.__version__ == project["version"]
