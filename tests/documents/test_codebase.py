"""The project keeps its house rules, and each rule finds a breach of its own."""

from __future__ import annotations

import subprocess
import sys
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
BREACHES = {
    rules.includes_follow_the_flow: [
        (f"{CORE}/integrate/loop/step.hpp", SCENE, "(integrate) includes pendcore/scene"),
        (f"{CORE}/integrate/step.hpp", "#include <dynamics/a.hpp>", "(integrate) includes"),
        (f"{CORE}/dynamics/a.hpp", '#include "integrate/a.hpp"', "(dynamics) includes"),
        (f"{CORE}/arithmetic/pack.hpp", SCENE, "(arithmetic) includes"),
        (f"{DOOR}/scene.hpp", '#include "pendcore/equations.hpp"', "(scene) includes"),
        (f"{CORE}/attic/a.hpp", SCENE, "stands in no folder of the flow"),
        (f"{DOOR}/attic.hpp", "", "stands in no folder of the flow"),
        (f"{CORE}/simulate/a.hpp", '#include "pendcore/pendcore.hpp"', "not by its place"),
        ("cpp/src/scene/a.cpp", '#include "pendcore/solution.hpp"', "(scene) includes"),
        ("cpp/src/simulate/a.cpp", '#include "../bindings/arrays.hpp"', "not by its place"),
    ],
    rules.the_door_is_small: [
        (f"{DOOR}/scene.hpp", '#include "scene/singular.hpp"', "which is not public"),
        (f"{DOOR}/scene.hpp", '#include "pendcore/link.hpp"', "which is not public"),
    ],
    rules.sources_stand_where_their_headers_do: [],  # two files make the breach: see below
    rules.imports_go_down: [
        (f"{PACKAGE}/_scene/scene.py", "from pendcore._run.solution import Solution", "above it"),
        (f"{PACKAGE}/_run/result.py", "import pendcore._views.table", "above it"),
        (
            f"{PACKAGE}/_views/table.py",
            "from pendcore import _api",
            "(_views) imports pendcore._api",
        ),
        (f"{PACKAGE}/_cases/case.py", "from pendcore import simulate", "above it"),
        (f"{PACKAGE}/__init__.py", "from pendcore.cli import main", "(pendcore) imports"),
        (
            f"{PACKAGE}/_api/ensemble.py",
            "def told():\n    from pendcore._views.table import text",
            "imports pendcore._views.table.text in a function",
        ),
        (
            f"{PACKAGE}/_views/table.py",
            "if TYPE_CHECKING:\n    from pendcore._run.solution import Solution",
            "for types alone",
        ),
        (
            f"{PACKAGE}/_views/table.py",
            "class A:\n    if typing.TYPE_CHECKING:\n        import pendcore._scene.link",
            "for types alone",
        ),
        (f"{PACKAGE}/_views/table.py", "from .._run import call", "has a relative import"),
        (f"{PACKAGE}/cli/run.py", "x = import_module('pendcore.derive')", "by its name"),
        (f"{PACKAGE}/attic/link.py", "", "attic/link.py is in no layer"),
    ],
    rules.imports_form_no_circle: [
        (f"{PACKAGE}/_run/solution.py", "import pendcore._run.solution", "a circle of imports"),
    ],
    rules.names_say_what_a_file_holds: [
        ("cpp/src/string_utils.cpp", "", "'utils'"),
        ("tests/helpers/angles.py", "", "'helpers'"),
    ],
    rules.files_are_short: [
        ("tests/test_long.py", "pass\n" * 401, "401 lines"),
        ("tests/test_all_long.py", "pass\n" * 301, "one file in twenty"),
        ("tests/test_half_long.py", "pass\n" * 121, "half of the files"),
        ("tests/test_wide.py", "x" * 101, "101 columns"),
    ],
    rules.comments_have_a_subject: [
        (f"{CORE}/dynamics/chain.hpp", f"/// {OF} each link: its inertia.", ':1 begins with "Of"'),
        (
            "cpp/src/scene/scene.cpp",
            f"double mass;  ///< {OF} the links, kg",
            ':1 begins with "Of"',
        ),
        ("tests/test_all.py", f'def f():\n    """{OF} no use."""', ':2 begins with "Of"'),
        ("python/pendcore/scene.py", f"x = 1\n# {OF} no use", ':2 begins with "Of"'),
    ],
    rules.kernels_call_no_libm: [
        (f"{CORE}/dynamics/chain.hpp", "auto s = std::sin(q);", "std::sin"),
        (f"{CORE}/arithmetic/power.hpp", "return pow(x, y);", "pow"),
        (f"{CORE}/integrate/control.hpp", "x = -__builtin_expf (y);", "__builtin_expf"),
        ("cpp/src/simulate/simulate.cpp", "sincos(q, &s, &c);", "sincos"),
    ],
    rules.workflows_are_pinned: [
        (".github/workflows/a.yml", "- uses: actions/checkout@v4", "uses actions/checkout@v4, not"),
        (".github/workflows/a.yml", f"- uses: a/b@{40 * 'c'}", "not a commit and its version"),
        (".github/workflows/a.yml", "permissions: write-all", "the permission to read alone"),
    ],
    rules.matrices_own_memory_of_malloc: [
        (f"{CORE}/simulate/modes.cpp", "Eigen::MatrixXd M(n, n);", "has a Eigen::MatrixXd"),
        (f"{DOOR}/scene.hpp", "Eigen::VectorXcd values;", "has a Eigen::VectorXcd"),
    ],
    rules.builds_use_no_flag_that_changes_bits: [
        ("CMakeLists.txt", "add_compile_options(-march=native)", "-march=native"),
        ("cpp/cmake/speed.cmake", "set(fast -O3 -ffast-math)", "-ffast-math"),
        ("CMakePresets.json", '"CMAKE_CXX_FLAGS": "-Ofast"', "-Ofast"),
    ],
}
CASES = [(rule, *breach) for rule, breaches in BREACHES.items() for breach in breaches]


