"""The laws of effects, which the core tells in plain letters, as formulas of HTML or LaTeX."""

from __future__ import annotations

import re

HTML = {
    "letter": "<i>{}</i>", "below": "<sub>{}</sub>", "above": "<sup>{}</sup>", "bars": "|{}|",
    "words": "{}", "function": "{}", "sign": "{}",
    "tau": "τ", "phid": "φ̇", "phi": "φ", "omega": "ω", "rho": "ρ", "psi": "ψ", "qd": "q̇",
    "<=": "≤", "+-": "±", "-": "−", "  ": "&emsp;",
}  # fmt: skip
"""How a language writes each kind of part; then signs, a wide space, letters that have a name."""

_NAMES, _FUNCTIONS = "tau|phid|phi|omega|rho|psi|qd", "sin|exp|sgn"
_WORD = (
    rf"(?!(?:{_NAMES}|{_FUNCTIONS}|abs)(?![a-z]))"
    r"(?:[a-z]{3,}|at|an|hi|is|lo|of|or|to)(?![a-z_^])"
)
_PART = re.compile(
    r"abs\((?P<bars>[^()]+)\)"
    rf"|(?P<words>(?:(?<![=( ]) )?\b{_WORD}(?: {_WORD})*(?: (?! ))?)"
    rf"|\b(?P<function>{_FUNCTIONS})\b"
    r"|(?:_|(?<=[a-z])(?=\d))(?P<below>\w+)"
    r"|(?:\^|(?<=\w)(?=[+-][ ,]))(?P<above>\w+|[+-])"
    rf"|(?P<letter>{_NAMES}|[A-Za-z])"
    r"|(?P<sign><=|\+-|-|  )"
)


def formula(text: str, language: dict[str, str]) -> str:
    """Return a law, or a part or a symbol of one, in a language."""

    def written(found: re.Match[str]) -> str:
        kind = str(found.lastgroup)
        inside = formula(found[kind], language) if kind in ("bars", "above") else found[kind]
        return language[kind].format(language.get(inside, inside))

    return _PART.sub(written, text)


def formulas(law: str, language: dict[str, str]) -> list[str]:
    """Return the alternatives of a law, each a formula."""
    first, *others = law.split(" | ")
    begin = first.partition("=")[0]
    return [formula(x, language) for x in (first, *(f"or  {begin}= {x}" for x in others))]
