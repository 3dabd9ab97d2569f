"""`pendcore map`: a number over a plane of starts or parameters, and which pixels are resolved."""

from __future__ import annotations

import argparse
import re
import sys
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any

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
        asked = _Map(case, _asked_for(table, args), args)
        levels_of(asked.shape, args.refine)
    folder = args.out or Path("out", args.case.stem)
    with new_folder(folder):
        with blamed_on_usage():
            complaint = asked.compute()
        files = FilesToWrite(folder, FILES)
        told = asked.summary()
        with files.one("summary.txt") as path:
            path.write_text(told, encoding="utf-8")
        with files.one("map.npz") as path, path.open("wb") as file:
            np.savez(
                file, x=asked.table.x.values, y=asked.table.y.values, values=asked.values,
                resolved=asked.resolved, computed=asked.computed, case=case.to_toml(),
            )  # fmt: skip
        with files.one("map.png") as path:
            asked.save_figure(path)
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


class _Map:
    """What a map shows, and its pixels: their values, which are resolved, and which computed.

    These are (n_x, n_y). A component of the end state needs no reducer.
    """

    def __init__(self, case: Case, table: MapTable, args: argparse.Namespace) -> None:
        self.case, self.table, self.args = case, table, args
        self.reducer = _reducer(table.show, case)
        self.shape = table.x.count, table.y.count
        self.values = np.full(self.shape, np.nan)
        self.resolved, self.computed = np.zeros(self.shape, bool), np.zeros(self.shape, bool)
        self._counts, self._needless = Counter[str](), 0

    def compute(self) -> str:
        """Compute the pixels; return a complaint if they are not all there."""

        def run(level: tuple[int, int], wanted: Mask) -> tuple[Floats, Mask]:
            x, y = (replace(self.table.x, count=level[0]), replace(self.table.y, count=level[1]))
            i, k = np.nonzero(wanted)
            return self._run(x.values[i], y.values[k])

        try:
            for found in refined(self.shape, self.args.refine, run):
                self.values, self.resolved, self.computed = found
        except KeyboardInterrupt:
            return "interrupted: the map has what was computed before"
        return ""

    def _run(self, x: Floats, y: Floats) -> tuple[Floats, Mask]:
        """Run pixels (k,); return their values, and which of them are resolved."""
        case, reducer, workers = self.case, self.reducer, self.args.workers
        q0, qd0, vary = self._starts(x, y)
        options = {name: value for name, value in case.options.items() if name in _OPTIONS}
        values, resolved = np.full(len(x), np.nan), np.ones(len(x), dtype=bool)
        wanted = ~self._forbidden(x, y)
        self._needless += int(np.count_nonzero(~wanted))
        vary = {name: one[wanted] for name, one in vary.items()}
        found = ensemble(
            case.scene, case.t_span, q0[wanted], qd0[wanted], vary=vary, workers=workers,
            keep="end" if reducer is None else reducer, on_failure="ignore", **options,
        )  # fmt: skip
        self._counts.update(found.counts())
        values[wanted] = values_of(found, self.table.show)
        if not self.args.no_trust:
            other = found.second(workers=workers, on_failure="ignore")
            resolved[wanted] = found.resolved(other)
        return values, resolved

    def _forbidden(self, x: Floats, y: Floats) -> Mask:
        """Return at which pixels (k,) the event cannot happen; where a parameter varies, none."""
        q0, qd0, vary = self._starts(x, y)
        if vary or not isinstance(self.reducer, FirstEvent):
            return np.zeros(len(x), dtype=bool)
        return is_forbidden(self.case.scene, q0, qd0, self.reducer.event)

    def _starts(self, x: Floats, y: Floats) -> tuple[Floats, Floats, dict[str, Floats]]:
        """Return angles and rates (k, n), and the parameters that vary, of pixels."""
        q0, qd0 = np.tile(self.case.q0, (len(x), 1)), np.tile(self.case.qd0, (len(x), 1))
        vary: dict[str, Floats] = {}
        for axis, values in ((self.table.x, x), (self.table.y, y)):
            start = re.fullmatch(r"(q0|q0_deg|qd0)\[(\d+)\]", axis.name)
            if start is None:
                vary[axis.name] = values
                continue
            _require_link(axis.name, start[2], self.case)
            target = qd0 if start[1] == "qd0" else q0
            target[:, int(start[2]) - 1] = np.radians(values) if start[1] == "q0_deg" else values
        return q0, qd0, vary

    def summary(self) -> str:
        table, total, (begin, end) = self.table, self.values.size, self.case.t_span
        lines = [
            f"{table.show} over {table.x.name} and {table.y.name}, t = {begin:g} to {end:g} s",
            f"{table.x.count} x {table.y.count} pixels",
            "runs: " + ", ".join(f"{count} {name}" for name, count in self._counts.items()),
        ]
        if needless := self._needless:
            lines.append(f"{needless} were not needed: the energy does not suffice for the event")
        if self.args.refine:
            share = np.count_nonzero(self.computed) / total
            lines.append(f"computed at the finest level: {share:.1%}")
        some = self.values[np.isfinite(self.values)]
        if some.size:
            lines.append(f"values: {some.min():.6g} to {some.max():.6g}, at {some.size} pixels")
        if not self.args.no_trust:
            lines.append(f"resolved: {np.count_nonzero(self.resolved) / total:.2%} of the pixels")
        return "\n".join(lines) + "\n"

    def save_figure(self, path: Path) -> None:
        from matplotlib.figure import Figure

        table, forbidden = self.table, ~np.isfinite(self.values)
        i, k = np.nonzero(forbidden)
        forbidden[i, k] = self._forbidden(table.x.values[i], table.y.values[k])
        why = "the energy forbids it"
        shown = shown_of(self.values, table.show, self.reducer, forbidden, why)
        (axes,) = new_axes(MAP_SIZE, new_figure=Figure)
        x, y = (_axis(self.case, axis) for axis in (table.x, table.y))
        draw_map(axes, x, y, shown, None if self.args.no_trust else self.resolved, {})
        figure: Any = axes.figure
        figure.savefig(path, dpi=150)


def _axis(case: Case, axis: MapAxis) -> Axis:
    starts = {"q0": "rad", "q0_deg": "deg", "qd0": "rad/s"}
    unit = starts.get(axis.name.partition("[")[0]) or case.scene.parameter_units()[axis.name]
    return Axis.of(axis.name.replace("q0_deg", "q0"), unit, axis.values)
