"""A swing by its pivot.

The pivot goes up and down at twice the swing's frequency, and the swing grows out of
almost nothing.
"""

from __future__ import annotations

import numpy as np
import pendcore as pc

rod = pc.Link.point_mass(mass=1.0, length=1.0)
lift = pc.effects.Sinusoid(amplitude=0.06, angular_frequency=2 * np.sqrt(9.807))
effects = [
    pc.effects.DrivenPivot(y=lift),
    pc.effects.ViscousJoint(joint=1, damping=0.1),
]
scene = pc.Scene(links=[rod], effects=effects)
sol = pc.simulate(scene, (0, 40), np.radians(90.5))
sol.to_video("parametric.mp4", speed=3.0)
sol.to_html("parametric.html", title="A swing by its pivot")
