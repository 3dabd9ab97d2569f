"""The project keeps its house rules, and each rule finds a breach of it."""

from __future__ import annotations

from pathlib import Path

import house_rules as rules
import pendcore
import pytest
from house_rules import Rule

ROOT = Path(__file__).parents[1]


@pytest.mark.parametrize("rule", rules.RULES, ids=lambda rule: rule.__name__)
def test_in_this_project(rule: Rule) -> None:
    breaches = "\n".join(rule(ROOT))
    assert not breaches, breaches


CORE = "cpp/include/pendcore"
OF = "Of"
SCENE = '#include "pendcore/scene/scene.hpp"'
BREACHES = {
    rules.includes_follow_the_flow: [
        (f"{CORE}/integrate/loop/step.hpp", SCENE, "(integrate) includes pendcore/scene"),
        (
            f"{CORE}/integrate/step.hpp",
            "#include <pendcore/dynamics/a.hpp>",
            "(integrate) includes",
        ),
        (f"{CORE}/dynamics/a.hpp", '#include "pendcore/integrate/a.hpp"', "(dynamics) includes"),
        (f"{CORE}/arithmetic/pack.hpp", SCENE, "(arithmetic) includes"),
        (f"{CORE}/scene/scene.hpp", '#include "pendcore/dynamics/a.hpp"', "(scene) includes"),
        (f"{CORE}/attic/a.hpp", SCENE, "stands in no folder of the flow"),
        (f"{CORE}/scene.hpp", "", "stands in no folder of the flow"),
        (
            f"{CORE}/simulate/a.hpp",
            '#include "pendcore/pendcore.hpp"',
            "includes pendcore/pendcore",
        ),
        ("cpp/src/scene/a.cpp", '#include "pendcore/simulate/solution.hpp"', "(scene) includes"),
        ("cpp/src/simulate/a.cpp", '#include "../bindings/arrays.hpp"', "not by its place"),
    ],
    rules.sources_stand_where_their_headers_do: [
        ("cpp/src/dynamics/chain.cpp", "", "has no folder dynamics"),
    ],
    rules.imports_follow_the_flow: [
        ("scene.py", "from pendcore.solution import Solution", "imports solution"),
        ("scene.py", "def f():\n    import pendcore.views.plot", "imports views"),
        ("solution.py", "from pendcore.views.plot import plot", "imports views"),
        ("views/plot.py", "from pendcore import simulate", "imports simulate"),
        ("views/plot.py", "from ..case import Case", "imports (relative)"),
        ("case.py", "from pendcore.cli import main", "imports cli"),
        ("scene.py", "def f():\n    from pendcore.derive import Derivation", "imports derive"),
        ("attic.py", "", "has no place in the flow"),
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
    folder = "python/pendcore" if rule is rules.imports_follow_the_flow else ""
    write(tmp_path / folder / path, text)
    assert [found for found in rule(tmp_path) if sentence in found]


def test_a_source_in_another_folder_than_its_header_is_found(tmp_path: Path) -> None:
    write(tmp_path / CORE / "dynamics/chain/chain.hpp", "")
    write(tmp_path / CORE / "dynamics/energetics/energy.hpp", "")
    write(tmp_path / "cpp/src/dynamics/energetics/chain.cpp", "")
    (found,) = rules.sources_stand_where_their_headers_do(tmp_path)
    assert "stands in another folder than chain.hpp" in found


@pytest.mark.parametrize(
    ("project", "citation", "sentence"),
    [
        (pendcore.__version__, "9.9.9", "CITATION.cff has version 9.9.9"),
        ("9.9.9", "9.9.9", "the built core has version"),
    ],
)
def test_a_second_version_is_found(
    project: str, citation: str, sentence: str, tmp_path: Path
) -> None:
    write(tmp_path / "pyproject.toml", f'[project]\nversion = "{project}"\n')
    write(tmp_path / "CITATION.cff", f"version: {citation}\n")
    (found,) = rules.version_is_the_same_everywhere(tmp_path)
    assert sentence in found


def test_what_the_rules_allow_is_no_breach(tmp_path: Path) -> None:
    write(
        tmp_path / CORE / "dynamics/chain/chain.hpp",
        '#include "pendcore/arithmetic/sine_cosine.hpp"\n'
        "// std::sin(q) differs from machine to machine\n"
        "x = std::sqrt(sine_cosine(q).sine);",
    )
    write(
        tmp_path / "cpp/bindings/module.cpp",
        '#include "arrays.hpp"\n'
        '#include "pendcore/simulate/solution.hpp"\n'
        "#include <pybind11/numpy.h>",
    )
    package = tmp_path / "python/pendcore"
    write(package / "solution.py", "def plot():\n    from pendcore.views.plot import plot")
    write(package / "views/plot.py", "from pendcore.solution import Solution")
    assert [found for rule in BREACHES for found in rule(tmp_path)] == []
