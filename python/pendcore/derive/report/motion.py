"""The numerical solution: method, table, curves, largest reactions, and the check by energy."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from pendcore._cases.case import Case
from pendcore._run.accuracy import AccuracyError
from pendcore._run.energy import LOSSES
from pendcore._run.solution import Solution
from pendcore.derive.algebra import Algebra
from pendcore.derive.report.document import Block, Heading, Paragraph, Table
from pendcore.derive.report.figures import Figures
from pendcore.derive.report.quantities import number, quantity
from pendcore.derive.report.scales import Scales

POINTS = 1201
"""The number of times at which curves are drawn."""
MOST_WITH_RATES = 3
"""The most links for which the table has the rates too: with more it is wider than a page."""
AT_REST = 1e-13
"""Share of weights times lengths below which a kinetic energy comes from rounding."""
ROWS = 11
"""The number of times that the table shows."""
DIGITS_OF_A_FORCE = 4
"""The number of digits of the largest reactions, where the run is that exact."""
VISIBLE = 1e-9
"""The least time that a run takes if its curves are drawn, as a share of the times themselves."""

METHODS = {
    "dopri5": "Dormand and Prince's method of order 5, that of MATLAB's `ode45`",
    "dop853": "Dormand and Prince's method of order 8",
    "taylor": "Taylor series",
    "radau5": "Radau IIA, an implicit method of order 5",
    "rk4": "the classical Runge-Kutta method of order 4",
}
"""Methods in words; for a pair, such as `taylor-radau5`, the first of the two."""


def solved(case: Case) -> Solution:
    """Run a case so that it can be drawn, with a ledger if its effects do work."""
    return solved_or_refused(case)[0]


def solved_or_refused(case: Case) -> tuple[Solution, str]:
    """Run a case as `solved` does; return also why its error was refused, if it was."""
    start, end = case.t_span
    if start == end:
        raise ValueError(f"t_span = {case.t_span}: a report draws curves: let the run take time")
    options: dict[str, Any] = dict(case.options)
    options.pop("store", None)
    options["store"] = "dense"
    if any(effect.description.account != "none" for effect in case.scene.effects):
        options["ledger"] = True
    found = _at_times_until(end, case, options)
    reached = float(found[0]._run.t_reached)
    return found if reached == end else _at_times_until(reached, case, options)


def _at_times_until(end: float, case: Case, options: dict[str, Any]) -> tuple[Solution, str]:
    """Run a case and keep its states and its ledger at times spread until then."""
    start = case.t_span[0]
    times = np.unique(np.linspace(start, end, POINTS))
    times = times if end >= start else times[::-1]
    spread = Case(
        scene=case.scene, q0=case.q0, qd0=case.qd0, t_span=case.t_span, name=case.name,
        options=options | {"t_eval": tuple(times.tolist())},
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
) -> Iterator[Block]:
    """Yield how the equations were integrated, and with what result."""
    yield Heading(2, "Numerical solution")
    yield Paragraph(_how(solution))
    if not solution.success:
        yield Paragraph(f"**The run is not complete: {solution.message}**")
    elif solution.status == "event":
        yield Paragraph(f"The run is {solution.message}.")
    if refusal:
        yield Paragraph(f"**The run is not shown to be as exact as asked for: {refusal}.**")
    if not takes_time(solution):
        yield Paragraph("It ends where it starts: there are no curves to draw.")
        return
    yield figures.angles(solution)
    yield _table(derivation, solution)
    yield figures.reactions(solution)
    yield Paragraph(_largest(derivation, solution))


def _how(solution: Solution) -> str:
    asked, stats = solution._run.arguments, solution.stats
    step = asked.get("step")
    tolerance = (
        f"with a fixed step of ${quantity(step, 's')}$"
        if step
        else f"with the tolerances $r = {_one(asked['rtol'])}$ and $a = {_one(asked['atol'])}$"
    )
    first, _, other = solution.method.partition("-")
    words = METHODS.get(first, f"the method `{first}`")
    words += ", and by Radau IIA where the equations are stiff" if other else ""
    return (
        f"The first-order system is integrated by {words}, {tolerance}: {stats.accepted} steps, "
        f"{stats.nfev} evaluations of the right-hand side."
    )


def _one(tolerance: Any) -> str:
    return number(float(np.min(tolerance)), 3)


def _table(derivation: Algebra, solution: Solution) -> Table:
    s, write = derivation.symbols, derivation.symbols.latex
    head = ["$t$ (s)", *(f"${write(x)}$ (deg)" for x in s.q)]
    with_rates = derivation.n <= MOST_WITH_RATES
    head += [f"${write(x)}$ (rad/s)" for x in s.qd] if with_rates else []
    chosen = np.unique(np.linspace(0, len(solution.t) - 1, ROWS).round().astype(int))
    rows = []
    for k in chosen:
        cells = [f"{solution.t[k]:.4g}", *(f"{x:z.3f}" for x in np.degrees(solution.q[k]))]
        cells += [f"{x:z.4f}" for x in solution.qd[k]] if with_rates else []
        rows.append(tuple(f"${cell}$" for cell in cells))
    return Table(tuple(head), tuple(rows), "r" * len(head))


def _largest(derivation: Algebra, solution: Solution) -> str:
    digits = min(solution.trusted_digits(), DIGITS_OF_A_FORCE)
    sentences = []
    for one in solution.largest_reactions():
        i = one.joint - 1
        name = derivation.symbols.latex(derivation.equations.forces[i][0]).replace("x}", "}")
        bold = rf"|\mathbf{{F}}{name[1:]}|"
        before = "just before" if one.just_before else "at"
        when = "throughout" if one.steady else f"{before} $t = {quantity(one.t, 's', 4)}$"
        force = quantity(float(f"{one.force:.{digits - 1}e}"), "N", DIGITS_OF_A_FORCE)
        sentences.append(f"${bold} = {force}$ {when}")
    among = "" if solution.store == "dense" else f" among the {len(solution.t)} kept times"
    return f"The largest reactions{among} are {', '.join(sentences)}."


def energy_check(derivation: Algebra, solution: Solution, figures: Figures) -> Iterator[Block]:
    """Yield the energies in symbols, and how well the run kept them."""
    yield Heading(2, "Check by the energy")
    moves = takes_time(solution)
    works = solution.energy().ledger is not None
    rate = r"\frac{\mathrm{d}}{\mathrm{d}t}(T + V)" + (r" - \sum_k P_k" if works else "")
    exactly = derivation.energy_rate() == 0
    yield Paragraph(
        (f"With the equations of motion put in, SymPy reduces ${rate}$ to 0: exactly, for all "
         "angles, rates and parameters. " if exactly else "")
        + ("What is left in the run is its error. " + _kept(derivation, solution) if moves else
           "The run ends where it starts: there is nothing to compare.")
    )  # fmt: skip
    if moves and works:
        yield from _work(solution)
    if moves:
        yield figures.energies(solution)


def _kept(derivation: Algebra, solution: Solution) -> str:
    drift, measure = solution.energy_drift(), Scales(derivation).of["J"]
    words = f"In the run, $T + V$ is ${quantity(drift.start, 'J')}$ at the start"
    if drift.largest_drift is None:
        return words + "."
    what = "the balance with all work" if drift.ledger else "it"
    kept = f"stays within ${quantity(drift.largest_drift, 'J', 2)}$"
    if drift.largest_drift == 0:
        kept = "leaves over nothing at all" if drift.ledger else "does not change in any digit"
    elif drift.relative_drift is not None and drift.largest_kinetic > AT_REST * measure:
        kept += f", ${number(drift.relative_drift, 2)}$ of the largest kinetic energy"
    else:
        kept += "; nothing moves, so there is no kinetic energy to measure this by"
    return f"{words}, and {what} {kept}."


def _work(solution: Solution) -> Iterator[Block]:
    ledger, energy = solution.energy().ledger, solution.energy()
    assert ledger is not None
    rows = [("change of $T + V$", f"${number(float(energy.total[-1] - energy.total[0]))}$")]
    for name, entry in ledger.items():
        words = {"residual": "left over"}.get(
            name, f"lost: {name}" if name in LOSSES else f"work done: {name}"
        )
        rows.append((words, f"${number(float(entry[-1]))}$"))
    yield Table(("from start to end", "J"), tuple(rows), "lr")
