"""`pendcore map`: a number over a plane of starts or parameters, and which pixels are resolved."""

from __future__ import annotations

import argparse
import re
import sys
from collections import Counter
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from pendcore import Case, ensemble, read_case
from pendcore.cli.arguments import add_flags, add_number, add_out
from pendcore.cli.files_to_write import FilesToWrite
from pendcore.cli.map.forbidden import is_forbidden
from pendcore.cli.map.refinement import Mask, levels_of, refined
from pendcore.cli.map.table import MapAxis, MapTable, read_map_table
from pendcore.cli.usage import UsageError, blamed_on_usage, new_folder
from pendcore.messages import Floats
from pendcore.plotting import MAP_SIZE, Axis, draw_map, new_axes, shown_of, values_of
from pendcore.reducers import REDUCERS, FirstEvent, Reducer

HELP = "draw a number over a plane of starts or parameters, and which pixels are resolved"
DESCRIPTION = "Run the case at every pixel of a map."
EPILOG = """
the case has a table
  [map]
  show = "first_event"     # or "largest_exponent", "energy_drift", "q[1]", "qd[2]" at the end
  x = {name = "q0_deg[1]", start = -180, stop = 180, count = 300}
  y = {name = "q0_deg[2]", start = -180, stop = 180, count = 300}
where names are those of parameters (scene.parameters() lists them) or of the start: q0[1],
q0_deg[1], qd0[2]. With "first_event" the first [[event]] of the case counts.

what is written into the folder:
  map.png       the map; pixels that a second, independent run does not confirm are red
  map.npz       x, y, values, resolved, computed: arrays of NumPy
  summary.txt   what was run, and how many pixels are resolved

example:
  pendcore map examples/11_flip_map.toml
  pendcore map examples/11_flip_map.toml --zoom -120 -60 20 80 -o out/zoom
"""

MOST_PIXELS = 100_000_000
"""The largest map: its values and masks take some 2 GB."""
FILES = ("summary.txt", "map.npz", "map.png")
_OPTIONS = ("method", "rtol", "atol", "max_steps", "max_step")
"""Those of the case that count in a map."""


class _Asked(NamedTuple):
    """What a map shows. A component of the end state needs no reducer."""

    case: Case
    table: MapTable
    reducer: Reducer | None
    args: argparse.Namespace


@dataclass(slots=True)
class Pixels:
    """The values of the pixels, and which are computed and resolved, (n_x, n_y)."""

    values: Floats
    resolved: Mask
    computed: Mask
    counts: Counter[str] = field(default_factory=Counter)
    forbidden: int = 0


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("case", type=Path, metavar="CASE.toml", help="a case with a table [map]")
    add_out(parser)
    add_number(parser, "--count", "N", "pixels along both axes", kind=int)
    ends, told = ("X0", "X1", "Y0", "Y1"), "other ends of x and y"
    parser.add_argument("--zoom", type=float, nargs=4, metavar=ends, help=told)
    told = "begin with pixels that are 2^LEVELS times as large, and divide those that differ from "
    add_number(parser, "--refine", "LEVELS", f"{told}a neighbour; 0 computes all", 0, int)
    add_flags(parser, no_trust="leave out the second runs that confirm pixels")
    add_number(parser, "--workers", "N", "threads; default: all processors", kind=int)


def execute(args: argparse.Namespace) -> int:
    with blamed_on_usage():
        case, table = read_case(args.case), read_map_table(args.case)
        table = _asked_for(table, args)
        reducer = _reducer(table.show, case)
        levels_of((table.x.count, table.y.count), args.refine)
    asked = _Asked(case, table, reducer, args)
    folder = args.out or Path("out", args.case.stem)
    with new_folder(folder):
        with blamed_on_usage():
            pixels, complaint = _computed(asked)
        files = FilesToWrite(folder, FILES)
        told = _summary(asked, pixels)
        with files.one("summary.txt") as path:
            path.write_text(told, encoding="utf-8")
        with files.one("map.npz") as path, path.open("wb") as file:
            np.savez(
                file, x=table.x.values, y=table.y.values, values=pixels.values,
                resolved=pixels.resolved, computed=pixels.computed, case=case.to_toml(),
            )  # fmt: skip
        with files.one("map.png") as path:
            _save_figure(asked, pixels, path)
        print(files.outcome(), file=sys.stderr)
        print(complaint or told, end="\n" * bool(complaint), file=sys.stderr if complaint else None)
        files.refuse_if_none()
    return 1 if complaint or files.left_out else 0


