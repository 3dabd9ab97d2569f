"""C++: a header with right-hand side, reactions and energies, for any C++17 program."""

from __future__ import annotations

from pendcore.derive.algebra import Algebra
from pendcore.derive.code.layout import (
    chain_in_words,
    constants,
    identifiers,
    indented,
    meanings,
    origin,
    wrapped,
)
from pendcore.derive.code.printer import Cpp
from pendcore.derive.code.quantities import Quantities
from pendcore.derive.code.shared import Computation

TAKEN = (
    *("links", "t", "y", "dydt", "q", "qd", "qdd", "force", "energy", "power", "square", "cube"),
    *("right_hand_side", "accelerations", "reactions", "energies", "powers", "total", "std"),
    *("Angles", "State", "Force", "Energy", "Powers", "x", "kinetic", "potential"),
)
"""Names that the header uses for itself."""

KEYWORDS = {
    *("alignas", "alignof", "and", "asm", "auto", "bitand", "bitor", "bool", "break", "case"),
    *("catch", "char", "class", "compl", "const", "constexpr", "continue", "decltype", "default"),
    *("delete", "do", "double", "else", "enum", "explicit", "export", "extern", "false", "float"),
    *("for", "friend", "goto", "if", "inline", "int", "long", "mutable", "namespace", "new"),
    *("noexcept", "not", "nullptr", "operator", "or", "private", "protected", "public"),
    *("register", "return", "short", "signed", "sizeof", "static", "struct", "switch"),
    *("template", "this", "throw", "true", "try", "typedef", "typeid", "typename", "union"),
    *("unsigned", "using", "virtual", "void", "volatile", "while", "xor"),
}
"""Keywords of C++ that Python allows as names."""

HEAD = """/// \\file
/// {chain}: right-hand side, joint reactions, energies. Needs nothing but C++17.
///
{origin}
///
///     M(q) qdd = f(t, q, qd)          M the mass matrix ({n} x {n}), kg m^2; f in N m
///     y = (q_1 .. q_n, qd_1 .. qd_n)  the state, 2n numbers: dy/dt = (qd, qdd)
///
/// Cost: {cost}.
/// Nothing is allocated and nothing thrown; angles and rates that are not finite give NaN.
///
///     {namespace}::{name} chain;
///     auto dydt = chain.right_hand_side(t, y);   // with the scene's numbers
///     chain.{first} = 2.0;
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
"""

DOCUMENTATION = {
    "accelerations": ["Angular accelerations of the links, rad/s^2."],
    "reactions": [
        "Force on each link where it begins: F_01, of the ground on link 1, then F_12, of link 1",
        "on link 2, and so on.",
    ],
    "energy": ["Kinetic and potential energy of the chain."],
    "powers": ["Power of each effect."],
}

RIGHT_HAND_SIDE = """
  /// dy/dt of the state y.
  State right_hand_side(double t, const State& y) const {
    Angles q{}, qd{};
    for (std::size_t i = 0; i < links; ++i) {
      q[i] = y[i];
      qd[i] = y[links + i];
    }
    const Angles qdd = accelerations(t, q, qd);
    State dydt{};
    for (std::size_t i = 0; i < links; ++i) {
      dydt[i] = qd[i];
      dydt[links + i] = qdd[i];
    }
    return dydt;
  }

  /// The same as Boost.odeint and others call it.
  void operator()(const State& y, State& dydt, double t) const { dydt = right_hand_side(t, y); }
"""
FORCES = "std::array<Force, links>"
POWER = {"square": "x * x", "cube": "x * x * x"}


