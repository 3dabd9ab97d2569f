"""The page on all solves: what to choose, how it was measured, where pendcore loses, and why."""

from __future__ import annotations

import statistics
from collections.abc import Mapping

import stiff_page
from equal_error import DECADES, SIDES, Comparison, Record, Side, compare
from tables import number, power, short, table

PAGE = """# What accuracy costs, beside other solvers

Made by `make compare` from its [records](../records/comparison). Do not edit: run again. The pages
of the cases have every contender's figures: {cases}. Three more pages answer other questions:
[effects](effects.md) (what each effect costs), [chains](chains.md) (forward dynamics of n links)
and [ensembles](ensembles.md) (many runs at once).

## What to choose

{choice}
* **Stiff scenes** (strong damping, hard springs, stiff controllers): `radau5`, or the default,
  which changes over to it.
* **Fixed steps** (`rk4`) are the yardstick, because many users write this method by hand. Nothing
  in the method tells how wrong its result is.
* **Chaotic motions** lose a digit every second or so: a tolerance that is enough for 5 s is not
  enough for 10 s. `high_energy` is such a motion; it loses eight digits on its way, and at about
  1e-8 double precision ends: smaller errors there are rounding luck.

## Best against best

The tables have the time of pendcore's best method divided by the time of the best peer at the same
achieved error; below 1 pendcore is quicker. The goal on the textbook's case is 0.5, and 0.6 in C++
at errors above 1e-5, where the best peer has the same coefficients. A dash means that nobody
reaches the error.

{tables}
{narrow}

## Where pendcore loses, and why

{losses}

## What bounds the rest

* **From Python** a solve of the textbook's case takes {own_call} more than in C++ (the median over
  `dopri5` and `taylor` at all settings), because pendcore checks its arguments and makes and
  returns a result object. This is why some errors reach the goal in C++ and miss it from Python.
* **In C++** `taylor` is the best method from errors of some 1e-4 down. By count in
  `double_pendulum_series.hpp`, order k of its series takes 2 k + 6 products of rows of four numbers
  and five of pairs. Factors that let an order wait less for the order before it took three times
  as many products and were no quicker, so they are gone.
* Outside the series a step computes its size (two logarithms, a power) and the new state (a
  polynomial), which takes a fifth of its time (`make bench`, `step/latency/taylor` beside
  `series`); the loop and the samples come on top. At 1e-2 its time is close to that of `dopri5`,
  whose steps wait for six right-hand sides one by one.

## How it was measured

* **Error** is the largest distance, over fixed times of the case, between computed and reference
  joints and tip, divided by the total length. The references are computed in multiple precision by
  a program that takes no part in the comparison (for the stiff scenes by SciPy, at tolerances far
  tighter than any in the comparison).
* **Time** is the time of the call that made the error; at its end the caller has the states at all
  times. Whatever can be built beforehand is not included; compile times are listed separately. All
  contenders take turns at all settings, in an order drawn anew in each of 30 rounds; the least
  time counts, and the median is given beside it. Calls longer than 20 ms have fewer turns, at
  least three, and a contender that takes half a second is not tried at tighter settings. Settings
  are tolerances, rtol = atol, four a decade, or steps. Between settings, log time is interpolated
  over log error, on the points that no other point beats in both.
* **Peers run at their best**, found by experiment: closed forms of two and of three unit rods with
  literal constants, where pendcore takes any masses and lengths; Boost.odeint compiled with -O3
  -march=native, its loop written out; SUNDIALS with its memory made once; heyoka with fast_math
  and a form of the equations that saves it a fifth of its time; CyRK with the address of compiled
  code; SciPy with its right-hand sides in Python and compiled by numba. pendcore checks its
  arguments and makes a result object in every call, and is compiled so that its bits are the same
  on every processor.
* **heyoka** is called from Python in both columns: {heyoka} of its time is the call's own cost.

{machines}
"""

