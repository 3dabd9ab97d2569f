"""The checked-in stub of the compiled module says what the built module has.

Types are mypy's business; here names, and the arguments in their order with or without default, are
compared with those that pybind11 writes on the first line of each docstring.
"""

from __future__ import annotations

import ast
import inspect
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from pendcore import _core

STUB = Path(__file__).parents[2] / "python/pendcore/_core.pyi"
SPECIAL = {"__init__", "__getstate__", "__setstate__", "__version__"}


def listed(body: list[ast.stmt]) -> dict[str, ast.stmt]:
    """What a stub's module or class declares, by name."""
    found: dict[str, ast.stmt] = {}
    for node in body:
        if isinstance(node, ast.ClassDef | ast.FunctionDef):
            found[node.name] = node
        elif isinstance(node, ast.AnnAssign):
            found[ast.unparse(node.target)] = node
        elif isinstance(node, ast.Assign):
            found |= {ast.unparse(target): node for target in node.targets}
    return {name: node for name, node in found.items() if is_public(name)}


def is_public(name: str) -> bool:
    return not name.startswith("_") or name in SPECIAL


def arguments(function: ast.FunctionDef) -> list[str]:
    """Names in order, `=` after those that have a default."""
    given = function.args
    names = [arg.arg for arg in given.posonlyargs + given.args]
    defaults = [""] * (len(names) - len(given.defaults)) + ["="] * len(given.defaults)
    words = [name + default for name, default in zip(names, defaults, strict=True)]
    words += ["*"] if given.kwonlyargs else []
    for arg, value in zip(given.kwonlyargs, given.kw_defaults, strict=True):
        words.append(arg.arg + ("=" if value else ""))
    return words


def signature(function: Any) -> str:
    return (inspect.getdoc(function) or "").split("\n")[0]


def built_arguments(function: Any) -> list[str]:
    (parsed,) = ast.parse(f"def {signature(function)}: ...").body
    assert isinstance(parsed, ast.FunctionDef)
    return arguments(parsed)


def differences(stub: list[ast.stmt], built: ModuleType | type, place: str) -> Iterator[str]:
    declared = listed(stub)
    present = {name: value for name, value in vars(built).items() if is_public(name)}
    if not signature(present.get("__init__")).startswith("__init__("):
        present.pop("__init__", None)  # of a class that Python does not construct
    for name in sorted(declared.keys() ^ present.keys()):
        yield f"{place}{name} is only in the {'stub' if name in declared else 'built module'}"
    for name in sorted(declared.keys() & present.keys()):
        node, value = declared[name], present[name]
        if isinstance(node, ast.ClassDef):
            yield from differences(node.body, value, f"{place}{name}.")
        elif isinstance(node, ast.FunctionDef) and not isinstance(value, property):
            said, taken = arguments(node), built_arguments(value)
            # What pybind11 registers for pickling has a nameless argument.
            if said != taken and "arg0" not in taken:
                yield f"{place}{name} takes {', '.join(taken)}; the stub says {', '.join(said)}"


def test_the_stub_has_what_the_built_module_has() -> None:
    assert list(differences(ast.parse(STUB.read_text()).body, _core, "")) == []


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("def instruction_set(", "def instruction_sets("),
        ("__version__: str", ""),
        ("def mass_matrix(self, q:", "def mass_matrix(self, angles:"),
        ("warn: Callable[[str], object],", "warn: Callable[[str], object] = print,"),
        ("class Scene:", "class Scene:\n    color: str"),
    ],
)
def test_a_stub_that_differs_is_found(right: str, wrong: str) -> None:
    text = STUB.read_text()
    assert right in text
    assert list(differences(ast.parse(text.replace(right, wrong)).body, _core, ""))
