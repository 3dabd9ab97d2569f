"""Every public name has examples in its docstring, and they do what they show."""

from __future__ import annotations

import doctest
import functools
import inspect
import re
from types import ModuleType

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import pendcore as pc
import pytest
from pendcore import effects
from pendcore._scene import effect_description

CLASSES = (pc.Case, pc.Ensemble, pc.Link, pc.Scene, pc.Solution)
"""The classes of which every public method has examples, too."""
EXTRAS = {
    "Ensemble.to_xarray": "xarray",
    "Solution.to_pandas": "pandas",
    "Solution.to_xarray": "xarray",
}


def public():
    """Yield what users may call, with its name."""
    for module in (pc, pc.sampling, pc.effects, pc.events, pc.reducers):
        for name in module.__all__:
            thing = getattr(module, name)
            if not isinstance(thing, ModuleType) and name != "__version__":
                yield f"{module.__name__}.{name}".removeprefix("pendcore."), thing
    for cls in CLASSES:
        for name, thing in inspect.getmembers(cls, inspect.isroutine):
            if not name.startswith("_"):
                yield f"{cls.__name__}.{name}", thing
    yield "Solution.__call__", pc.Solution.__call__


PUBLIC = dict(public())


def examples_of(docstring):
    """Return the examples in the last section of a docstring, none if it is another one."""
    before, _, section = docstring.rpartition("\nExamples\n--------\n")
    return doctest.DocTestParser().get_examples(section) if before else []


def complaints(name, docstring):
    """Run the examples of a docstring; return what they do other than what they show."""
    names = {"np": np, "pc": pc}
    test = doctest.DocTest(examples_of(docstring), names, name, None, None, docstring)
    told = []
    doctest.DocTestRunner(verbose=False).run(test, out=told.append)
    return "".join(told)


@pytest.mark.parametrize("name", PUBLIC)
def test_the_examples_of_a_docstring_do_what_they_show(name, tmp_path, monkeypatch):
    mpl.use("Agg")
    monkeypatch.chdir(tmp_path)
    small = functools.partialmethod(pc.Solution.to_video, fps=4, size=(160, 90))
    monkeypatch.setattr(pc.Solution, "to_video", small)
    docstring = inspect.getdoc(PUBLIC[name]) or ""
    examples = examples_of(docstring)
    assert examples, f"{name} has no section of examples at the end of its docstring"
    assert examples[-1].want, f"{name}: the last example shows nothing"
    if name in EXTRAS:
        pytest.importorskip(EXTRAS[name])
    told = complaints(name, docstring)
    plt.close("all")
    assert not told, f"\n{told}"


@pytest.mark.parametrize("kind", effects.kinds())
def test_an_example_whose_outcome_is_not_told_shows_the_kind(kind):
    told = effects.kinds()[kind].description._replace(outcome="")
    docstring = effect_description.docstring(told)
    assert examples_of(docstring)[-1].want == f"'{kind}'\n"
    assert complaints(kind, docstring) == ""


@pytest.mark.parametrize(
    "name", ["simulate", "effects.User", "effects.CompiledUser", "Scene.linearize"]
)
def test_who_differentiates_a_function_of_the_users_says_how(name):
    told = " ".join((inspect.getdoc(PUBLIC[name]) or "").split())
    assert re.search("(differentiated|differentiate the function) by central differences", told)
