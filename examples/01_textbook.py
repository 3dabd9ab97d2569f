"""The textbook's double pendulum, section 2.1: two rods, let go from 45 and 60 degrees.

By ode45, as in the book; without a method, simulate() takes a quicker one for the same
accuracy.

The same in C++: 01_textbook.cpp.
"""

from __future__ import annotations

from math import pi

import pendcore as pc

sol = pc.simulate(
    pc.Scene.textbook(), q0=[pi / 4, pi / 3], qd0=[0, 0], t_span=(0, 5), method="ode45"
)

for i in range(2):
    q, qd = sol.q[-1, i], sol.qd[-1, i]
    print(f"q_{i + 1}(5) = {q:.17g} rad, qd_{i + 1}(5) = {qd:.17g} rad/s")

curve_1, curve_2 = sol.plot()
curve_1.figure.savefig("textbook.png")
