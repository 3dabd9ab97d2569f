"""How long a chaotic run is right, how long it says that it is, and what one more digit is worth.

    make write PAGE=horizon

It runs what docs/background/horizon.md tells of, and writes the tables of that page,
docs/records/horizon.json and the figures docs/figures/horizon_*.png. The truth comes from the
Taylor series in many digits of tests/reference/taylor_series.py and its record,
tests/data/chaotic_starts.json.
"""

from __future__ import annotations

import json
import sys
from fractions import Fraction
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pendcore as pc
from numpy.typing import NDArray
from page_part import ROOT, rewrite
from pendcore.cost.horizon import METHODS
from pendcore.plotting import LIGHT, grid, legend_above, new_axes

sys.path += [str(ROOT / "tests"), str(ROOT / "tests/models")]

import chaotic_starts as record
from reference.taylor_series import RodChain, motion

BOOK = pc.Scene.textbook()
START, SPAN = [-1.2, -0.6], (0.0, 14.0)
LIMIT = 0.1
RTOLS = [1e-4, 1e-6, 1e-9, 1e-12]
FIVE_RTOLS = [1e-4, 1e-6, 1e-8, 1e-10, 1e-12]
STUDENT = 3.5  # of Student's t with 49 degrees of freedom, 99.9 % lie within +- this
FIGURES = ROOT / "docs/figures"