SHOWN_SIDES = (SIDES[0], SIDES[-1])
NAMES = {
    "textbook": "textbook, 5 s",
    "textbook_long": "textbook, 60 s",
    "high_energy": "high energy",
    "damped_textbook": "damped",
    "three_links": "three links",
}


def spans(compared: list[Comparison]) -> list[tuple[str, list[float]]]:
    """List pendcore's methods with the errors at which each is its best, loosest first."""
    found: dict[str, list[float]] = {}
    for at in compared:
        if at.own:
            found.setdefault(short(at.own[1]).removeprefix("pendcore "), []).append(at.error)
    return list(found.items())


def span(errors: list[float]) -> str:
    if len(errors) == 1:
        return f"at {power(errors[0])}"
    return f"from {power(max(errors))} to {power(min(errors))}"


def choice(records: Mapping[str, Record]) -> str:
    """Say for each case which method is the quickest at which achieved errors."""
    lines = ["* The quickest of pendcore's methods, by the error that you want (C++):"]
    for case, name in NAMES.items():
        if case in records:
            listed = [f"`{who}` {span(at)}" for who, at in spans(compare(records[case], SIDES[0]))]
            lines.append(f"  * {name}: {', '.join(listed) or 'not measured'}.")
    return "\n".join(lines)


def cell(at: Comparison) -> str:
    if at.ratio is not None:
        who = short(at.peer[1] if at.peer else "").split()[0]
        return f"{number(at.ratio, 2)} ({who})"
    return "alone" if at.own else "peer alone" if at.peer else "—"


def ratios(records: Mapping[str, Record], side: Side) -> str:
    """Tabulate the ratios of all cases on a side, a column for each case."""
    known = {case: compare(records[case], side) for case in NAMES if case in records}
    known = {case: compared for case, compared in known.items() if compared}
    if not known:
        return "Not measured.\n"
    header = ["achieved error", *(NAMES[case] for case in known)]
    rows = [
        [power(error), *(cell(compared[k]) for compared in known.values())]
        for k, error in enumerate(DECADES)
    ]
    return table(header, rows)


def narrow(records: Mapping[str, Record]) -> str:
    """Say what pendcore loses without AVX-512, and where the figures with AVX-512 come from."""
    found = []
    for record in records.values():
        for wide, held_back in zip(*(compare(record, side) for side in SIDES[:2]), strict=False):
            if wide.own and held_back.own:
                found.append(held_back.own[0] / wide.own[0])
    if not found:
        return "pendcore's best times use no AVX-512 here, or were measured with one set alone."
    return (
        "pendcore chose its kernels for x86-64-v4 (AVX-512). Held back to x86-64-v3, its best\n"
        f"method takes {min(found):.2f} to {max(found):.2f} times as long; the pages of the cases "
        "have the\ntables. In both comparisons the peers keep the processor's own instructions."
    )


def lost(records: Mapping[str, Record]) -> dict[str, list[str]]:
    """List, by program, where a peer is quicker: sentences with case, side and errors."""
    found: dict[str, dict[str, list[Comparison]]] = {}
    for case, record in records.items():
        sections = record["scenes"] if case == "stiff" else [record]
        for each in sections:
            errors = stiff_page.ERRORS if case == "stiff" else DECADES
            for side in SHOWN_SIDES:
                for at in compare(each, side, errors):
                    if at.peer and (at.own is None or (at.ratio is not None and at.ratio > 1)):
                        who = short(at.peer[1]).split()[0]
                        where = (
                            f"[{each.get('label', NAMES.get(case, case))}]({case}.md) {side.title}"
                        )
                        found.setdefault(who, {}).setdefault(where, []).append(at)
    return {
        who: [
            f"  * {where}: {span([at.error for at in places])}{worst(places)}"
            for where, places in of_who.items()
        ]
        for who, of_who in found.items()
    }


