"""What is known of each kind of effect, as the core says it: law, source, parameters.

From it come the classes of `pendcore.effects`, their docstrings and stubs, the keys of case files
and the pages in docs/effects.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from functools import cache
from textwrap import fill
from typing import Any, NamedTuple

from pendcore import _core
from pendcore._messages.arguments import in_unit


class Parameter(NamedTuple):
    """One parameter of an effect, or of a part of one."""

    name: str
    """As in Python and in case files."""
    symbol: str
    """As in the law; empty for what is no quantity."""
    unit: str
    """SI; empty for what has none, ``"1"`` for a ratio."""
    sentence: str
    """What it is."""
    type: str
    """``"bool"``, ``"int"``, ``"float"``, ``"optional float"``, ``"pair"``, ``"floats"``,
    ``"address"``, ``"function"``, or the name of a part."""
    range: str
    """Allowed values, in words."""
    required: bool
    """Whether it has no default."""
    default: Any
    """None where there is none, and where leaving it out means something of its own."""
    components: tuple[str, str] = ("x", "y")
    """The names of the two numbers of a pair."""

    @property
    def optional(self) -> bool:
        """Whether it may be None."""
        return not self.required and self.default is None

    @property
    def part(self) -> str | None:
        """The class of its values, if they have parameters of their own."""
        return self.type if self.type[0].isupper() else None


class Description(NamedTuple):
    """One kind of effect, or of a part of effects."""

    name: str
    """The name of the class."""
    sentence: str
    """What it is."""
    parameters: tuple[Parameter, ...]
    """The required ones first."""
    kind: str = ""
    """As in case files; empty for a part."""
    law: str = ""
    source: str = ""
    """The equation, and where it comes from."""
    account: str = "none"
    """Where the ledger books its work; ``"none"`` where there is none."""
    bounds_joint: bool = False
    """Whether the effect may forbid a start that is next to one that it allows."""
    jumps_or_sticks: bool = False
    """Whether the motion jumps or sticks under it, each time at an instant of its own."""
    moves_pivot: bool = False
    """Whether it moves the pivot."""
    is_function: bool = False
    """Whether it is a function of the user's, of whose cost and smoothness nothing is known."""
    damps_small_motions: bool = False
    """Whether it damps motions however small they are, so that a run forgets its errors."""
    examples: str = ""
    """Calls that make one, a line each, after lines that prepare them."""
    outcome: str = ""
    """What the first of them does to the textbook's rods within 1 s; empty if that is not known."""

    @property
    def calls(self) -> tuple[str, ...]:
        """The calls among the examples."""
        return tuple(x for x in self.examples.splitlines() if x.startswith(f"{self.name}("))


COLUMNS = 88
"""As many as a page shows of a line of code."""
CAVEATS = {
    "dry": "A joint that friction brings to rest sticks: its rate is 0.0, exactly, until the "
    "torque that holds it exceeds `static`. A run in which nothing can move any more has the "
    'status "at_rest".',
    "impact": "A joint at rest at a stop is held there until what holds it would have to pull. "
    'A run in which nothing can move any more has the status "at_rest".',
    "drag": "Drag has a kink where the speed across an end of the rod changes its sign. At `rtol` "
    "and `atol` of 1e-7 and below, steps of `dop853` end there.",
    "motor": "A positive torque turns its link towards growing angles, clockwise as seen, because "
    "y points down. A torque that a source counts counter-clockwise needs a minus.",
    "user": "`linearize` and `simulate(sensitivities=...)` differentiate the function by "
    "central differences, to some ten digits where it is smooth.",
}
"""Notes on the laws whose work the ledger books on an account, by that account."""


@cache
def effects() -> tuple[Description, ...]:
    """Return the kinds of effects: the core's in the order of its registry, and the user's."""
    core = tuple(map(_description, _core.effect_descriptors()))
    return (*core, _in_python(next(one for one in core if one.is_function)))


def _in_python(compiled: Description) -> Description:
    """Return what a Python function is in place of a compiled one."""
    function = Parameter(
        name="function",
        symbol="f",
        unit="N m",
        sentence="f(t, q, qd) of the time (s), the angles (n,) and the rates (n,) returns the "
        "generalised forces (n,) of the absolute angles; the same for the same arguments. It "
        "is called at every right-hand side, a few microseconds each",
        type="function",
        range="",
        required=True,
        default=None,
    )
    return compiled._replace(
        name="User",
        kind="user",
        sentence="An effect of the user's own, as a Python function of t, q and qd.",
        law="Q += f(t, q, qd)",
        parameters=(function, *(p for p in compiled.parameters if p.name == "breaks")),
        examples="User(function=lambda t, q, qd: -0.1 * qd)\n"
        "User(function=lambda t, q, qd: [2.0 if t < 0.5 else -2.0, 0.0], breaks=[0.5])",
        outcome="user: -1.305 J",
    )


@cache
def parts() -> tuple[Description, ...]:
    """Return the kinds of what parameters of effects hold that have parameters of their own."""
    return tuple(map(_description, _core.part_descriptors()))


