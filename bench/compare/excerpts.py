"""The few figures of the textbook's record that the README and docs/background/trust.md quote.

They stand between a pair of comments that name them, and are written anew with the record.
"""

from __future__ import annotations

import sys
from pathlib import Path

from equal_error import OUTER_SIDES, compare
from record import Record
from solve_tables import at_tolerance, per_evaluation
from tables import NONE, number, power, short, table

sys.path.append(str(Path(__file__).parents[2] / "docs/generators"))

from page_part import rewrite

CORE, PYTHON = "pendcore_dopri5_cpp", "pendcore_dopri5"
ERRORS = (1e-3, 1e-6, 1e-9, 1e-12)


def figures(record: Record) -> str:
    """Sum up accuracy and speed: a row for each achieved error, then the cost of a call."""
    who = record.taking_part()
    rows = []
    for error in ERRORS:
        cells = [f"{power(error)} of the length"]
        for side in OUTER_SIDES:
            found = compare(who, side, [error])
            for best in (found[0].own, found[0].peer) if found else (None, None):
                cells.append(f"{number(best[0])} us, {short(best[1])}" if best else NONE)
        rows.append([cell.replace("pendcore ", "") for cell in cells])
    known = {one["name"]: one for one in who}
    call, core = (number(known[name]["one_step"]["minimum_us"]) for name in (PYTHON, CORE))
    each = number(per_evaluation(at_tolerance(known[CORE], 1e-9)))
    machine = record.measured["machine"]
    header = ["largest position error", "C++", "best peer", "`pc.simulate`", "best peer"]
    return (
        f"{table(header, rows)}\n"
        f"* A right-hand side, all in: {each} ns. A call of one step: {core} us in C++, {call} us "
        f"from Python.\n\nOn one core of {machine['processor']}, with "
        f"{machine['instruction set of pendcore']}.\n"
    )


def tolerances(record: Record) -> str:
    """Tabulate the errors that tolerances give with dopri5."""
    core = next(one for one in record.taking_part() if one["name"] == CORE)
    points = {decade: at_tolerance(core, 10.0**-decade) for decade in range(3, 14, 2)}
    rows = [[f"1e-{k}", f"{at['error']:.0e}", str(at["evaluations"])] for k, at in points.items()]
    header = ["rtol = atol", "largest position error / total length", "right-hand sides"]
    return table(header, rows)


EXCERPTS = {
    "README.md": ("figures", figures),
    "docs/background/trust.md": ("tolerances", tolerances),
}


def write(project: Path, record: Record) -> None:
    """Bring the documents up to date with the record."""
    for document, (name, excerpt) in EXCERPTS.items():
        rewrite(project / document, **{name: excerpt(record)})
