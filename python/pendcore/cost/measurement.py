"""How a sweep is measured: a reference, one run of each contender, then rounds of timed calls."""

from __future__ import annotations

import platform
import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from math import inf
from pathlib import Path
from statistics import median
from time import monotonic, perf_counter
from typing import Any

import numpy as np

import pendcore as pc
from pendcore import build
from pendcore.cost.accuracy_cost import AccuracyCost
from pendcore.cost.point import Point
from pendcore.cost.reference import KNOWN, Reference, reference
from pendcore.cost.runs import Start, has_error_estimate
from pendcore.methods import known_methods, pair_of

# A third of the time limit is for the reference and a third for single runs; the rest for repeats.
SHARE = 1 / 3
PILOT_SHARE = 1 / 200
"""The share of a first loose run; if that takes longer, tight runs would not get to the end."""
SHORTER = 0.6
"""The factor by which the span is cut again where the references did not get so far."""
PILOT: dict[str, Any] = {"rtol": 1e-6, "atol": 1e-9, "store": "end"}
"""A first loose run."""


@dataclass(slots=True)
class Contender:
    """A method at a tolerance or with a fixed step: what its first call told, and all times, s."""

    point: Point
    seconds: list[float] = field(default_factory=list)

    def timed(self) -> Point:
        """Return the point that the result keeps."""
        point = replace(self.point, repeats=len(self.seconds))
        if point.failure:
            return point
        return replace(point, seconds=min(self.seconds), median=median(self.seconds))


