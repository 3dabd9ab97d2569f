"""The project keeps its house rules, and each rule finds a breach of its own."""

from __future__ import annotations

import tomllib
from pathlib import Path

import house_rules as rules
import pendcore
import pytest
from house_rules import Rule

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("rule", rules.RULES, ids=lambda rule: rule.__name__)
def test_the_project_keeps_every_house_rule(rule: Rule) -> None:
    breaches = "\n".join(rule(ROOT))
    assert not breaches, breaches


CORE = "cpp/src"
DOOR = "cpp/include/pendcore"
PACKAGE = "python/pendcore"
OF = "Of"
SCENE = '#include "pendcore/scene.hpp"'
# A rule, the files that break it, and what it then says.
BREACHES: list[tuple[Rule, dict[str, str], str]] = [
    (rules.includes_follow_the_flow, {f"{CORE}/integrate/loop/step.hpp": SCENE}, "(integrate) i"),
    (
        rules.includes_follow_the_flow,
        {f"{CORE}/simulate/a.cpp": '#include "../bindings/arrays.hpp"'},
        "not by its place",
    ),
    (rules.includes_follow_the_flow, {f"{DOOR}/attic.hpp": ""}, "stands in no folder of the flow"),
    (
        rules.the_door_is_small,
        {f"{DOOR}/scene.hpp": '#include "scene/singular.hpp"'},
        "which is not public",
    ),
    (
        rules.the_door_is_small,
        {f"{DOOR}/{number}.hpp": "" for number in range(rules.MOST_PUBLIC_HEADERS + 1)},
        "31 public headers",
    ),
    (
        rules.sources_stand_where_their_headers_do,
        {f"{CORE}/dynamics/chain/chain.hpp": "", f"{CORE}/dynamics/energetics/chain.cpp": ""},
        "stands in another folder than chain.hpp",
    ),
    (
        rules.imports_go_down,
        {f"{PACKAGE}/_cases/archive.py": "from pendcore import _api"},
        "(_cases) imports pendcore._api",
    ),
    (
        rules.imports_go_down,
        {f"{PACKAGE}/_api/ensemble.py": "def told():\n    from pendcore._cases.case import Case"},
        "imports pendcore._cases.case.Case in a function",
    ),
    (
        rules.imports_go_down,
        {f"{PACKAGE}/_cases/npz.py": "if TYPE_CHECKING:\n    from pendcore._run import solution"},
        "for types alone",
    ),
    (
        rules.imports_go_down,
        {f"{PACKAGE}/_cases/archive.py": "from .._run import call"},
        "has a relative import",
    ),
    (
        rules.imports_go_down,
        {f"{PACKAGE}/__init__.py": "from pendcore.cli import main"},
        "(pendcore) imports",
    ),
    (
        rules.extras_stand_on_public_names,
        {f"{PACKAGE}/cost/sweep.py": "from pendcore._run.call import run"},
        "imports pendcore._run.call.run, which is private",
    ),
    (
        rules.extras_stand_on_public_names,
        {
            f"{PACKAGE}/_run/solution.py": "class A:\n    def f(self):\n        return self._run",
            f"{PACKAGE}/plotting/stage.py": "def f(solution):\n    return solution._run",
        },
        "uses solution._run, which is private",
    ),
    (
        rules.imports_form_no_circle,
        {
            f"{PACKAGE}/derive/algebra.py": "from pendcore.derive import laws",
            f"{PACKAGE}/derive/laws/__init__.py": "import pendcore.derive.algebra",
        },
        "a circle of imports",
    ),
    (rules.names_say_what_a_file_holds, {f"{CORE}/string_utils.cpp": ""}, "'utils'"),
    (rules.files_are_short, {"tests/test_long.py": "pass\n" * 401}, "401 lines"),
    (rules.files_are_short, {"tests/test_wide.py": "x" * 101}, "101 columns"),
    (
        rules.comments_have_a_subject,
        {f"{CORE}/scene/scene.cpp": f"double mass;  ///< {OF} the links, kg"},
        ':1 begins with "Of"',
    ),
    (
        rules.comments_have_a_subject,
        {"tests/test_all.py": f'def f():\n    """{OF} no use."""'},
        ':2 begins with "Of"',
    ),
    (rules.kernels_call_no_libm, {f"{CORE}/dynamics/a.hpp": "auto s = std::sin(q);"}, "std::sin"),
    (rules.kernels_call_no_libm, {f"{CORE}/integrate/a.hpp": "x = -__builtin_expf (y);"}, "expf"),
    (
        rules.matrices_own_memory_of_malloc,
        {f"{CORE}/simulate/modes.cpp": "Eigen::MatrixXd M(n, n);"},
        "has a Eigen::MatrixXd",
    ),
    (
        rules.builds_use_no_flag_that_changes_bits,
        {"CMakePresets.json": '"CMAKE_CXX_FLAGS": "-Ofast"'},
        "-Ofast",
    ),
    (
        rules.builds_use_no_flag_that_changes_bits,
        {"cpp/cmake/speed.cmake": "set(fast -O3 -ffast-math)"},
        "-ffast-math",
    ),
    (
        rules.version_is_the_same_everywhere,
        {
            "pyproject.toml": '[project]\nversion = "0.1.0"\n',
            "CITATION.cff": "version: 9.9.9\n",
        },
        "CITATION.cff has version 9.9.9, pyproject.toml 0.1.0",
    ),
    (
        rules.workflows_are_pinned,
        {".github/workflows/a.yml": "- uses: actions/checkout@v4"},
        "uses actions/checkout@v4, not",
    ),
    (
        rules.workflows_are_pinned,
        {".github/workflows/a.yml": "permissions: write-all"},
        "the permission to read alone",
    ),
]