def _description(told: dict[str, Any]) -> Description:
    parameters = [Parameter(**row) for row in told["parameters"]]
    parameters.sort(key=lambda parameter: not parameter.required)
    return Description(**(told | {"parameters": tuple(parameters)}))


def type_in_words(parameter: Parameter) -> str:
    """Return the type of a parameter as a docstring gives it."""
    words = {
        "optional float": "float",
        "pair": "(float, float)",
        "floats": "array_like, (k,)",
        "function": "callable",
        "address": "int, ctypes function or numba cfunc"
        if parameter.required
        else "int or ndarray",
    }
    word = words.get(parameter.type, parameter.type)
    if parameter.required:
        return word
    return f"{word}, optional" if parameter.optional else f"{word}, default {parameter.default!r}"


def law_in_lines(law: str) -> str:
    """Return a law as a block of code, broken before an alternative or after a comma."""
    whole = re.sub(r"(?<!,)(?<!, ) (?!\|)", "\N{NO-BREAK SPACE}", law)
    broken = fill(whole, COLUMNS, initial_indent="    ", subsequent_indent="        ")
    return broken.replace("\N{NO-BREAK SPACE}", " ")


@cache  # a dataclass with slots is made twice
def docstring(described: Description) -> str:
    """Return the docstring of a class."""
    return "\n\n".join(_sections(described))


def _sections(described: Description) -> Iterator[str]:
    yield described.sentence
    if described.law:
        yield f"Law::\n\n{law_in_lines(described.law)}"
    parameters = (
        f"{parameter.name} : {type_in_words(parameter)}\n"
        + fill(_meaning(parameter), 92, initial_indent="    ", subsequent_indent="    ")
        for parameter in described.parameters
    )
    yield "\n".join(["Parameters\n----------", *parameters])
    yield (
        "Raises\n------\nValueError, TypeError\n"
        "    If a value is not allowed; the message gives the value, its range and its unit."
    )
    if described.source:
        yield "Notes\n-----\n" + fill(f"Source: {described.source}.", 92)
    if described.account in CAVEATS:
        yield fill(CAVEATS[described.account], 92)
    example = _effect_example(described) if described.kind else _part_example(described.name)
    if lines := "\n".join(example):
        yield f"Examples\n--------\n{lines}"


def _effect_example(effect: Description) -> Iterator[str]:
    """Yield lines that run the textbook's scene with an effect, if it has an example."""
    if not effect.calls:
        return
    for line in effect.examples.splitlines()[: -len(effect.calls)]:
        yield f"... {line}" if line.startswith((" ", "def ")) else f">>> {line}"
    yield _assignment(effect.calls[0], [p.part for p in effect.parameters if p.part])
    if not effect.outcome:
        yield from (">>> effect.kind", repr(effect.kind))
        return
    yield ">>> scene = pc.Scene.textbook().replace(effects=[effect])"
    yield ">>> sol = pc.simulate(scene, q0=[0.5, 1.0], t_span=(0, 1), ledger=True)"
    if effect.account == "none":
        yield '>>> print(f"q at 1 s: {sol(1.0)[:2].round(3).tolist()} rad")'
    else:
        booked = f"{{sol.energy().ledger.{effect.account}[-1]:.3f}} J"
        yield f'>>> print(f"{effect.account}: {booked}")'
    yield effect.outcome


def _part_example(name: str) -> Iterator[str]:
    """Yield lines that make an effect with a part, and show the part, if there is an example."""
    as_argument = re.compile(rf"(\w+)=({name}\((?:[^()]|\([^()]*\))*\))")
    for call in (call for effect in effects() for call in effect.calls):
        if found := as_argument.search(call):
            yield from (_assignment(call, [name]), f">>> effect.{found[1]}", found[2])
            return


def _assignment(call: str, parts: Iterable[str] = ()) -> str:
    """Return the line that makes an effect, or more where it is long."""
    for part in parts:
        call = call.replace(f"={part}(", f"=pc.effects.{part}(")
    return f">>> effect = {_broken(f'pc.effects.{call}', COLUMNS - 13)}"


def _broken(call: str, room: int, indent: str = "... ") -> str:
    """Return a call, its arguments on lines of their own where there is no room for it."""
    if len(call) <= room:
        return call
    head, _, inner = call.partition("(")
    further = f"{indent}    "
    inner = _broken(inner[:-1], COLUMNS - len(further), further)
    return f"{head}(\n{further}{inner}\n{indent})"


def _meaning(parameter: Parameter) -> str:
    """Return what a parameter is, its symbol, its range and its unit."""
    symbol = f"{parameter.symbol}: " if parameter.symbol else ""
    told = parameter.sentence
    sentence = told if symbol else told[:1].upper() + told[1:]
    allowed = f"; {parameter.range}" if parameter.range else ""
    return f"{symbol}{sentence}{allowed}{in_unit(parameter.unit)}."
