"""What all records of solves say together: what to choose, ratios, and where pendcore loses."""

from __future__ import annotations

import statistics
from collections.abc import Mapping

from equal_error import DECADES, OUTER_SIDES, SIDES, Comparison, Contender, compare
from record import Record
from solve_tables import STIFF_ERRORS
from tables import NONE, WORDS, listed, number, power, short, table

Records = Mapping[str, Record]
NAMES = WORDS["names"]


def known(records: Records) -> dict[str, list[Contender]]:
    """Return who took part in each case that is no stiff scene."""
    return {stem: records[stem].taking_part() for stem in NAMES if stem in records}


def span(errors: list[float]) -> str:
    if len(errors) == 1:
        return f"at {power(errors[0])}"
    return f"from {power(max(errors))} to {power(min(errors))}"


def pages(records: Records) -> str:
    return ", ".join(f"[{NAMES.get(stem, stem)}]({stem}.md)" for stem in records)


def choice(records: Records) -> str:
    """Say for each case which of pendcore's methods is the quickest at which achieved errors."""
    lines = []
    for stem, who in known(records).items():
        spans: dict[str, list[float]] = {}
        for at in compare(who, SIDES[0]):
            if at.own:
                method = short(at.own[1]).removeprefix("pendcore ")
                spans.setdefault(method, []).append(at.error)
        methods = (f"`{method}` {span(errors)}" for method, errors in spans.items())
        lines.append(f"  * {NAMES[stem]}: {', '.join(methods) or 'not measured'}.")
    return "\n".join(lines)


def cell(at: Comparison) -> str:
    if at.ratio is not None and at.peer:
        return f"{number(at.ratio, 2)} ({short(at.peer[1]).split()[0]})"
    return "alone" if at.own else "peer alone" if at.peer else NONE


def ratios(records: Records) -> str:
    """Tabulate the ratios of all cases, a column for each case."""
    parts = []
    for side in OUTER_SIDES:
        compared = {stem: compare(who, side) for stem, who in known(records).items()}
        compared = {stem: found for stem, found in compared.items() if found}
        rows = [
            [power(error), *(cell(found[k]) for found in compared.values())]
            for k, error in enumerate(DECADES)
        ]
        header = ["achieved error", *(NAMES[stem] for stem in compared)]
        parts.append(f"{side.title}:\n\n{table(header, rows) if compared else 'Not measured.'}")
    return "\n".join(parts)


def narrow(records: Records) -> str:
    """Say what pendcore loses without AVX-512."""
    found = [
        held_back.own[0] / wide.own[0]
        for who in known(records).values()
        for wide, held_back in zip(*(compare(who, side) for side in SIDES[:2]), strict=False)
        if wide.own and held_back.own
    ]
    return f"{min(found):.2f} to {max(found):.2f}" if found else NONE


def losses(records: Records) -> str:
    """List who is quicker where, with the reason below each."""
    lost: dict[str, dict[str, list[Comparison]]] = {}
    for stem, record in records.items():
        errors = STIFF_ERRORS if stem == "stiff" else DECADES
        for case, facts in record.cases.items():
            for side in OUTER_SIDES:
                where = f"[{facts.get('label', NAMES.get(stem))}]({stem}.md) {side.title}"
                for at in compare(record.taking_part(case), side, errors):
                    if at.peer and at.lost:
                        peer = short(at.peer[1]).split()[0]
                        lost.setdefault(peer, {}).setdefault(where, []).append(at)
    lines = []
    for peer, places in lost.items():
        why = WORDS["reasons"].get(peer, "").format(compiling=compiling(records))
        lines.append(f"* **{peer}**. {why}".rstrip())
        for where, found in places.items():
            lines.append(f"  * {where}: {span([at.error for at in found])}{worst(found)}")
    return "\n".join(lines) or "* Nowhere among these contenders at the errors above."


def worst(places: list[Comparison]) -> str:
    found = [at.ratio for at in places if at.ratio is not None]
    most = f", at most {number(max(found))} times its time" if found else ""
    alone = [power(at.error) for at in places if at.own is None]
    return most + (f", of which pendcore does not reach {', '.join(alone)}" if alone else "") + "."


def calls_of_heyoka(records: Records) -> list[dict[str, float]]:
    entrants = (one for who in known(records).values() for one in who)
    return [one["one_step"] for one in entrants if one["name"] == "heyoka" and one["one_step"]]


def compiling(records: Records) -> str:
    calls = [call for call in calls_of_heyoka(records) if "compiling_least_s" in call]
    if not calls:
        return "a second"
    least, most = (
        extreme(call[f"compiling_{end}_s"] for call in calls)
        for extreme, end in ((min, "least"), (max, "most"))
    )
    return f"{number(least, 1)} to {number(most, 2)} s"


def call_of_heyoka(records: Records) -> str:
    """Say how long heyoka's call of one step takes: an upper bound on what Python costs it."""
    taken = [call["minimum_us"] for call in calls_of_heyoka(records)]
    return f"at most {number(max(taken), 2)} us" if taken else "a few us"


def own_call(records: Records) -> str:
    """Say by how much a solve from Python takes longer than the same in C++, in the median."""
    least = {
        (one["name"], point["setting"]): point["minimum_us"]
        for one in known(records).get("textbook", ())
        for point in one["points"]
        if "minimum_us" in point
    }
    more = [
        python - least[f"{name}_cpp", setting]
        for (name, setting), python in least.items()
        if name in ("pendcore_dopri5", "pendcore_taylor") and (f"{name}_cpp", setting) in least
    ]
    return f"{number(statistics.median(more), 2)} us" if more else "a few us"


def machines(records: Records) -> str:
    measured = ((stem, record.measured) for stem, record in records.items())
    return listed(
        sorted(
            f"{NAMES.get(stem, stem)}: {one['machine']['processor']}, {one['date']}, pendcore on "
            f"{one['machine']['instruction set of pendcore']}"
            for stem, one in measured
        )
    )
