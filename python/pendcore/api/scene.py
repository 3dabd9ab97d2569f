"""The scene that a user holds: plain data and what is built on it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pendcore.explanation.explain import explain
from pendcore.explanation.explanation import Explanation
from pendcore.messages.arguments import vector
from pendcore.messages.html import beside, drawing, table
from pendcore.scene.scene import SceneData

MOST_ROWS = 20
"""The most links in the table of a notebook."""


@dataclass(frozen=True, slots=True, init=False, repr=False, eq=False)
class Scene(SceneData):
    """A chain of links on a pivot, and what acts on it, ready to be simulated.

    Parameters
    ----------
    links : iterable of Link
        From the pivot outwards, one or more.
    gravity : float, default 9.807
        Downward, m/s^2; finite. 0 is allowed.
    effects : iterable of pendcore.effects.Effect
        What acts besides gravity, in any number and order. Nothing else is simulated:
        `explain` says what is and what is not.

    Raises
    ------
    ValueError, TypeError
        If a value is out of its range; the message names link, value, range and unit.

    Warns
    -----
    PendcoreWarning
        If a value is allowed and implausible, such as more inertia than a link of that length
        could have.

    Notes
    -----
    A scene cannot be changed; ``scene.replace(gravity=1.62)`` makes another.

    Examples
    --------
    >>> rods = [pc.Link(mass=1.0, length=1.0), pc.Link(mass=0.5, length=0.7)]
    >>> damper = pc.effects.ViscousJoint(joint=2, damping=0.1)
    >>> scene = pc.Scene(links=rods, effects=[damper])
    >>> scene.effects
    (ViscousJoint(joint=2, damping=0.1),)
    """

    def _repr_html_(self) -> str:
        links = [
            [str(i), *(f"{x:.6g}" for x in (one.mass, one.length, one.center, one.inertia))]
            for i, one in enumerate(self.links[:MOST_ROWS], 1)
        ]
        left_out = len(self.links) - len(links)
        links += [[f"and {left_out} more", "", "", "", ""]] * (left_out > 0)
        head = ("link", "mass (kg)", "length (m)", "center (m)", "inertia (kg m^2)")
        effects = [[str(i), repr(one)] for i, one in enumerate(self.effects, 1)]
        below = table(effects, ("", "effect")) if effects else "<p>no effects</p>"
        n = len(self.links)
        slanted = np.linspace(0.35, 0.9, n)[np.newaxis]  # rad; a pose that shows every link
        pose = self._compiled.positions(np.zeros(1), slanted)[0]
        about = f"<p>gravity {self.gravity:.6g} m/s^2, downwards</p>"
        return beside(about + table(links, head) + below, drawing([pose], None, f"{n} links"))

    def explain(self, t: float = 0.0, q: npt.ArrayLike | None = None) -> Explanation:
        """Say what is simulated and what is not, what it costs, and how fast it moves.

        Parameters
        ----------
        t : float, default 0
            Time at which motors and pivot are looked at, s.
        q : array_like, (n,), optional
            Angles from which to look for equilibria, besides hanging and upright, rad. A `Lock`
            without an angle holds its joint as it is in ``q``; if ``q`` is not given, as it is in
            hanging and in upright, and a remark says so.

        Returns
        -------
        Explanation
            Print it, or take its fields; ``to_dict()`` for JSON.

        Examples
        --------
        >>> told = pc.Scene.textbook().explain()  # print(told) shows it all
        >>> hanging, upright = told.equilibria
        >>> [f"{mode.frequency:.3f} Hz" for mode in hanging.modes]
        ['0.426 Hz', '1.144 Hz']
        """
        start = None if q is None else vector("q", q, len(self.links), "rad")
        (time,) = vector("t", t, 1, "s")
        return explain(self, time, start)
