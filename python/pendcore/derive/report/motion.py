"""The numerical solution: method, table, curves, largest reactions, and the check by energy."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import AutoMinorLocator

from pendcore import AccuracyError, Case, Solution
from pendcore.derive.derivation import Derivation
from pendcore.derive.document import Drawing, Paragraph, Table
from pendcore.derive.report.pictures import lettering
from pendcore.derive.report.quantities import Scales, number, quantity
from pendcore.messages import Floats
from pendcore.plotting import LIGHT, new_axes, theme_of
from pendcore.plotting.axes import Request
from pendcore.plotting.over_time import Curves, draw_curves, in_colors

POINTS = 1201
"""The number of times at which curves are drawn."""
MOST_WITH_RATES = 3
"""The most links for which the table has the rates too: with more it is wider than a page."""
ROWS = 11
"""The number of times that the table shows."""
VISIBLE = 1e-9
"""The least time that a run takes if its curves are drawn, as a share of the times themselves."""
MOST_TICKS = 7
"""The largest number of ticks on an axis that is drawn into by hand."""
OF_LINKS = "The angles of the links over time."

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


def solved(case: Case) -> tuple[Solution, str]:
    """Run a case so that it can be drawn; return also why its error was refused, if it was."""
    start, end = case.t_span
    if start == end:
        raise ValueError(f"t_span = {case.t_span}: a report draws curves: let the run take time")
    found = _at_times_until(end, case)
    reached = found[0].t_reached
    return found if reached == end else _at_times_until(reached, case)


def _at_times_until(end: float, case: Case) -> tuple[Solution, str]:
    """Run a case and keep its states at times spread until then, with a ledger if work is done."""
    start = case.t_span[0]
    times = np.unique(np.linspace(start, end, POINTS))[:: 1 if end >= start else -1]
    options: dict[str, Any] = {**case.options, "store": "dense", "t_eval": tuple(times.tolist())}
    options |= {"ledger": True} if does_work(case) else {}
    try:
        return replace(case, options=options).simulate(on_failure="ignore"), ""
    except AccuracyError as refused:
        if refused.solution is None:
            raise
        return refused.solution, str(refused)


def takes_time(solution: Solution) -> bool:
    """Return whether a run went on for long enough to draw curves of it."""
    start, end = float(solution.t[0]), float(solution.t[-1])
    return abs(end - start) > VISIBLE * max(abs(start), abs(end))


def numerical_solution(derivation: Derivation, solution: Solution, refusal: str) -> dict[str, Any]:
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
        "angles": [angles(solution)] if moves else [],
        "table": [_table(derivation, solution)] if moves else [],
        "reactions": [reactions(derivation, solution)] if moves else [],
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


def _table(derivation: Derivation, solution: Solution) -> Table:
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


def _largest(derivation: Derivation, solution: Solution) -> str:
    digits = min(solution.trusted_digits(), 4)
    sentences = []
    for one in solution.largest_reactions():
        name = derivation.symbols.latex(derivation.equations.forces[one.joint - 1][0])
        before = "just before" if one.just_before else "at"
        when = "throughout" if one.steady else f"{before} $t = {quantity(one.t, 's', 4)}$"
        force = quantity(float(f"{one.force:.{digits - 1}e}"), "N", 4)
        sentences.append(rf"$|\mathbf{{F}}{name[1:].replace('x}', '}')}| = {force}$ {when}")
    return f"The largest reactions are {', '.join(sentences)}."


def energy_check(derivation: Derivation, solution: Solution) -> dict[str, Any]:
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
        start, ledger = float(energy.total[0]), energy.ledger
        left = energy.total - start if ledger is None else ledger["residual"]
        moving = Scales(derivation).shown(float(energy.kinetic.max()), "J")
        kept = (
            f"In the run, $T + V$ is ${quantity(start, 'J')}$ at the start; "
            f"{'the balance with all work' if ledger else 'it'} stays within "
            f"${quantity(float(np.abs(left).max()), 'J', 2)}$, and the largest kinetic energy is "
            f"${quantity(moving, 'J')}$."
        )
    if moves and energy.ledger is not None:
        rows = [("change of $T + V$", f"${number(float(energy.total[-1] - energy.total[0]))}$")]
        for name, entry in energy.ledger.items():
            kind = "lost" if name in energy.ledger.losses else "work done"
            words = "left over" if name == "residual" else f"{kind}: {name}"
            rows.append((words, f"${number(float(entry[-1]))}$"))
    return {
        "exactly": exactly,
        "kept": kept,
        "work": [Table(("from start to end", "J"), tuple(rows), "lr")] if rows else [],
        "energies": [energies(solution)] if moves else [],
    }


@lettering
def angles(solution: Solution) -> Drawing:
    """Draw the textbook's figure, the angles over time."""
    figure, axes = _sheets(solution.q.shape[1])
    solution.plot(ax=axes)
    return Drawing("angles", OF_LINKS, figure)


