"""What is simulated: links in a chain, gravity, and the effects that the scene has. SI units.

x points right, **y points down**, the origin is the pivot. The angle ``q_i`` of link i is absolute,
from +x towards +y: 0 is horizontal, pi/2 hangs straight down. Links and joints count from 1; joint
i is where link i begins.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, NamedTuple, Self

import numpy as np
import numpy.typing as npt

from pendcore import _core
from pendcore._messages.arguments import (
    Floats,
    finite_array,
    link_array,
    number,
    numbers,
    time_span,
    vector,
)
from pendcore._messages.html import beside, drawing, table
from pendcore._messages.warning import silence, warn
from pendcore._scene.effect_class import Described, Effect
from pendcore._scene.link import Link
from pendcore._scene.parametrized import tuple_of

if TYPE_CHECKING:
    from pendcore._scene.linearization import Linearization
    from pendcore.explanation.explanation import Absence, Explanation

_PLACE = re.compile(r"(link|effect)\[(\d+)\]\.(.+)")
"""The name of a parameter, as the core lists them (cpp/include/pendcore/parameters.hpp)."""
MOST_ROWS = 20
"""The most links in the table of a notebook."""


class Mobility(NamedTuple):
    """The textbook's count of the degrees of freedom: ``M = 3 links - 2 c5 - c4``.

    Attributes
    ----------
    links : int
        Moving links; links that a lock joins count as one.
    c5 : int
        Joints with one degree of freedom (hinges).
    c4 : int
        Joints with two degrees of freedom.
    degrees_of_freedom : int
        ``M``.

    Examples
    --------
    >>> pc.Scene.textbook().mobility()
    Mobility(links=2, c5=2, c4=0, degrees_of_freedom=2)
    >>> locked = pc.Scene.textbook().replace(effects=[pc.effects.Lock(joint=2)])
    >>> locked.mobility().degrees_of_freedom
    1
    """

    links: int
    c5: int
    c4: int
    degrees_of_freedom: int


@dataclass(frozen=True, slots=True, init=False, repr=False)
class Scene:
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

    links: tuple[Link, ...]
    gravity: float = 9.807
    effects: tuple[Effect, ...] = ()
    _compiled: _core.Scene = field(init=False, compare=False)

    def __init__(
        self, *, links: Iterable[Link], gravity: float = 9.807, effects: Iterable[Effect] = ()
    ) -> None:
        links = tuple_of("link", Link, links, "pendcore.Link, from the pivot outwards")
        effects = tuple_of("effect", Effect, effects, "pendcore.effects")
        gravity = number("gravity", gravity, "m/s^2")
        acting = [effect._as_pair() for effect in effects]
        rows = [(link.mass, link.length, link.center, link.inertia) for link in links]
        object.__setattr__(self, "links", links)
        object.__setattr__(self, "gravity", gravity)
        object.__setattr__(self, "effects", effects)
        object.__setattr__(self, "_compiled", _core.scene(rows, gravity, acting))
        for message in self._compiled.warnings:
            warn(message)

    @classmethod
    def textbook(cls) -> Self:
        """Section 2.1 of the textbook: two uniform rods of 1 kg and 1 m, g = 9.807 m/s^2.

        Examples
        --------
        >>> scene = pc.Scene.textbook()
        >>> scene.links[1], scene.gravity
        (Link(mass=1.0, length=1.0), 9.807)
        """
        return cls(links=[Link(mass=1.0, length=1.0), Link(mass=1.0, length=1.0)])

    def replace(
        self,
        *,
        links: Iterable[Link] | None = None,
        gravity: float | None = None,
        effects: Iterable[Effect] | None = None,
    ) -> Self:
        """Return a scene with other links, gravity or effects; the rest stays as it is.

        Parameters
        ----------
        links, gravity, effects
            As in `Scene`.

        Examples
        --------
        >>> moon = pc.Scene.textbook().replace(gravity=1.62)
        >>> moon.gravity, len(moon.links)
        (1.62, 2)
        """
        return type(self)(
            links=self.links if links is None else links,
            gravity=self.gravity if gravity is None else gravity,
            effects=self.effects if effects is None else effects,
        )

    __replace__ = replace  # copy.replace() of Python 3.13

    def parameters(self) -> dict[str, float]:
        """Return every number of the scene that has a name, in SI units.

        Links and effects count from 1. Numbers that an effect leaves out are not among them, nor
        are those of tables and splines. `with_parameters` and `pendcore.ensemble` take these names.

        Examples
        --------
        >>> damper = pc.effects.ViscousJoint(joint=2, damping=0.1)
        >>> scene = pc.Scene.textbook().replace(effects=[damper])
        >>> known = scene.parameters()
        >>> known["gravity"], known["link[1].mass"], known["effect[1].damping"]
        (9.807, 1.0, 0.1)
        """
        return {name: value for name, _, value in _core.parameters(self._compiled)}

    def parameter_units(self) -> dict[str, str]:
        """Return the unit of every parameter; empty for a ratio.

        Examples
        --------
        >>> pc.Scene.textbook().parameter_units()["link[1].inertia"]
        'kg m^2'
        """
        return {name: unit for name, unit, _ in _core.parameters(self._compiled)}

    def with_parameters(self, values: Mapping[str, float]) -> Self:
        """Return a scene with other values of some parameters; see `parameters` for their names.

        A link that is a uniform rod stays one when its mass or its length changes, unless its
        ``center`` or ``inertia`` is given as well.

        Raises
        ------
        ValueError
            If the scene has no parameter of that name; the message says what may be meant.
        TypeError
            If a name is no text.

        Examples
        --------
        >>> changed = {"link[2].length": 1.5, "gravity": 1.62}
        >>> longer = pc.Scene.textbook().with_parameters(changed)
        >>> longer.links[1], longer.gravity
        (Link(mass=1.0, length=1.5), 1.62)
        """
        check_parameter_names(self._compiled, values)
        links, gravity, effects = list(self.links), self.gravity, list(self.effects)
        of_links: dict[int, dict[str, float]] = {}
        for name, value in values.items():
            given = number(name, value, "")
            if (place := _PLACE.fullmatch(name)) is None:
                gravity = given
            elif place[1] == "link":
                of_links.setdefault(int(place[2]) - 1, {})[place[3]] = given
            else:
                i = int(place[2]) - 1
                effects[i] = _with(effects[i], place[3].split("."), given)
        for i, fields in of_links.items():
            links[i] = links[i].replace(**fields)
        return type(self)(links=links, gravity=gravity, effects=effects)

    def accelerations(self, t: npt.ArrayLike, q: npt.ArrayLike, qd: npt.ArrayLike) -> Floats:
        """Angular accelerations of the links: the right-hand side that is integrated.

        A law that is smooth only in pieces, such as dry friction, is on the side that a forward run
        would take. A locked joint does not turn: its rate, ``qd_i - qd_{i-1}``, must be zero; the
        accelerations of any other state are not those of the scene.

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

        Examples
        --------
        >>> scene = pc.Scene.textbook()
        >>> scene.accelerations(0.0, q=[0.0, 0.0], qd=[0.0, 0.0]).round(3)  # let go
        array([12.609, -4.203])
        >>> scene.accelerations([0.0, 1.0], q=np.zeros((2, 2)), qd=[0.0, 0.0]).shape
        (2, 2)
        """
        found = self._compiled.acceleration_of_state(t, q, qd)
        if found is not None:  # one state of plain numbers costs a microsecond, as in a loop
            return found
        lead, states = self._broadcast(t, q=q, qd=qd)
        return self._compiled.accelerations(*states).reshape(*lead, len(self.links))

    def jacobian(
        self, t: npt.ArrayLike, q: npt.ArrayLike, qd: npt.ArrayLike
    ) -> tuple[Floats, Floats]:
        """Derivatives of the `accelerations` by the angles and by the rates, to the last bits.

        The arguments are as in `accelerations`, and so is the side of a law that is smooth only in
        pieces; `linearize` refuses a state where its sides differ. Functions of the user's alone
        are differentiated by differences.

        Returns
        -------
        by_q, by_qd : ndarray, (..., n, n)
            1/s^2 and 1/s: row i has the derivatives of the acceleration of link i.

        Examples
        --------
        >>> hanging, scene = [np.pi / 2, np.pi / 2], pc.Scene.textbook()
        >>> by_q, by_qd = scene.jacobian(0.0, q=hanging, qd=[0.0, 0.0])
        >>> np.sqrt(-np.linalg.eigvals(by_q)).round(3)  # rad/s, about hanging
        array([2.68 , 7.188])
        """
        lead, states = self._broadcast(t, q=q, qd=qd)
        n = len(self.links)
        by_q, by_qd = self._compiled.jacobian(*states)
        return by_q.reshape(*lead, n, n), by_qd.reshape(*lead, n, n)

    def linearize(
        self,
        q: npt.ArrayLike,
        qd: npt.ArrayLike = 0.0,
        t: float = 0.0,
        *,
        inputs: Iterable[int | str] = (),
        outputs: Iterable[str] | None = None,
        torques: npt.ArrayLike | None = None,
    ) -> Linearization:
        """The motion close to a state, as the linear system of a controller.

        Parameters
        ----------
        q : array_like, (n,)
            Absolute angles, rad. The state need not be an equilibrium.
        qd : array_like, (n,), or float, default 0
            Rates, rad/s; one number stands for all.
        t : float, default 0
            Time, s, of effects that depend on it.
        inputs : iterable of int or str
            A joint, for a torque in it beside what its effects do (N m; also ``"torque[2]"``);
            ``"pivot.x"`` or ``"pivot.y"``, for an acceleration of the pivot beside that of a drive
            (m/s^2; to the right, and downward); or the name of one of `parameters`, for a change of
            it. A link that is a uniform rod stays one, unless its centre or inertia is an input,
            too.
        outputs : iterable of str, optional
            ``"q[1]"``, ``"qd[1]"``, ``"qdd[1]"`` of a link; ``"phi[2]"``, ``"phid[2]"`` of a joint,
            relative to the link before; ``"x[2]"``, ``"y[2]"``, ``"vx[2]"``, ``"vy[2]"`` of the end
            of a link; ``"kinetic"``, ``"potential"`` and their sum, ``"energy"``, J. The state,
            unless given. Inputs ``"pivot.x"`` and ``"pivot.y"`` have not moved the pivot yet:
            places, velocities and energies do not change with them.
        torques : array_like, (k,), optional
            Torques that are held in the joints of ``inputs`` at that state, N m: those of `trim`
            make it an equilibrium.

        Raises
        ------
        ValueError
            Where the motion has no derivative: at a stop, in a joint at rest under dry friction,
            where two laws of an effect meet; the message says on which side it has one. Also for
            a torque in a joint that a `Lock` holds, for angles and rates that locks and stops do
            not allow, and for names that are not known.

        Notes
        -----
        The derivatives are those of the motion itself, by dual numbers through its equations, and
        not of a step of some method. Functions of the user's alone are differentiated by central
        differences, which are right to some ten digits. A joint that is locked keeps its angle and
        rate in the state, which no input moves: a regulator takes the other states.

        Examples
        --------
        >>> upright = pc.Scene.textbook().linearize([-np.pi / 2, -np.pi / 2], inputs=[1])
        >>> float(np.linalg.eigvals(upright.A).real.max().round(3))  # 1/s: how fast it falls
        7.188
        >>> upright.B[2:, 0].round(4)
        array([ 1.7143, -2.5714])
        """
        from pendcore._scene import linearization

        n = len(self.links)
        driven, names = linearization.known_inputs(inputs)
        if torques is not None:
            if any(isinstance(one, str) for one in driven):
                raise ValueError(
                    f"torques: are of joints, and the inputs are {', '.join(names)}: give torques "
                    "that are held beside other inputs as effects, Motor(joint, constant=...)"
                )
            torques = finite_array("torques", torques, "N m")
        found = self._compiled.linearize(t, q, qd, driven, torques)
        if found is None:  # a state of plain numbers costs three microseconds, as in a loop
            (t,) = vector("t", t, 1, "s")
            state = numbers("q", q, "rad", n), vector("qd", qd, n, "rad/s")
            found = self._compiled.linearize(t, *state, driven, torques)
        assert found is not None
        x, drift, A, B = found
        C, D, of_state = linearization.state_as_output(n, len(driven))
        system = linearization.Linearization(A, B, C, D, drift, x, x, names, of_state)
        if outputs is None:
            return system
        from pendcore._scene.outputs import Rows, outputs_at

        wanted = linearization.different_names("outputs", outputs)
        qdd = Rows(drift[n:], A[n:], B[n:])
        values, C, D = outputs_at(self, np.asarray(t), x, names, wanted, qdd)
        return replace(system, C=C, D=D, outputs_there=values, outputs=wanted)

    def inverse_dynamics(
        self, t: npt.ArrayLike, q: npt.ArrayLike, qd: npt.ArrayLike, qdd: npt.ArrayLike
    ) -> Floats:
        """Torques in the joints that give these accelerations, N m, (..., n).

        They come beside what the effects do. No lock or stop pushes, and a joint at rest has no dry
        friction. ``qdd`` is in rad/s^2; the arguments are as in `accelerations`.

        Examples
        --------
        >>> scene = pc.Scene.textbook()
        >>> scene.inverse_dynamics(0.0, [0.0, 0.0], qd=[0.0, 0.0], qdd=[0.0, 0.0])  # held level
        array([-19.614 ,  -4.9035])
        """
        lead, states = self._broadcast(t, q=q, qd=qd, qdd=qdd)
        return self._compiled.inverse_dynamics(*states).reshape(*lead, len(self.links))

    def trim(self, q: npt.ArrayLike, t: float = 0.0, *, inputs: Iterable[int | str]) -> Floats:
        """Torques in some joints that hold these angles at rest, N m, one for each of ``inputs``.

        Parameters
        ----------
        q : array_like, (n,)
            Absolute angles, rad.
        t : float, default 0
            Time, s, of effects that depend on it.
        inputs : iterable of int or str
            The joints that are driven, beside what their effects do: 2, or ``"torque[2]"``.

        Raises
        ------
        ValueError
            If the other joints do not rest: the message says which, and what torque they lack.
            Also for a torque in a joint that a `Lock` holds.

        Notes
        -----
        In a chain, what a joint takes to rest follows from the weights beyond it, whatever the
        others do. Locks, stops and dry friction hold a joint that is not driven, if they can; a
        joint that is driven gets no help from its friction.

        Examples
        --------
        >>> scene = pc.Scene.textbook()
        >>> scene.trim([0.0, np.pi / 2], inputs=[1])  # link 1 level, link 2 hangs
        array([-14.7105])
        """
        from pendcore._scene import linearization

        joints = linearization.driven_joints(inputs, len(self.links), self.effects)
        (time,) = vector("t", t, 1, "s")
        return self._compiled.trim(time, numbers("q", q, "rad", len(self.links)), joints)

    def positions(self, t: npt.ArrayLike, q: npt.ArrayLike) -> Floats:
        """Pivot, joints and tip, m, (..., n+1, 2): x right, y down; a driven pivot moves.

        ``t`` and ``q`` are as in `accelerations`.

        Examples
        --------
        >>> scene = pc.Scene.textbook()
        >>> scene.positions(0.0, [0.0, np.pi / 2]).round(3)  # pivot, joint 2, tip
        array([[0., 0.],
               [1., 0.],
               [1., 1.]])
        """
        lead, states = self._broadcast(t, q=q)
        return self._compiled.positions(*states).reshape(*lead, len(self.links) + 1, 2)

    def velocities(self, t: npt.ArrayLike, q: npt.ArrayLike, qd: npt.ArrayLike) -> Floats:
        """Velocities of pivot, joints and tip, m/s, (..., n+1, 2): x right, y down.

        The arguments are as in `accelerations`.

        Examples
        --------
        >>> scene = pc.Scene.textbook()
        >>> scene.velocities(0.0, [0.0, np.pi / 2], qd=[1.0, 2.0]).round(3)
        array([[ 0.,  0.],
               [ 0.,  1.],
               [-2.,  1.]])
        """
        lead, states = self._broadcast(t, q=q, qd=qd)
        return self._compiled.velocities(*states).reshape(*lead, len(self.links) + 1, 2)

    def mass_centers(self, t: npt.ArrayLike, q: npt.ArrayLike) -> Floats:
        """Mass centres of the links, a payload excluded, m, (..., n, 2): x right, y down.

        ``t`` and ``q`` are as in `accelerations`.

        Examples
        --------
        >>> pc.Scene.textbook().mass_centers(0.0, [0.0, np.pi / 2]).round(3)
        array([[0.5, 0. ],
               [1. , 0.5]])
        """
        lead, states = self._broadcast(t, q=q)
        return self._compiled.mass_centers(*states).reshape(*lead, len(self.links), 2)

    def reactions(self, t: npt.ArrayLike, q: npt.ArrayLike, qd: npt.ArrayLike) -> Floats:
        """Force on each link at the joint where it begins, N, (..., n, 2): x right, y down.

        The arguments are as in `accelerations`. The textbook's F_01 (the ground's on link 1), F_12
        (link 1's on link 2), and so on.

        Examples
        --------
        >>> scene = pc.Scene.textbook()
        >>> hanging = scene.reactions(0.0, [np.pi / 2, np.pi / 2], [0.0, 0.0])
        >>> hanging[:, 1].round(3)  # upwards, and y points down
        array([-19.614,  -9.807])
        """
        lead, states = self._broadcast(t, q=q, qd=qd)
        return self._compiled.reactions(*states).reshape(*lead, len(self.links), 2)

    def energy(
        self, t: npt.ArrayLike, q: npt.ArrayLike, qd: npt.ArrayLike
    ) -> tuple[Floats, Floats]:
        """Kinetic and potential energy, J, each (...); the arguments are as in `accelerations`.

        The potential energy is zero where all links are level, and springs are at rest.

        Examples
        --------
        >>> scene = pc.Scene.textbook()
        >>> kinetic, potential = scene.energy(0.0, [0.0, np.pi / 2], [2.0, 0.0])
        >>> f"{kinetic:.3f} J, {potential:.4f} J"
        '2.667 J, -4.9035 J'
        """
        lead, states = self._broadcast(t, q=q, qd=qd)
        kinetic, potential = self._compiled.energy(*states)
        return kinetic.reshape(lead), potential.reshape(lead)

    def _broadcast(
        self, t: npt.ArrayLike, **angles: npt.ArrayLike
    ) -> tuple[tuple[int, ...], list[Floats]]:
        """Return the leading shape of times and angles or rates, and each of them in rows."""
        n = len(self.links)
        units = {"q": "rad", "qd": "rad/s", "qdd": "rad/s^2"}
        times = finite_array("t", t, "s")
        given = [link_array(name, one, n, units[name]) for name, one in angles.items()]
        shapes = [times.shape, *(one.shape for one in given)]
        try:
            lead = np.broadcast_shapes(times.shape, *(one.shape[:-1] for one in given))
        except ValueError:
            raise ValueError(
                f"{', '.join(['t', *angles])}: shapes {', '.join(map(str, shapes))}: must "
                f"broadcast, the last axis of {' and '.join(angles)} aside"
            ) from None
        rows = [np.broadcast_to(one, (*lead, n)).reshape(-1, n) for one in given]
        return lead, [np.broadcast_to(times, lead).reshape(-1), *rows]

    def distances(self, q: npt.ArrayLike, reference: npt.ArrayLike) -> Floats:
        """How far apart two motions are, as a share of the total length: the error of positions.

        It is the largest distance between the places of the same joint, or of the tip, of the order
        of 1 where the motions have nothing in common, and 0 for angles that differ by whole turns.
        A driven pivot moves alike in both. A link of the length L adds to the distance, in the
        complex plane and from the pivot outwards,

            L (exp(i q) - exp(i r)) = 2 i L sin((q - r)/2) exp(i (q + r)/2),

        whose right-hand side loses no digits where q and r are close.

        Parameters
        ----------
        q, reference : array_like, (..., n)
            Absolute angles, rad.

        Returns
        -------
        ndarray, (...)
            NaN where an angle is not finite.

        Examples
        --------
        >>> scene = pc.Scene.textbook()
        >>> float(scene.distances([0.0, 0.0], [0.0, np.pi]))  # the tip moves by 2 m
        1.0
        """
        q, r = np.asarray(q, dtype=np.float64), np.asarray(reference, dtype=np.float64)
        lengths = np.array([link.length for link in self.links])
        lengths = lengths / lengths.sum()
        place, apart = np.complex128(), np.float64()
        with np.errstate(all="ignore"):
            for i, length in enumerate(lengths):  # numpy is slow along an axis as short as a chain
                chord = 2 * length * np.sin((q[..., i] - r[..., i]) / 2)
                place = place + chord * np.exp(0.5j * (q[..., i] + r[..., i]))
                apart = np.maximum(apart, np.abs(place))
        return np.asarray(apart)

    def mass_matrix(self, q: npt.ArrayLike) -> Floats:
        """Mass matrix of the equations of motion, symmetric and positive definite.

        It includes payloads and rotors. It ignores locks: it is the matrix of the chain with all
        its joints free.

        Parameters
        ----------
        q : array_like, (..., n)
            Absolute angles, rad.

        Returns
        -------
        ndarray, (..., n, n)
            kg m^2.

        Examples
        --------
        >>> pc.Scene.textbook().mass_matrix([0.0, 0.0]).round(3)  # stretched out
        array([[1.333, 0.5  ],
               [0.5  , 0.333]])
        """
        n = len(self.links)
        q = link_array("q", q, n, "rad")
        return self._compiled.mass_matrix(q.reshape(-1, n)).reshape(*q.shape, n)

    def mobility(self) -> Mobility:
        """Count the degrees of freedom as the textbook does, ``M = 3 n - 2 c5 - c4``.

        See `pendcore.Mobility`.

        Examples
        --------
        >>> links, c5, c4, freedom = pc.Scene.textbook().mobility()
        >>> 3 * links - 2 * c5 - c4 == freedom
        True
        """
        return Mobility(*self._compiled.mobility())

    def fastest_drive(self) -> float:
        """Return the largest angular frequency of a sinusoid, rad/s; 0 if there is none.

        Examples
        --------
        >>> y = pc.effects.Sinusoid(amplitude=0.01, angular_frequency=350.0)
        >>> shaken = pc.effects.DrivenPivot(y=y)
        >>> pc.Scene.textbook().replace(effects=[shaken]).fastest_drive()
        350.0
        """
        parts = (part for effect in self.effects for part in effect.parts().values())
        return max((abs(getattr(x, "angular_frequency", 0.0)) for x in parts), default=0.0)

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
        from pendcore.explanation.explain import explain

        start = None if q is None else vector("q", q, len(self.links), "rad")
        (time,) = vector("t", t, 1, "s")
        lanes = _core.methods_with_lanes(self._compiled)
        return explain(self, time, start, self._compiled.costs(), lanes)

    def not_simulated(self) -> list[Absence]:
        """Return the effects that the scene does not have, and physics that no effect models.

        Examples
        --------
        >>> scene = pc.Scene.textbook()
        >>> "payload" in [absence.kind for absence in scene.not_simulated()]
        True
        """
        from pendcore.explanation.explain import absent

        return absent(self)

    def run_warnings(self, q0: npt.ArrayLike, t_span: Iterable[float]) -> list[str]:
        """Return what `simulate` would warn of in a start (rad) and a span (s).

        Examples
        --------
        >>> told = pc.Scene.textbook().run_warnings([45, 60], (0, 5))
        >>> told[0][:44]
        'q0[0] = 45.0 rad: that is 2578 degrees: angl'
        """
        angles = vector("q0", q0, len(self.links), "rad")
        return self._compiled.run_warnings(angles, *time_span(t_span))

    def __repr__(self) -> str:
        effects = f", effects={self.effects!r}" if self.effects else ""
        return f"Scene(links={self.links!r}, gravity={self.gravity!r}{effects})"

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

    @classmethod
    def _unpickled(
        cls, links: Iterable[Link], gravity: float, effects: Iterable[Effect] = ()
    ) -> Self:
        scene = object.__new__(cls)  # a class of the user's may be made from other arguments
        with silence():  # what is implausible was said when it was first made
            Scene.__init__(scene, links=links, gravity=gravity, effects=effects)
        return scene

    def __reduce__(self) -> tuple[object, tuple[object, ...]]:
        # The compiled scene is made anew.
        return type(self)._unpickled, (self.links, self.gravity, self.effects)


def check_parameter_names(scene: _core.Scene, names: Collection[Any]) -> None:
    """Raise a ValueError for a name that the scene does not have, a TypeError if it is no text."""
    for name in names:
        if not isinstance(name, str):
            raise TypeError(f'parameter {name!r}: must be a name, such as "link[1].mass"')
    _core.check_parameter_names(scene, list(names))


def _with(owner: Any, path: list[str], value: float) -> Any:
    """Return an effect, or a part of one, with another value at a path of names."""
    name, *inner = path
    if not inner:
        return owner.replace(**{name: value})
    held = getattr(owner, name)
    if isinstance(held, Described):
        return owner.replace(**{name: _with(held, inner, value)})
    (components,) = (p.components for p in owner.description.parameters if p.name == name)
    which = components.index(inner[0])
    return owner.replace(**{name: tuple(value if k == which else x for k, x in enumerate(held))})


def require_scene(scene: object) -> None:
    """Raise TypeError for anything else."""
    if isinstance(scene, Scene):
        return
    told, remedy = f"scene = {scene!r}", ""
    if isinstance(getattr(scene, "scene", None), Scene):
        told = f"scene: is a {type(scene).__name__}"
        remedy = "; case.simulate() runs a case" if hasattr(scene, "simulate") else ""
    raise TypeError(f"{told}: must be a pendcore.Scene{remedy}")
