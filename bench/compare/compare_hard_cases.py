"""Run the hard cases in pendcore and its peers, and write the results.

This writes docs/records/hard_cases.json, docs/background/hard_cases.md and the page's figures,
docs/figures/hard_cases_*.png.
`make hard-cases` builds what is needed and calls this; by hand:

    python bench/compare/compare_hard_cases.py                 some minutes
    python bench/compare/compare_hard_cases.py --only bounces  that case, the others as recorded
    python bench/compare/compare_hard_cases.py --redraw        page and figures from the JSON
"""

from __future__ import annotations

import argparse
import datetime
import json
import sys
from collections.abc import Sequence
from importlib import metadata
from math import isfinite
from pathlib import Path
from typing import Any

PROJECT = Path(__file__).parents[2]
sys.path += [
    str(PROJECT / "tests"),
    str(PROJECT / "tests/models"),
]  # references that share no code with the core

from hard_cases import figures, page  # noqa: E402
from hard_cases.case import Absent, HardCase, run_bounded  # noqa: E402
from hard_cases.cases import CASES  # noqa: E402
from machine import machine  # noqa: E402
from tqdm import tqdm  # noqa: E402

Record = dict[str, Any]
FACTS = ("name", "title", "scene", "answer", "unit", "figure", "loop_not_run")


def rounded(curves: Any) -> dict[str, list[float]]:
    return {name: [float(f"{x:.6g}") for x in curve] for name, curve in curves.items()}


def measure(case: HardCase) -> Record:
    """Run a case in all programs; return its record for JSON. Name absent programs on stderr."""
    known = rounded(case.reference())
    contenders = []
    for one in case.contenders:
        try:
            outcome = run_bounded(one.run)
        except Absent as absence:
            print(f"{case.name}: {one.program}: {absence}", file=sys.stderr)
            continue
        error = None if outcome.error is None else float(outcome.error)
        right = outcome.right
        if right is None:
            right = error is not None and error <= case.allowed
        contenders.append(
            {
                "program": one.program,
                "how": one.how,
                "own_loop": one.own_loop,
                "error": error if error is not None and isfinite(error) else None,
                "said": outcome.said,
                "right": bool(right),
                "trace": rounded(outcome.trace),
            }
        )
    facts = {name: getattr(case, name) for name in FACTS}
    return {**facts, "allowed": case.allowed, "reference": known, "contenders": contenders}


def versions() -> dict[str, str]:
    """Name the versions that took part; the version of Boost comes from its headers."""
    found = {}
    for name, distribution in (("SciPy", "scipy"), ("MuJoCo", "mujoco-core")):
        try:
            found[name] = metadata.version(distribution)
        except metadata.PackageNotFoundError:
            found[name] = "not installed"
    from hard_cases.odeint import ask

    try:
        found["Boost"] = next(iter(ask("version"))).replace("_", ".")
    except (ImportError, RuntimeError, StopIteration):
        found["Boost"] = "not built"
    return {**found, "pendcore": metadata.version("pendcore")}


def arguments(given: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument(
        "--only", nargs="+", choices=[case.name for case in CASES], help="these cases anew"
    )
    parser.add_argument("--redraw", action="store_true", help="run nothing, read the JSON")
    parser.add_argument("--output", type=Path, default=PROJECT / "docs", help="in place of docs")
    return parser.parse_args(given)


def run(asked: argparse.Namespace, raw: Path) -> Record:
    before: Record = json.loads(raw.read_text(encoding="utf-8")) if raw.exists() else {"cases": []}
    if asked.redraw:
        return before
    known = {case["name"]: case for case in before["cases"]}
    chosen = [case for case in CASES if not asked.only or case.name in asked.only]
    for case in tqdm(chosen, desc="hard cases", disable=None):
        known[case.name] = measure(case)
    return {
        "date": datetime.datetime.now(datetime.UTC).date().isoformat(),
        "machine": machine(),
        "versions": versions(),
        "cases": [known[case.name] for case in CASES if case.name in known],
    }


def main(given: Sequence[str] | None = None) -> int:
    asked = arguments(given)
    raw = asked.output / "records/hard_cases.json"
    written = asked.output / "background/hard_cases.md"
    try:
        record = run(asked, raw)
    except KeyboardInterrupt:
        print("stopped; nothing was written", file=sys.stderr)
        return 130
    for path in (raw, written):
        path.parent.mkdir(parents=True, exist_ok=True)
    raw.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    written.write_text(page.page(record), encoding="utf-8")
    figures.draw(record, asked.output / "figures")
    print(page.glance(record))
    print(page.summary(record))
    return 0


if __name__ == "__main__":
    sys.exit(main())
