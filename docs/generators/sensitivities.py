"""What derivatives along a run cost, beside the run and heyoka's.

    make write PAGE=sensitivities

The tables of docs/how_to/linearize.md: two rods, derivatives by their starts, or by these and six
more numbers; times are minima of turns. Beside the run alone: at the end of 20 s, by each method at
each tolerance. Beside heyoka: at 51 times over 5 s; each way takes the loosest of its tolerances
that keeps an error, as a share of the largest entry. The reference is heyoka's at its tightest for
pendcore, and pendcore's for heyoka.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import heyoka as hy
import numpy as np
import pendcore as pc
from asked_errors import least_times
from page_part import ROOT, rewrite, table_of

Q0, QD0, TIMES, TURNS = [0.5, 1.0], [0.0, 0.0], np.linspace(0.0, 5.0, 51), 15
STARTS = ["q0[1]", "q0[2]", "qd0[1]", "qd0[2]"]
MORE = ["gravity", "link[1].mass", "link[2].mass", "link[1].inertia", "link[2].inertia",
        "link[1].length"]  # fmt: skip
CENTER, INERTIA = 0.45, 0.08
"""Not those of uniform rods, whose centres would move with their lengths."""
ROD = pc.Link(mass=1.0, length=1.0, center=CENTER, inertia=INERTIA)
SCENE = pc.Scene(links=[ROD, ROD])
Run = Callable[[], np.ndarray]


def pendulum() -> tuple[Any, Any, list[Any]]:
    """The equations for heyoka, its variables, and its parameters in the order of MORE."""
    q1, q2, w1, w2 = variables = hy.make_vars("q1", "q2", "w1", "w2")
    g, m1, m2, i1, i2, length = parameters = [hy.par[i] for i in range(6)]
    a11, a22 = i1 + m1 * CENTER**2 + m2 * length**2, i2 + m2 * CENTER**2
    a12 = m2 * length * CENTER
    c, s = hy.cos(q1 - q2), hy.sin(q1 - q2)
    b1 = (m1 * CENTER + m2 * length) * g * hy.cos(q1) - a12 * s * w2**2
    b2 = m2 * CENTER * g * hy.cos(q2) + a12 * s * w1**2
    det = a11 * a22 - (a12 * c) ** 2
    rates = [w1, w2, (a22 * b1 - a12 * c * b2) / det, (a11 * b2 - a12 * c * b1) / det]
    return list(zip(variables, rates, strict=True)), list(variables), parameters


def of_heyoka(names: list[str], tolerance: float) -> Run:
    equations, variables, parameters = pendulum()
    by = variables + parameters[: len(names) - 4]
    system = hy.var_ode_sys(equations, by, order=1)
    values = [9.807, 1.0, 1.0, INERTIA, INERTIA, 1.0]
    run = hy.taylor_adaptive(system, [*Q0, *QD0], pars=values, tol=tolerance, fast_math=True)
    start = run.state.copy()

    def derivatives() -> np.ndarray:
        run.time, run.state[:] = 0.0, start
        states = run.propagate_grid(TIMES)[-1]
        return states[:, 4:].reshape(len(TIMES), 4, -1)

    return derivatives


def of_pendcore(names: list[str], tolerance: float) -> Run:
    more = {"sensitivities": names} if names else {}
    how: Any = {"method": "taylor", "rtol": tolerance, "atol": tolerance / 1000} | more
    return lambda: pc.simulate(SCENE, (0, 5), Q0, QD0, t_eval=TIMES, **how).sensitivities


def of_differences(names: list[str], tolerance: float) -> Run:
    how: Any = {"method": "taylor", "rtol": tolerance, "atol": tolerance / 1000}

    def end(name: str, by: float) -> np.ndarray:
        scene, y = SCENE, np.array([*Q0, *QD0])
        if name in STARTS:
            y[STARTS.index(name)] += by
        else:
            scene = scene.with_parameters({name: scene.parameters()[name] + by})
        return pc.simulate(scene, (0, 5), y[:2], y[2:], t_eval=TIMES, **how).y.T

    def derivatives() -> np.ndarray:
        by = 1e-5
        return np.stack([(end(x, by) - end(x, -by)) / (2 * by) for x in names], axis=2)

    return derivatives


def loosest(way: Callable[[float], Run], right: np.ndarray, error: float) -> tuple[Run, float]:
    """The run of the loosest tolerance that keeps an error, or of the best one; and its error."""
    found: list[tuple[float, Run]] = []
    for tolerance in 10.0 ** -np.arange(6, 15.5, 0.5):
        run = way(tolerance)
        off = np.abs(run() - right).max() / np.abs(right).max()
        found.append((off, run))
        if off <= error:
            break
    off, run = min(found, key=lambda one: one[0])
    return run, off


def times(runs: list[Run]) -> list[float]:
    """The least time of each, taken in turns, s."""
    return [*least_times(dict(enumerate(runs)), TURNS).values()]


def by_method() -> str:
    """How many runs alone a run with names takes."""
    rows = []
    for method in ("taylor", "dop853", "dopri5"):
        took = np.empty((3, 3))
        for k, rtol in enumerate((1e-6, 1e-9, 1e-12)):
            how: Any = {"method": method, "rtol": rtol, "atol": rtol / 1000, "store": "end"}
            run = partial(pc.simulate, SCENE, (0, 20), Q0, QD0, **how)
            by_names = [partial(run, sensitivities=names) for names in (STARTS, STARTS + MORE)]
            took[:, k] = times([run, *by_names])
        for names, of_run in zip((4, 10), took[1:] / took[0], strict=True):
            cells = [f"{x:.1f}" for x in of_run]
            rows.append([f"`{method}`" if names == 4 else "", str(names), *cells])
    heads = ["runs alone by the same method", "names", "`rtol` 10⁻⁶", "10⁻⁹", "10⁻¹²"]
    return table_of(heads, rows)


def beside_heyoka() -> str:
    ways = {"pendcore": of_pendcore, "heyoka, `var_ode_sys`": of_heyoka,
            "central differences of `pc.simulate`": of_differences}  # fmt: skip
    cells: dict[str, list[str]] = {name: [] for name in ways}
    for names in (STARTS, STARTS + MORE):
        ours, theirs = (way(names, 1e-15)() for way in (of_pendcore, of_heyoka))
        for error in (1e-8, 1e-11):
            runs = [
                loosest(partial(way, names), ours if way is of_heyoka else theirs, error)
                for way in ways.values()
            ]
            plain = of_pendcore([], 1e-12 if error < 1e-9 else 1e-9)
            of_run, *took = times([plain, *(run for run, _ in runs)])
            for name, (_, off), spent in zip(ways, runs, took, strict=True):
                missed = f", {off:.0e} off" if off > error else ""
                cells[name].append(f"{spent / of_run:.0f} runs{missed}".replace("e-0", "e-"))
    heads = ["derivatives of two rods, 5 s, at 51 times"]
    heads += ["4 names, 10⁻⁸", "10⁻¹¹", "10 names, 10⁻⁸", "10⁻¹¹"]
    return table_of(heads, [(name, *of_it) for name, of_it in cells.items()])


def main() -> None:
    page = ROOT / "docs" / "how_to" / "linearize.md"
    rewrite(page, sensitivities=beside_heyoka(), names_by_method=by_method())


if __name__ == "__main__":
    main()