def write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)


@pytest.mark.parametrize(("rule", "path", "text", "sentence"), CASES)
def test_a_breach_is_found(rule: Rule, path: str, text: str, sentence: str, tmp_path: Path) -> None:
    write(tmp_path / path, text)
    assert [found for found in rule(tmp_path) if sentence in found]


def test_a_door_with_too_many_headers_is_found(tmp_path: Path) -> None:
    for number in range(rules.MOST_PUBLIC_HEADERS + 1):
        write(tmp_path / DOOR / f"{number}.hpp", "")
    (found,) = rules.the_door_is_small(tmp_path)
    assert "31 public headers" in found


def test_a_source_in_another_folder_than_its_header_is_found(tmp_path: Path) -> None:
    write(tmp_path / CORE / "dynamics/chain/chain.hpp", "")
    write(tmp_path / CORE / "dynamics/energetics/energy.hpp", "")
    write(tmp_path / "cpp/src/dynamics/energetics/chain.cpp", "")
    (found,) = rules.sources_stand_where_their_headers_do(tmp_path)
    assert "stands in another folder than chain.hpp" in found


def test_a_circle_of_imports_is_found(tmp_path: Path) -> None:
    package = tmp_path / PACKAGE
    write(package / "derive/__init__.py", "from pendcore.derive.algebra import Algebra")
    write(package / "derive/algebra.py", "from pendcore.derive import laws")
    write(package / "derive/laws/__init__.py", "import pendcore.derive.algebra")
    (found,) = rules.imports_form_no_circle(tmp_path)
    assert "pendcore.derive.algebra" in found
    assert "pendcore.derive.laws" in found


def test_a_second_version_is_found(tmp_path: Path) -> None:
    write(tmp_path / "pyproject.toml", '[project]\nversion = "0.1.0"\n')
    write(tmp_path / "CITATION.cff", "version: 9.9.9\n")
    (found,) = rules.version_is_the_same_everywhere(tmp_path)
    assert "CITATION.cff has version 9.9.9, pyproject.toml 0.1.0" in found


def test_the_built_core_has_the_version_of_the_project() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert pendcore.__version__ == project["version"]


def test_the_rules_are_a_command_that_fails_at_a_breach(tmp_path: Path) -> None:
    for file in ["pyproject.toml", "CITATION.cff"]:
        write(tmp_path / file, (ROOT / file).read_text())
    command = tmp_path / "tests/documents/house_rules.py"
    write(command, Path(rules.__file__).read_text())
    write(tmp_path / "tests/test_long.py", "pass\n" * 401)
    done = subprocess.run([sys.executable, command], capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert done.stderr.splitlines()[0] == "tests/test_long.py has 401 lines: more than 400"


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
    write(package / "cli/derive.py", "import pendcore\nfrom pendcore import _core")
    write(
        package / "_views/table.py",
        "from pendcore._run.solution import Solution\nif TYPE_CHECKING:\n    import matplotlib\n"
        "def plot():\n    import matplotlib",
    )
    write(package / "_run/result.py", "from pendcore import _scene\nfrom pendcore._run import call")
    write(package / "_run/call.py", "from pendcore._scene.link import Link")
    assert [found for rule in BREACHES for found in rule(tmp_path)] == []
