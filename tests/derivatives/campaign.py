"""`make campaign OF=derivatives`: sensitivities of random runs, by the hundred.

    PYTHONPATH=tests:tests/models python -m derivatives.campaign hybrid --seeds 0:300
    PYTHONPATH=tests:tests/models python -m derivatives.campaign hybrid --seeds 51:52    # that one
    PYTHONPATH=tests:tests/models python -m derivatives.campaign smooth --seeds 0:1000

Hybrid runs go through impacts, stick and release; smooth ones have all other effects. A run whose
derivative is wrong is listed, and so is one whose end is not that of the reference: the exit status
is then 1. A run may be refused, and says why, or only some names by name; some have no reference.
From seed 300 on, some motors of hybrid runs have tables, and some joints rest at the start. Smooth
runs of odd seeds are in air.
"""

from __future__ import annotations

import argparse
import sys
from typing import NamedTuple

import numpy as np
from tqdm import tqdm

from derivatives import hybrid_runs, smooth_runs
from derivatives.random_run import by_pendcore

ALLOWED = 1e-8
"""A share of the largest entry: of derivatives, and of states, that both are of the same motion."""
ALLOWED_IF_SMOOTH = 1e-12
"""Errors of smooth runs are shares of the largest entry by a name, or by the start if larger."""

LOOKS = [(1e-16, 0.02), (1e-19, 0.001)]
"""Tolerance and longest step, s, of the reference of a smooth run: a second look if it is wrong."""


class Verdict(NamedTuple):
    """What one run came to: its error as a share of the largest entry, and what was said of it."""

    seed: int
    events: int
    names: int
    """How many of its names were refused, while others were not."""
    error: float
    kind: str  # "right", "refused", "wrong", "another motion" or "no reference"
    told: str


def judged_smooth(seed: int) -> Verdict:
    """Hold a smooth run against differences in many digits."""
    case = smooth_runs.drawn(seed)
    end, columns, why = by_pendcore(case, rtol=1e-14, atol=1e-17)
    sizes = dict(zip(case.changes, np.abs(columns).max(axis=0), strict=True))
    names = [name for name, size in sizes.items() if np.isfinite(size)]
    refused = len(sizes) - len(names)
    if not names:
        return Verdict(seed, 0, 0, np.nan, "refused", why)
    if any(f'"{name}"' not in why for name in {*sizes} - {*names}):
        return Verdict(seed, 0, refused, np.nan, "wrong", f"names that are not told: {why}")
    transition = max(sizes[name] for name in names if name.startswith("q"))
    changes = {name: case.changes[name] / max(sizes[name], transition) for name in names}
    found = columns[:, np.isfinite(columns).all(axis=0)] @ [*changes.values()]
    verdict = Verdict(seed, 0, refused, np.nan, "no reference", "a bend may only be touched")
    for how in LOOKS:
        try:
            right_end, right = smooth_runs.by_differences(case, changes, *how)
        except AssertionError:
            continue
        error = float(np.abs(found - right).max())
        off = float(np.abs(end - right_end).max() / max(1.0, np.abs(right_end).max()))
        if off > ALLOWED:
            kind = "another motion"
        else:
            kind = "right" if error <= ALLOWED_IF_SMOOTH else "wrong"
        verdict = Verdict(seed, 0, refused, error, kind, f"the end itself is {off:.1e} off. {why}")
        if kind == "right":
            break
    return verdict


def judged(seed: int) -> Verdict:
    """Hold a hybrid run against the reference in complex numbers."""
    case = hybrid_runs.drawn(seed)
    end, columns, why = by_pendcore(case, rtol=1e-13, atol=1e-15)
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
            right_end, right, events = hybrid_runs.by_complex_numbers(case, changes, step)
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
    parser.add_argument("runs", choices=["hybrid", "smooth"])
    parser.add_argument("--seeds", default="0:300", metavar="FIRST:END")
    told = parser.parse_args(arguments)
    first, end = map(int, told.seeds.split(":"))
    verdicts = []
    for seed in tqdm(range(first, end), disable=None):
        verdicts.append(one := (judged if told.runs == "hybrid" else judged_smooth)(seed))
        if one.kind != "right" or one.names:
            print(f"seed {one.seed}: {one.kind} ({one.error:.1e}): {one.told}", flush=True)
    if right := [one for one in verdicts if one.kind == "right"]:
        errors, events = [one.error for one in right], sum(one.events for one in right)
        print(
            f"{len(right)} of {len(verdicts)} right, with {events} events; "
            f"the worst is {max(errors):.1e} off, the median {np.median(errors):.1e}"
        )
    refused = sum(one.kind == "refused" for one in verdicts)
    names = sum(one.names for one in verdicts)
    print(f"{refused} were refused; at most a tenth may be; {names} names of others were")
    is_wrong = any(one.kind in {"wrong", "another motion"} for one in verdicts)
    return 1 if is_wrong or refused > 0.1 * len(verdicts) else 0


if __name__ == "__main__":
    sys.exit(main())
