"""Three starts.

Three pendulums start a ten-thousandth of a radian apart. For seven seconds they are
one.
"""

from __future__ import annotations

import pendcore as pc

scene = pc.Scene.textbook()
starts = [[-0.6, -0.9 + 1e-4 * k] for k in range(3)]
sol, *others = [
    pc.simulate(scene, (0, 12), q0, rtol=1e-11, atol=1e-12) for q0 in starts
]
names = ("-0.9 rad", "-0.8999 rad", "-0.8998 rad")
sol.to_video("three_starts.mp4", *others, names=names, trace=0.6)
sol.to_html("three_starts.html", title="Three starts")
