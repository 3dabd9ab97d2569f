"""The results of a campaign: counts and shares by family, and scenes that break a claim."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np

from true_error.judge import Verdict

SHARES = (5, 25, 50, 75, 95, 99, 100)
NO_REFERENCE, MANY = 0.02, 20
"""The share of scenes whose error, or whose time of validity, the reference may not know; and the
number of scenes from which on at least one is kept and the median tells something."""
UNVERIFIED, TOLD_TOO_LITTLE = 1 / 100, 1 / 100
"""The shares of scenes that may end unverified, and whose ``achieved`` may be below the truth."""
MEDIAN = (0.05, 0.8)
"""The bounds between which the median of true over asked has to lie."""
SHOWN = 40
"""Offenders of one kind that are listed."""


def record_of(verdicts: list[Verdict]) -> dict[str, Any]:
    """Return what became of the scenes of a family."""
    outcomes = Counter(verdict.outcome for verdict in verdicts)
    faults = Counter(fault for verdict in verdicts for fault in verdict.faults)
    ratios = ratios_of(verdicts)
    refused = [verdict for verdict in verdicts if verdict.outcome == "refused"]
    return {
        "scenes": len(verdicts),
        "kept": outcomes["kept"],
        "above": faults["above"],
        "told_too_little": sum(verdict.is_told_too_little for verdict in verdicts),
        "contradicted": faults["contradicted"],
        "late": faults["late"],
        "refused": len(refused),
        "refused_though_doubles_know": sum(is_needless(verdict) for verdict in refused),
        "ended_early": outcomes["ended early"],
        "unverified": outcomes["unverified"],
        "exceptions": faults["exception"],
        "no_reference": sum(verdict.is_unknown for verdict in verdicts),
        "limit_not_known": sum(not verdict.limit_known for verdict in verdicts),
        "ratios": {
            str(share): round(float(np.percentile(ratios, share)), 4) for share in SHARES
        } if len(ratios) else {},
        "work": sum(verdict.work for verdict in verdicts),
        "seconds": round(sum(verdict.seconds for verdict in verdicts), 1),
        "reference_seconds": round(sum(verdict.reference_seconds for verdict in verdicts), 1),
    }  # fmt: skip


def is_needless(verdict: Verdict) -> bool:
    """Whether an error was refused that an independent integrator easily keeps in doubles."""
    return verdict.doubles is not None and 10 * verdict.doubles < verdict.asked


def ratios_of(verdicts: list[Verdict]) -> np.ndarray:
    """Return the true error over the one asked for, where that was kept and is known."""
    return np.array(
        [v.true / v.asked for v in verdicts if v.outcome == "kept" and v.true is not None]
    )


def broken(verdicts: list[Verdict]) -> list[str]:
    """Return the claims that a family breaks."""
    record = record_of(verdicts)
    found = [
        f"{record[name]} {what}"
        for name, what in (
            ("above", "above what was asked"),
            ("contradicted", "told as kept, which sol.estimate_error() denies"),
            ("late", "with a valid_until that is late"),
            ("exceptions", "with an exception other than AccuracyError"),
        )
        if record[name]
    ]
    for name, most in (
        ("no_reference", NO_REFERENCE),
        ("limit_not_known", NO_REFERENCE),
        ("unverified", UNVERIFIED),
    ):
        if record[name] > most * len(verdicts):
            found.append(f"{record[name]} of {len(verdicts)} {name.replace('_', ' ')}")
    if len(verdicts) >= MANY and not record["kept"]:
        found.append("no error was kept: nothing was tested")
    most_told = max(1.0, TOLD_TOO_LITTLE * len(verdicts))
    if record["told_too_little"] > most_told:
        found.append(f"{record['told_too_little']} of {len(verdicts)} told too little")
    low, high = MEDIAN
    if len(verdicts) >= MANY and record["ratios"] and not low <= record["ratios"]["50"] <= high:
        found.append(f"the median of true over asked is {record['ratios']['50']}")
    return found


def offenders(found: dict[str, list[Verdict]]) -> str:
    """Return the scenes that break a claim, each with what repeats it."""
    lines = []
    for family, verdicts in found.items():
        kinds: dict[str, list[Verdict]] = {}
        for verdict in sorted(verdicts, key=lambda verdict: verdict.seed):
            for kind in verdict.faults or _rarities(verdict):
                kinds.setdefault(kind, []).append(verdict)
        for fault, those in kinds.items():
            lines.append(f"==== {family}, {fault}: {len(those)}")
            lines += [line_of(verdict, fault) for verdict in those[:SHOWN]]
    return "\n".join(lines)


def _rarities(verdict: Verdict) -> list[str]:
    """Return what is no fault of a scene, but must not happen in many."""
    found = {
        "unverified": verdict.outcome == "unverified",
        "told too little": verdict.is_told_too_little,
    }
    return [name for name, is_so in found.items() if is_so]


def line_of(verdict: Verdict, fault: str) -> str:
    """Return one scene that breaks a claim, and what repeats it."""
    errors = (
        f"true {times(verdict.true, verdict.asked)} of {verdict.asked:.2e}, told "
        f"{times(verdict.achieved, verdict.asked)}"
    )
    what = {
        "above": errors,
        "told too little": errors,
        "contradicted": f"sol.estimate_error() {times(verdict.estimated, verdict.asked)}, true "
        f"{times(verdict.true, verdict.asked)} of {verdict.asked:.2e}",
        "late": f"valid_until {verdict.valid_until}, past {verdict.limit} at {verdict.first_past}",
    }.get(fault, "")
    repeat = f"--family {verdict.family} --seeds {verdict.seed}:{verdict.seed + 1}"
    says = verdict.exception or verdict.says
    return f"{repeat}  n = {verdict.n}, {verdict.method}: {what} {says}"[:200]


def times(value: float | None, asked: float) -> str:
    return "?" if value is None else f"{value / asked:.3g}x"


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


def table(record: dict[str, Any]) -> str:
    """Return the families side by side."""
    families = record["families"]
    rows = [["", *families]]
    names = [name for name in next(iter(families.values())) if name != "ratios"]
    for name in names[: names.index("work")]:
        rows.append([name.replace("_", " "), *(str(of_it[name]) for of_it in families.values())])
    for share in SHARES:
        name = {50: "median", 100: "largest"}.get(share, f"{share} %")
        values = [f"{of_it['ratios'].get(str(share), np.nan):.3g}" for of_it in families.values()]
        rows.append([f"true / asked, {name}", *values])
    for name in names[names.index("work") :]:
        values = [f"{of_it[name] / of_it['scenes']:.3g}" for of_it in families.values()]
        rows.append([f"{name.replace('_', ' ')} of a scene", *values])
    wide = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = ["  ".join(cell.rjust(to) for cell, to in zip(row, wide, strict=True)) for row in rows]
    return "\n".join(lines)
