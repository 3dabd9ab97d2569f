"""The checked-in stub of the compiled module says what the built module has.

Types are mypy's business; here names, and the arguments in their order with or without default, are
compared with those that pybind11 writes on the first line of each docstring.
"""

from __future__ import annotations

import ast
import inspect
from pathlib import Path

from pendcore import _core

STUB = Path(__file__).parents[2] / "python/pendcore/_core.pyi"
SPECIAL = {"__init__", "__getstate__", "__setstate__", "__version__"}


def is_public(name):
    return not name.startswith("_") or name in SPECIAL


def declared_in(body):
    """What a stub's module or class declares, by name."""
    found = {}
    for node in body:
        if isinstance(node, ast.ClassDef | ast.FunctionDef):
            found[node.name] = node
        elif isinstance(node, ast.AnnAssign | ast.Assign):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            found |= {ast.unparse(target): node for target in targets}
    return {name: node for name, node in found.items() if is_public(name)}


def arguments(function):
    """Names in order, `=...` after those that have a default."""
    given = function.args
    given.posonlyargs, given.args = [], given.posonlyargs + given.args
    for arg in given.args + given.kwonlyargs:
        arg.annotation = None
    given.defaults = [ast.Constant(...) for _ in given.defaults]
    given.kw_defaults = [default and ast.Constant(...) for default in given.kw_defaults]
    return ast.unparse(given)


def signature(function):
    return (inspect.getdoc(function) or "").split("\n")[0]


def differences(stub, built, place=""):
    declared = declared_in(stub)
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
            said = arguments(node)
            taken = arguments(ast.parse(f"def {signature(value)}: ...").body[0])
            # What pybind11 registers for pickling has a nameless argument.
            if said != taken and "arg0" not in taken:
                yield f"{place}{name} takes {taken}; the stub says {said}"


def test_the_stub_has_what_the_built_module_has():
    assert list(differences(ast.parse(STUB.read_text()).body, _core)) == []
