"""What is simulated: links in a chain, hung on a fixed pivot, and gravity. SI units.

x points right, **y points down**, the origin is the pivot. The angle ``q_i`` of link i is absolute,
from +x towards +y: 0 is horizontal, pi/2 hangs straight down. Links and joints count from 1; joint
i is where link i begins.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from pendcore import _core
from pendcore.arguments import Floats, finite_array, link_array, number
from pendcore.warning import PendcoreWarning


@dataclass(frozen=True, slots=True, init=False, repr=False)
class Link:
    """One rigid link of the chain; a uniform rod unless said otherwise.

    Parameters
    ----------
    mass : float
        kg; finite and >= 0, and > 0 for the last link.
    length : float
        From joint to joint, m; finite and > 0.
    center : float, optional
        Of mass, from the joint where the link begins, along the link, m. Default: the middle.
    inertia : float, optional
        Moment of inertia about the mass centre, kg m^2. Default: ``mass * length**2 / 12``, a
        uniform rod's.

    Raises
    ------
    TypeError
        If a value is not a real number. Ranges are checked by the `Scene`, which can name the link.

    Notes
    -----
    A link cannot be changed; ``link.replace(mass=2.0)`` makes another. A centre or inertia that is
    a uniform rod's counts as left to the default: links that are equal behave the same.
    """

    # init=False makes dataclasses.replace() refuse: it would carry centre and inertia of a rod over
    # to another mass or length. `replace` below does it right.
    mass: float = field(init=False)
    length: float = field(init=False)
    center: float = field(init=False)
    inertia: float = field(init=False)

    def __init__(
        self,
        *,
        mass: float,
        length: float,
        center: float | None = None,
        inertia: float | None = None,
    ) -> None:
        mass, length = number("mass", mass, "kg"), number("length", length, "m")
        center = length / 2 if center is None else number("center", center, "m")
        if inertia is None:
            inertia = mass * length * length / 12  # in this order, as in the core: the same bits
        else:
            inertia = number("inertia", inertia, "kg m^2")
        object.__setattr__(self, "mass", mass)
        object.__setattr__(self, "length", length)
        object.__setattr__(self, "center", center)
        object.__setattr__(self, "inertia", inertia)

    @classmethod
    def point_mass(cls, *, mass: float, length: float) -> Link:
        """All the mass at the tip of a massless rod: the pendulum of many books.

        Parameters
        ----------
        mass : float
            kg.
        length : float
            m.
        """
        return cls(mass=mass, length=length, center=length, inertia=0.0)

    def replace(self, **changes: float | None) -> Link:
        """Return a link of other properties; what is as in a uniform rod stays as in one.

        Parameters
        ----------
        **changes : float
            Any of ``mass``, ``length``, ``center``, ``inertia``; for the last two None is a rod's.
            A centre or inertia of its own stays what it is, in m and kg m^2.
        """
        return Link(**{**self.particulars(), **changes})  # type: ignore[arg-type]

    __replace__ = replace  # copy.replace() of Python 3.13

    def particulars(self) -> dict[str, float]:
        """Return mass, length, and what is not as in a uniform rod: all it is made from."""
        rod = Link(mass=self.mass, length=self.length)
        values = {"mass": self.mass, "length": self.length}
        if self.center != rod.center:
            values["center"] = self.center
        if self.inertia != rod.inertia:
            values["inertia"] = self.inertia
        return values

    def __repr__(self) -> str:
        return f"Link({', '.join(f'{name}={x!r}' for name, x in self.particulars().items())})"


class Mobility(NamedTuple):
    """The textbook's count of the degrees of freedom: ``M = 3 links - 2 c5 - c4``.

    Attributes
    ----------
    links : int
        Moving links.
    c5 : int
        Joints with one degree of freedom (hinges).
    c4 : int
        Joints with two degrees of freedom.
    degrees_of_freedom : int
        ``M``.
    """

    links: int
    c5: int
    c4: int
    degrees_of_freedom: int


@dataclass(frozen=True, slots=True, init=False)
class Scene:
    """A chain of links on a fixed pivot, ready to be simulated.

    Parameters
    ----------
    links : iterable of Link
        From the pivot outwards. This version simulates one or two.
    gravity : float, default 9.807
        Downward, m/s^2; finite. 0 is allowed.

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
    """

    links: tuple[Link, ...]
    gravity: float = 9.807
    _compiled: _core.Scene = field(init=False, repr=False, compare=False)

    def __init__(self, *, links: Iterable[Link], gravity: float = 9.807) -> None:
        self._compile(links, gravity)
        self._warn()

    def _compile(self, links: Iterable[Link], gravity: float) -> None:
        links = _tuple_of_links(links)
        gravity = number("gravity", gravity, "m/s^2")
        rows = [(link.mass, link.length, link.center, link.inertia) for link in links]
        object.__setattr__(self, "links", links)
        object.__setattr__(self, "gravity", gravity)
        object.__setattr__(self, "_compiled", _core.Scene(rows, gravity))

    def _warn(self) -> None:
        """Blame what is implausible on the line that called the method which calls this."""
        for message in self._compiled.warnings:
            warnings.warn(message, PendcoreWarning, stacklevel=3)

    @classmethod
    def textbook(cls) -> Scene:
        """Section 2.1 of the textbook: two uniform rods of 1 kg and 1 m, g = 9.807 m/s^2."""
        return cls(links=[Link(mass=1.0, length=1.0), Link(mass=1.0, length=1.0)])

    def replace(
        self, *, links: Iterable[Link] | None = None, gravity: float | None = None
    ) -> Scene:
        """Return a scene with other links or another gravity; what is not given stays.

        Parameters
        ----------
        links, gravity
            As in `Scene`.
        """
        scene = Scene._unpickled(
            self.links if links is None else links, self.gravity if gravity is None else gravity
        )
        scene._warn()
        return scene

    def accelerations(self, t: npt.ArrayLike, q: npt.ArrayLike, qd: npt.ArrayLike) -> Floats:
        """Angular accelerations of the links: the right-hand side that is integrated.

        Parameters
        ----------
        t : array_like, (...)
            Time, s.
        q, qd : array_like, (..., n)
            Absolute angles, rad, and rates, rad/s. The leading axes broadcast.

        Returns
        -------
        qdd : ndarray, (..., n)
            rad/s^2.

        Raises
        ------
        ValueError, TypeError
            If an argument is not finite real numbers of that shape.
        """
        n = len(self.links)
        times = finite_array("t", t, "s")
        q, qd = link_array("q", q, n, "rad"), link_array("qd", qd, n, "rad/s")
        lead = np.broadcast_shapes(times.shape, q.shape[:-1], qd.shape[:-1])
        return self._compiled.accelerations(
            np.broadcast_to(times, lead).reshape(-1),
            np.broadcast_to(q, (*lead, n)).reshape(-1, n),
            np.broadcast_to(qd, (*lead, n)).reshape(-1, n),
        ).reshape(*lead, n)

    def mass_matrix(self, q: npt.ArrayLike) -> Floats:
        """Mass matrix of the equations of motion, symmetric and positive definite.

        Parameters
        ----------
        q : array_like, (..., n)
            Absolute angles, rad.

        Returns
        -------
        ndarray, (..., n, n)
            kg m^2.
        """
        n = len(self.links)
        q = link_array("q", q, n, "rad")
        return self._compiled.mass_matrix(q.reshape(-1, n)).reshape(*q.shape, n)

    def mobility(self) -> Mobility:
        """Count the degrees of freedom as the textbook does, ``M = 3 n - 2 c5 - c4``."""
        return Mobility(*self._compiled.mobility())

    @classmethod
    def _unpickled(cls, links: Iterable[Link], gravity: float) -> Scene:
        scene = object.__new__(cls)
        scene._compile(links, gravity)
        return scene

    def __reduce__(self) -> tuple[object, tuple[tuple[Link, ...], float]]:
        # The compiled scene is made anew; what is implausible was said when it was first made.
        return type(self)._unpickled, (self.links, self.gravity)


def _tuple_of_links(links: Iterable[Link]) -> tuple[Link, ...]:
    remedy = "must be a list of pendcore.Link, from the pivot outwards"
    try:
        links = tuple(links)
    except TypeError:
        raise TypeError(f"links = {links!r}: {remedy}") from None
    for i, link in enumerate(links, start=1):
        if not isinstance(link, Link):
            raise TypeError(f"link {i} = {link!r}: {remedy}")
    return links