def _asked_for(table: MapTable, args: argparse.Namespace) -> MapTable:
    """Return the table with what the command line changes."""
    x, y = table.x, table.y
    if args.count is not None:
        if args.count < 2:
            raise UsageError(f"--count = {args.count}: must be 2 or more pixels")
        x, y = (replace(axis, count=args.count) for axis in (x, y))
    if args.zoom is not None:
        x0, x1, y0, y1 = args.zoom
        if not (x0 < x1 and y0 < y1):
            raise UsageError(f"--zoom {x0:g} {x1:g} {y0:g} {y1:g}: X0 < X1 and Y0 < Y1 are needed")
        x, y = replace(x, start=x0, stop=x1), replace(y, start=y0, stop=y1)
    if x.count * y.count > MOST_PIXELS:
        raise UsageError(f"{x.count:,} x {y.count:,} pixels: must be at most {MOST_PIXELS:,}")
    if args.refine < 0:
        raise UsageError(f"--refine = {args.refine}: must be 0 or more levels")
    return MapTable(table.show, x, y)


def _reducer(show: str, case: Case) -> Reducer | None:
    """Return the reducer that makes what is shown; None for a component of the end state."""
    if show == FirstEvent.usual_name:
        events = case.options.get("events", ())
        if not events:
            raise UsageError('show = "first_event": the case has no [[event]]')
        return FirstEvent(events[0])
    kinds = {x.usual_name: x for x in REDUCERS if x is not FirstEvent and not x.axes}
    if show in kinds:
        return kinds[show]()
    component = re.fullmatch(r"qd?\[(\d+)\]", show)
    if component is None:
        known = ", ".join([FirstEvent.usual_name, *kinds])
        raise UsageError(f"show = {show!r}: must be one of {known}, or q[i] or qd[i] of a link i")
    _require_link(f"show = {show!r}", component[1], case)
    return None


def _require_link(what: str, number: str, case: Case) -> None:
    if not 1 <= int(number) <= len(case.scene.links):
        raise UsageError(f"{what}: the scene has {len(case.scene.links)} links")


def _computed(asked: _Asked) -> tuple[Pixels, str]:
    """Return the pixels, and a complaint if they are not all there."""
    table, shape = asked.table, (asked.table.x.count, asked.table.y.count)
    pixels = Pixels(np.full(shape, np.nan), np.zeros(shape, bool), np.zeros(shape, bool))

    def compute(level: tuple[int, int], wanted: Mask) -> tuple[Floats, Mask]:
        x, y = (replace(table.x, count=level[0]), replace(table.y, count=level[1]))
        i, k = np.nonzero(wanted)
        return _run(asked, x.values[i], y.values[k], pixels)

    complaint = ""
    try:
        for found in refined(shape, asked.args.refine, compute):
            pixels.values, pixels.resolved, pixels.computed = found
    except KeyboardInterrupt:
        complaint = "interrupted: the map has what was computed before"
    return pixels, complaint


def _run(asked: _Asked, x: Floats, y: Floats, pixels: Pixels) -> tuple[Floats, Mask]:
    """Run pixels (k,); return their values, and which of them are resolved."""
    case, table, reducer, args = asked
    q0, qd0, vary = _starts(asked, x, y)
    options = {name: value for name, value in case.options.items() if name in _OPTIONS}
    values, resolved = np.full(len(x), np.nan), np.ones(len(x), dtype=bool)
    wanted = ~_forbidden(asked, x, y)
    pixels.forbidden += int(np.count_nonzero(~wanted))
    vary = {name: one[wanted] for name, one in vary.items()}
    found = ensemble(
        case.scene, case.t_span, q0[wanted], qd0[wanted], vary=vary, workers=args.workers,
        keep="end" if reducer is None else reducer, on_failure="ignore", **options,
    )  # fmt: skip
    pixels.counts.update(found.counts())
    values[wanted] = values_of(found, table.show)
    if not args.no_trust:
        other = found.second(workers=args.workers, on_failure="ignore")
        resolved[wanted] = found.resolved(other)
    return values, resolved