def worst(places: list[Comparison]) -> str:
    known = [at.ratio for at in places if at.ratio is not None]
    most = f", at most {number(max(known))} times its time" if known else ""
    alone = [power(at.error) for at in places if at.own is None]
    return most + (f", of which pendcore does not reach {', '.join(alone)}" if alone else "") + "."


REASONS = {
    "heyoka": (
        "It compiles the equations of one scene, masses and lengths as constants, at one order, "
        "into straight machine code for Taylor series, without loops, branches or anything that "
        "only other scenes need. Compiling takes tenths of a second the first time on a machine, "
        "a second for three links at high orders: as long as thousands of its solves, and again "
        "for another scene or tolerance. Since 7.10 a cache on disk keeps the code; these runs "
        "read most of it from there, which took {compiling}. Where pendcore's best is a "
        "Runge-Kutta method, heyoka has the higher order as well."
    ),
    "Boost.odeint": (
        "Its right-hand side is written by hand for rods of 1 kg and 1 m. For three links pendcore "
        "has no closed form: it uses the recursion for n links, with any masses, lengths and "
        "effects."
    ),
    "CyRK": (
        "It calls the compiled closed form for unit rods without Python in between; a call of "
        "pendcore costs a few microseconds more, for checks and its result object."
    ),
    "CVODE": "A multistep method needs fewer right-hand sides and factors its Jacobian seldom.",
    "SciPy": "It has the same methods; on some stiff scenes another order is better.",
}


def losses(records: Mapping[str, Record]) -> str:
    """List who is quicker where, with the reason below each."""
    lines = []
    for who, places in lost(records).items():
        why = REASONS.get(who, "").format(compiling=compiling(records))
        lines += [f"* **{who}**. {why}".rstrip(), *places]
    return "\n".join(lines) or "* Nowhere among these contenders at the errors above."


def of_heyoka(records: Mapping[str, Record]) -> list[Record]:
    return [
        one for record in records.values() for one in record.get("contenders", ())
        if one["name"] == "heyoka"
    ]  # fmt: skip


def compiling(records: Mapping[str, Record]) -> str:
    seconds = [s for one in of_heyoka(records) for s in one["compile_seconds"] or ()]
    return f"{number(min(seconds), 1)} to {number(max(seconds), 2)} s" if seconds else "a second"


def call(records: Mapping[str, Record]) -> str:
    """Say how long heyoka's call of one step takes: an upper bound on what Python costs it."""
    taken = [one["one_step"]["minimum_us"] for one in of_heyoka(records) if one["one_step"]]
    return f"at most {number(max(taken), 2)} us" if taken else "a few us"


def own_call(records: Mapping[str, Record]) -> str:
    """Say by how much a solve from Python takes longer than the same in C++, in the median."""
    contenders = records.get("textbook", {}).get("contenders", ())
    least = {
        (one["name"], point["setting"]): point["minimum_us"]
        for one in contenders
        for point in one["points"]
        if "minimum_us" in point
    }
    more = [
        python - least[f"{name}_cpp", setting]
        for (name, setting), python in least.items()
        if name in ("pendcore_dopri5", "pendcore_taylor") and (f"{name}_cpp", setting) in least
    ]
    return f"{number(statistics.median(more), 2)} us" if more else "a few us"


def page(records: Mapping[str, Record]) -> str:
    """Make the whole page from the records that are there, by stem."""
    machines = {
        f"* {stem}: {record['machine']['processor']}, {record['date']}, pendcore on "
        f"{record['machine']['instruction set of pendcore']}"
        for stem, record in records.items()
    }
    shown = [f"{side.title}:\n\n{ratios(records, side)}" for side in SHOWN_SIDES]
    return PAGE.format(
        cases=", ".join(f"[{stem}]({stem}.md)" for stem in records),
        choice=choice(records),
        tables="\n".join(shown),
        narrow=narrow({case: records[case] for case in NAMES if case in records}),
        losses=losses(records),
        heyoka=call(records),
        own_call=own_call(records),
        machines="\n".join(sorted(machines)),
    )
