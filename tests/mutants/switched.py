"""All mutants of the core in one build; the number in PENDCORE_MUTANT chooses one while it runs.

What the compiler evaluates itself cannot be switched, and is as it was: such mutants, and those
that would not compile, are built alone.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from pathlib import Path

from mutants.mutation import PARSERS, Mutant

VARIABLE = "PENDCORE_MUTANT"
HEADER = f"""\
#pragma once
#include <cstdlib>
namespace mutants {{
inline const int chosen = [] {{
  const char* number = std::getenv("{VARIABLE}");
  return number ? std::atoi(number) : 0;
}}();
constexpr bool is(int number) {{ return !__builtin_is_constant_evaluated() && chosen == number; }}
}}
"""
"""Included by every source. Mutants are counted from 1."""


def with_switches(path: str, source: bytes, mutants: Mapping[int, Mutant]) -> bytes:
    """Return a source with the mutants of it, on the same lines as before."""
    tree = PARSERS[Path(path).suffix].parse(source)
    places: dict[int, tuple[int, int]] = {}
    for number, mutant in mutants.items():
        node = tree.root_node.descendant_for_byte_range(mutant.start, mutant.end)
        assert node is not None
        if mutant.kind == "operator" and not node.is_named:  # a sign between its operands
            assert node.parent is not None
            node = node.parent
        places[number] = node.start_byte, node.end_byte

    def written(start: int, end: int, numbers: Iterable[int]) -> str:
        """Return what stands between two bytes, with those of the mutants that lie there."""
        left = [n for n in numbers if start <= places[n][0] and places[n][1] <= end]
        text = ""
        while left:
            outer = min(left, key=lambda n: (places[n][0], -places[n][1]))
            begin, close = places[outer]
            within = [n for n in left if n != outer and places[n][1] <= close]
            text += source[start:begin].decode() + with_switch(outer, within)
            start = close
            left = [n for n in left if n != outer and n not in within]
        return text + source[start:end].decode()

    def with_switch(number: int, within: Iterable[int]) -> str:
        """Return what stands in the place of a mutant."""
        mutant, chosen, (begin, close) = mutants[number], f"mutants::is({number})", places[number]
        right = written(begin, close, within)
        is_not = mutant.before.startswith("!") and mutant.before != "!="
        if mutant.kind == "left out":
            return f"{{ if (!{chosen}) {{ {right} }} }}"
        if mutant.kind == "condition" or mutant.before in ("true", "false") or is_not:
            return f"({chosen} != static_cast<bool>({right}))"
        if mutant.end - mutant.start < close - begin:
            before = written(begin, mutant.start, within)
            after = written(mutant.end, close, within)
            wrong = f"{before}{mutant.after}{after}".replace("\n", " ")
            return f"({chosen} ? ({wrong}) : ({right}))"
        return f"({chosen} ? {mutant.after} : {right})"

    return written(0, len(source), places).encode()


def is_constant(source: bytes, mutant: Mutant) -> bool:
    """Whether the compiler evaluates a mutant: it cannot be switched."""
    tree = PARSERS[Path(mutant.path).suffix].parse(source)
    node = tree.root_node.descendant_for_byte_range(mutant.start, mutant.end)
    while node is not None and node.type != "compound_statement":
        is_constexpr = b"constexpr" in [child.text for child in node.children]
        if is_constexpr or node.type in ("template_argument_list", "enumerator"):
            return True
        node = node.parent
    return False


def not_compiled(said: str, root: Path, mutants: Mapping[int, Mutant]) -> set[int]:
    """Return the mutants that GCC complains of: those on lines that it names, or the nearest."""
    found = re.findall(rf"{re.escape(str(root))}/(\S+?):(\d+):\d+: +(?:error|  required)", said)
    bad = {(path, int(line)) for path, line in found}
    named = {n for n, mutant in mutants.items() if (mutant.path, mutant.line) in bad}
    if named:
        return named
    nearest = (
        min((abs(m.line - line), n) for n, m in mutants.items() if m.path == path)
        for path, line in bad
        if any(m.path == path for m in mutants.values())
    )
    return {number for _, number in nearest}
