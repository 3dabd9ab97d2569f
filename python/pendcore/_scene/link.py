"""A link of the chain: mass, length, mass centre, moment of inertia. SI units."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from pendcore._messages.arguments import number
from pendcore._scene.parametrized import Parametrized


@dataclass(frozen=True, slots=True, init=False, repr=False)
class Link(Parametrized):
    """One rigid link of the chain; a uniform rod unless said otherwise.

    Parameters
    ----------
    mass : float
        kg; finite and > 0, or 0 where something else resists the link's rotation: what hangs on
        it, an inertia, a payload, a rotor, or a lock that makes it one body with another link.
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

    Examples
    --------
    >>> rod = pc.Link(mass=1.0, length=2.0)
    >>> f"centre at {rod.center} m, inertia {rod.inertia:.3f} kg m^2"
    'centre at 1.0 m, inertia 0.333 kg m^2'
    >>> pc.Link(mass=1.0, length=2.0, center=1.5, inertia=0.2)
    Link(mass=1.0, length=2.0, center=1.5, inertia=0.2)
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

        Examples
        --------
        >>> pc.Link.point_mass(mass=0.5, length=1.0)
        Link(mass=0.5, length=1.0, center=1.0, inertia=0.0)
        """
        return cls(mass=mass, length=length, center=length, inertia=0.0)

    def replace(self, **changes: float | None) -> Link:
        """Return a link of other properties; what is as in a uniform rod stays as in one.

        Parameters
        ----------
        **changes : float
            Any of ``mass``, ``length``, ``center``, ``inertia``; for the last two None is a rod's.
            A centre or inertia of its own stays what it is, in m and kg m^2.

        Examples
        --------
        >>> heavy = pc.Link(mass=1.0, length=2.0).replace(mass=3.0)
        >>> heavy, heavy.inertia
        (Link(mass=3.0, length=2.0), 1.0)
        """
        given: dict[str, Any] = {**self.particulars(), **changes}
        return Link(**given)

    __replace__ = replace  # copy.replace() of Python 3.13

    def particulars(self) -> dict[str, float]:
        """Return mass, length, and what differs from a uniform rod, enough to make it again.

        Units are kg, m and kg m^2.

        Examples
        --------
        >>> pc.Link(mass=1.0, length=2.0, center=1.5).particulars()
        {'mass': 1.0, 'length': 2.0, 'center': 1.5}
        """
        rod = Link(mass=self.mass, length=self.length)
        values = {"mass": self.mass, "length": self.length}
        if self.center != rod.center:
            values["center"] = self.center
        if self.inertia != rod.inertia:
            values["inertia"] = self.inertia
        return values
