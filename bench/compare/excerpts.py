"""The few figures of the textbook's record that the README and docs/background/trust.md quote.

They stand between a pair of comments that name them, and are written anew with the record.
"""

from __future__ import annotations

from pathlib import Path

from equal_error import SIDES, Record, compare
from tables import at_tolerance, entrants, number, per_evaluation, power, short, table

CORE, PYTHON = "pendcore_dopri5_cpp", "pendcore_dopri5"
ERRORS = (1e-3, 1e-6, 1e-9, 1e-12)


def figures(record: Record) -> str:
    """Sum up accuracy and speed: a row for each achieved error, then the cost of a call."""
    header = ["largest position error", "C++", "best peer", "`pc.simulate`", "best peer"]
    sides = [SIDES[0], SIDES[-1]]
    rows = []
    for error in ERRORS:
        cells = [f"{power(error)} of the length"]
        for side in sides:
            found = compare(record, side, [error])
            for best in (found[0].own, found[0].peer) if found else (None, None):
                cells.append(f"{number(best[0])} us, {short(best[1])}" if best else "—")
        rows.append([cell.replace("pendcore ", "") for cell in cells])
    known = entrants(record)
    call, core = (known[who]["one_step"]["minimum_us"] for who in (PYTHON, CORE))
    each = per_evaluation(at_tolerance(known[CORE], 1e-9))
    last = (
        f"* A right-hand side, all in: {number(each)} ns. A call of one step: {number(core)} us in "
        f"C++, {number(call)} us from Python."
    )
    on = f"On one core of {record['machine']['processor']}, with " + str(
        record["machine"]["instruction set of pendcore"]
    )
    return f"{table(header, rows)}\n{last}\n\n{on}.\n"


def tolerances(record: Record) -> str:
    """Tabulate the errors that tolerances give with dopri5."""
    core = entrants(record)[CORE]
    rows = []
    for decade in range(3, 14, 2):
        point = at_tolerance(core, 10.0**-decade)
        rows.append([f"1e-{decade}", f"{point['error']:.0e}", str(point["evaluations"])])
    header = ["rtol = atol", "largest position error / total length", "right-hand sides"]
    return table(header, rows)


EXCERPTS = {
    "README.md": ("figures", figures),
    "docs/background/trust.md": ("tolerances", tolerances),
}


def insert(text: str, name: str, excerpt: str) -> str:
    """Replace what stands between the comments of that name."""
    begin, end = f"<!-- {name}: begin -->\n", f"<!-- {name}: end -->"
    before, _, rest = text.partition(begin)
    _, _, after = rest.partition(end)
    return before + begin + excerpt + end + after


def write(project: Path, record: Record) -> None:
    """Bring the documents up to date with the record."""
    for document, (name, excerpt) in EXCERPTS.items():
        path = project / document
        path.write_text(insert(path.read_text(encoding="utf-8"), name, excerpt(record)), "utf-8")
