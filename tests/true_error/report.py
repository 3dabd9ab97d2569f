"""The results of a campaign: counts and shares by family, and scenes that break a claim."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np

from true_error.judge import Verdict

SHARES = (5, 25, 50, 75, 95, 99, 100)
MOST = {
    **dict.fromkeys(("above", "contradicted", "late", "exceptions"), 0.0),
    **dict.fromkeys(("no_reference", "limit_not_known"), 0.02),
    **dict.fromkeys(("unverified", "told_too_little"), 0.01),
}
"""The shares of scenes that may break a claim, or of which that may be said which is no fault."""
MANY = 20
"""The number of scenes from which on at least one is kept and the median tells something."""
MEDIAN = (0.05, 0.8)
"""The bounds between which the median of true over asked has to lie."""
SHOWN = 40
"""Offenders of one kind that are listed."""


def record_of(verdicts: list[Verdict]) -> dict[str, Any]:
    """Return what became of the scenes of a family."""
    outcomes = Counter(verdict.outcome for verdict in verdicts)
    told = Counter(what for verdict in verdicts for what in (*verdict.faults, *verdict.rarities))
    ratios = [v.true / v.asked for v in verdicts if v.outcome == "kept" and v.true is not None]
    return {
        "scenes": len(verdicts),
        "kept": outcomes["kept"],
        "above": told["above"],
        "told_too_little": told["told_too_little"],
        "contradicted": told["contradicted"],
        "late": told["late"],
        "refused": outcomes["refused"],
        "refused_though_doubles_know": sum(map(is_needless, verdicts)),
        "ended_early": outcomes["ended early"],
        "unverified": told["unverified"],
        "exceptions": told["exceptions"],
        "no_reference": told["no_reference"],
        "limit_not_known": told["limit_not_known"],
        "ratios": {
            str(share): round(float(np.percentile(ratios, share)), 4) for share in SHARES if ratios
        },
        "work": sum(verdict.work for verdict in verdicts),
        "seconds": round(sum(verdict.seconds for verdict in verdicts), 1),
        "reference_seconds": round(sum(verdict.reference_seconds for verdict in verdicts), 1),
    }


def is_needless(verdict: Verdict) -> bool:
    """Whether an error was refused that an independent integrator easily keeps in doubles."""
    is_known = verdict.outcome == "refused" and verdict.doubles is not None
    return is_known and 10 * verdict.doubles < verdict.asked


def broken(verdicts: list[Verdict]) -> list[str]:
    """Return the claims that a family breaks."""
    record, count = record_of(verdicts), len(verdicts)
    most = {name: share * count for name, share in MOST.items()}
    most["told_too_little"] = max(1.0, most["told_too_little"])
    found = [
        f"{record[name]} of {count} {name.replace('_', ' ')}"
        for name in MOST
        if record[name] > most[name]
    ]
    if count >= MANY and not record["kept"]:
        found.append("no error was kept: nothing was tested")
    low, high = MEDIAN
    if count >= MANY and record["ratios"] and not low <= record["ratios"]["50"] <= high:
        found.append(f"the median of true over asked is {record['ratios']['50']}")
    return found


def offenders(found: dict[str, list[Verdict]]) -> str:
    """Return the scenes that break a claim, each with what repeats it."""
    lines = []
    for family, verdicts in found.items():
        kinds: dict[str, list[Verdict]] = {}
        for verdict in sorted(verdicts, key=lambda verdict: verdict.seed):
            for kind in verdict.faults or verdict.rarities:
                kinds.setdefault(kind, []).append(verdict)
        for kind, those in kinds.items():
            lines.append(f"==== {family}, {kind.replace('_', ' ')}: {len(those)}")
            lines += map(line_of, those[:SHOWN])
    return "\n".join(lines)


def line_of(verdict: Verdict) -> str:
    """Return what repeats a scene, and what was found: errors as multiples of what was asked."""
    errors = {"true": verdict.true, "told": verdict.achieved, "estimated": verdict.estimated}
    told = [f"{name} {x / verdict.asked:.3g}x" for name, x in errors.items() if x is not None]
    if verdict.first_past is not None:
        told += [f"until {verdict.valid_until}, past {verdict.limit} at {verdict.first_past}"]
    what = f"asked {verdict.asked:.2e}, {', '.join(told)}; {verdict.exception or verdict.says}"
    repeat = f"--family {verdict.family} --seeds {verdict.seed}:{verdict.seed + 1}"
    return f"{repeat}  n = {verdict.n}, {verdict.method}: {what}"[:200]


def markdown(record: dict[str, Any]) -> str:
    """Return what the page shows of a record: a row for each family."""
    names = ["scenes", "kept", "above", "told_too_little", "late", "refused", "ended_early"]
    names += ["unverified", "exceptions", "no_reference"]
    heads = ["family", *(name.replace("_", " ") for name in names)]
    heads += ["true / asked, median", "largest"]
    lines = [f"| {' | '.join(heads)} |", "|---|" + "--:|" * (len(heads) - 1)]
    for family, of_it in record["families"].items():
        ratios = of_it["ratios"]
        shares = [f"{ratios[share]:.2f}" if ratios else "-" for share in ("50", "100")]
        cells = [family, *(str(of_it[name]) for name in names), *shares]
        lines.append(f"| {' | '.join(cells)} |")
    first, _ = record["seeds"]
    lines.append(f"\nSeeds from {first} on, {record['date']}.")
    return "\n".join(lines) + "\n"
