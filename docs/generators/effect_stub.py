"""The stub python/pendcore/effects.pyi, from the descriptions of the effects.

The classes are made when pendcore is imported; the stub shows type checkers and editors what they
are. docs/generators/write_effects.py writes it.
"""

from __future__ import annotations

from collections.abc import Iterator

from pendcore._scene.effect_class import KINDS, PARTS, Described, Effect
from pendcore._scene.effect_description import Parameter

HEAD = '''"""What acts on a chain besides gravity: a class for each effect that the core has.

Written by docs/generators/write_effects.py from what the core says of each effect.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar, Final, Literal

import numpy.typing as npt

from pendcore._scene.effect_class import Effect as Effect
from pendcore._scene.effect_class import OwnEffect, PythonEffect
from pendcore._scene.effect_class import Part as Part

def kinds() -> dict[str, type[Effect]]:
    """Return the class of every kind of effect, the kind as in case files."""

def parts() -> dict[str, type[Part]]:
    """Return the class of every part of an effect, such as the sinusoid of a motor, by its name."""
'''
TAKEN = {
    "optional float": "float",
    "pair": "npt.ArrayLike",
    "floats": "npt.ArrayLike",
    "address": "Any",
    "function": "Callable[..., npt.ArrayLike]",
}
"""The type of an argument, where it is not the type of the attribute in `KEPT`."""
KEPT = {
    "optional float": "float",
    "pair": "tuple[float, float]",
    "floats": "tuple[float, ...]",
    "address": "int",
    "function": "Callable[..., npt.ArrayLike]",
}


def stub() -> str:
    """Return the whole stub."""
    return "\n".join(
        [HEAD, *("\n".join(_class(cls)) for cls in (*PARTS.values(), *KINDS.values()))]
    )


def _class(cls: type[Described]) -> Iterator[str]:
    parameters = cls.description.parameters
    yield f"class {cls.__name__}({cls.__bases__[0].__name__}):"
    yield f'    """{cls.description.sentence}"""'
    yield ""
    if issubclass(cls, Effect):
        yield f'    kind: ClassVar[Literal["{cls.kind}"]]'
    match = ", ".join(f'"{p.name}"' for p in parameters)
    yield f"    __match_args__: Final = ({match}{',' * (len(parameters) == 1)})"
    yield from _function("__init__", [_argument(p, default=not p.required) for p in parameters])
    changes = ["*", *(_argument(p, default=True) for p in parameters)]
    yield from _function("replace", changes, cls.__name__, "  # type: ignore[override]")
    for p in parameters:
        if p.name == "function":
            continue
        yield "    @property"
        yield f"    def {p.name}(self) -> {_type(p, KEPT)}: ..."
    yield ""


def _type(parameter: Parameter, words: dict[str, str]) -> str:
    word = words.get(parameter.type, parameter.type)
    return f"{word} | None" if parameter.optional else word


def _argument(parameter: Parameter, *, default: bool) -> str:
    usual = " = ..." if default else ""
    return f"{parameter.name}: {_type(parameter, TAKEN)}{usual}"


def _function(
    name: str, arguments: list[str], result: str = "None", remark: str = ""
) -> Iterator[str]:
    line = f"    def {name}(self, {', '.join(arguments)}) -> {result}: ..."
    if len(line + remark) <= 100:
        yield line + remark
        return
    yield f"    def {name}({remark}"
    yield "        self,"
    yield from (f"        {argument}," for argument in arguments)
    yield f"    ) -> {result}: ..."