@lettering
def empty_axes(solution: Solution) -> Drawing:
    """Draw the axes of the angles with nothing in them: the scale gives nothing away."""
    span = solution.t[0], solution.t[-1]
    if span[0] == span[1]:  # a run that failed at once
        span = solution.t_span
    figure, axes = _sheets(solution.q.shape[1])
    for i, axis in enumerate(axes, start=1):
        low, high, step = whole_ticks(np.degrees(solution.q[:, i - 1]))
        axis.set(xlim=span, ylim=(low, high), ylabel=f"$q_{{{i}}}$ (deg)")
        axis.set_yticks(np.arange(low, high + 1.0, step))
        axis.set_yticks(np.arange(low, high + 1.0, step / 3.0), minor=True)
        axis.xaxis.set_minor_locator(AutoMinorLocator(5))
        axis.grid(True, which="major", color=LIGHT.lost, linewidth=0.6)
        axis.grid(True, which="minor", color=LIGHT.line, linewidth=0.5)
    return Drawing("axes", OF_LINKS, figure)


@lettering
def reactions(derivation: Derivation, solution: Solution) -> Drawing:
    """Draw the joint forces as the derivation has them: F_01, F_21, ..."""
    forces = solution.reactions().copy()
    forces[:, 1:] *= -1  # F_12 is the core's, F_21 the derivation's
    figure, axes = _sheets(derivation.n, 2.4)
    panels: dict[str, Curves] = {}
    for pair, (x, y) in zip(derivation.equations.forces, forces.transpose(1, 2, 0), strict=True):
        along_x, along_y = map(derivation.symbols.latex, pair)
        name = along_x.replace("x}", "}")
        size = rf"$|\mathbf{{F}}{name[1:]}|$"
        parts = {f"${along_x}$": x, f"${along_y}$": y, size: np.hypot(x, y)}
        panels[f"${name}$ (N)"] = in_colors(parts, theme_of(axes[0]), [size])
    draw_curves(Request(solution=solution), axes, solution.t, panels)
    words = "The joint reactions over time; $y$ points down, so a force upward is negative."
    return Drawing("reactions", words, figure)


@lettering
def energies(solution: Solution) -> Drawing:
    """Draw the energies, and what their balance leaves over."""
    energy = solution.energy()
    parts = {"$T$": energy.kinetic, "$V$": energy.potential, "$T + V$": energy.total}
    left, less = energy.total - energy.total[0], ""
    if energy.ledger is not None:
        left, less = energy.ledger["residual"], " less all work"
    figure, axes = _sheets(2, 2.4)
    theme = theme_of(axes[0])
    curves = {"energy (J)": in_colors(parts, theme, ["$T + V$"])}
    curves["balance (J)"] = {"balance": (left, theme.ink)}
    draw_curves(Request(solution=solution), axes, solution.t, curves)
    words = (
        "Above: kinetic, potential and total energy over time. Below: the change of $T + V$ "
        f"since the start{less}, which should be zero."
    )
    return Drawing("energies", words, figure)


def _sheets(rows: int, height: float = 2.1) -> tuple[Figure, list[Axes]]:
    """Return a figure with axes one below the other."""
    axes = new_axes((6.6, max(3.0, height * rows)), rows, new_figure=Figure)
    axes[-1].set_xlabel("t (s)")
    figure: Any = axes[0].figure
    return figure, axes


def whole_ticks(angles: Floats) -> tuple[float, float, float]:
    """Return ends and step of an axis for angles, deg: at most seven ticks, at whole 30 degrees."""
    for step in (30.0, 45.0, 90.0, 180.0, *(360.0 * 2.0 ** np.arange(20))):
        low = step * np.floor(min(0.0, float(angles.min())) / step)
        high = step * np.ceil(max(90.0, float(angles.max()) + 0.05 * step) / step)
        if (high - low) / step <= MOST_TICKS - 1:
            break
    return float(low), float(high), float(step)
