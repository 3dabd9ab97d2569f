"""MATLAB and Octave: the textbook's function file RR.m, and its inline function."""

from __future__ import annotations

from sympy import Expr, Float, Rational, Symbol, octave_code

from pendcore.derive.code import statements
from pendcore.derive.code.statements import wrapped
from pendcore.derive.derivation import Derivation

KEYWORDS = {
    *("break", "case", "catch", "classdef", "continue", "do", "else", "elseif", "end", "endfor"),
    *("endfunction", "endif", "endswitch", "endwhile", "for", "function", "global", "if"),
    *("otherwise", "parfor", "persistent", "return", "spmd", "switch", "try", "until", "while"),
    *("t", "x", "dx"),
}
"""Names that the function cannot have: those of Octave and MATLAB, and those of its arguments."""

FILE = """\
function dx = {name}(t,x)
% {capitals}  First-order system of {chain}, for ode45.
{comment}
%
%   [t,xs] = ode45(@{name}, [0 5], [{start}]);

{body}
dx = zeros({states},1);
{results}
"""
INLINE = """\
% {name}  First-order system of {chain}, as an inline function.
{comment}
%
%   [t,xs] = ode45({name}, [0 5], x0);              % MATLAB, as in the book
%   [t,xs] = ode45(@(t,x) {name}(t,x), [0 5], x0);  % Octave, whose ode45 wants a handle

{rows}
{call}
"""
COMMENT = """\
%   t    time, s
%   x    [{state}]: angles, rad, and rates, rad/s
%   dx   its derivative with respect to time, {states} x 1
%
"""


def function_file(derivation: Derivation, name: str = "RR") -> str:
    """Return the file; `Derivation.to_octave` says what is in it."""
    computation, state = statements.computations(derivation)["accelerations"], _state(derivation)

    def write(expression: Expr) -> str:
        return str(octave_code(expression.xreplace(state)))

    lines = [statements.constants(derivation, "{} = {!r};", "% "), ""]
    for line in statements.assigned(derivation, computation, write, "{} = {};", "% "):
        lines += wrapped(line, "", " ...")
    return _file(derivation, name, [*map(write, computation.results)], "\n".join([*lines, ""]))


def written_out(derivation: Derivation, name: str = "RR") -> str:
    """Return a function file as the textbook's program writes it: with numbers, nothing shared.

    The expressions are those of `inline_function`, so that the two can be compared.
    """
    return _file(derivation, name, _with_numbers(derivation))


def inline_function(derivation: Derivation, name: str = "g") -> str:
    """Return the statements; `Derivation.to_octave_inline` says what they make."""
    rows: dict[str, str] = {}
    for k, text in enumerate(_with_numbers(derivation)):
        rows |= {f"dx{2 * k + 1}dt": f"x({2 * k + 2})", f"dx{2 * k + 2}dt": text}
    pattern = ";".join(["%s"] * len(rows))
    call = f"{name} = inline(sprintf('[{pattern}]', {', '.join(rows)}), 't', 'x');"
    return INLINE.format(
        **_words(derivation, name),
        rows="\n".join(f"{part} = '{row}';" for part, row in rows.items()),
        call="\n".join(wrapped(call, "", " ...")),
    )


def _file(derivation: Derivation, name: str, accelerations: list[str], body: str = "") -> str:
    start = " ".join(["pi/4 0", *["pi/3 0"] * (derivation.n - 1)])
    results = []
    for i, value in enumerate(accelerations):
        results += [f"dx({2 * i + 1}) = x({2 * i + 2});"]
        results += wrapped(f"dx({2 * i + 2}) = {value};", "", " ...")
    return FILE.format(
        **_words(derivation, name), capitals=name.upper(), start=start, body=body,
        states=2 * derivation.n, results="\n".join(results),
    )  # fmt: skip


def _words(derivation: Derivation, name: str) -> dict[str, str]:
    """Return what every template has."""
    if not name.isidentifier() or not name.isascii() or name.startswith("_") or name in KEYWORDS:
        raise ValueError(f"name = {name!r}: must be a name that Octave allows, such as 'RR'")
    state = "; ".join(f"q{i}; q{i}'" for i in range(1, derivation.n + 1))
    comment = COMMENT.format(state=state, states=2 * derivation.n)
    comment += statements.origin(derivation, "% ")
    return {"name": name, "chain": f"a {derivation.in_words}", "comment": comment}


def _state(derivation: Derivation) -> dict[Symbol, Symbol]:
    """Return the state in the textbook's order: x(1) = q1, x(2) = qd1, ..."""
    s = derivation.symbols
    pairs = [symbol for pair in zip(s.q, s.qd, strict=True) for symbol in pair]
    return {symbol: Symbol(f"x({i})", real=True) for i, symbol in enumerate(pairs, start=1)}


def _with_numbers(derivation: Derivation) -> list[str]:
    """The accelerations written out, in x(1), x(2), ... and numbers."""
    known = _state(derivation) | {s: _exact(value) for s, value in derivation.values.items()}
    return [str(octave_code(one.xreplace(known))) for one in derivation.accelerations]


def _exact(value: float) -> Rational | Float:
    """Return 9.807 as 9807/1000, as MATLAB does; a number of many digits stays as it is."""
    digits = repr(value).partition("e")[0].replace(".", "").strip("-0")
    return Rational(repr(value)) if len(digits) <= 6 and abs(value) > 1e-6 else Float(value, 17)
