"""C++: a header with right-hand side, reactions and energies, for any C++17 program."""

from __future__ import annotations

import re
from typing import Any

from sympy import Expr, cos, cxxcode, sin
from sympy.printing.cxx import CXX17CodePrinter

from pendcore.derive.code import statements
from pendcore.derive.code.statements import Computation, indented, wrapped
from pendcore.derive.derivation import Derivation

KEYWORDS = {*CXX17CodePrinter.reserved_words, "catch", "register"}  # SymPy forgets these two

HEADER = """\
/// \\file
/// {chain}: right-hand side, joint reactions, energies. Needs nothing but C++17.
///
{origin}
///
///     M(q) qdd = f(t, q, qd)          M the mass matrix ({n} x {n}), kg m^2; f in N m
///     y = (q_1 .. q_n, qd_1 .. qd_n)  the state, 2n numbers: dy/dt = (qd, qdd)
///
/// Cost: {calls} sines and cosines, {others} other operations a right-hand side.
/// Nothing is allocated and nothing thrown; angles and rates that are not finite give NaN.
///
///     {namespace}::{name} chain;
///     auto dydt = chain.right_hand_side(t, y);   // with the scene's numbers
///     chain.m1 = 2.0;
///     chain(y, dydt, t);                         // with others; as Boost.odeint calls a system
#pragma once

// clang-format off: written by a program, and again when the scene changes

#include <array>
#include <cmath>
#include <cstddef>

namespace {namespace} {{

struct {name} {{
{constants}

  static constexpr std::size_t links = {n};
  using Angles = std::array<double, links>;     ///< a number for each link
  using State = std::array<double, 2 * links>;  ///< q_1 .. q_n, rad; qd_1 .. qd_n, rad/s

  struct Force {{
    double x, y;  ///< N; x right, y down
  }};
  struct Energy {{
    double kinetic;    ///< J
    double potential;  ///< J; 0 at the height of the origin
    double total() const {{ return kinetic + potential; }}
  }};
{powers}
  /// dy/dt of the state y.
  State right_hand_side(double t, const State& y) const {{
    Angles q{{}}, qd{{}};
    for (std::size_t i = 0; i < links; ++i) {{
      q[i] = y[i];
      qd[i] = y[links + i];
    }}
    const Angles qdd = accelerations(t, q, qd);
    State dydt{{}};
    for (std::size_t i = 0; i < links; ++i) {{
      dydt[i] = qd[i];
      dydt[links + i] = qdd[i];
    }}
    return dydt;
  }}

  /// The same as Boost.odeint and others call it.
  void operator()(const State& y, State& dydt, double t) const {{ dydt = right_hand_side(t, y); }}
{functions}
 private:
  static double square(double x) {{ return x * x; }}
  static double cube(double x) {{ return x * x * x; }}
}};

}}  // namespace {namespace}
"""
FUNCTION = """
{documentation}
  {result} {name}({arguments}) const {{
{body}
  }}"""
POWERS = """
  /// Power that each effect brings into the chain, W; negative where it takes energy.
  struct Powers {{
{members}
    /// The rate at which kinetic + potential energy grows.
    double total() const {{
{total}
    }}
  }};
"""
FUNCTIONS = {
    "accelerations": ("Angles", "Angular accelerations of the links, rad/s^2."),
    "reactions": (
        "std::array<Force, links>",
        "Force on each link where it begins: F_01, of the ground on link 1, then F_12, of link 1\n"
        "on link 2, and so on.",
    ),
    "energy": ("Energy", "Kinetic and potential energy of the chain."),
    "powers": ("Powers", "Power of each effect."),
}
TAKEN = {*re.findall(r"[A-Za-z]\w*", re.sub(r"//.*", "", HEADER + POWERS)), *FUNCTIONS}
"""Names that the header uses for itself."""

