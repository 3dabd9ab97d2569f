"""Python: a module with right-hand side, reactions and energies, for NumPy and SciPy."""

from __future__ import annotations

from sympy.printing.numpy import NumPyPrinter

from pendcore.derive.code import statements
from pendcore.derive.code.statements import Computation, wrapped
from pendcore.derive.derivation import Derivation

MODULE = '''\
"""{chain}: right-hand side, joint reactions, energies.

{origin}

    from scipy.integrate import solve_ivp

    sol = solve_ivp(right_hand_side, (0.0, 5.0), y0, rtol=1e-9, atol=1e-12)  # y0: angles, rates
    q, qd = sol.y[:n], sol.y[n:]
    force = reactions(sol.t, q, qd)                                          # N, (n, 2, n_t)

Arrays have the links along their first axis, as `sol.y` has; any other axes, such as one of times,
follow. The numbers below may be changed: each call takes those that stand there.
"""

from __future__ import annotations

import numpy

n = {n}  # links
{constants}


def right_hand_side(t, y):
    """Return dy/dt, (2n, ...), of the state y = (q_1 .. q_n, qd_1 .. qd_n), for `solve_ivp`."""
    y = numpy.asarray(y, dtype=float)
    return numpy.concatenate([y[n:], accelerations(t, y[:n], y[n:])])
'''
FUNCTION = '''

def {name}(t, q, qd):
    """{documentation}"""
    q, qd = numpy.asarray(q, dtype=float), numpy.asarray(qd, dtype=float)
{body}
    return {returned}
'''
DOCUMENTATION = {
    "accelerations": "Return the angular accelerations of the links, rad/s^2, (n, ...).",
    "reactions": """Return the force on each link where it begins, N, (n, 2, ...); x right, y down.

    First F_01, of the ground on link 1, then F_12, of link 1 on link 2, and so on.
    """,
    "energies": "Return kinetic and potential energy, J, the latter 0 at the origin's height.",
    "powers": """Return the power that each effect brings into the chain, W; negative if it takes.

    Their sum is the rate at which kinetic + potential energy grows.
    """,
}


def module(derivation: Derivation) -> str:
    """Return the module; `Derivation.to_python` says what is in it."""
    n, found = derivation.n, statements.computations(derivation)
    text = MODULE.format(
        chain=f"A {derivation.in_words}", n=n, origin=statements.origin(derivation),
        constants=statements.constants(derivation, "{} = {!r}", "# "),
    )  # fmt: skip
    rates = [f"qdd[{i}]" for i in range(n)]
    forces = [f"force[{i}, {k}]" for i in range(n) for k in (0, 1)]
    powers = [f'power["{name}"]' for name in statements.powers_by_name(derivation)]
    energies = ["kinetic", "potential"]
    for name, computation, made, results, returned in (
        ("accelerations", found["accelerations"], "qdd = numpy.empty_like(q)", rates, "qdd"),
        ("reactions", found["reactions"], "force = numpy.empty((n, 2, *q.shape[1:]))", forces,
         "force"),
        ("energies", found["energy"], "", energies, ", ".join(energies)),
        ("powers", found["powers"], "power = {}", powers, "power"),
    ):  # fmt: skip
        if results:
            text += FUNCTION.format(
                name=name, documentation=DOCUMENTATION[name], returned=returned,
                body="\n".join(_body(derivation, computation, made, results)),
            )  # fmt: skip
    return text


def _body(
    derivation: Derivation, computation: Computation, made: str, results: list[str]
) -> list[str]:
    """Return the lines of a function of t, q, qd."""
    s, write = derivation.symbols, NumPyPrinter().doprint
    lines = []
    for symbols, whole in ((s.q, "q"), (s.qd, "qd"), (s.qdd, "accelerations(t, q, qd)")):
        if computation.needs & {*symbols}:
            lines.append(f"{', '.join(map(str, symbols))}, = {whole}")
    lines += statements.assigned(derivation, computation, write, "{} = {}", "# ")
    lines += [made] * bool(made)
    named = zip(results, computation.results, strict=True)
    lines += [f"{name} = {write(value)}" for name, value in named]
    body = []
    for line in lines:
        name, _, value = line.partition(" = ")
        own = wrapped(line, "    ")
        body += own if len(own) == 1 else wrapped(f"{name} = ({value})", "    ")
    return body
