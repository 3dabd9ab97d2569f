"""MATLAB and Octave: the textbook's function file RR.m, and its inline function."""

from __future__ import annotations

from sympy import Expr, Float, Rational, Symbol

from pendcore.derive.algebra import Algebra
from pendcore.derive.code.layout import (
    chain_in_words,
    constants,
    identifiers,
    meanings,
    origin,
    wrapped,
)
from pendcore.derive.code.printer import Octave
from pendcore.derive.code.shared import Computation, share

TAKEN = ("t", "x", "dx", "g0", "i", "j", "e", "pi", "end", "function", "Inf", "NaN", "eps")
"""Names that the language, or the file, uses for itself."""

KEYWORDS = {
    *("break", "case", "catch", "classdef", "continue", "do", "else", "elseif", "end", "endfor"),
    *("endfunction", "endif", "endswitch", "endwhile", "for", "function", "global", "if"),
    *("otherwise", "parfor", "persistent", "return", "spmd", "switch", "try", "until", "while"),
}
"""Names that no function can have, in Octave or in MATLAB."""


def function_file(derivation: Algebra, name: str = "RR") -> str:
    """Return the text of a function file for ``ode45``, such as the textbook's RR.m.

    The scene's numbers stand at its top, by name, and what expressions share is computed once.

    Parameters
    ----------
    derivation : Algebra
        The derivation of any scene.
    name : str, default "RR"
        The name of the function; the file has to have the same name, with ``.m``.
    """
    _check(name)
    computation = share(derivation.shared_accelerations, derivation.shared, TAKEN)
    printer = Octave(_names(derivation, computation))
    numbers = constants(derivation, printer, "{} = ", "{!r};", "  % {}")
    lines = [*_head(derivation, name), "", *numbers, ""]
    words = meanings(derivation)
    for symbol, value in computation.assignments:
        lines += [f"% {words[symbol]}"] if symbol in words else []
        lines += _assignment(printer, printer.doprint(symbol), value)
    lines += ["", f"dx = zeros({2 * derivation.n},1);"]
    for i, value in enumerate(computation.results):
        lines.append(f"dx({2 * i + 1}) = x({2 * i + 2});")
        lines += _assignment(printer, f"dx({2 * i + 2})", value)
    return "\n".join(lines) + "\n"


def written_out(derivation: Algebra, name: str = "RR") -> str:
    """Return a function file as the textbook's program writes it: with numbers, nothing shared.

    The expressions are those of `inline_function`, so that the two can be compared.
    """
    _check(name)
    lines = [*_head(derivation, name), "", f"dx = zeros({2 * derivation.n},1);"]
    for i, text in enumerate(_with_numbers(derivation)):
        lines += [f"dx({2 * i + 1}) = x({2 * i + 2});", f"dx({2 * i + 2}) = {text};"]
    return "\n".join(lines) + "\n"


def inline_function(derivation: Algebra, name: str = "g") -> str:
    """Return the statements that make the textbook's inline function, called `g` as there.

    An inline function is one expression: the scene's numbers are put in, and nothing is shared.
    """
    _check(name)
    rows = []
    for i, text in enumerate(_with_numbers(derivation), start=1):
        rows += [f"x({2 * i})", text]
    parts = [f"dx{i}dt" for i in range(1, len(rows) + 1)]
    pattern = ";".join(["%s"] * len(rows))
    call = f"{name} = inline(sprintf('[{pattern}]', {', '.join(parts)}), 't', 'x');"
    lines = [
        f"% {name}  First-order system of {chain_in_words(derivation)}, as an inline function.",
        *_comment(derivation),
        "%",
        f"%   [t,xs] = ode45({name}, [0 5], x0);              % MATLAB, as in the book",
        f"%   [t,xs] = ode45(@(t,x) {name}(t,x), [0 5], x0);  % Octave, whose ode45 wants a handle",
        "",
        *(f"{part} = '{row}';" for part, row in zip(parts, rows, strict=True)),
        *wrapped(call, "", " ..."),
    ]
    return "\n".join(lines) + "\n"


def _head(derivation: Algebra, name: str) -> list[str]:
    start = " ".join(["pi/4 0", *["pi/3 0"] * (derivation.n - 1)])
    return [
        f"function dx = {name}(t,x)",
        f"% {name.upper()}  First-order system of {chain_in_words(derivation)}, for ode45.",
        *_comment(derivation),
        "%",
        f"%   [t,xs] = ode45(@{name}, [0 5], [{start}]);",
    ]


def _comment(derivation: Algebra) -> list[str]:
    n = derivation.n
    state = "; ".join(f"q{i}; q{i}'" for i in range(1, n + 1))
    return [
        "%   t    time, s",
        f"%   x    [{state}]: angles, rad, and rates, rad/s",
        f"%   dx   its derivative with respect to time, {2 * n} x 1",
        "%",
        *(f"% {line}".rstrip() for line in origin(derivation)),
    ]


def _names(derivation: Algebra, computation: Computation) -> dict[Symbol, str]:
    own = [symbol for symbol, _ in computation.assignments]
    parameters = [p.symbol for p in derivation.symbols.parameters]
    return identifiers([*parameters, *own], TAKEN) | _state(derivation)


def _state(derivation: Algebra) -> dict[Symbol, str]:
    s = derivation.symbols
    places = {q: f"x({2 * i + 1})" for i, q in enumerate(s.q)}
    return places | {qd: f"x({2 * i + 2})" for i, qd in enumerate(s.qd)} | {s.t: "t"}


def _assignment(printer: Octave, name: str, value: Expr) -> list[str]:
    return wrapped(f"{name} = {printer.doprint(value)};", "", " ...")


def _with_numbers(derivation: Algebra) -> list[str]:
    """The accelerations written out, in x(1), x(2), ... and numbers."""
    numbers = {symbol: _exact(value) for symbol, value in derivation.values.items()}
    printer = Octave(_state(derivation))
    return [printer.doprint(one.xreplace(numbers)) for one in derivation.accelerations]


def _exact(value: float) -> Rational | Float:
    """Return 9.807 as 9807/1000, as MATLAB does; a number of many digits stays as it is."""
    digits = repr(value).partition("e")[0].replace(".", "").strip("-0")
    return Rational(repr(value)) if len(digits) <= 6 and abs(value) > 1e-6 else Float(value)


def _check(name: str) -> None:
    refused = name.startswith("_") or name in KEYWORDS | {"t", "x", "dx"}
    if not name.isidentifier() or not name.isascii() or refused:
        raise ValueError(f"name = {name!r}: must be a name that Octave allows, such as 'RR'")
