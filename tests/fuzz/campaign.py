"""`make campaign OF=fuzz`: random cases by the hundred thousand, in processes that are watched.

    PYTHONPATH=tests:tests/models python -m fuzz.campaign --cases 100000 --seed 1
    PYTHONPATH=tests:tests/models python -m fuzz.campaign --seed 1 --only 4711  # again, made small

Every case is bounded in steps and in time. It fails where its process dies or falls silent, and
where it breaks a claim of `fuzz.claims`. The report says what became of them; exit 1 if any failed.
"""

from __future__ import annotations

import argparse
import datetime
import json
import sys
import time
from collections import Counter
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import pendcore as pc
from tqdm import tqdm

from fuzz import watch
from fuzz.choices import FromSeed
from fuzz.drawn_run import drawn
from fuzz.shrinking import breaches_alone, kind, shrunk
from fuzz.verdict import Verdict, of_number, seed_of

sys.path.append(str(Path(__file__).parents[2] / "docs/generators"))

from page_part import rewrite

FULL = 100_000
"""Cases that a campaign has to have run for the page to be written."""
SHOWN = 3
"""Cases of one kind of failure that are made small."""


@dataclass
class Told:
    """How often each outcome occurred, what failed, and seconds and number of the longest case."""

    outcomes: Counter[str] = field(default_factory=Counter)
    failed: dict[int, Verdict] = field(default_factory=dict)
    longest: tuple[float, int] = (0.0, 0)


def main(arguments: list[str] | None = None) -> int:
    """Run a campaign, or one case of it."""
    parser = argparse.ArgumentParser(prog="fuzz.campaign", description=__doc__.split("\n")[0])
    parser.add_argument("--cases", type=int, default=10_000)
    parser.add_argument("--first", type=int, default=0, help="number of the first case")
    parser.add_argument("--seed", default="1")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--only", type=int, help="number of one case, to be shown and made small")
    parser.add_argument("--output", type=Path, default=Path("out/fuzz/report.txt"))
    parser.add_argument("--page", type=Path, help=f"page of a campaign of {FULL} or more")
    parser.add_argument("--record", type=Path, help="JSON that the page is made of")
    asked = parser.parse_args(arguments)
    if (asked.page is None) != (asked.record is None):
        parser.error("--page and --record need each other")
    if asked.only is not None:
        print(report_of_case(asked.seed, asked.only))
        return 0
    started = time.monotonic()
    told = run(asked.seed, range(asked.first, asked.first + asked.cases), asked.workers)
    seconds = time.monotonic() - started
    head = f"{asked.cases} cases from {asked.first}, seed {asked.seed!r}, pendcore {pc.__version__}"
    report = report_of(head, told, asked.seed, seconds)
    asked.output.parent.mkdir(parents=True, exist_ok=True)
    asked.output.write_text(report)
    if asked.page and asked.cases >= FULL:
        record = record_of(asked, told, seconds)
        asked.record.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
        rewrite(asked.page, campaign=tables(record))
    print(report)
    return 1 if told.failed else 0


def record_of(asked: argparse.Namespace, told: Told, seconds: float) -> dict[str, Any]:
    """Return what is kept of a campaign."""
    return {
        "seed": asked.seed,
        "first": asked.first,
        "cases": told.outcomes.total(),
        "failed": len(told.failed),
        "failures": [*told.failed][:100],
        "outcomes": dict(told.outcomes.most_common()),
        "longest": dict(zip(("seconds", "case"), told.longest, strict=True)),
        "seconds": seconds,
        "workers": asked.workers,
        "pendcore": pc.__version__,
        "date": datetime.datetime.now(datetime.UTC).date().isoformat(),
    }


def tables(record: dict[str, Any]) -> str:
    """Return what stands between the markers of the page."""
    words = {"refused": "refused, with the reason", "not drawn": "not drawn: no such scene can be"}
    seconds, longest = record["longest"]["seconds"], record["longest"]["case"]
    facts = {
        "seed": f"`{record['seed']}`",
        "cases": f"{record['cases']:,}",
        "failed": f"{record['failed']:,}",
        "crashed or hung": f"{sum(record['outcomes'].get(x, 0) for x in ('crash', 'hang')):,}",
        "longest case": f"{seconds:.1f} s (number {longest})",
        "in all": f"{record['seconds']:,.0f} s, {record['workers']} processes",
        "pendcore": record["pendcore"],
        "date": record["date"],
    }
    lines = ["| | |", "|---|---|", *(f"| {name} | {fact} |" for name, fact in facts.items())]
    lines += ["", "| outcome | cases |", "|---|--:|"]
    cases: Counter[str] = Counter()
    for outcome, count in record["outcomes"].items():  # the reason stands after a colon
        cases[outcome.partition(":")[0]] += count
    kinds = Counter(outcome.partition(":")[0] for outcome in record["outcomes"])
    for name, count in cases.most_common():
        text = words.get(name, f"`{name}`" if " " not in name else name)
        of_kinds = f" ({kinds[name]} kinds)" if kinds[name] > 1 else ""
        lines.append(f"| {text}{of_kinds} | {count:,} |")
    if record["failed"]:
        lines += ["", f"Failed: cases {', '.join(map(str, record['failures']))}."]
    return "\n".join(lines) + "\n"


def run(seed: str, cases: range, workers: int = 1) -> Told:
    """Return what became of the cases."""
    found = Told()
    verdicts = watch.run(partial(of_number, campaign=seed), cases, workers)
    told = tqdm(verdicts, total=len(cases), unit="case", disable=None)
    for case, verdict in zip(cases, told, strict=True):
        found.outcomes[verdict.outcome] += 1
        found.longest = max(found.longest, (verdict.seconds, case))
        if verdict.breaches:
            found.failed[case] = verdict
    return found


def report_of(head: str, told: Told, seed: str, seconds: float) -> str:
    """Return what became of all, and the first failures of each kind made small."""
    lines = [f"{head}: {len(told.failed)} failed, {seconds:.0f} s", ""]
    lines += [f"{count:8d}  {outcome}" for outcome, count in told.outcomes.most_common()]
    kinds: dict[str, list[int]] = {}
    for case, verdict in told.failed.items():
        for one in {kind(breach) for breach in verdict.breaches}:
            kinds.setdefault(one, []).append(case)
    for one, cases in kinds.items():
        lines += ["", f"==== {one}: {len(cases)} cases: {', '.join(map(str, cases[:20]))}"]
        lines += [report_of_case(seed, case, one) for case in cases[:SHOWN]]
    return "\n".join(lines) + "\n"


def report_of_case(seed: str, number: int, wanted: str = "") -> str:
    """Return one case as Python, made small if it breaks a claim."""
    own = seed_of(seed, number)
    try:
        case = drawn(FromSeed(own))
    except ValueError as refusal:
        return f"---- case {number}: not drawn: {refusal}"
    breaches = breaches_alone(case, own)
    chosen = [breach for breach in breaches if kind(breach) == wanted] or breaches
    if chosen:
        case = shrunk(case, own, chosen[0])
        breaches = breaches_alone(case, own)
    return "\n".join([f"---- case {number}", *breaches, repr(case)])


if __name__ == "__main__":
    sys.exit(main())
