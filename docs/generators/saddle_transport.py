"""Orbits about Down-Up and Up-Down, and the motions between them, with error bars.

    make write PAGE=saddle_transport

It makes figures of Kaheman, Bramburger, Kutz & Brunton, Nonlinear Dynamics 111 (2023) 7199, anew:
docs/figures/saddle_*.webp and the tables of docs/how_to/orbits.md. THEIRS are numbers from the
programs that go with the paper (github.com/dynamicslab/Saddle-Mediated-Transport-of-Double-
Pendulum).
"""

from __future__ import annotations

from typing import Any

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import pendcore as pc
from page_part import ROOT, rewrite, table_of
from pendcore.plotting import LIGHT, grid, sheet

DOWN = np.pi / 2
SCENE = pc.Scene(
    links=[
        pc.Link(mass=0.0938439747983407, length=0.172719203817519, center=0.108565214610396,
                inertia=0.00043752942975691),
        pc.Link(mass=0.137595970499412, length=0.2286, center=0.116779018445656,
                inertia=0.00126882939257741),
    ],
    gravity=9.8085802336215,
)  # fmt: skip
ENERGY = 0.2
"""J; at 0.1754 J the way past Up-Down opens."""
THEIRS = {
    "about Down-Up": (1, [14.75091676562244, 8.84629055058124]),
    "about Up-Down": (2, [1.2873939240043606, 4.869279573811112]),
    "Up-Down, whole turns": (2, [20.704284411720227, -20.03102661145768]),
    "Down-Up, whole turns": (1, [-9.65638354688606, -20.5152473222608]),
}
"""The link that hangs, and both rates there, rad/s."""
HANGS = [pc.events.LinkAngle(link, DOWN, every_turn=True) for link in (1, 2)]
STRAIGHT = pc.events.JointAngle(2, 0.0, every_turn=True)


def of_whole_turns(name: str) -> pc.PeriodicOrbit:
    start = {"Up-Down, whole turns": [0.0, 0.0], "Down-Up, whole turns": [0.0, np.pi]}[name]
    return pc.periodic_orbit(SCENE, np.add(start, DOWN), THEIRS[name][1], energy=ENERGY)


def rows_of_orbits(orbits: dict[str, pc.PeriodicOrbit]) -> str:
    """A table of periods, multipliers, and rates where a link hangs, beside theirs."""
    rows = []
    for name, orbit in orbits.items():
        link, theirs = THEIRS[name]
        run = orbit.solution(events=[HANGS[link - 1]], rtol=1e-13, atol=1e-16)
        starts = np.vstack([run.events[0].qd, orbit.qd0])
        rates = starts[np.abs(starts - theirs).max(axis=1).argmin()]
        largest = max(orbit.multipliers, key=abs)
        grown = f"{largest.real:,.3f}" if abs(largest) > 1 + 1e-9 else "1 (stable)"
        ours, others = (", ".join(f"{x:.7f}" for x in y) for y in (rates, theirs))
        bar = f"{orbit.period:.12f} ± {max(orbit.period_error, 1e-14):.0e}"
        rows.append([name, bar, grown, ours, others])
    heads = ["orbit at 0.2 J", "period, s", "largest multiplier", "rates where a link hangs, rad/s"]
    return table_of([*heads, "theirs"], rows)


def rows_of_connections(found: dict[str, tuple[int, tuple[pc.Connection, ...]]]) -> str:
    rows = []
    for name, (link, connections) in found.items():
        for x in sorted(connections, key=lambda x: (round(abs(wrapped(x.q)[link]), 6), x.qd[link])):
            angle = 0.0 + round(float(wrapped(x.q)[link]), 8)
            told = f"{angle:.8f}", f"{x.qd[link]:.7f}", f"{x.error:.0e}", f"{x.angle:.3f}"
            rows.append([name, *told])
    heads = ["connection", "θ, rad", "rate of it, rad/s", "error, rad", "angle, rad"]
    return table_of(heads, rows)


def wrapped(q: Any) -> Any:
    """Angles from hanging, within half a turn."""
    return (np.asarray(q) - DOWN + np.pi) % (2 * np.pi) - np.pi


