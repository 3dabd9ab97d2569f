"""Shows that an installed pendcore works, with NumPy and the standard library alone.

    python tests/packaging/installed.py

It repeats runs of tests/cpp/trajectory_hash.cpp. The exit status is 1 if the hash of one is not
the recorded one, if pickle does not find an effect, if a page of a run has no core inside, or if
pendcore is not the installed one.
"""

from __future__ import annotations

import math
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

began = time.perf_counter()
import pendcore as pc  # noqa: E402
from pendcore import effects as fx  # noqa: E402

IMPORT = time.perf_counter() - began

RECORDED = Path(__file__).parents[1] / "cpp/trajectory_hash.txt"
BOOK, RODS = pc.Scene.textbook(), [pc.Link(mass=1.0, length=0.7)] * 2
CHAIN = pc.Scene(links=[pc.Link(mass=0.4, length=0.3)] * 7)
POINT = pc.Link.point_mass(mass=0.4, length=1.6)
UNEVEN = pc.Scene(links=[pc.Link(mass=2.5, length=0.7), POINT], gravity=9.81)
DRAG = pc.Scene(links=RODS, effects=[fx.RodDrag(2, drag_coefficient=1.2, diameter=0.03)])
DAMPER = pc.Scene(links=RODS, effects=[fx.ViscousJoint(2, damping=1e5)])
HIGH = {"q0": [-1.4, -1.1], "t_span": (0, 60)}
DOPRI5 = {"method": "dopri5"}
RUNS: dict[str, tuple[pc.Scene, dict[str, Any]]] = {
    "textbook": (BOOK, {"q0": [math.pi / 4, math.pi / 3], "t_span": (0, 60), **DOPRI5}),
    "backward": (UNEVEN, {"q0": [2.8, -0.4], "qd0": [1.5, -2.0], "t_span": (0, -20), **DOPRI5}),
    "default textbook": (BOOK, HIGH),
    "textbook dop853": (BOOK, {**HIGH, "method": "dop853", "rtol": 1e-11}),
    "textbook rk4": (BOOK, {**HIGH, "method": "rk4", "rtol": 1e-11, "step": 0.01}),
    "chain": (CHAIN, {"q0": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7], "t_span": (0, 5), **DOPRI5}),
    "default drag": (DRAG, {"q0": [0.3, 0.9], "qd0": [4.0, -9.0], "t_span": (0, 4)}),
    "default damper": (DAMPER, {"q0": [0.8, 1.0], "t_span": (0, 2)}),
}


def is_found_by_its_name(cls: type) -> bool:
    """Say whether a pickle, and so another process, knows the class; its maker is not its home."""
    return getattr(sys.modules[cls.__module__], cls.__qualname__, None) is cls


def main() -> int:
    recorded = dict(line.rsplit(" ", 1) for line in RECORDED.read_text().splitlines())
    here = Path(pc.__file__).resolve()
    wrong = 0
    if "site-packages" not in here.parts and "dist-packages" not in here.parts:
        print(f"{here} is not an installed pendcore")
        wrong += 1
    for name, (scene, asked) in RUNS.items():
        found = pc.simulate(scene, on_failure="ignore", **asked).fingerprint
        same = found == recorded[name]
        wrong += not same
        print(f"{name:20} {found} {'the recorded hash' if same else f'NOT {recorded[name]}'}")
    with tempfile.TemporaryDirectory() as folder:
        page = pc.Case.textbook().simulate().to_html(Path(folder, "run.html")).read_text()
    lost = [kind for kind, cls in fx.kinds().items() if not is_found_by_its_name(cls)]
    wrong += len(lost)
    print(f"pickle finds {'every effect' if not lost else f'NOT {lost}'}")
    alive = "plays back" not in page
    wrong += not alive
    print(f"a page has {len(page)} bytes, and {'' if alive else 'NOT '}the core inside")
    print(f"pendcore {pc.__version__}, imported in {1000 * IMPORT:.0f} ms")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
