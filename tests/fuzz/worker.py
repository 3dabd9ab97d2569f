"""One process of the campaign: cases one after the other, each told before it begins.

A crash takes this process with it, and the campaign knows of which case. Lines of JSON on standard
output: ``{"begins": 7}``, then ``{"case": 7, "outcome": ..., "breaches": [...], "seconds": ...}``.
"""

from __future__ import annotations

import faulthandler
import json
import sys

from fuzz.verdict import of_seed


def seed_of(campaign: str, case: int) -> str:
    """Return the seed of a case of a campaign."""
    return f"{campaign}/{case}"


def main(campaign: str, first: int, end: int, stride: int) -> None:
    """Run every stride-th case."""
    faulthandler.enable()
    for case in range(first, end, stride):
        print(json.dumps({"begins": case}), flush=True)
        _, verdict = of_seed(seed_of(campaign, case))
        told = {
            "case": case,
            "outcome": verdict.outcome,
            "breaches": verdict.breaches,
            "seconds": verdict.seconds,
        }
        print(json.dumps(told), flush=True)


if __name__ == "__main__":
    main(sys.argv[1], *map(int, sys.argv[2:5]))
