"""The calls that `against.py` times, and the worker that times them in one build of pendcore.

    python bench/timed_calls.py

The worker says first which pendcore it has. A line of its input names a call and the seconds to
spend on it; the answer is the least time of a call, in seconds, or "-" and the reason where this
build lacks what the call needs. Arguments have names, so that a build that takes them in another
order is timed all the same.
"""

from __future__ import annotations

import json
import math
import sys
import time
import warnings
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pendcore as pc
from pendcore import effects as fx

Call = Callable[[], object]
Prepare = Callable[[], Call]
"""Makes what a call needs; it fails where the build lacks something."""
MakeScene = Callable[[], pc.Scene]

START = (math.pi / 4, math.pi / 3)
LEAST_CALLS = 2
RODS = {"one rod": 1, "three rods": 3, "four rods": 4, "ten rods": 10, "hundred rods": 100}


def rods(n: int) -> pc.Scene:
    return pc.Scene(links=[pc.Link(mass=1.0, length=1.0)] * n)


def damped() -> pc.Scene:
    dampers = [fx.ViscousJoint(joint=1, damping=0.1), fx.ViscousJoint(joint=2, damping=0.05)]
    return pc.Scene.textbook().replace(effects=dampers)


def four_effects() -> pc.Scene:
    effects = [
        fx.ViscousJoint(joint=1, damping=0.1),
        fx.TorsionalSpring(joint=2, stiffness=3.0),
        fx.Motor(joint=1, sinusoid=fx.Sinusoid(1.0, 2.0, 0.0)),
        fx.Payload(mass=0.3),
    ]
    return pc.Scene.textbook().replace(effects=effects)


def python_effect() -> pc.Scene:
    return pc.Scene.textbook().replace(effects=[fx.User(lambda t, q, qd: -0.1 * qd)])


def friction_and_stop() -> pc.Scene:
    friction = fx.DryJointFriction(joint=1, coulomb=0.2)
    stop = fx.JointStop(joint=2, range=(-1.0, 1.0), restitution=0.5)
    return pc.Scene.textbook().replace(effects=[friction, stop])


def stiff() -> pc.Scene:
    return pc.Scene.textbook().replace(effects=[fx.ViscousJoint(joint=2, damping=1e4)])


def run(scene: MakeScene, q0: Any, seconds: float, **settings: Any) -> Prepare:
    def prepare() -> Call:
        return partial(pc.simulate, scene(), q0=q0, t_span=(0.0, seconds), **settings)

    return prepare


def at_end(method: str, rtol: float) -> dict[str, Any]:
    return {"store": "end", "method": method, "rtol": rtol, "atol": rtol}


def ensemble(scene: MakeScene, method: str, rtol: float) -> Prepare:
    angles = np.random.default_rng(1).uniform(-math.pi, math.pi, (1024, 2))
    settings: dict[str, Any] = {"q0": angles, "t_span": (0.0, 5.0), "workers": 1}

    def prepare() -> Call:
        return partial(pc.ensemble, scene(), **settings, method=method, rtol=rtol, atol=rtol)

    return prepare


def tip_line() -> Call:
    bottom = pc.events.TipLine(point=(0.0, 0.0), normal=(0.0, 1.0))
    return run(pc.Scene.textbook, START, 5.0, events=[bottom])()


def energy() -> Call:
    scene = pc.Scene.textbook()
    return lambda: pc.simulate(scene, q0=START, t_span=(0.0, 5.0)).energy()


def accelerations() -> Call:
    return partial(pc.Scene.textbook().accelerations, t=0.0, q=np.array(START), qd=np.zeros(2))


def single_runs() -> dict[str, Prepare]:
    found = {
        "textbook 60 s taylor 1e-09": run(pc.Scene.textbook, START, 60.0, **at_end("taylor", 1e-9))
    }
    for method in ("dopri5", "dop853", "taylor"):
        for rtol in (1e-3, 1e-6, 1e-9, 1e-12):
            if method != "dopri5" or rtol >= 1e-9:
                settings = at_end(method, rtol)
                found[f"textbook 5 s {method} {rtol:g}"] = run(
                    pc.Scene.textbook, START, 5.0, **settings
                )
    return found


def chains_and_effects() -> dict[str, Prepare]:
    scenes: list[tuple[str, MakeScene, int]] = [
        ("damped", damped, 2),
        ("four effects", four_effects, 2),
        *((name, partial(rods, n), n) for name, n in RODS.items()),
    ]
    return {
        f"{name} 2 s {method} 1e-09": run(
            scene, np.linspace(0.5, 1.0, n), 2.0, **at_end(method, 1e-9)
        )
        for name, scene, n in scenes
        for method in ("dopri5", "dop853", "taylor")
    }


def prepared_calls() -> dict[str, Prepare]:
    """Return all calls by their names."""
    return {
        **single_runs(),
        **chains_and_effects(),
        "effect in Python 2 s": run(python_effect, START, 2.0, **at_end("dopri5", 1e-9)),
        "friction and stop 5 s": run(friction_and_stop, START, 5.0, **at_end("dopri5", 1e-8)),
        "stiff 2 s radau5": run(stiff, START, 2.0, **at_end("radau5", 1e-6)),
        "501 kept times": run(pc.Scene.textbook, START, 5.0, t_eval=np.linspace(0.0, 5.0, 501)),
        "dense, energy": energy,
        "events of the tip": tip_line,
        "error=1e-6": run(pc.Scene.textbook, START, 5.0, error=1e-6),
        "one step": run(pc.Scene.textbook, START, 1e-4, **at_end("dopri5", 1e-6)),
        "accelerations": accelerations,
        "ensemble of 1024 dopri5 1e-06": ensemble(pc.Scene.textbook, "dopri5", 1e-6),
        "ensemble of 1024 taylor 1e-06": ensemble(pc.Scene.textbook, "taylor", 1e-6),
        "ensemble of 1024 taylor 1e-12": ensemble(pc.Scene.textbook, "taylor", 1e-12),
        "ensemble of 1024 damped taylor 1e-06": ensemble(damped, "taylor", 1e-6),
    }


def least_time(call: Call, seconds: float) -> float:
    """Return the least time of a call, in seconds, after a first one that warms what it needs."""
    call()
    least = math.inf
    calls = 0
    end = time.perf_counter() + seconds
    while calls < LEAST_CALLS or time.perf_counter() < end:
        begin = time.perf_counter()
        call()
        least = min(least, time.perf_counter() - begin)
        calls += 1
    return least


def main() -> None:
    warnings.simplefilter("ignore")
    prepared = prepared_calls()
    ready: dict[str, Call] = {}
    print(pc.__file__, flush=True)
    for line in sys.stdin:
        name, seconds = json.loads(line)
        try:
            if name not in ready:
                ready[name] = prepared[name]()
            print(least_time(ready[name], seconds), flush=True)
        except Exception as lack:
            print(f"- {type(lack).__name__}: {lack}".splitlines()[0], flush=True)


if __name__ == "__main__":
    main()
