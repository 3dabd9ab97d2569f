"""Writes docs/effects from the descriptions of the effects: run it after adding one.

    python docs/generators/write_effects.py

A test compares the pages with what it would write. Further sections are in effect_sections.py. The
examples are those of the descriptions, as in the docstrings.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import inf
from pathlib import Path

import pendcore as pc
from effect_sections import COMPILED, MORE
from page_part import ROOT, table_of
from pendcore._run.energy import LOSSES
from pendcore._scene.effect_class import Effect, OwnEffect
from pendcore._scene.effect_description import CAVEATS, COLUMNS, Description
from pendcore.effects import KINDS
from pendcore.page.formulas import formula, formulas

FOLDER = ROOT / "docs/effects"
BOOKED = {
    "none": "Nothing: the effect does no work, or stores it as energy that `sol.energy()` counts.",
    "viscous": "`viscous`: the energy that the effect takes out of the motion, J.",
    "dry": "`dry`: the energy that the effect takes out of the motion, J.",
    "impact": "`impact`: the energy that impacts take out of the motion, J.",
    "drag": "`drag`: the energy that the rod loses, the integral of k |w|^3 along it, J, never "
    "negative. The remaining work of the air is in `wind`, J: none without wind.",
    "motor": "`motor`: the work of the motor, the integral of torque times rate of the joint, J.",
    "drive": "`drive`: the work done by moving the pivot, the integral of F_01 . v_0, J.",
    "user": "`user`: the work of the effect, the integral of Q . qd, J.",
}

TRUST = "[trust.md](../background/trust.md#points-where-a-law-changes)"
WHERE = {
    "dry": TRUST,
    "impact": TRUST,
    "drag": TRUST,
    "motor": "[conventions.md](../reference/conventions.md#angles-and-torques-of-another-source)",
    "user": "[Derivatives](../how_to/linearize.md)",
}
"""The page that has more on the note of an account."""


def written() -> dict[Path, str]:
    """Return every page and its text."""
    pages = {f"{kind}.md": _page(cls) for kind, cls in KINDS.items()} | {"README.md": _index()}
    return {FOLDER / name: text for name, text in pages.items()}


def examples(cls: type[Effect]) -> list[Effect]:
    """Return the effects that the examples of a kind make."""
    names = {name: getattr(pc.effects, name) for name in pc.effects.__all__} | {"inf": inf}
    return [eval(call, names) for call in cls.description.calls]


LATEX = {
    "letter": "{}", "below": "_{{{}}}", "above": "^{{{}}}", "bars": r"\lvert {} \rvert",
    "words": r"\text{{{}}}", "function": r"\operatorname{{{}}}", "sign": "{}",
    "tau": r"\tau", "phid": r"\dot\varphi", "phi": r"\varphi", "omega": r"\omega",
    "rho": r"\rho", "psi": r"\psi", "qd": r"\dot q", "<=": r"\le", "+-": r"\pm", "  ": r" \quad ",
}  # fmt: skip


def _page(cls: type[Effect]) -> str:
    return "\n\n".join(part.strip() for part in _parts(cls.description, cls) if part) + "\n"


def _parts(told: Description, cls: type[Effect]) -> Iterator[str]:
    yield f"# {told.name}"
    writer = "docs/generators/write_effects.py"
    yield f"<!-- Written by {writer} from what the core says of `{told.kind}`. -->"
    yield told.sentence
    yield from (f"$$\n{law}\n$$" for law in formulas(told.law, LATEX))
    if told.account in CAVEATS:
        yield f"**{CAVEATS[told.account]}** {WHERE[told.account]} has more."
    conventions = "[conventions.md](../reference/conventions.md)"
    every = "[All effects](README.md)."
    yield f"Source: {told.source}. The symbols are those of {conventions}. {every}"
    yield _table(told)
    for part in dict.fromkeys(p.part for p in told.parameters if p.part):
        described = getattr(pc.effects, part).description
        yield f"`{part}`: {described.sentence}"
        yield _table(described)
    if told.kind == "compiled_user":
        yield COMPILED
    else:
        yield "## In Python"
        yield f"```python\n{_python(examples(cls)[0], cls)}```"
    yield MORE.get(told.kind, "")
    yield "## In a case file"
    if issubclass(cls, OwnEffect):
        yield "No file can hold a function: no case file, no saved run, no pickle."
    else:
        tables = "\n".join(map(_toml, examples(cls)))
        yield f"```toml\n{tables}```"
    yield f"## In the ledger\n\n{BOOKED[told.account]}"


def _table(told: Description) -> str:
    rows = []
    for p in told.parameters:
        default = "needed" if p.required else "none" if p.optional else f"`{p.default!r}`"
        symbol = f"${formula(p.symbol, LATEX)}$" if p.symbol else ""
        sentence = p.sentence.replace("|", "\\|")
        rows.append([f"`{p.name}`", symbol, p.unit, default, p.range, sentence])
    heads = ["parameter", "symbol", "unit", "default", "allowed", "meaning"]
    return table_of(heads, rows, left=6)


def _python(effect: Effect, cls: type[Effect]) -> str:
    shown = cls.description.calls[0] if isinstance(effect, OwnEffect) else repr(effect)
    for name in pc.effects.__all__:
        shown = shown.replace(f"{name}(", f"pc.effects.{name}(")
    if len(f"effect = {shown}") > COLUMNS:
        call, _, inner = shown.partition("(")
        shown = f"{call}(\n    {inner[:-1]}\n)"
    return f"""\
import pendcore as pc

rod = pc.Link(mass=1.0, length=1.0)
effect = {shown}
scene = pc.Scene(links=[rod, rod], effects=[effect])
sol = pc.simulate(scene, q0=[0.5, 1.0], t_span=(0, 1), ledger=True)
print(sol.energy().ledger)
"""


def _toml(effect: Effect) -> str:
    """Return the table of an effect, as a case writes it."""
    rod = pc.Link(mass=1.0, length=1.0)
    whole = pc.Case(scene=pc.Scene(links=[rod, rod], effects=[effect]), q0=0, t_span=(0, 1))
    text = whole.to_toml()
    return text[text.index("[[effect]]") : text.index("\n[start]")]


def _index() -> str:
    losses = ", ".join(f"`{name}`" for name in sorted(LOSSES))
    rows = []
    for kind, cls in KINDS.items():
        told = cls.description
        keys = ", ".join(f"`{p.name}`" for p in told.parameters)
        rows.append([f"[{told.name}]({kind}.md)", told.sentence, f"`{kind}`", keys])
    table = table_of(["effect", "what it is", "kind", "parameters"], rows, left=4)
    return f"""\
# Effects

<!-- Written by docs/generators/write_effects.py from the core's list of effects. -->

A scene simulates gravity and the effects that it lists, and nothing else; unlisted effects cost
nothing. Each effect may act on any joint or link, and a scene may have several effects of one
kind. The torque `tau_j` at joint j acts on link j, and `-tau_j` on link j-1;
`phi_j = q_j - q_(j-1)` is the angle of joint j, `w` its rate. All grow clockwise as seen, because y
points down; {WHERE["motor"]} has the signs of other sources.
`scene.explain()` says what a scene simulates, what it leaves out, and what each effect costs.

{table}
With `pc.simulate(..., ledger=True)`, `sol.energy().ledger` tells where the energy went: {losses}
are losses, the other entries are work done on the chain, and `residual` is the remainder of the
balance.

[add_an_effect.md](../how_to/add_an_effect.md) says how to add an effect to the core.
"""


if __name__ == "__main__":
    for path, text in written().items():
        path.write_text(text)
        print(path.name)
