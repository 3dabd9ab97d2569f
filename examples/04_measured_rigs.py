"""Real pendulums, measured and simulated: five swings of double and triple ones.

The swings and where they come from: measured/README.md. Each has its case beside it,
which the shell runs too: pendcore run measured/triple_identification_1.toml
"""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pendcore as pc
from matplotlib.lines import Line2D
from pendcore.plotting import sheet

MEASURED = Path(__file__).parent / "measured"
BOUNDS = {  # how far simulated angles may be from the measured ones, rad
    "double_validation_1": 0.03,
    "double_validation_2": 0.03,
    "triple_identification_1": 0.015,
    "double_identification_1": 0.025,
    "double_identification_2": 0.025,
}
DOTS = {"linestyle": "", "marker": "o", "markersize": 4, "alpha": 0.6}

plt.style.use(sheet())
figure, axes = plt.subplots(
    len(BOUNDS), 2, figsize=(10, 11), layout="constrained", width_ratios=[3, 2]
)
for (name, bound), (angles, differences) in zip(BOUNDS.items(), axes, strict=True):
    case = pc.read_case(MEASURED / f"{name}.toml")
    rows = np.loadtxt(MEASURED / f"{name}.csv", delimiter=",", skiprows=1)
    n = len(case.scene.links)
    t, q = rows[:, 0], rows[:, 1 : 1 + n]

    sol = pc.simulate(case.scene, case.t_span, case.q0, case.qd0, t_eval=t)
    off = sol.q - q
    found = f"within {np.abs(off).max():.4f} rad over {t[-1]:.2f} s"
    print(f"{case.name}: {found}; bound {bound} rad")

    for i in range(n):
        angles.plot(t[::8], np.degrees(q[::8, i]) - 90, color=f"C{i}", **DOTS)
        angles.plot(t, np.degrees(sol.q[:, i]) - 90, color=f"C{i}", linewidth=1)
        differences.plot(t, 1e3 * off[:, i], color=f"C{i}")
    differences.axhline(1e3 * bound, color="0.4", linestyle="--")
    differences.axhline(-1e3 * bound, color="0.4", linestyle="--")
    differences.set_ylim(-1.2e3 * bound, 1.2e3 * bound)
    angles.set(title=case.name, ylabel="from hanging (deg)")
    differences.set(title="simulated - measured", ylabel="difference (mrad)")
    for axis in (angles, differences):
        axis.margins(x=0)
        axis.grid(True)
for axis in axes[-1]:
    axis.set_xlabel("t (s)")

legend = [Line2D([], [], color=f"C{i}", label=f"link {i + 1}") for i in range(3)]
legend += [
    Line2D([], [], color="k", label="measured", **DOTS),
    Line2D([], [], color="k", linewidth=1, label="simulated"),
    Line2D([], [], color="0.4", linestyle="--", label="bound"),
]
figure.legend(handles=legend, loc="outside upper center", ncols=len(legend))
figure.savefig("measured_rigs.png")