def write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)


@pytest.mark.parametrize(
    ("rule", "files", "sentence"), BREACHES, ids=lambda value: getattr(value, "__name__", "")
)
def test_a_breach_is_found(
    rule: Rule, files: dict[str, str], sentence: str, tmp_path: Path
) -> None:
    for path, text in files.items():
        write(tmp_path / path, text)
    assert [found for found in rule(tmp_path) if sentence in found]


def test_every_rule_has_a_breach() -> None:
    assert {rule for rule, *_ in BREACHES} == {*rules.RULES}


def test_the_built_core_has_the_version_of_the_project() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert pendcore.__version__ == project["version"]


ANYWHERE = [rule for rule in rules.RULES if rule is not rules.version_is_the_same_everywhere]


def test_what_the_rules_allow_is_no_breach(tmp_path: Path) -> None:
    write(
        tmp_path / CORE / "dynamics/chain/chain.hpp",
        '#include "arithmetic/sine_cosine.hpp"\n#include "pendcore/scene.hpp"\n'
        "// std::sin(q) differs from machine to machine\n"
        "x = std::sqrt(sine_cosine(q).sine);",
    )
    write(
        tmp_path / "cpp/bindings/module.cpp",
        '#include "arrays.hpp"\n#include "pendcore/solution.hpp"\n#include <pybind11/numpy.h>',
    )
    package = tmp_path / PACKAGE
    write(package / "__main__.py", "from pendcore.cli import main")
    write(package / "cli/derive.py", "import pendcore\nfrom pendcore import build")
    write(
        package / "_cases/archive.py",
        "from pendcore._run.solution import Solution\nif TYPE_CHECKING:\n    import matplotlib\n"
        "def plot():\n    import matplotlib",
    )
    write(package / "_run/result.py", "from pendcore import _scene\nfrom pendcore._run import call")
    write(package / "_run/call.py", "from pendcore._scene.link import Link")
    assert [found for rule in ANYWHERE for found in rule(tmp_path)] == []
