"""Derivatives along a run of what is made of its states: places, velocities, energies."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import numpy.typing as npt

from pendcore._messages.arguments import Floats
from pendcore._messages.warning import warn
from pendcore._run.sensitivities import along, sensitivities_there, times_within
from pendcore._run.solution import Solution
from pendcore._scene.linearization import different_names
from pendcore._scene.outputs import Rows, outputs_at
from pendcore._scene.scene import Scene


def output_sensitivities(
    solution: Solution, outputs: Iterable[str], t: npt.ArrayLike | None
) -> Floats:
    """See `Solution.output_sensitivities`."""
    S, states = sensitivities_there(solution), solution.y.T
    wanted = different_names("outputs", outputs)
    times = solution.t if t is None else times_within(solution, t)
    flat = times.reshape(-1)
    if t is not None:
        S, states = along(solution, flat)
    scene, names, rows = solution.scene, solution.sensitivity_names, None
    if any(str(name).startswith("qdd[") for name in wanted):
        rows = _accelerations(scene, flat, states, names)
    found = outputs_at(scene, flat, states, names, wanted, rows, flat - solution.t_span[0])
    by_names: Floats = found.by_state @ S + found.by_names
    return by_names.reshape(*times.shape, *by_names.shape[1:])


def _accelerations(scene: Scene, times: Floats, states: Floats, names: tuple[str, ...]) -> Rows:
    """Return accelerations and their derivatives at states (k, 2n); NaN where there are none."""
    n = len(scene.links)
    inputs = {x: k for k, x in enumerate(names) if not x.startswith(("q0[", "qd0["))}
    values, by_state = np.full((len(times), n), np.nan), np.full((len(times), n, 2 * n), np.nan)
    by_names, refusals = np.zeros((len(times), n, len(names))), []
    for i, (t, x) in enumerate(zip(times.tolist(), states, strict=True)):
        try:
            there = scene.linearize(x[:n], x[n:], t, inputs=list(inputs))
        except ValueError as refused:
            refusals.append(f"t = {t:.6g} s: {refused}")
            continue
        values[i], by_state[i] = there.drift[n:], there.A[n:]
        by_names[i][:, list(inputs.values())] = there.B[n:]
    if refusals:
        warn(f"outputs: qdd[i] have no derivative at {len(refusals)} times, such as {refusals[0]}")
    return Rows(values, by_state, by_names)
