"""`make campaign OF=errors`: scenes by the thousand, each held against a reference of more digits.

    PYTHONPATH=tests python -m true_error.campaign --family mixed --seeds 0:5000 --workers 2
    PYTHONPATH=tests python -m true_error.campaign --family mixed --seeds 4711:4712    # that one

Every scene is bounded in time. What breaks a claim is listed with the command that repeats it; the
exit status is then 1.
"""

from __future__ import annotations

import argparse
import datetime
import json
import multiprocessing
import platform
import sys
import time
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import heyoka
import pendcore as pc
from tqdm import tqdm

from true_error.families import FAMILIES
from true_error.judge import SECONDS, Verdict, judged
from true_error.report import broken, markdown, offenders, record_of

sys.path.append(str(Path(__file__).parents[2] / "docs/generators"))

from page_part import rewrite


def main(arguments: list[str] | None = None) -> int:
    """Run a campaign."""
    parser = argparse.ArgumentParser(prog="true_error.campaign", description=__doc__.split("\n")[0])
    parser.add_argument("--family", action="append", choices=FAMILIES, help="default: all")
    parser.add_argument("--seeds", type=seeds, default=range(100), metavar="FIRST:END")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--seconds", type=float, default=SECONDS, help="for each answer of a scene")
    parser.add_argument("--output", type=Path, help="JSON with a verdict for each scene")
    parser.add_argument("--record", type=Path, help="JSON with what the families came to")
    parser.add_argument("--page", type=Path, help="the page that shows what they came to")
    asked = parser.parse_args(arguments)
    began = time.monotonic()
    names = asked.family or list(FAMILIES)
    found: dict[str, list[Verdict]] = {name: [] for name in names}
    for verdict in verdicts(names, asked.seeds, asked.workers, asked.seconds):
        found[verdict.family].append(verdict)
    record = {
        "seeds": [asked.seeds.start, asked.seeds.stop],
        "seconds": round(time.monotonic() - began),
        "workers": asked.workers,
        "pendcore": pc.__version__,
        "heyoka": heyoka.__version__,
        "machine": platform.machine(),
        "date": datetime.datetime.now(datetime.UTC).date().isoformat(),
        "families": {name: record_of(of_it) for name, of_it in found.items()},
    }
    print(offenders(found))
    print(markdown(record))
    scenes = [
        verdict.record()
        for of_it in found.values()
        for verdict in sorted(of_it, key=lambda verdict: verdict.seed)
    ]
    for path, content in ((asked.output, scenes), (asked.record, record)):
        if path:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(json.dumps(content, indent=1) + "\n")
    if asked.page:
        rewrite(asked.page, true_error=markdown(record))
    failures = [f"{name}: {claim}" for name, of_it in found.items() for claim in broken(of_it)]
    print(*failures, sep="\n")
    return 1 if failures else 0


def seeds(text: str) -> range:
    """Return the seeds that FIRST:END says, the end left out."""
    first, end = map(int, text.split(":"))
    return range(first, end)


def verdicts(
    families: Iterable[str], numbers: Iterable[int], workers: int = 1, seconds: float = SECONDS
) -> Iterator[Verdict]:
    """Return what became of each seed of each family, as they come."""
    cases = [(name, seed, seconds) for seed in numbers for name in families]
    shown: dict[str, Any] = {"total": len(cases), "unit": "scene", "disable": None}
    if workers == 1:
        yield from tqdm(map(of_case, cases), **shown)
        return
    with multiprocessing.get_context("spawn").Pool(workers) as pool:
        yield from tqdm(pool.imap_unordered(of_case, cases, chunksize=4), **shown)


def of_case(case: tuple[str, int, float]) -> Verdict:
    """Return what became of the scene of a family's seed."""
    family, seed, seconds = case
    return judged(FAMILIES[family](seed), seconds=seconds)


if __name__ == "__main__":
    sys.exit(main())
