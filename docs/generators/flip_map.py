"""The flip map of the textbook's rods, which pixels of it are true, and a check in many digits.

    make write PAGE=flip_map

It runs what docs/background/flip_map.md tells of, and writes the numbers of that page,
docs/records/flip_map.json and docs/figures/flip_map.png. The truth at some pixels comes from the
Taylor series in many digits of tests/reference/taylor_series.py, which share no code with the core.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
from concurrent.futures import ProcessPoolExecutor
from fractions import Fraction
from pathlib import Path
from time import perf_counter
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pendcore as pc
from numpy.typing import NDArray
from page_part import ROOT, rewrite, table_of
from pendcore.cli.map.forbidden import is_forbidden
from pendcore.cost.measurement import processor
from pendcore.messages import Floats
from pendcore.plotting import Axis, Shown, draw_map, new_axes
from scipy.interpolate import CubicHermiteSpline

sys.path.append(str(ROOT / "tests"))

from reference.taylor_series import RodChain, motion

BOOK = pc.Scene.textbook()
UP = -np.pi / 2
EVENTS = {f"link {i}": pc.events.LinkAngle(i, UP, every_turn=True, terminal=True) for i in (1, 2)}
UNIT = float(np.sqrt(1.0 / BOOK.gravity))  # sqrt(l/g), s
T_END = 1e4 * UNIT
CHECKED = 1000
GRID = 0.02  # s, of the times at which turns are counted in many digits
CLOSE = 0.1  # rad, between upright and a reversal that is computed in many digits as well
LONGEST = 30.0  # s, of a motion in many digits


def angles(count: int) -> Floats:
    """Return the angles from hanging at the centres of even pixels, rad."""
    return np.pi * (2 * np.arange(count) + 1 - count) / count


def half(count: int) -> Floats:
    """Return the starts of half of the pixels, from hanging, (count/2, count, 2).

    The motion from (-theta_1, -theta_2) is the mirror image of that from (theta_1, theta_2).
    """
    theta = angles(count)
    return np.stack(np.meshgrid(theta[: count // 2], theta, indexing="ij"), axis=-1)


def whole(part: NDArray[Any]) -> NDArray[Any]:
    """Return all pixels from half of them."""
    return np.concatenate([part, part[::-1, ::-1]])


def flips(found: pc.Ensemble) -> Floats:
    """Return when one of the links first turns over, s; NaN where none does."""
    return np.fmin(*(found[name] for name in EVENTS))


def computed(count: int) -> dict[str, Any]:
    """Compute the map, and a second time, and which pixels agree."""
    q0 = np.pi / 2 + half(count)
    forbidden = np.all([is_forbidden(BOOK, q0, 0.0, one) for one in EVENTS.values()], axis=0)
    begin = perf_counter()
    keep = {name: pc.reducers.FirstEvent(one) for name, one in EVENTS.items()}
    asked = {"t_span": (0, T_END), "keep": keep, "max_steps": 10**9, "progress": True}
    found = pc.ensemble(BOOK, q0=q0[~forbidden], **asked)
    seconds = perf_counter() - begin
    other = found.second(progress=True)
    both = perf_counter() - begin
    one, two = flips(found), flips(other)
    agree = (np.abs(one - two) <= 0.01 * np.fmax(one, two)) | (np.isnan(one) & np.isnan(two))
    agree &= found.success & other.success

    def placed(values: NDArray[Any], otherwise: Any) -> NDArray[Any]:
        full = np.full(forbidden.shape, otherwise, values.dtype)
        full[~forbidden] = values
        return whole(full)

    return {
        "flip": placed(one, np.nan),
        "resolved": placed(agree, True),
        "first": placed(np.fmin(one, two), np.nan),
        "forbidden": whole(forbidden),
        "seconds": seconds,
        "seconds with the second ensemble": both,
        "right-hand sides or series": found.statistics["nfev"],
    }


def in_many_digits(theta: tuple[float, float], until: float) -> float:
    """Return the time at which a link first turns over, s, off by GRID at most; NaN if none does.

    A link may turn over and back between two times of the grid: it does if it reverses beyond
    upright.
    """
    chain = RodChain([1.0, 1.0], [1.0, 1.0], BOOK.gravity)
    q0 = [np.pi / 2 + x for x in theta]
    digits = 24 + int(1.2 * until)

    def angles_at(times: Floats) -> tuple[Floats, Floats]:
        exact = [Fraction(t) for t in times.tolist()]
        made = motion(chain, q0, [0.0, 0.0], exact, digits=digits)
        state = np.array([[float(x) for x in row] for row in made]).reshape(-1, 4)
        return state[:, :2], state[:, 2:]

    times = GRID * np.arange(1, int(np.ceil(until / GRID)) + 1)
    q, qd = angles_at(times)
    times = np.concatenate([[0.0], times])
    q, qd = np.concatenate([[q0], q]), np.concatenate([[[0.0, 0.0]], qd])
    between = CubicHermiteSpline(times, q, qd)
    rates = between.derivative()
    reversals = np.unique(np.concatenate([*rates.roots(extrapolate=False)]))
    distance = (between(reversals) - UP + np.pi) % (2 * np.pi) - np.pi
    close = reversals[(np.abs(distance) < CLOSE).any(axis=1) & (reversals > 0)]
    if len(close):
        times = np.concatenate([times, close])
        q = np.concatenate([q, angles_at(close)[0]])
    turns = np.floor((q - UP) / (2 * np.pi))
    changed = (turns != turns[0]).any(axis=1)
    return float(times[changed].min()) if changed.any() else np.nan


def checked(found: dict[str, Any], count: int, pixels: int) -> dict[str, Any]:
    """Compare resolved pixels, drawn at random, with motions in many digits."""
    theta = angles(count)
    may = found["resolved"] & ~found["forbidden"]
    may[count // 2 :] = False  # mirror images
    places = np.argwhere(may)
    drawn = places[(pc.sampling.uniform(0, 1, pixels, seed=3) * len(places)).astype(int)]
    flip = found["flip"][tuple(drawn.T)]
    until = np.fmin(np.where(np.isnan(flip), LONGEST, 1.01 * flip + 2 * GRID), LONGEST)
    starts = [tuple(float(x) for x in theta[place]) for place in drawn]
    with ProcessPoolExecutor() as pool:
        truth = np.array([*pool.map(in_many_digits, starts, until.tolist(), chunksize=4)])
    expected = np.where(flip < until, flip, np.nan)
    wrong = ~(
        (np.abs(truth - expected) <= GRID + 0.01 * expected)
        | (np.isnan(truth) & np.isnan(expected))
    )
    return {
        "pixels": len(drawn),
        "that turn over": int(np.isfinite(expected).sum()),
        "longest": float(until.max()),
        "wrong": int(wrong.sum()),
        "wrong ones": [
            [*starts[k], float(flip[k]), float(truth[k])] for k in np.flatnonzero(wrong)
        ],
    }


def unresolved(found: dict[str, Any], times: Floats) -> list[float]:
    """Return the share of pixels that are not resolved if the map ends at each of the times."""
    lost = np.where(found["resolved"], np.inf, found["first"])
    lost = np.where(np.isnan(lost), np.inf, lost)
    return [float(np.mean(lost <= t)) for t in times]


def draw(found: dict[str, Any], path: Path) -> None:
    """Draw when a link first turns over, what is not resolved, and what has no value."""
    never = ~np.isfinite(found["flip"]) & ~found["forbidden"]
    blanks = {"did not turn over": never, "energy forbids it": found["forbidden"]}
    shown = Shown("first turn over, in sqrt(l/g)", found["flip"] / UNIT, blanks, is_log=True)
    degrees = np.linspace(-180, 180, len(found["flip"]))
    across, up = (Axis(f"angle of link {i} from hanging (deg)", degrees) for i in (1, 2))
    (axes,) = new_axes((8.6, 7.0))
    draw_map(axes, across, up, shown, found["resolved"], {})
    axes.set(xticks=range(-180, 181, 60), yticks=range(-180, 181, 60))
    plt.savefig(path, dpi=110)


def page(record: dict[str, Any]) -> str:
    count, check = record["pixels along an axis"], record["check in many digits"]
    columns = record["times"], record["turned over"], record["unresolved"]
    rows = [(f"{t:,.0f}", f"{x:.2%}", f"{lost:.2%}") for t, x, lost in zip(*columns, strict=True)]
    heads = ["map to t, sqrt(l/g)", "turned over by then", "not resolved"]
    size = f"{count} x {count} pixels"
    end = f"10^{np.log10(record['t_end'] / UNIT):.0f} sqrt(l/g) = {record['t_end']:.0f} s"
    times = f"{record['seconds']:.0f} s on {record['processors']} processors ({record['machine']})"
    both = f"{record['seconds with the second ensemble']:.0f} s"
    return f"""
{size}, to {end}. The map took {times},
with the second ensemble {both}. At {record["forbidden"]:.1%} of the pixels energy forbids that
a link turns over.

