"""`make fuzz`: random cases by the hundred thousand, in processes that are watched.

    PYTHONPATH=tests python -m fuzz.campaign --cases 100000 --seed 1
    PYTHONPATH=tests python -m fuzz.campaign --seed 1 --only 4711      # that case again, made small

Every case is bounded in steps and in time. It fails where its process dies or falls silent, and
where it breaks a claim of `fuzz.claims`. The report says what became of them; exit 1 if any failed.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from pathlib import Path
from typing import Any

import pendcore as pc
from tqdm import tqdm

from fuzz import watch
from fuzz.choices import FromSeed
from fuzz.drawn_run import drawn
from fuzz.shrinking import breaches_alone, kind, shrunk
from fuzz.worker import seed_of

WORKER = [sys.executable, "-m", "fuzz.worker"]
SHOWN = 3
"""Cases of one kind of failure that are made small."""


def main(arguments: list[str] | None = None) -> int:
    """Run a campaign, or one case of it."""
    parser = argparse.ArgumentParser(prog="fuzz.campaign", description=__doc__.split("\n")[0])
    parser.add_argument("--cases", type=int, default=10_000)
    parser.add_argument("--first", type=int, default=0, help="number of the first case")
    parser.add_argument("--seed", default="1")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--only", type=int, help="number of one case, to be shown and made small")
    parser.add_argument("--output", type=Path, default=Path("out/fuzz/report.txt"))
    asked = parser.parse_args(arguments)
    if asked.only is not None:
        print(report_of_case(asked.seed, asked.only))
        return 0
    started = time.monotonic()
    outcomes, failed = run(asked.seed, range(asked.first, asked.first + asked.cases), asked.workers)
    head = f"{asked.cases} cases from {asked.first}, seed {asked.seed!r}, pendcore {pc.__version__}"
    report = report_of(head, outcomes, failed, asked.seed, time.monotonic() - started)
    asked.output.parent.mkdir(parents=True, exist_ok=True)
    asked.output.write_text(report)
    print(report)
    return 1 if failed else 0


def run(
    seed: str, cases: range, workers: int = 1, worker: list[str] = WORKER,
    patience: float = watch.HANGS_AFTER,
) -> tuple[Counter[str], list[dict[str, Any]]]:  # fmt: skip
    """Return how often each outcome was, and the cases that failed."""
    outcomes: Counter[str] = Counter()
    failed = []
    told = watch.run([*worker, seed], cases, workers, patience)
    for verdict in tqdm(told, total=len(cases), unit="case", disable=None):
        outcomes[verdict["outcome"]] += 1
        if verdict["breaches"]:
            failed.append(verdict)
    return outcomes, failed


def report_of(
    head: str, outcomes: Counter[str], failed: list[dict[str, Any]], seed: str, seconds: float
) -> str:
    """Return what became of all, and the first failures of each kind made small."""
    lines = [f"{head}: {len(failed)} failed, {seconds:.0f} s", ""]
    lines += [f"{count:8d}  {outcome}" for outcome, count in outcomes.most_common()]
    kinds: dict[str, list[dict[str, Any]]] = {}
    for verdict in sorted(failed, key=lambda verdict: verdict["case"]):
        for one in {kind(breach) for breach in verdict["breaches"]}:
            kinds.setdefault(one, []).append(verdict)
    for one, verdicts in kinds.items():
        numbers = ", ".join(str(verdict["case"]) for verdict in verdicts[:20])
        lines += ["", f"==== {one}: {len(verdicts)} cases: {numbers}"]
        lines += [report_of_case(seed, verdict["case"], one) for verdict in verdicts[:SHOWN]]
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
