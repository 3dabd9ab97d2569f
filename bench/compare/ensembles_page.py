"""The record of ensembles as a page, made of nothing but what the JSON holds."""

from __future__ import annotations

from equal_error import Record, curve
from page import machine
from tables import number, power, table
from work_precision import time_at

ERRORS = (1e-3, 1e-6, 1e-9, 1e-12)
BARS = {"bare": "1/3", "damped": "1/2", "motor": "1/2", "three_links": "1/2"}

PAGE = """# Many runs at once

Made by `make compare`; do not edit: run again. The raw figures are in
[ensembles.json](../records/comparison/ensembles.json).

![Error against time of a trajectory](ensembles.png)

Rods of 1 kg and 1 m are released at rest from random angles over the whole circle, {members} of
them, and move for 5 s; what is kept is the state at the end. A time is that of one trajectory, on
one processor, the least of calls that alternate with those of the others. An error is the median
over {known} trajectories of the position error at the end, as a share of the total length, against
heyoka in long double.

heyoka advances a batch of trajectories to the end before the next begins; the batch has as many as
a register of the processor holds, or twice as many. `pc.ensemble` begins the next trajectory in a
lane as soon as one has ended. Scenes, methods and tolerances that have no lanes are run one by one:
`explain()` says which.

{scenes}
## Two threads

{threads}

## On what

{machine}
"""


def best(record: Record, error: float, *, ours: bool) -> tuple[float, str] | None:
    """Find the least time at an error, and who takes it: pendcore's methods, or heyoka."""
    found = [
        (at, one["label"])
        for one in record["contenders"]
        if one["ours"] == ours and (ours or "heyoka" in one["label"])
        if (at := time_at(curve(one), error)) is not None
    ]
    return min(found, default=None)


def rows(record: Record) -> list[list[str]]:
    """Compare the best of both at each error."""
    found = []
    for error in ERRORS:
        own, peer = best(record, error, ours=True), best(record, error, ours=False)
        ratio = number(own[0] / peer[0]) if own and peer else "—"
        cells = [
            cell
            for one in (own, peer)
            for cell in ((one[1], number(one[0])) if one else ("—", "—"))
        ]
        found.append([power(error), *cells, f"**{ratio}**", BARS[record["case"]]])
    return found


def section(record: Record) -> str:
    header = ["median error", "pendcore", "us", "heyoka", "us", "ratio", "bar"]
    everybody = [
        [one["label"], *(number(time_at(curve(one), error)) for error in ERRORS)]
        for one in record["contenders"]
    ]
    return "\n".join([
        f"## {record['label'][0].upper()}{record['label'][1:]}\n",
        table(header, rows(record)),
        "Everybody, us a trajectory at an error of:\n",
        table(["", *map(power, ERRORS)], everybody),
    ])  # fmt: skip


def threads(record: Record) -> str:
    found = record["scenes"][0]["threads"]
    ratio = found["ensemble"] / found["loops"]
    told = (
        f"Two threads make the ensemble {found['ensemble']:.2f} times as fast as one. Two "
        f"processes of a bare loop were {found['loops']:.2f} times as fast as one in the same run: "
        f"the gain of the ensemble is {ratio:.2f} times that of the loops."
    )
    if ratio > 1:
        told += " The loops are a yardstick of the machine at that moment, not a bound."
    return told


def page(record: Record) -> str:
    first = record["scenes"][0]
    return PAGE.format(
        members=first["members"],
        known=first["known"],
        scenes="\n".join(section(each) for each in record["scenes"]),
        threads=threads(record),
        machine=machine(record),
    )


def summary(record: Record) -> str:
    """Make the few lines for the terminal."""
    return "\n".join(
        f"{each['label']}:\n"
        + table(["median error", "pendcore", "us", "heyoka", "us", "ratio", "bar"], rows(each))
        for each in record["scenes"]
    )
