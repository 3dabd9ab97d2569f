"""`make campaign OF=derivatives`: sensitivities through impacts, stick and release, by the hundred.

    PYTHONPATH=tests:tests/models python -m derivatives.campaign --seeds 0:300
    PYTHONPATH=tests:tests/models python -m derivatives.campaign --seeds 51:52    # that one

A run whose derivative is wrong is listed, and so is one whose end is not that of the reference: the
exit status is then 1. A run may be refused, and says why, or only some names by name; some have no
reference. From seed 300 on, some motors have tables, and some joints rest at the start.
"""

from __future__ import annotations

import argparse
import sys
from typing import NamedTuple

import numpy as np
from tqdm import tqdm

from derivatives.hybrid_runs import by_complex_numbers, by_pendcore, drawn

ALLOWED = 1e-8
"""A share of the largest entry: of derivatives, and of states, that both are of the same motion."""


class Verdict(NamedTuple):
    """What one run came to: its error as a share of the largest entry, and what was said of it."""

    seed: int
    events: int
    names: int
    """How many of its names were refused, while others were not."""
    error: float
    kind: str  # "right", "refused", "wrong", "another motion" or "no reference"
    told: str


def judged(seed: int) -> Verdict:
    """Hold a run against the reference."""
    case = drawn(seed)
    end, columns, why = by_pendcore(case)
    is_there = np.isfinite(columns).all(axis=0)
    names = [name for name, there in zip(case.changes, is_there, strict=True) if not there]
    if names and not why:
        return Verdict(seed, 0, len(names), np.nan, "wrong", "no derivative, in silence")
    if not is_there.any():
        return Verdict(seed, 0, 0, np.nan, "refused", why)
    if any(f'"{name}"' not in why for name in names):
        return Verdict(seed, 0, len(names), np.nan, "wrong", f"names that are not told: {why}")
    changes = {name: by for name, by in case.changes.items() if name not in names}
    found = columns[:, is_there] @ [*changes.values()]
    verdict = Verdict(seed, 0, 0, np.nan, "no reference", "it cannot tell what is held")
    for step in (0.02, 0.005, 0.00125):
        try:
            right_end, right, events = by_complex_numbers(case, changes, step)
        except (AssertionError, OverflowError, np.linalg.LinAlgError):
            continue
        error = float(np.abs(found - right).max() / max(1.0, np.abs(right).max()))
        is_same = np.abs(end - right_end).max() <= ALLOWED * max(1.0, np.abs(right_end).max())
        kind = "another motion" if not is_same else "right" if error <= ALLOWED else "wrong"
        verdict = Verdict(seed, len(events), len(names), error, kind, " ".join(events))
        if kind == "right":
            break
    return verdict


def main(arguments: list[str] | None = None) -> int:
    """Run a campaign."""
    parser = argparse.ArgumentParser(prog="derivatives.campaign")
    parser.add_argument("--seeds", default="0:300", metavar="FIRST:END")
    first, end = map(int, parser.parse_args(arguments).seeds.split(":"))
    verdicts = []
    for seed in tqdm(range(first, end), disable=None):
        verdicts.append(one := judged(seed))
        if one.kind != "right":
            print(f"seed {one.seed}: {one.kind} ({one.error:.1e}): {one.told}", flush=True)
    right = [one for one in verdicts if one.kind == "right"]
    print(
        f"{len(right)} of {len(verdicts)} right, with {sum(one.events for one in right)} events; "
        f"the worst is {max((one.error for one in right), default=0.0):.1e} off, "
        f"the median {np.median([one.error for one in right] or [0.0]):.1e}"
    )
    refused = sum(one.kind == "refused" for one in verdicts)
    names = sum(one.names for one in verdicts)
    print(f"{refused} were refused; at most a tenth may be; {names} names of others were")
    is_wrong = any(one.kind in {"wrong", "another motion"} for one in verdicts)
    return 1 if is_wrong or refused > 0.1 * len(verdicts) else 0


if __name__ == "__main__":
    sys.exit(main())