{table_of(heads, rows, left=3)}
{check["pixels"]} resolved pixels, drawn at random, were computed in many digits until they turned
over, or for at most {check["longest"]:.0f} s: {check["that turn over"]} turned over by then.
**{check["wrong"]} of them were wrong.**

"""


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--count", type=int, default=1024)
    parser.add_argument("--checked", type=int, default=CHECKED)
    args = parser.parse_args()
    found = computed(args.count)
    times = 10.0 ** np.arange(0.5, 4.01, 0.5)
    record = {
        "pixels along an axis": args.count,
        "t_end": T_END,
        "machine": processor(),
        "processors": os.cpu_count(),
        **{name: x for name, x in found.items() if not isinstance(x, np.ndarray)},
        "forbidden": float(found["forbidden"].mean()),
        "times": times.tolist(),
        "turned over": [float(np.mean(found["flip"] <= t * UNIT)) for t in times],
        "unresolved": unresolved(found, times * UNIT),
        "check in many digits": checked(found, args.count, args.checked),
    }
    draw(found, ROOT / "docs/figures/flip_map.png")
    (ROOT / "docs/records/flip_map.json").write_text(json.dumps(record, indent=1) + "\n")
    rewrite(ROOT / "docs/background/flip_map.md", flip_map=page(record))
    print(page(record))


if __name__ == "__main__":
    main()
