"""The record of effects as a page, made of nothing but what the JSON holds."""

from __future__ import annotations

from typing import Any

from equal_error import Record
from tables import table

CORE, PEER = "pendcore", "mujoco_forward"
STEP = "pendcore_step"
RUNS = {CORE: "pendcore_run", PEER: "mujoco_run"}
WAYS = ("call", "step")

PAGE = """# What an effect costs

Made by `make compare`; do not edit: run again. The raw figures are in
[effects.json](../records/comparison/effects.json).

![What each effect adds to a right-hand side, pendcore beside MuJoCo](effects.png)

Two rods ran with one effect and without effects, in C++ programs. The figures are the nanoseconds
that the effect **adds to a right-hand side**, each program compared with its own bare scene. A
*call* is the right-hand side alone, waiting for the accelerations of the previous call; *in a
step* is its share of an attempted step of dopri5; *in a run* is the time of a whole run, divided
by the number of its right-hand sides (pendcore: dopri5, including the search for points where a
law changes; MuJoCo: its RK4, four right-hand sides a step). Times are the least over {rounds}
rounds in which every scene had its turn, in an order drawn anew; differences of a few parts in a
hundred of the bare scene are noise. The number in parentheses is the share of the same program's
bare scene. Where both programs have the same law, their accelerations differ by at most
{disagreement:.0e} of the largest.

The bare scene takes {bare}.

{beside}
MuJoCo is set up at its best: features that the scene does not need are disabled, and bodies have
no shapes. In both programs the effects act at joint 2; drag acts on both links.

## Absent costs nothing

{absent}

## Present costs its arithmetic

Each smooth effect adds at most 60 instructions (drag 150) and 6 ns (drag 15, a sinusoid 10) to a
right-hand side. Instructions are those of the kernels for x86-64-v3, counted by callgrind in a
call and within steps of dopri5. All couples on a joint are summed when the scene is compiled, so
several couples cost no more than one.

{promised}
## Where pendcore loses

{losses}

## Who took part, and on what

{contenders}

{machine}
"""


def by_name(record: Record) -> dict[str, Any]:
    return {effect["name"]: effect for effect in record["effects"]}


def time(effect: Any, side: str, kind: str = "minimum_ns") -> float | None:
    found = effect["sides"].get(side, {}).get(kind)
    return None if found is None else float(found)


def added(record: Record, effect: Any, side: str, kind: str = "minimum_ns") -> float | None:
    """Return what the effect adds on that side, in nanoseconds."""
    mine, bare = time(effect, side, kind), time(by_name(record)["none"], side, kind)
    return None if mine is None or bare is None else mine - bare


def share(record: Record, effect: Any, side: str) -> float | None:
    """Return what the effect adds as a share of the same side's bare scene."""
    more, bare = added(record, effect, side), time(by_name(record)["none"], side)
    return None if more is None or not bare else more / bare


def instructions_added(record: Record, effect: Any, way: str) -> float | None:
    mine = effect["instructions"].get(way)
    bare = by_name(record)["none"]["instructions"].get(way)
    return None if mine is None or bare is None else mine - bare


def signed(value: float | None, decimals: int = 1) -> str:
    return "—" if value is None else f"{value:+.{decimals}f}"


def cell(record: Record, effect: Any, side: str) -> str:
    part = share(record, effect, side)
    return "—" if part is None else f"{signed(added(record, effect, side))} ({part:+.0%})"


def effects_of(record: Record) -> list[Any]:
    return [effect for effect in record["effects"] if effect["name"] != "none"]


def beside(record: Record) -> str:
    header = ["effect", "pendcore, a call", "in a step", "in a run"]
    header += ["MuJoCo's", "mj_forward", "in a run"]
    rows = [
        [
            effect["label"],
            *(cell(record, effect, side) for side in (CORE, STEP, RUNS[CORE])),
            *(effect["theirs"] or "has none",),
            *(cell(record, effect, PEER), cell(record, effect, RUNS[PEER])),
        ]
        for effect in effects_of(record)
    ]
    return table(header, rows)