def header(derivation: Algebra, name: str = "Chain", namespace: str = "pendulum") -> str:
    """Return the text of a C++17 header that needs the standard library alone.

    Its struct has the scene's numbers as defaults, and ``accelerations``, ``right_hand_side``,
    ``reactions``, ``energy`` and, where effects do work, ``powers``.

    Parameters
    ----------
    derivation : Algebra
        The derivation of any scene.
    name, namespace : str, default "Chain" and "pendulum"
        The name of the struct, and the namespace in which it stands.
    """
    for what, given, own in (("name", name, TAKEN), ("namespace", namespace, ("std",))):
        if not given.isidentifier() or not given.isascii() or given in KEYWORDS:
            raise ValueError(f"{what} = {given!r}: must be a name that C++ allows")
        if given in own:
            raise ValueError(f"{what} = {given!r}: is taken: the header has something of that name")
    taken = (*TAKEN, name, namespace)
    n, quantities = derivation.n, Quantities.of(derivation, taken)
    every = [p.symbol for p in derivation.symbols.parameters]
    writer = Cpp(identifiers([*every, *quantities.symbols()], taken))
    numbers = constants(derivation, writer, "  double {} = ", "{!r};", "  ///< {}")
    text = HEAD.format(
        chain=chain_in_words(derivation).capitalize(), name=name, namespace=namespace, n=n,
        origin="\n".join(f"/// {line}".rstrip() for line in origin(derivation)),
        cost=_cost(quantities), first=writer.doprint(every[0]), constants="\n".join(numbers),
    )  # fmt: skip
    if quantities.powers:
        text += _powers_struct(quantities)
    text += RIGHT_HAND_SIDE
    for result, what, computation in (
        ("Angles", "accelerations", quantities.accelerations),
        (FORCES, "reactions", quantities.reactions),
        ("Energy", "energy", quantities.energies),
        ("Powers", "powers", quantities.power),
    ):
        if computation.results:
            text += _function(derivation, writer, result, what, computation)
    used = [f"  static double {one}(double x) {{ return {product}; }}"
            for one, product in POWER.items() if f"{one}(" in text]  # fmt: skip
    text += "\n".join(["\n private:", *used, ""]) if used else ""
    return f"{text}}};\n\n}}  // namespace {namespace}\n"


def _cost(quantities: Quantities) -> str:
    calls = sum(
        type(value).__name__ in ("sin", "cos") for _, value in quantities.accelerations.assignments
    )
    others = quantities.accelerations.operations - calls
    return f"{calls} sines and cosines, {others} other operations a right-hand side"


def _powers_struct(quantities: Quantities) -> str:
    told = "Power that each effect brings into the chain, W; negative where it takes energy."
    lines = [f"  /// {told}", "  struct Powers {"]
    for name, effect in quantities.powers.items():
        lines += [f"    /// {line.strip()}" for line in indented(repr(effect))]
        lines.append(f"    double {name};")
    lines.append("    /// The rate at which kinetic + potential energy grows.")
    lines.append("    double total() const {")
    lines += wrapped(f"return {' + '.join(quantities.powers)};", "      ")
    return "\n".join([*lines, "    }", "  };", ""])


def _function(
    derivation: Algebra, writer: Cpp, result: str, name: str, computation: Computation
) -> str:
    """Write a member function of t, q, qd that returns the computation's results in braces."""
    s, needs = derivation.symbols, computation.needs
    accelerated = bool(needs & {*s.qdd})
    time, angles, rates = (
        f"{kind} {name}" if accelerated or needs & {*symbols} else f"{kind} /*{name}*/"
        for kind, name, symbols in (
            ("double", "t", (s.t,)),
            ("const Angles&", "q", s.q),
            ("const Angles&", "qd", s.qd),
        )
    )
    lines = ["", *(f"  /// {line}" for line in DOCUMENTATION[name])]
    lines.append(f"  {result} {name}({time}, {angles}, {rates}) const {{")
    if accelerated:
        lines.append("    const Angles qdd = accelerations(t, q, qd);")
    for symbols, whole in ((s.q, "q"), (s.qd, "qd"), (s.qdd, "qdd")):
        parts = [
            f"{writer.doprint(one)} = {whole}[{i}]" for i, one in enumerate(symbols) if one in needs
        ]
        lines += wrapped(f"const double {', '.join(parts)};", "    ") if parts else []
    words = meanings(derivation)
    for symbol, value in computation.assignments:
        lines += [f"    // {words[symbol]}"] if symbol in words else []
        own = f"{writer.doprint(symbol)} = {writer.doprint(value)}"
        lines += wrapped(f"const double {own};", "    ")
    values = [writer.doprint(value) for value in computation.results]
    if result == FORCES:
        values = [f"Force{{{x}, {y}}}" for x, y in zip(values[::2], values[1::2], strict=True)]
    body = [line for value in values for line in wrapped(f"{value},", "        ")]
    body[-1] = body[-1].removesuffix(",")
    opening, closing = ("{{", "}}") if result in ("Angles", FORCES) else ("{", "}")
    lines += [f"    return {result}{opening}", *body, f"    {closing};", "  }"]
    return "\n".join(lines) + "\n"
