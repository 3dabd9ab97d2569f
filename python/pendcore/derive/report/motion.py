"""The numerical solution: method, table, curves, largest reactions, and the check by energy."""

from __future__ import annotations

from typing import Any

import numpy as np

from pendcore import AccuracyError, Case, Solution
from pendcore.derive.algebra import Algebra
from pendcore.derive.document import Paragraph, Table
from pendcore.derive.report.figures import Figures
from pendcore.derive.report.quantities import Scales, number, quantity

POINTS = 1201
"""The number of times at which curves are drawn."""
MOST_WITH_RATES = 3
"""The most links for which the table has the rates too: with more it is wider than a page."""
ROWS = 11
"""The number of times that the table shows."""
VISIBLE = 1e-9
"""The least time that a run takes if its curves are drawn, as a share of the times themselves."""
LOSSES = ("viscous", "drag")
"""The entries of the ledger that smooth effects lose; the others are work done on the chain."""

METHODS = {
    "dopri5": "Dormand and Prince's method of order 5, that of MATLAB's `ode45`",
    "dop853": "Dormand and Prince's method of order 8",
    "taylor": "Taylor series",
    "radau5": "Radau IIA, an implicit method of order 5",
    "rk4": "the classical Runge-Kutta method of order 4",
}
"""Methods in words; for a pair, such as `taylor-radau5`, the first of the two."""


def does_work(case: Case) -> bool:
    """Return whether the effects of a case change the energy."""
    return any(effect.description.account != "none" for effect in case.scene.effects)


def solved(case: Case) -> Solution:
    """Run a case so that it can be drawn, with a ledger if its effects do work."""
    return solved_or_refused(case)[0]


def solved_or_refused(case: Case) -> tuple[Solution, str]:
    """Run a case as `solved` does; return also why its error was refused, if it was."""
    start, end = case.t_span
    if start == end:
        raise ValueError(f"t_span = {case.t_span}: a report draws curves: let the run take time")
    found = _at_times_until(end, case)
    reached = found[0].t_reached
    return found if reached == end else _at_times_until(reached, case)


def _at_times_until(end: float, case: Case) -> tuple[Solution, str]:
    """Run a case and keep its states and its ledger at times spread until then."""
    start = case.t_span[0]
    times = np.unique(np.linspace(start, end, POINTS))
    times = times if end >= start else times[::-1]
    options: dict[str, Any] = {**case.options, "store": "dense", "t_eval": tuple(times.tolist())}
    if does_work(case):
        options["ledger"] = True
    spread = Case(
        scene=case.scene, q0=case.q0, qd0=case.qd0, t_span=case.t_span, name=case.name,
        options=options,
    )  # fmt: skip
    try:
        return spread.simulate(on_failure="ignore"), ""
    except AccuracyError as refused:
        if refused.solution is None:
            raise
        return refused.solution, str(refused)


def takes_time(solution: Solution) -> bool:
    """Return whether a run went on for long enough to draw curves of it."""
    start, end = float(solution.t[0]), float(solution.t[-1])
    return abs(end - start) > VISIBLE * max(abs(start), abs(end))


def numerical_solution(
    derivation: Algebra, solution: Solution, figures: Figures, refusal: str = ""
) -> dict[str, Any]:
    """Return how the equations were integrated, and with what result."""
    complaints, moves = [], takes_time(solution)
    if not solution.success:
        complaints.append(f"**The run is not complete: {solution.message}**")
    elif solution.status == "event":
        complaints.append(f"The run is {solution.message}.")
    if refusal:
        complaints.append(f"**The run is not shown to be as exact as asked for: {refusal}.**")
    if not moves:
        complaints.append("It ends where it starts: there are no curves to draw.")
    return {
        "method": how(solution),
        "complaints": [Paragraph(words) for words in complaints],
        "angles": [figures.angles(solution)] if moves else [],
        "table": [_table(derivation, solution)] if moves else [],
        "reactions": [figures.reactions(solution)] if moves else [],
        "largest": _largest(derivation, solution) if moves else "",
    }