def exceeded(record: Record, effect: Any) -> list[str]:
    """List what the effect adds beyond the promise."""
    over = []
    limit = effect["most_instructions"]
    for way in WAYS:
        more = instructions_added(record, effect, way)
        if limit is not None and more is not None and more > limit:
            over.append(f"{more:.0f} instructions in a {way}")
    for side, where in ((CORE, "in a call"), (STEP, "in a step")):
        nanoseconds = added(record, effect, side)
        if effect["most_ns"] is not None and nanoseconds and nanoseconds > effect["most_ns"]:
            over.append(f"{nanoseconds:.1f} ns {where}")
    return over


def verdict(record: Record, effect: Any) -> str:
    if added(record, effect, CORE) is None:
        return "not measured"
    return "; ".join(exceeded(record, effect)) or "kept"


def promised(record: Record) -> str:
    header = ["effect", "at most", "ns, a call", "in a step", "at most", "instructions, a call"]
    rows = []
    for effect in effects_of(record):
        if effect["most_ns"] is None:
            continue
        counted = [instructions_added(record, effect, way) for way in WAYS]
        rows.append(
            [effect["label"], f"{effect['most_ns']} ns"]
            + [signed(added(record, effect, side)) for side in (CORE, STEP)]
            + [str(effect["most_instructions"]), *(signed(one, 0) for one in counted)]
            + [verdict(record, effect)]
        )
    return table([*header, "in a step", "verdict"], rows)


def absent(record: Record) -> str:
    """Say what the bare scene executes, and what it would execute without any effects."""
    counted = record["bare_instructions"]
    if not counted:
        return "Not counted."
    alike = counted["scene"] == counted["kernel"] == counted["one_effect_more"]
    return (
        f"A right-hand side of the bare scene executes {counted['scene']:.1f} instructions within "
        "a step,\nand the kernel that is named by its type and knows of no effect executes "
        f"{counted['kernel']:.1f}.\nIn a core with one law more in its list the bare scene "
        "executes "
        f"{counted['one_effect_more']:.1f}: {'kept' if alike else '**missed**'}."
    )


def losses(record: Record) -> list[str]:
    """Name each effect that costs pendcore more than it costs MuJoCo, or more than promised."""
    lines = []
    for effect in effects_of(record):
        for where, ours, theirs in (("call", CORE, PEER), ("run", RUNS[CORE], RUNS[PEER])):
            mine, other = added(record, effect, ours), added(record, effect, theirs)
            if mine is not None and other is not None and mine > max(other, 0.5):
                more = f"{mine:.1f} ns here, {other:.1f} ns there"
                lines.append(f"* {effect['label']} in a {where}: {more}.")
        over = exceeded(record, effect)
        if over:
            lines.append(f"* {effect['label']} adds more than promised: {', '.join(over)}.")
    shares = [
        effect["label"]
        for effect in effects_of(record)
        if (mine := share(record, effect, STEP)) is not None
        and (other := share(record, effect, PEER)) is not None
        and mine > max(other, 0.02)
    ]
    if shares:
        lines.append(
            "* In a step, as a share of pendcore's own bare scene, which takes less time than "
            f"MuJoCo's: {'; '.join(shares)}."
        )
    compared = any(
        added(record, effect, CORE) is not None and added(record, effect, PEER) is not None
        for effect in effects_of(record)
    )
    return lines or ["* Nowhere." if compared else "* Not measured."]


def bare(record: Record) -> str:
    """Say how long each side's scene without effects takes."""
    known = by_name(record)["none"]
    labels = {one["name"]: one["label"] for one in record["contenders"]}
    found = [
        f"{nanoseconds:.1f} ns ({labels[side]})"
        for side in labels
        if (nanoseconds := time(known, side)) is not None
    ]
    return ", ".join(found) or "no time: nobody took part"


def summary(record: Record) -> str:
    """Make the few lines for the terminal."""
    return "\n".join(
        [f"bare scene: {bare(record)}", beside(record), absent(record), promised(record)]
    )


def page(record: Record) -> str:
    """Make the whole page."""
    apart = [one["disagreement"] for one in record["effects"] if one["disagreement"] is not None]
    machine = [*record["machine"].items(), ("date", record["date"])]
    return PAGE.format(
        rounds=record["rounds"],
        disagreement=max(apart, default=0.0),
        bare=bare(record),
        beside=beside(record),
        absent=absent(record),
        promised=promised(record),
        losses="\n".join(losses(record)),
        contenders="\n".join(f"* {one['label']}: {one['about']}" for one in record["contenders"]),
        machine="\n".join(f"* {name}: {value}" for name, value in machine),
    )