def draw_families(families: dict[str, tuple[pc.PeriodicOrbit, ...]]) -> None:
    figure, axes = plt.subplots(1, 4, figsize=(12.0, 3.2), layout="constrained")
    for k, (name, family) in enumerate(families.items()):
        levels = np.linspace(family[0].energy, family[-1].energy, 7)[1:]
        chosen = [min(family, key=lambda one: abs(one.energy - level)) for level in levels]
        for i, one in enumerate(chosen):
            q = one.solution(t_eval=np.linspace(0, one.period, 400)).q - DOWN
            axes[k].plot(*q.T, color=plt.cm.cividis(i / 6), lw=1.4)
        axes[k].set(title=f"about {name}", xlabel="θ₁ (rad)", ylabel="θ₂ (rad)")
        energies = [one.energy for one in family]
        growth = [abs(one.multipliers[0]) for one in family]
        color, dash = LIGHT.links[k], ("-", "--")[k]
        axes[2].plot(energies, [one.period for one in family], dash, color=color, label=name)
        axes[3].semilogy(energies, growth, dash, color=color)
    axes[2].set(xlabel="energy (J)", ylabel="period (s)")
    axes[3].set(xlabel="energy (J)", ylabel="largest multiplier")
    axes[2].legend()
    for one in axes:
        grid(one)
    figure.savefig(ROOT / "docs/figures/saddle_orbits.webp", dpi=110)


def draw_connections(cases: dict[str, Any]) -> None:
    figure, axes = plt.subplots(2, 3, figsize=(12.0, 7.0), layout="constrained")
    for name, (above, below) in zip(cases, axes.T, strict=True):
        away, back, link, found = cases[name]
        for tube, color in ((away, LIGHT.red), (back, LIGHT.blue)):
            states = tube.crossings(4000)
            x, rate = wrapped(states[:, :2])[:, link], states[:, 2 + link]
            x[np.abs(np.diff(x, append=x[0])) > 1] = np.nan
            above.plot(x, rate, color=color, lw=0.9, label=tube.stability)
            for phase in np.arange(60) / 60:
                run = tube.run(phase, store="dense")
                q = run(np.linspace(run.t[0], run.t[-1], 200))[:2].T
                below.plot(*(q - q[-1] + wrapped(q[-1])).T, color=color, lw=0.4, alpha=0.6)
        points = np.array([[wrapped(x.q)[link], x.qd[link]] for x in found])
        above.plot(*points.T, "o", color=LIGHT.ink, ms=4, label="connections")
        t, y = found[0].motion()
        middle = y[np.abs(t).argmin(), :2]
        below.plot(*(y[:, :2] - middle + wrapped(middle)).T, color=LIGHT.ink, lw=1.6)
        angle = f"θ{'₁₂'[link]}"
        above.set(title=name, xlabel=f"{angle} (rad)", ylabel=f"rate of {angle} (rad/s)")
        below.set(xlabel="θ₁ (rad)", ylabel="θ₂ (rad)")
        grid(above)
        grid(below)
    axes[0, 0].legend()
    figure.savefig(ROOT / "docs/figures/saddle_connections.webp", dpi=110)


def main() -> None:
    mpl.use("Agg")
    mpl.rcParams.update(sheet())
    _, down_up, up_down, _ = pc.equilibria(SCENE)
    saddles = {"Down-Up": down_up, "Up-Down": up_down}
    families = {name: one.orbit(1).continued("energy", 0.48) for name, one in saddles.items()}
    one, other = (x.orbit(1).continued("energy", ENERGY)[-1] for x in saddles.values())
    orbits = {"about Down-Up": one, "about Up-Down": other}
    orbits |= {name: of_whole_turns(name) for name in [*THEIRS][2:]}
    cases: dict[str, Any] = {}
    for name, first, second, until, sides, link in (
        ("Down-Up to itself", one, one, HANGS[1], (1, -1), 0),
        ("Up-Down to itself", other, other, HANGS[0], (-1, -1), 1),
        ("Down-Up to Up-Down", one, other, STRAIGHT, (1, -1), 0),
    ):
        away = first.manifold("unstable", sides[0], until=until)
        back = second.manifold("stable", sides[1], until=until)
        cases[name] = away, back, link, pc.connections(away, back)
    draw_families(families)
    draw_connections(cases)
    found = {name: (link, connections) for name, (_, _, link, connections) in cases.items()}
    rewrite(ROOT / "docs/how_to/orbits.md", saddle_orbits=rows_of_orbits(orbits),
            saddle_connections=rows_of_connections(found))  # fmt: skip


if __name__ == "__main__":
    main()