def how(solution: Solution) -> str:
    """Return the method and its settings in words."""
    stats, asked = solution.stats, solution.options
    settings = f"with a fixed step of ${quantity(asked['step'] or 0.0, 's')}$"
    if not asked["step"]:
        relative, absolute = (number(float(np.min(asked[name])), 3) for name in ("rtol", "atol"))
        settings = f"with the tolerances $r = {relative}$ and $a = {absolute}$"
    first, _, other = solution.method.partition("-")
    words = METHODS.get(first, f"the method `{first}`")
    words += ", and by Radau IIA where the equations are stiff" if other else ""
    counts = f"{stats.accepted} steps, {stats.nfev} evaluations of the right-hand side"
    return f"{words}, {settings}: {counts}"


def _table(derivation: Algebra, solution: Solution) -> Table:
    s, write = derivation.symbols, derivation.symbols.latex
    with_rates = derivation.n <= MOST_WITH_RATES
    head = ["$t$ (s)", *(f"${write(x)}$ (deg)" for x in s.q)]
    head += [f"${write(x)}$ (rad/s)" for x in s.qd] if with_rates else []
    rows = []
    for k in np.unique(np.linspace(0, len(solution.t) - 1, ROWS).round().astype(int)):
        cells = [f"{solution.t[k]:.4g}", *(f"{x:z.3f}" for x in np.degrees(solution.q[k]))]
        cells += [f"{x:z.4f}" for x in solution.qd[k]] if with_rates else []
        rows.append(tuple(f"${cell}$" for cell in cells))
    return Table(tuple(head), tuple(rows), "r" * len(head))


def _balance(solution: Solution) -> tuple[float, float, float]:
    """Return the energy at the start, the largest error of its balance, the largest T, J."""
    energy = solution.energy()
    left = energy.total - energy.total[0] if energy.ledger is None else energy.ledger["residual"]
    return float(energy.total[0]), float(np.abs(left).max()), float(energy.kinetic.max())


def _largest(derivation: Algebra, solution: Solution) -> str:
    digits = min(solution.trusted_digits(), 4)
    sentences = []
    for one in solution.largest_reactions():
        name = derivation.symbols.latex(derivation.equations.forces[one.joint - 1][0])
        before = "just before" if one.just_before else "at"
        when = "throughout" if one.steady else f"{before} $t = {quantity(one.t, 's', 4)}$"
        force = quantity(float(f"{one.force:.{digits - 1}e}"), "N", 4)
        sentences.append(rf"$|\mathbf{{F}}{name[1:].replace('x}', '}')}| = {force}$ {when}")
    return f"The largest reactions are {', '.join(sentences)}."


def energy_check(derivation: Algebra, solution: Solution, figures: Figures) -> dict[str, Any]:
    """Return the energies in symbols, and how well the run kept them."""
    energy, moves = solution.energy(), takes_time(solution)
    rate = r"\frac{\mathrm{d}}{\mathrm{d}t}(T + V)" + (r" - \sum_k P_k" if energy.ledger else "")
    exactly, kept, rows = "", "The run ends where it starts: there is nothing to compare.", []
    if derivation.energy_rate() == 0:
        exactly = (
            f"With the equations of motion put in, SymPy reduces ${rate}$ to 0: exactly, for all "
            "angles, rates and parameters. What is left in the run is its error."
        )
    if moves:
        start, left, moving = _balance(solution)
        moving = Scales(derivation).shown(moving, "J")
        kept = (
            f"In the run, $T + V$ is ${quantity(start, 'J')}$ at the start; "
            f"{'the balance with all work' if energy.ledger else 'it'} stays within "
            f"${quantity(left, 'J', 2)}$, and the largest kinetic energy is "
            f"${quantity(moving, 'J')}$."
        )
    if moves and energy.ledger is not None:
        rows = [("change of $T + V$", f"${number(float(energy.total[-1] - energy.total[0]))}$")]
        for name, entry in energy.ledger.items():
            kind = f"lost: {name}" if name in LOSSES else f"work done: {name}"
            words = "left over" if name == "residual" else kind
            rows.append((words, f"${number(float(entry[-1]))}$"))
    return {
        "exactly": exactly,
        "kept": kept,
        "work": [Table(("from start to end", "J"), tuple(rows), "lr")] if rows else [],
        "energies": [figures.energies(solution)] if moves else [],
    }
