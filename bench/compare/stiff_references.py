"""Make tests/data/stiff_trajectories.json, the references of the stiff scenes, in some minutes.

SciPy solves each scene twice, by unlike methods or steps and far more tightly than any contender.
The positions of the two differ by at most `disagreement` of the total length. The right-hand side
and the Jacobian are those of contenders/equations.py, which share nothing with pendcore.
"""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import stiff
from cases import Array, Case
from contenders.scipy_solvers import by_numba
from scipy.integrate import solve_ivp
from tqdm import tqdm
from trajectory_error import position_error

# The steps follow the spring's vibration, about a radian in each.
WAYS: dict[str, tuple[dict[str, Any], ...]] = {
    "damper": ({"method": "Radau", "tolerance": 1e-11}, {"method": "LSODA", "tolerance": 1e-12}),
    "spring": (
        {"method": "DOP853", "tolerance": 1e-11, "max_step": 2e-5},
        {"method": "DOP853", "tolerance": 1e-10, "max_step": 3e-5},
    ),
    "controller": (
        {"method": "Radau", "tolerance": 1e-11},
        {"method": "DOP853", "tolerance": 1e-12},
    ),
}


def solve(case: Case, method: str, tolerance: float, **more: Any) -> Array:
    """Solve with compiled right-hand sides and Jacobian: states (n_t, 4)."""
    function, derivatives, _ = by_numba(case)
    if method in ("Radau", "LSODA"):
        more["jac"] = derivatives
    found = solve_ivp(
        function, (0.0, stiff.TIMES[-1]), stiff.START, method=method, t_eval=stiff.TIMES,
        rtol=tolerance, atol=tolerance, **more,
    )  # fmt: skip
    if not found.success:
        raise RuntimeError(f"{case.name}: {found.message}")
    return found.y.T


def main() -> None:
    references = {}
    for name, ways in tqdm(WAYS.items(), unit="scene", disable=None):
        first, second = (solve(stiff.scene(name), **how) for how in ways)
        references[name] = {
            "made_by": [str(how) for how in ways],
            "disagreement": position_error(second[:, :2], first[:, :2], np.ones(2)),
            "states": first.tolist(),
        }
    stiff.REFERENCES.write_text(json.dumps(references) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