PRINTED_AS = {"Pow": [
    (lambda base, exponent: exponent == 2, lambda base, exponent: f"square({base})"),
    (lambda base, exponent: exponent == 3, lambda base, exponent: f"cube({base})"),
    (lambda base, exponent: True, "std::pow"),
]}  # fmt: skip
"""What SymPy's printer of C++ writes for powers."""


def write(expression: Expr) -> str:
    """Write an expression in C++."""
    return str(cxxcode(expression, standard="C++17", user_functions=PRINTED_AS))


def header(derivation: Derivation, name: str = "Chain", namespace: str = "pendulum") -> str:
    """Return the header; `Derivation.to_cpp` says what is in it."""
    found, powers = statements.computations(derivation), statements.powers_by_name(derivation)
    inside = {symbol.name for one in found.values() for symbol, _ in one.assignments}
    inside |= {*TAKEN, *(symbol.name for symbol in derivation.values)}
    for what, given, own in (("name", name, inside), ("namespace", namespace, {"std"})):
        if not given.isidentifier() or not given.isascii() or given in KEYWORDS:
            raise ValueError(f"{what} = {given!r}: must be a name that C++ allows")
        if given in own:
            raise ValueError(f"{what} = {given!r}: is taken: the header has something of that name")
    accelerations = found["accelerations"]
    calls = sum(isinstance(value, (sin, cos)) for _, value in accelerations.assignments)
    return HEADER.format(
        chain=f"A {derivation.in_words}", name=name, namespace=namespace,
        n=derivation.n, origin=statements.origin(derivation, "/// "), calls=calls,
        others=accelerations.operations - calls,
        constants=statements.constants(derivation, "  double {} = {!r};", "///< "),
        powers=_powers(powers) if powers else "",
        functions="\n".join(
            _function(derivation, what, one) for what, one in found.items() if one.results
        ),
    )  # fmt: skip


def _powers(powers: dict[str, Any]) -> str:
    members = []
    for name, effect in powers.items():
        members += [f"    /// {line.strip()}" for line in indented(repr(effect))]
        members.append(f"    double {name};")
    total = wrapped(f"return {' + '.join(powers)};", "      ")
    return POWERS.format(members="\n".join(members), total="\n".join(total))


def _function(derivation: Derivation, name: str, computation: Computation) -> str:
    """Write a member function of t, q, qd that returns the computation's results in braces."""
    s, needs = derivation.symbols, computation.needs
    result, documentation = FUNCTIONS[name]
    accelerated = bool(needs & {*s.qdd})
    arguments = (
        f"{kind} {argument}" if accelerated or needs & {*symbols} else f"{kind} /*{argument}*/"
        for kind, argument, symbols in (
            ("double", "t", (s.t,)), ("const Angles&", "q", s.q), ("const Angles&", "qd", s.qd)
        )
    )  # fmt: skip
    lines = []
    if accelerated:
        lines.append("const Angles qdd = accelerations(t, q, qd);")
    for symbols, whole in ((s.q, "q"), (s.qd, "qd"), (s.qdd, "qdd")):
        parts = [f"{one} = {whole}[{i}]" for i, one in enumerate(symbols) if one in needs]
        lines += [f"const double {', '.join(parts)};"] if parts else []
    lines += statements.assigned(derivation, computation, write, "const double {} = {};", "// ")
    body = [line for one in lines for line in wrapped(one, "    ")]
    values = [write(value) for value in computation.results]
    if name == "reactions":
        values = [f"Force{{{x}, {y}}}" for x, y in zip(values[::2], values[1::2], strict=True)]
    opened, closed = ("{{", "}}") if name in ("accelerations", "reactions") else ("{", "}")
    body.append(f"    return {result}{opened}")
    body += [line for value in values for line in wrapped(f"{value},", "        ")]
    body.append(f"    {closed};")
    return FUNCTION.format(
        documentation="\n".join(f"  /// {line}" for line in documentation.splitlines()),
        result=result, name=name, arguments=", ".join(arguments), body="\n".join(body),
    )  # fmt: skip
