"""Python: a module with right-hand side, reactions and energies, for NumPy and SciPy."""

from __future__ import annotations

from pendcore.derive.algebra import Algebra
from pendcore.derive.code.layout import (
    chain_in_words,
    constants,
    identifiers,
    meanings,
    origin,
    wrapped,
)
from pendcore.derive.code.printer import NumPy
from pendcore.derive.code.quantities import Quantities
from pendcore.derive.code.shared import Computation

TAKEN = (
    *("np", "n", "t", "y", "q", "qd", "qdd", "force", "kinetic", "potential"),
    *("right_hand_side", "accelerations", "reactions", "energies", "powers", "annotations"),
)
"""Names that the module uses for itself; `identifiers` keeps clear of Python's keywords."""

HEAD = '''"""{chain}: right-hand side, joint reactions, energies.

{origin}

    from scipy.integrate import solve_ivp

    sol = solve_ivp(right_hand_side, (0.0, 5.0), y0, rtol=1e-9, atol=1e-12)  # y0: angles, rates
    q, qd = sol.y[:n], sol.y[n:]
    force = reactions(sol.t, q, qd)                                          # N, (n, 2, n_t)

Arrays have the links along their first axis, as `sol.y` has; any other axes, such as one of times,
follow. The numbers below may be changed: each call takes those that stand there.
"""

from __future__ import annotations

import numpy as np

n = {n}  # links
{constants}


def right_hand_side(t, y):
    """Return dy/dt, (2n, ...), of the state y = (q_1 .. q_n, qd_1 .. qd_n), for `solve_ivp`."""
    y = np.asarray(y, dtype=float)
    return np.concatenate([y[n:], accelerations(t, y[:n], y[n:])])
'''

DOCUMENTATION = {
    "accelerations": ["Return the angular accelerations of the links, rad/s^2, (n, ...)."],
    "reactions": [
        "Return the force on each link where it begins, N, (n, 2, ...); x right, y down.",
        "First F_01, of the ground on link 1, then F_12, of link 1 on link 2, and so on.",
    ],
    "energies": [
        "Return kinetic and potential energy, J, the latter 0 at the height of the origin."
    ],
    "powers": [
        "Return the power that each effect brings into the chain, W; "
        "negative where it takes energy.",
        "Their sum is the rate at which kinetic + potential energy grows.",
    ],
}


def module(derivation: Algebra) -> str:
    """Return the text of a Python module.

    The scene's numbers stand at its top, by name; ``right_hand_side(t, y)`` is for SciPy's
    ``solve_ivp``; ``accelerations``, ``reactions``, ``energies`` and ``powers`` take ``t, q, qd``
    with any axes after that of the links.

    Parameters
    ----------
    derivation : Algebra
        The derivation of any scene.
    """
    n, quantities = derivation.n, Quantities.of(derivation, TAKEN)
    every = [p.symbol for p in derivation.symbols.parameters]
    writer = NumPy(identifiers([*every, *quantities.symbols()], TAKEN))
    numbers = constants(derivation, writer, "{} = ", "{!r}", "  # {}")
    text = HEAD.format(
        chain=chain_in_words(derivation).capitalize(), origin="\n".join(origin(derivation)), n=n,
        constants="\n".join(numbers),
    )  # fmt: skip
    places = [f"[{i}, {k}]" for i in range(n) for k in (0, 1)]
    text += _function(
        derivation, writer, "accelerations", quantities.accelerations,
        ["qdd = np.empty_like(q)"], [f"qdd[{i}]" for i in range(n)], "qdd",
    )  # fmt: skip
    text += _function(
        derivation, writer, "reactions", quantities.reactions,
        ["force = np.empty((n, 2, *q.shape[1:]))"], [f"force{place}" for place in places], "force",
    )  # fmt: skip
    text += _function(
        derivation, writer, "energies", quantities.energies,
        [], ["kinetic", "potential"], "kinetic, potential",
    )  # fmt: skip
    if quantities.powers:
        text += _function(
            derivation, writer, "powers", quantities.power,
            ["power = {}"], [f'power["{name}"]' for name in quantities.powers], "power",
        )  # fmt: skip
    return text


def _function(
    derivation: Algebra, writer: NumPy, name: str, computation: Computation,
    made: list[str], results: list[str], returned: str,
) -> str:  # fmt: skip
    """Write a function of t, q, qd."""
    s = derivation.symbols
    summary, *more = DOCUMENTATION[name]
    lines = ["", "", f"def {name}(t, q, qd):", f'    """{summary}']
    lines += ["", *(f"    {line}" for line in more), "    "] if more else []
    lines[-1] += '"""'
    lines.append("    q, qd = np.asarray(q, dtype=float), np.asarray(qd, dtype=float)")
    for symbols, whole in ((s.q, "q"), (s.qd, "qd"), (s.qdd, "accelerations(t, q, qd)")):
        if computation.needs & {*symbols}:
            parts = ", ".join(map(writer.doprint, symbols))
            lines.append(f"    {parts if len(symbols) > 1 else f'({parts},)'} = {whole}")
    words = meanings(derivation)
    for symbol, value in computation.assignments:
        lines += [f"    # {words[symbol]}"] if symbol in words else []
        lines += _assignment(writer.doprint(symbol), writer.doprint(value))
    lines += [f"    {line}" for line in made]
    for result, value in zip(results, computation.results, strict=True):
        lines += _assignment(result, writer.doprint(value))
    return "\n".join([*lines, f"    return {returned}"]) + "\n"


def _assignment(name: str, value: str) -> list[str]:
    lines = wrapped(f"{name} = {value}", "    ")
    return lines if len(lines) == 1 else wrapped(f"{name} = ({value})", "    ")
