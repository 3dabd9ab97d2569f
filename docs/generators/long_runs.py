"""What ten million steps do to the energy, with and without compensated steps.

    make write PAGE=long_runs

It runs both, checks what docs/background/long_runs.md promises, and writes
docs/records/long_runs.json, the figure docs/figures/long_runs.png and the tables of the page.
tests/core/test_long_runs.py runs the same in a reduced form.
"""

from __future__ import annotations

import json
import sys
from fractions import Fraction
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import numpy.typing as npt
import pendcore as pc
from mpmath import cos, mp, mpf, sin
from page_part import ROOT, rewrite, table_of
from pendcore.plotting import LIGHT, grid, new_axes, sheet

BOOK = pc.Scene.textbook()
STEP = 5e-4
FINE = 1e-4
"""s: at this step the method's own error stays below the rounding of the energies."""


def energy(state: dict[str, Any]) -> mpf:
    """Return the textbook's total energy in 40 digits, J, at the state that a run has reached.

    The textbook has two rods of 1 kg and 1 m; angles are from the horizontal, downwards.
    """
    y = [mpf(float(x)) for x in state["position_y"]]
    for i, low in enumerate(state["position_stepper"]):
        y[i] += mpf(float(low))
    q1, q2, w1, w2 = y
    kinetic = w1**2 * 2 / 3 + w1 * w2 * cos(q1 - q2) / 2 + w2**2 / 6
    return kinetic - mpf(BOOK.gravity) * (3 * sin(q1) + sin(q2)) / 2


