"""The equations of an arm as code of its own: here NumPy, and a header in the C++ twin.

    pendcore derive examples/10_generated_header.toml --to python -o arm.py

Both need SymPy: `pip install ".[symbolic]"` in a clone. This writes the module, runs it
in the same fixed steps as the C++ program, and holds the result against pendcore's own.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pendcore as pc
from pendcore.derive import Derivation

case = pc.read_case(Path(__file__).with_suffix(".toml"))
Path("arm.py").write_text(Derivation(case.scene).to_python())
arm: dict = {}
exec(Path("arm.py").read_text(), arm)  # as `import arm` does, wherever this runs


def rate(t, p):
    """Return the rates of the state and of the energy that the effects bring in."""
    return np.append(
        arm["right_hand_side"](t, p[:4]), sum(arm["powers"](t, p[:2], p[2:4]).values())
    )


h, steps = 5e-4, 10_000
p = np.append(case.q0, [0.0, 0.0, 0.0])
before = sum(arm["energies"](0.0, p[:2], p[2:4]))
for k in range(steps):  # the classical Runge-Kutta method
    t = k * h
    a = rate(t, p)
    b = rate(t + h / 2, p + h / 2 * a)
    c = rate(t + h / 2, p + h / 2 * b)
    d = rate(t + h, p + h * c)
    p = p + h / 6 * a + h / 3 * b + h / 3 * c + h / 6 * d

q, qd = p[:2], p[2:4]
force = arm["reactions"](steps * h, q, qd)
print(f"q(5) = {q[0]:.7f}, {q[1]:.7f} rad")
print(
    f"F_01 = ({force[0, 0]:.6f}, {force[0, 1]:.6f}) N, "
    f"F_12 = ({force[1, 0]:.6f}, {force[1, 1]:.6f}) N"
)
gained = sum(arm["energies"](steps * h, q, qd)) - before
print(f"energy gained {gained:.6f} J, brought in by motor and damper {p[4]:.6f} J")

core = case.simulate()
assert abs(core.q[-1] - q).max() < 1e-8
assert abs(core.reactions()[-1] - force).max() < 1e-5
