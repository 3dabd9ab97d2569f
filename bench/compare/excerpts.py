"""The few figures of the textbook's record that the README and docs/trust.md quote.

They stand between a pair of comments that name them, and are written anew with the record.
"""

from __future__ import annotations

from pathlib import Path

from tables import (
    CORE,
    CORE_PEERS,
    DECADES,
    PYTHON,
    PYTHON_PEERS,
    Record,
    at_tolerance,
    curve,
    entrants,
    number,
    per_evaluation,
    table,
)
from work_precision import ratios_at


def figures(record: Record) -> str:
    """Sum up accuracy and speed: a row a tolerance, then a sentence a peer."""
    known = entrants(record)
    core, python = known[CORE], known[PYTHON]
    header = ["rtol = atol", "largest position error", "right-hand sides", "C++", "`pc.simulate`"]
    rows = []
    for tolerance in (1e-3, 1e-6, 1e-9, 1e-12):
        point = at_tolerance(core, tolerance)
        rows.append(
            [f"{tolerance:.0e}", f"{point['error']:.0e} of the length", str(point["evaluations"])]
            + [f"{number(at_tolerance(who, tolerance)['minimum_us'])} us" for who in (core, python)]
        )
    lines = [table(header, rows)]
    for peer in CORE_PEERS:
        ratios = ratios_at(curve(core), curve(known[peer]), DECADES).values()
        found = [ratio for ratio in ratios if ratio is not None]
        lines.append(
            f"* C++ against {known[peer]['label']}, at equal achieved error from 1e-2 to 1e-11: "
            f"{min(found):.2f} to {max(found):.2f} of its time."
        )
    for peer in PYTHON_PEERS:
        own, other = (at_tolerance(who, 1e-6)["minimum_us"] for who in (python, known[peer]))
        lines.append(
            f"* `pc.simulate` against {known[peer]['label']}, at rtol 1e-6: "
            f"1/{other / own:.1f} of its time."
        )
    each = per_evaluation(at_tolerance(core, 1e-9))
    call = python["one_step"]["minimum_us"]
    lines.append(
        f"* A right-hand side, all in: {number(each)} ns. A call of one step from Python: "
        f"{number(call)} us."
    )
    return "\n".join(lines) + f"\n\nOn one core of {record['machine']['processor']}.\n"


def tolerances(record: Record) -> str:
    """Tabulate what a tolerance brings."""
    core = entrants(record)[CORE]
    rows = []
    for decade in range(3, 14, 2):
        point = at_tolerance(core, 10.0**-decade)
        rows.append([f"1e-{decade}", f"{point['error']:.0e}", str(point["evaluations"])])
    header = ["rtol = atol", "largest position error / total length", "right-hand sides"]
    return table(header, rows)


EXCERPTS = {"README.md": ("figures", figures), "docs/trust.md": ("tolerances", tolerances)}


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