def truth(times: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the angles of the start above in many digits, as doubles, (n_t, 2)."""
    chain = RodChain([1.0, 1.0], [1.0, 1.0], BOOK.gravity)
    made = motion(chain, START, [0.0, 0.0], [Fraction(float(t)) for t in times], digits=44)
    return np.array([[float(x) for x in row[:2]] for row in made])


def trusted(method: str, rtol: float) -> dict[str, Any]:
    """Compare `valid_until` with the record's truth, over all of its starts."""
    valid, right = [], []
    for case in record.chaotic_starts():
        run = pc.simulate(
            case.scene, q0=case.q0, qd0=case.qd0, t_span=(0, record.T_END), method=method,
            rtol=rtol, atol=1e-3 * rtol,
        )  # fmt: skip
        last = case.last_right(run, LIMIT)
        if last < record.T_END:
            valid.append(run.valid_until(LIMIT))
            right.append(last)
    return {"method": method, "rtol": rtol, "valid": valid, "right": right}


def slopes() -> dict[str, dict[str, list[float]]]:
    """Return, for each method, the seconds that a digit buys over those of the exponent, by start.

    `share` has this ratio as it is measured, and `even` as the variational equations alone have it
    for the same early errors. `gained` has, for each run, the error at the limit over what the
    early error has grown to by the variational equations.
    """
    found: dict[str, dict[str, list[float]]] = {}
    for case in record.chaotic_starts():
        how: dict[str, Any] = {"methods": METHODS, "rtols": FIVE_RTOLS, "progress": False}
        work = pc.horizon_work(case.scene, (0, 30), case.q0, case.qd0, **how)
        assert work.growth is not None
        t, grown = work.growth.t, np.maximum.accumulate(work.growth.growth[:, 0])
        for method in work.methods:
            of = found.setdefault(method, {"share": [], "even": [], "gained": []})
            early = np.array([point.early for point in work.of(method)])
            wanted = np.log(LIMIT / early)
            within = wanted <= grown[-1]
            reached = np.interp(wanted[within], grown, t)
            even = np.polyfit(-np.log10(early[within]), reached, 1)[0]
            at_limit = np.interp([point.valid for point in work.of(method)], t, grown)
            of["share"].append(work.measured(method) / work.seconds_a_digit)
            of["even"].append(float(even) / work.seconds_a_digit)
            of["gained"] += np.exp(wanted - at_limit).tolist()
    return found


def neighbours() -> list[float]:
    """Return the largest exponent over 1000 s of starts that are next to this one, 1/s."""
    starts = [[START[0] + k * 1e-12, START[1]] for k in range(40)]
    return [pc.lyapunov(BOOK, (0, 1000), q0, count=1).largest for q0 in starts]


def mean_and_interval(values: list[float]) -> tuple[float, float]:
    """Return the mean, and by how much it may be off where their scatter is chance (99.9 %)."""
    error = np.std(values, ddof=1) / np.sqrt(len(values))
    return float(np.mean(values)), float(STUDENT * error)


def table(found: dict[str, Any]) -> str:
    """Return the tables of the page."""
    lines = [
        "| method | rtol | starts | right for, median | trusted for, median share | least | most |",
        "|---|--:|--:|--:|--:|--:|--:|",
    ]
    for one in found["trusted"]:
        share = np.array(one["valid"]) / np.array(one["right"])
        lines.append(
            f"| `{one['method']}` | {one['rtol']:.0e} | {len(share)} "
            f"| {np.median(one['right']):.1f} s | {np.median(share):.2f} "
            f"| {share.min():.2f} | {share.max():.2f} |"
        )
    work = found["work"]
    lines += [
        "",
        f"For this start a digit is worth {work['seconds_a_digit']:.2f} s by the exponent between "
        "its horizons. The table has the measured seconds, and their share of the exponent's "
        "seconds over all starts of the record:",
        "",
        "| method | this start | starts | share, mean (99.9 %) | from start to start | of that, "
        "neighbours | error at the limit |",
        "|---|--:|--:|--:|--:|--:|--:|",
    ]
    for method, of in found["shares"].items():
        mean, half = mean_and_interval(of["share"])
        least, most = np.percentile(of["gained"], [5, 95])
        lines.append(
            f"| `{method}` | {work['slopes'][method]:.2f} s | {len(of['share'])} "
            f"| {mean:.2f} ± {half:.2f} | {np.std(of['share'], ddof=1):.2f} "
            f"| {np.std(of['even'], ddof=1):.2f} | {least:.1f} to {most:.1f} |"
        )
    exponents = ", ".join(f"{x:.3f}".replace("-", "\N{MINUS SIGN}") for x in found["exponents"])
    largest = found["neighbours"]
    lines += [
        "",
        f"Exponents of this start over {found['long']:.0f} s: {exponents}, in 1/s. "
        f"For {len(largest)} starts within 1e-10 rad of it the largest is "
        f"{np.mean(largest):.2f} with a standard deviation of {np.std(largest, ddof=1):.2f}: "
        "the exponent is known no better after that time.",
    ]
    return "\n".join(lines) + "\n"


def draw_run(path: Path) -> None:
    """Draw one run, what is past its horizon, and its error: true, estimated, largest so far."""
    run = pc.simulate(BOOK, SPAN, START)
    times = np.linspace(*SPAN, 281)
    true = np.abs(run(times)[:2].T - truth(times)).max(axis=1)
    found, valid = run.estimate_error(), run.valid_until(LIMIT)
    above, middle, below = new_axes((7.2, 6.4), 3, height_ratios=[1, 1, 1.5])
    run.plot(ax=[above, middle], horizon=LIMIT)
    for axis in (above, middle):
        axis.set_xlabel("")
    below.semilogy(found.t[1:], found.angle[1:], "-", color=LIGHT.lost, lw=4, label="estimate")
    limited = np.maximum.accumulate(found.angle)
    below.semilogy(found.t[1:], limited[1:], "--", color=LIGHT.red, lw=1.2,
                   label="what valid_until takes")  # fmt: skip
    below.semilogy(
        times[1:], true[1:], ".", color=LIGHT.ink, ms=3, label="true, by series in 44 digits"
    )
    below.axhline(LIMIT, color=LIGHT.teal, lw=0.9)
    below.axvline(valid, color=LIGHT.teal, lw=0.9)
    below.annotate(f"valid until {valid:.2f} s", (valid, 1e-11), xytext=(-6, 0), ha="right",
                   textcoords="offset points", color=LIGHT.teal)  # fmt: skip
    below.annotate(f"{LIMIT} rad", (0.2, LIMIT), xytext=(0, 4), textcoords="offset points",
                   color=LIGHT.teal)  # fmt: skip
    below.set(xlabel="t (s)", ylabel="error of the angles (rad)", xlim=SPAN, ylim=(1e-13, 1e3))
    grid(below)
    legend_above(below)
    plt.savefig(path, dpi=110)


def draw_trusted(found: dict[str, Any], path: Path) -> None:
    """Draw how long runs are trusted against how long they are right."""
    (axis,) = new_axes((5.4, 5.2))
    marks = dict(zip(RTOLS, ["v", "^", "o", "s"], strict=True))
    for one in found["trusted"]:
        if one["method"] != "dopri5":
            continue
        axis.plot(one["right"], one["valid"], marks[one["rtol"]], ms=5, mfc="none",
                  label=f"rtol = {one['rtol']:.0e}")  # fmt: skip
    ends = np.array([0.0, float(record.T_END)])
    axis.plot(ends, ends, "-", color=LIGHT.ink, lw=1)
    axis.plot(ends, 0.7 * ends, ":", color=LIGHT.ink, lw=1)
    axis.annotate("as long as it is right", (9.0, 9.0), xytext=(-4, 4), ha="right",
                  textcoords="offset points")  # fmt: skip
    axis.annotate("0.7 of that", (10.5, 7.35), xytext=(4, -10), textcoords="offset points")
    axis.set(xlabel=f"time until an angle is off by {LIMIT} rad (s)",
             ylabel=f"valid_until({LIMIT}) (s)", xlim=ends, ylim=ends)  # fmt: skip
    axis.set_aspect("equal")
    grid(axis)
    legend_above(axis)
    plt.savefig(path, dpi=110)


def draw_exponents(spectrum: pc.LyapunovExponents, path: Path) -> None:
    """Draw the finite-time spectrum."""
    (axis,) = new_axes((6.4, 3.8))
    for line, style in zip(spectrum.plot(axis), ["-", "--", "-.", ":"], strict=True):
        line.set_linestyle(style)
    axis.set_xscale("log")
    axis.set_ylim(-4, 4)
    plt.savefig(path, dpi=110)


def main() -> None:
    spectrum = pc.lyapunov(BOOK, (0, 1000), START, t_eval=np.geomspace(0.5, 1000, 400))
    work = pc.horizon_work(
        BOOK, q0=START, t_span=(0, 30), limit=LIMIT, time_limit=600, progress=True
    )
    found = {
        "exponents": spectrum.exponents.tolist(),
        "long": 1000.0,
        "neighbours": neighbours(),
        "trusted": [trusted(method, rtol) for method in METHODS for rtol in RTOLS],
        "shares": slopes(),
        "work": {
            "points": [point._asdict() for point in work.points],
            "exponent": work.exponent,
            "seconds_a_digit": work.seconds_a_digit,
            "slopes": {method: work.measured(method) for method in work.methods},
        },
    }
    (ROOT / "docs/records/horizon.json").write_text(json.dumps(found, indent=1) + "\n")
    rewrite(ROOT / "docs/background/horizon.md", horizon=table(found))
    draw_run(FIGURES / "horizon_run.png")
    draw_trusted(found, FIGURES / "horizon_starts.png")
    draw_exponents(spectrum, FIGURES / "horizon_exponents.png")
    work.plot().savefig(FIGURES / "horizon_work.png", dpi=110)
    print(table(found))
    late = [one for one in found["trusted"] if (np.array(one["valid"]) > one["right"]).any()]
    if late:
        sys.exit(f"trusted longer than right: {late}")


if __name__ == "__main__":
    main()