def drift(steps: int, compensated: bool) -> dict[str, Any]:
    """Return the drift at every thousandth step of the textbook's case."""
    times = np.arange(0, steps + 1, 1000) * STEP
    sol = pc.simulate(
        BOOK, (0, steps * STEP), [np.pi / 4, np.pi / 3], t_eval=times, method="dopri5",
        max_step=STEP, first_step=STEP, max_steps=2 * steps, compensated=compensated,
    )  # fmt: skip
    found = sol.energy()
    change = found.total - found.total[0]
    return {
        "steps": sol.stats.accepted,
        "largest": float(np.abs(change).max()),
        "of_total": float(np.abs(change).max() / abs(found.total[0])),
        "of_kinetic": float(np.abs(change).max() / found.kinetic.max()),
        "series": (change[:: max(1, len(change) // 500)] / abs(found.total[0])).tolist(),
    }


def walks(steps: list[int], starts: int, compensated: bool) -> npt.NDArray[np.float64]:
    """Return the energy's drift after so many steps from random starts, J, (starts, len(steps)).

    The energy is that of both parts of the state, in 40 digits.
    """
    rng = np.random.default_rng(2718)
    rows = []
    with mp.workdps(40):
        for q0 in rng.uniform(np.pi / 2 - 0.9, np.pi / 2 + 0.9, (starts, 2)):
            how = {"method": "dopri5", "store": "end", "step": FINE, "compensated": compensated}
            sol = pc.simulate(BOOK, (0, 0), q0, **how)
            begun = energy(sol._run.__getstate__())
            row = []
            for count in steps:
                sol = sol.resume((count + 0.5) * FINE, max_steps=10**10)
                state = sol._run.__getstate__()
                assert state["position_accepted"] == count
                row.append(float(energy(state) - begun))
            rows.append(row)
    return np.array(rows)


def slope(steps: list[int], rms: npt.NDArray[np.float64]) -> float:
    """Return the exponent of the growth of rms with the number of steps."""
    return float(np.polyfit(np.log(steps), np.log(rms), 1)[0])


def time_kept(steps: int) -> dict[str, Any]:
    """Return how far the time of fixed steps is from their number times their size, s."""
    sol = pc.simulate(BOOK, q0=0.3, t_span=(0, 1.01 * steps * STEP), method="dopri5",
                      step=STEP, store="end", max_steps=steps, on_failure="ignore")  # fmt: skip
    state = sol._run.__getstate__()
    exact = steps * Fraction(STEP)
    plain = float(np.add.accumulate(np.full(steps, STEP))[-1])
    return {
        "steps": sol.stats.accepted,
        "two_doubles": float(
            abs(Fraction(state["position_t"]) + Fraction(state["position_t_low"]) - exact)
        ),
        "one_double": float(abs(Fraction(plain) - exact)),
    }


def record(steps: int, starts: int) -> dict[str, Any]:
    """Run it all."""
    counts = [round(x) for x in np.logspace(4, np.log10(steps), 2 * len(str(steps)) - 9)]
    found: dict[str, Any] = {"steps": counts, "starts": starts, "time": time_kept(steps)}
    for name, compensated in (("rounded", False), ("compensated", True)):
        rms = np.sqrt((walks(counts, starts, compensated) ** 2).mean(axis=0))
        found[name] = {
            "drift": drift(steps, compensated),
            "rms": rms.tolist(),
            "slope": slope(counts, rms),
        }
    return found


def tables(found: dict[str, Any]) -> str:
    """Return the tables of the page."""
    both = found["rounded"], found["compensated"]
    steps, of_total, of_kinetic = (
        " | ".join(f"{one['drift'][key]:{form}}" for one in both)
        for key, form in (("steps", ","), ("of_total", ".1e"), ("of_kinetic", ".1e"))
    )
    rows = [
        (f"{count:,}", *(f"{one['rms'][i]:.1e}" for one in both))
        for i, count in enumerate(found["steps"])
    ]
    rows.append(("exponent of the growth", *(f"{one['slope']:.2f}" for one in both)))
    walked = f"rms drift of {found['starts']} starts, J, after steps of 1e-4 s"
    kept = found["time"]
    off = kept["two_doubles"]
    time = f"off by {off:.0e} s" if off else "exact to the last bit"
    return f"""\
| | rounded | compensated |
|---|--:|--:|
| steps of 5e-4 s | {steps} |
| largest drift, share of the total energy | {of_total} |
| largest drift, share of the largest kinetic energy | {of_kinetic} |

{table_of([walked, "rounded", "compensated"], rows, left=0)}
After {kept["steps"]:,} fixed steps of 5e-4 s the time is {time}; one double would be off by
{kept["one_double"]:.0e} s.
"""


def figure(found: dict[str, Any], path: Path) -> None:
    """Draw the drift of the textbook's case, and the growth of the rms over the starts."""
    plt.style.use(sheet())
    axes = new_axes((9, 3.6), columns=2)
    for name, color in (("rounded", LIGHT.ochre), ("compensated", LIGHT.blue)):
        one = found[name]
        times = np.linspace(0, one["drift"]["steps"] * STEP, len(one["drift"]["series"]))
        axes[0].plot(times, np.array(one["drift"]["series"]) * 1e12, color=color, label=name, lw=1)
        axes[1].loglog(found["steps"], one["rms"], "o-", color=color, label=name, ms=3)
    first = found["compensated"]["rms"][0]
    root = first * np.sqrt(np.array(found["steps"]) / found["steps"][0])
    axes[1].loglog(found["steps"], root, ":", color=LIGHT.quiet, label="square root of the steps")
    axes[0].set(xlabel="t (s)", ylabel="energy drift / |total energy| (1e-12)",
                title=f"textbook's case, {found['rounded']['drift']['steps']:,} steps")  # fmt: skip
    axes[1].set(xlabel="steps of 1e-4 s", ylabel="rms energy drift (J)",
                title=f"{found['starts']} random starts")  # fmt: skip
    for part in axes:
        part.legend()
        grid(part)
    plt.savefig(path, dpi=110)


def main() -> None:
    found = record(10_000_000, 24)
    (ROOT / "docs/records/long_runs.json").write_text(json.dumps(found, indent=1) + "\n")
    rewrite(ROOT / "docs/background/long_runs.md", long_runs=tables(found))
    figure(found, ROOT / "docs/figures/long_runs.png")
    print(tables(found))
    largest = found["compensated"]["drift"]["of_kinetic"]
    if not largest < 1e-12:
        sys.exit(f"compensated, the energy drifted by {largest:.1e}")


if __name__ == "__main__":
    main()