@dataclass(slots=True, kw_only=True)
class Measurement:
    """A sweep; it can be interrupted at any time, and `result` returns what was measured so far."""

    start: Start
    name: str
    methods: list[str] | None
    tolerances: list[tuple[float, float]]
    steps: list[float] | None
    limits: dict[str, Any]
    points: int
    repeats: int
    time_limit: float
    report: Callable[[float], object] = lambda fraction: None
    reference: Reference | None = None
    rows: list[list[Contender]] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)
    began: float = field(default_factory=monotonic)
    asked_t_span: tuple[float, float] = (0.0, 0.0)
    cut: str = ""

    def measure(self) -> None:
        """Make the whole measurement."""
        self.asked_t_span = (self.start.t_start, self.start.t_end)
        self.report(0.0)
        limit = max(PILOT_SHARE * self.time_limit, 1e-3)
        pilot = self.start.run(pair_of("dopri5"), **PILOT, time_limit=limit, **self.limits)
        if pilot.status == "time_limit":
            self._cut(pilot.t_reached, self._too_little())
        stiff = pilot.stats.stiff
        self._find_reference(stiff)
        self.report(0.2)
        self._try_each(stiff)
        self._repeat()
        self.report(1.0)

    def result(self) -> AccuracyCost:
        """Return what was measured; there are no points without a reference."""
        found = self.reference
        tried = [one.timed() for row in self.rows for one in row if one.seconds]
        return AccuracyCost(
            name=self.name,
            t_span=(self.start.t_start, self.start.t_end),
            asked_t_span=self.asked_t_span,
            times=len(found.times) if found else 0,
            points=tuple(tried),
            uncertainty=found.uncertainty if found else inf,
            references=found.texts() if found else ("there is none yet", "neither"),
            timed=self._timed(tried) if found else "nothing was timed",
            remarks=tuple(self.remarks),
            machine=f"{processor()}, instruction set {build.instruction_set()}",
            version=build.version,
        )

    def _timed(self, tried: list[Point]) -> str:
        counts = [p.repeats for p in tried if not p.failure] or [0]
        calls = f"{min(counts)}" if min(counts) == max(counts) else f"{min(counts)}-{max(counts)}"
        count = len(self._known.times)
        return (
            f"of pendcore.simulate(..., t_eval={count} times), the call that has the "
            f"error, from Python: the least, and the median, of {calls} calls in turns"
        )

    def _left(self, share: float = 1.0) -> float:
        """Return how much is left of a share of the time limit, s."""
        return max(self.began + share * self.time_limit - monotonic(), 1e-3)

    @property
    def _known(self) -> Reference:
        assert self.reference is not None
        return self.reference

    def _find_reference(self, stiff: bool) -> None:
        """Run the reference, and again over a shorter span if the whole one cannot be followed."""
        for _ in range(3):
            found = self._reference(stiff)
            end, known = float(found.times[-1]), found.known_until()
            if known < 2:
                self.remarks.append("the two references part at once: no error here has a meaning")
                break
            if known < len(found.times):
                self.cut = ""  # of the two reasons, the one that more time would not mend
                why = f"double precision follows this motion to {KNOWN:.0e} of the length"
                self._cut(float(found.times[known - 1]), why)
            elif end != self.start.t_end:
                stopped = found.second
                is_late = stopped.status == "time_limit"
                why = f"{stopped.method} got no farther: {stopped.message}"
                self._cut(end, self._too_little() if is_late else why)
            else:
                break
            # If this was the last attempt.
            found = found._replace(times=found.times[:known], apart=found.apart[:known])
        self.reference = found
        if self.cut:
            self.remarks.append(
                f"{self.cut}: until {self.start.t_end:.6g} s, not to {self.asked_t_span[1]:.6g} s; "
                "errors and times are up to there"
            )
        if {found.first.method, found.second.method} == {"radau5", pair_of("dopri5")}:
            self.remarks.append(
                "both references are radau5 where the scene is stiff: an error in its table would "
                "show in neither"
            )

    def _reference(self, stiff: bool) -> Reference:
        """Return the reference over as much of the span as the time allows."""
        asked: dict[str, Any] = {"stiff": stiff, "points": self.points, **self.limits}
        while True:
            limit = SHARE * self._left()
            found = reference(self.start, time_limit=limit, **asked)
            if len(found.times) > 1:
                return found
            begin, second = self.start.t_start, found.second
            if second.t_reached == begin or self._left() < self.time_limit / 3:
                remedy = ": or shorten t_span" if second.status == "time_limit" else ""
                raise ValueError(
                    f"no reference: within {limit:.3g} s no two methods got beyond the first of "
                    f"the {self.points} times ({second.method}: {second.message}){remedy}"
                )
            self._cut(begin + SHORTER * (second.t_reached - begin), self._too_little())

    def _cut(self, t_end: float, why: str) -> None:
        """Measure a shorter span, and keep the reason for the first cut."""
        self.start = self.start._replace(t_end=t_end)
        self.cut = self.cut or why

    def _too_little(self) -> str:
        return f"a time_limit of {self.time_limit:.3g} s is too little for more of this span"

    def _try_each(self, stiff: bool) -> None:
        """Run each contender once, the loosest of all methods first."""
        self.rows = rows = [[*self._contenders_of(method)] for method in self._methods(stiff)]
        allowed = max(self._left(2 * SHARE), self._left() / 2) / max(len(rows), 1)
        left = [allowed] * len(rows)
        longest = max((len(row) for row in rows), default=0)
        for k in range(longest):
            for i, row in enumerate(rows):
                if k < len(row) and left[i] > 0:
                    self._try(row[k], left[i])
                    left[i] -= sum(row[k].seconds)
                    if self.steps is None and self._is_short_enough(row[: k + 1], allowed):
                        del row[k + 1 :]
            self.report(0.2 + 0.3 * (k + 1) / longest)
        cut_short = [row for row in rows if not row[-1].seconds]
        left_out = [next(x.point for x in row if not x.seconds) for row in cut_short]
        if left_out:
            missed = ", ".join(f"{one.method} at {one.setting} and below" for one in left_out)
            self.remarks.append(
                f"the time limit was up before these were tried: {missed}; a larger "
                f"time_limit than {self.time_limit:.3g} s includes them"
            )

    def _is_short_enough(self, row: list[Contender], allowed: float) -> bool:
        """Return whether halving a fixed step is over: it gained nothing, or is too dear."""
        one, before = row[-1].point, row[-2].point.error if len(row) > 1 else inf
        gained = one.error > 2 * self._known.uncertainty
        # Errors above `KNOWN` may come from unstable steps, and need not fall yet.
        gained &= one.error < before / 2 or before > KNOWN
        dear = sum(row[-1].seconds) > allowed / self.repeats
        return one.step is not None and (dear or not gained)

    def _try(self, one: Contender, limit: float) -> None:
        solution, seconds = self._call(one.point, time_limit=limit)
        error, failure = self._known.error_of(solution), ""
        if not solution.success:
            too_long = f"took more than the {limit:.2g} s left for it of the time limit"
            failure = too_long if solution.status == "time_limit" else solution.message
        elif error == inf:
            failure = "did not get to the end with finite angles"
        counts = {name: getattr(solution.stats, name) for name in ("nfev", "accepted")}
        one.point = replace(one.point, error=error, failure=failure, **counts)
        one.seconds.append(seconds)

    def _repeat(self) -> None:
        """Time all in rounds, each round in an order drawn anew, until the time is up."""
        tried = [one for row in self.rows for one in row if one.seconds]
        fine = [one for one in tried if not one.point.failure]
        for number in range(1, self.repeats):
            random.Random(number).shuffle(fine)
            for one in fine:
                if self._left() > max(one.seconds[-1], 1e-3):
                    one.seconds.append(self._call(one.point)[1])
            self.report(0.5 + 0.5 * number / self.repeats)
            if self._left() <= 1e-3:
                break
        if any(len(one.seconds) < self.repeats for one in fine):
            self.remarks.append(
                f"the time was up before all had {self.repeats} timed calls: a larger time_limit "
                f"than {self.time_limit:.3g} s gives more"
            )

    def _call(self, one: Point, time_limit: float | None = None) -> tuple[pc.Solution, float]:
        """Make the call that is timed."""
        start = self.start
        tolerances = {"rtol": one.rtol, "atol": one.atol, **self.limits}
        options = tolerances if one.step is None else {"step": one.step}
        span = (start.t_start, start.t_end)
        begin = perf_counter()
        solution = pc.simulate(
            start.scene, span, start.q0, start.qd0, method=one.method, t_eval=self._known.times,
            time_limit=time_limit, on_failure="ignore", progress=False, **options,
        )  # fmt: skip
        return solution, perf_counter() - begin

    def _methods(self, stiff: bool) -> list[str]:
        if self.methods is not None:
            return [method for method in known_methods() if method in self.methods]
        known = [m for m, about in known_methods().items() if about["kind"] != "pair" or stiff]
        steps = {name: None if has_error_estimate(name) else 1e-3 for name in known}
        return [name for name, step in steps.items() if self.start.is_supported_by(name, step)]

    def _contenders_of(self, method: str) -> Iterator[Contender]:
        if has_error_estimate(method):
            for rtol, atol in self.tolerances:
                yield Contender(Point(method=method, rtol=rtol, atol=atol))
        else:
            for step in self.steps or self._halved_steps():
                yield Contender(Point(method=method, step=step))

    def _halved_steps(self) -> list[float]:
        """Return steps from twice those of a loose run on, halved down to a ten thousandth."""
        loose = self.start.run(
            "dopri5", rtol=1e-3, atol=1e-6, store="end", time_limit=0.1 * self._left(),
            **self.limits,
        )  # fmt: skip
        span = abs(self.start.t_end - self.start.t_start)
        longest = span / max(1.0, np.ceil(loose.stats.accepted / 2))
        return [float(longest / 2**k) for k in range(14)]


def processor() -> str:
    """Return the processor, without which times mean nothing, as the kernel calls it."""
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    except OSError:
        return platform.processor() or platform.machine()
    facts = dict(line.split(":", 1) for line in text.splitlines() if ":" in line)
    names = {key.strip(): value.strip() for key, value in facts.items()}
    return names.get("model name", platform.machine())