def _forbidden(asked: _Asked, x: Floats, y: Floats) -> Mask:
    """Return at which pixels (k,) the event cannot happen; where a parameter varies, none."""
    q0, qd0, vary = _starts(asked, x, y)
    if vary or not isinstance(asked.reducer, FirstEvent):
        return np.zeros(len(x), dtype=bool)
    return is_forbidden(asked.case.scene, q0, qd0, asked.reducer.event)


def _starts(asked: _Asked, x: Floats, y: Floats) -> tuple[Floats, Floats, dict[str, Floats]]:
    """Return angles and rates (k, n), and the parameters that vary, of pixels."""
    case, table, *_ = asked
    q0, qd0 = np.tile(case.q0, (len(x), 1)), np.tile(case.qd0, (len(x), 1))
    vary: dict[str, Floats] = {}
    for axis, values in ((table.x, x), (table.y, y)):
        start = re.fullmatch(r"(q0|q0_deg|qd0)\[(\d+)\]", axis.name)
        if start is None:
            vary[axis.name] = values
            continue
        _require_link(axis.name, start[2], case)
        target = qd0 if start[1] == "qd0" else q0
        target[:, int(start[2]) - 1] = np.radians(values) if start[1] == "q0_deg" else values
    return q0, qd0, vary


def _summary(asked: _Asked, pixels: Pixels) -> str:
    case, table, _, args = asked
    total = pixels.values.size
    begin, end = case.t_span
    lines = [
        f"{table.show} over {table.x.name} and {table.y.name}, t = {begin:g} to {end:g} s",
        f"{table.x.count} x {table.y.count} pixels",
        "runs: " + ", ".join(f"{count} {name}" for name, count in pixels.counts.items()),
    ]
    if needless := pixels.forbidden:
        lines.append(f"{needless} were not needed: the energy does not suffice for the event")
    if args.refine:
        share = np.count_nonzero(pixels.computed) / total
        lines.append(f"computed at the finest level: {share:.1%}")
    some = pixels.values[np.isfinite(pixels.values)]
    if some.size:
        lines.append(f"values: {some.min():.6g} to {some.max():.6g}, at {some.size} pixels")
    if not args.no_trust:
        lines.append(f"resolved: {np.count_nonzero(pixels.resolved) / total:.2%} of the pixels")
    return "\n".join(lines) + "\n"


def _save_figure(asked: _Asked, pixels: Pixels, path: Path) -> None:
    from matplotlib.figure import Figure

    case, table, reducer, args = asked
    forbidden = ~np.isfinite(pixels.values)
    i, k = np.nonzero(forbidden)
    forbidden[i, k] = _forbidden(asked, table.x.values[i], table.y.values[k])
    shown = shown_of(pixels.values, table.show, reducer, forbidden, "the energy forbids it")
    (axes,) = new_axes(MAP_SIZE, new_figure=Figure)
    x, y = (_axis(case, axis) for axis in (table.x, table.y))
    draw_map(axes, x, y, shown, None if args.no_trust else pixels.resolved, {})
    figure: Any = axes.figure
    figure.savefig(path, dpi=150)


def _axis(case: Case, axis: MapAxis) -> Axis:
    starts = {"q0": "rad", "q0_deg": "deg", "qd0": "rad/s"}
    unit = starts.get(axis.name.partition("[")[0]) or case.scene.parameter_units()[axis.name]
    return Axis.of(axis.name.replace("q0_deg", "q0"), unit, axis.values)
