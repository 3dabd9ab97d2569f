"""Direct dynamics of pendulum chains, by a compiled core.

    import numpy as np
    import pendcore as pc

    scene = pc.Scene.textbook()                  # two rods of 1 kg and 1 m, g = 9.807 m/s^2
    scene = pc.Scene(links=[pc.Link(mass=1.0, length=1.0), pc.Link(mass=0.5, length=0.7)])

    scene = scene.replace(effects=[pc.effects.ViscousJoint(joint=2, damping=0.1)])
    print(scene.explain())                       # what is simulated, what is not, how fast it moves

    sol = pc.simulate(scene, (0, 5), [np.pi / 4, np.pi / 3])    # t_span in s, q0 in rad
    print(sol)                                   # what came of it
    sol.t, sol.q, sol.qd                         # s, rad, rad/s: (n_t,), (n_t, n), (n_t, n)
    sol(2.5)                                     # the state at any time: q_1, q_2, qd_1, qd_2
    sol.reactions()                              # N: on each link, where it begins
    sol.energy().total                           # J; with ledger=True, .ledger: where it went
    sol.events                                   # times and states at which what was asked for is
    sol.plot()                                   # the angles over time, as in the textbook
    sol.save("run.npz")                          # and pc.load("run.npz")
    print(pc.derive.Derivation(scene))           # the equations in symbols, step by step: SymPy

x points right, **y points down**, and an angle q is absolute, from x towards y: q = 0 is
horizontal, q = pi/2 hangs straight down. Everything is in SI units: kg, m, s, rad, N, J. Links and
joints count from 1. The examples in the docstrings need these two imports.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from pendcore import effects, events
from pendcore._api.simulate import simulate
from pendcore._cases.case import Case
from pendcore._core import __version__
from pendcore._messages.warning import PendcoreWarning
from pendcore._run.accuracy import Accuracy, AccuracyError
from pendcore._run.energy import Energy, Ledger
from pendcore._run.error_estimate import ErrorEstimate
from pendcore._run.largest_reactions import LargestReaction
from pendcore._run.run_error import RunError
from pendcore._run.solution import Solution
from pendcore._run.statistics import Statistics
from pendcore._scene.angles import angles_from_vertical, angles_to_vertical
from pendcore._scene.link import Link
from pendcore._scene.scene import Mobility, Scene

if TYPE_CHECKING:
    from pendcore import reducers, sampling
    from pendcore._accuracy.defect import Defect
    from pendcore._api.ensemble import ensemble
    from pendcore._api.files import load, read_case
    from pendcore._ensemble.ensemble import Ensemble
    from pendcore._horizon.lyapunov import LyapunovExponents, lyapunov
    from pendcore._run.event_sensitivities import EventSensitivities
    from pendcore._run.extreme_sensitivities import ExtremeSensitivities
    from pendcore._scene.linearization import Linearization
    from pendcore.cost.accuracy_cost import AccuracyCost
    from pendcore.cost.horizon import horizon_work
    from pendcore.cost.horizon_work import HorizonWork
    from pendcore.cost.sweep import accuracy_cost
    from pendcore.explanation.explanation import Explanation
    from pendcore.orbits.connection import Connection, connections
    from pendcore.orbits.equilibrium import Equilibrium, equilibria
    from pendcore.orbits.manifold import Manifold
    from pendcore.orbits.periodic_orbit import PeriodicOrbit, periodic_orbit

_WHEN_ASKED_FOR = {
    "AccuracyCost": "pendcore.cost.accuracy_cost",
    "Connection": "pendcore.orbits.connection",
    "Defect": "pendcore._accuracy.defect",
    "Ensemble": "pendcore._ensemble.ensemble",
    "Equilibrium": "pendcore.orbits.equilibrium",
    "EventSensitivities": "pendcore._run.event_sensitivities",
    "ExtremeSensitivities": "pendcore._run.extreme_sensitivities",
    "Explanation": "pendcore.explanation.explanation",
    "HorizonWork": "pendcore.cost.horizon_work",
    "Linearization": "pendcore._scene.linearization",
    "LyapunovExponents": "pendcore._horizon.lyapunov",
    "Manifold": "pendcore.orbits.manifold",
    "PeriodicOrbit": "pendcore.orbits.periodic_orbit",
    "accuracy_cost": "pendcore.cost.sweep",
    "connections": "pendcore.orbits.connection",
    "derive": "pendcore.derive",  # SymPy is an extra, and takes its time
    "ensemble": "pendcore._api.ensemble",
    "equilibria": "pendcore.orbits.equilibrium",
    "horizon_work": "pendcore.cost.horizon",
    "load": "pendcore._api.files",
    "lyapunov": "pendcore._horizon.lyapunov",
    "periodic_orbit": "pendcore.orbits.periodic_orbit",
    "read_case": "pendcore._api.files",
    "reducers": "pendcore.reducers",
    "sampling": "pendcore.sampling",
}
"""What a run does not need is loaded when it is asked for, which halves the time of an import."""


def __getattr__(name: str) -> Any:
    if name not in _WHEN_ASKED_FOR:
        raise AttributeError(f"module 'pendcore' has no attribute {name!r}")
    home = import_module(_WHEN_ASKED_FOR[name])
    found = home if home.__name__ == f"pendcore.{name}" else getattr(home, name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return [*__all__, "derive"]


__all__ = [
    "Accuracy",
    "AccuracyCost",
    "AccuracyError",
    "Case",
    "Connection",
    "Defect",
    "Energy",
    "Ensemble",
    "Equilibrium",
    "ErrorEstimate",
    "EventSensitivities",
    "Explanation",
    "ExtremeSensitivities",
    "HorizonWork",
    "LargestReaction",
    "Ledger",
    "Linearization",
    "Link",
    "LyapunovExponents",
    "Manifold",
    "Mobility",
    "PendcoreWarning",
    "PeriodicOrbit",
    "RunError",
    "Scene",
    "Solution",
    "Statistics",
    "__version__",
    "accuracy_cost",
    "angles_from_vertical",
    "angles_to_vertical",
    "connections",
    "effects",
    "ensemble",
    "equilibria",
    "events",
    "horizon_work",
    "load",
    "lyapunov",
    "periodic_orbit",
    "read_case",
    "reducers",
    "sampling",
    "simulate",
]
