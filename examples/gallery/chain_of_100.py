"""A chain of a hundred links.

Two metres of chain fall from the horizontal. A Taylor series computes them by a
recursion over the links.
"""

from __future__ import annotations

import pendcore as pc

links = [pc.Link(mass=0.01, length=0.02)] * 100
damping = [pc.effects.ViscousJoint(joint=j, damping=2e-5) for j in range(2, 101)]
scene = pc.Scene(links=links, effects=damping)
sol = pc.simulate(scene, (0, 4), 0.0, rtol=1e-6)
sol.to_video("chain_of_100.mp4", trace=1.0)
sol.to_html("chain_of_100.html", title="A chain of a hundred links")
