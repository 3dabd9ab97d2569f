"""Energies over time, and where the energy went: work and loss of every effect."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from pendcore import _core
from pendcore._messages.arguments import Floats
from pendcore._scene.scene import Scene

LOSSES = frozenset(name for name, is_loss in _core.accounts().items() if is_loss)
"""The entries that count what is lost; the others count work done on the chain."""


class Ledger(Mapping[str, Floats]):
    """Work and loss since the start, J, an entry for each kind that the scene has.

    ``viscous``, ``dry``, ``drag`` and ``impact`` are losses, ``motor``, ``drive``, ``wind`` and
    ``user`` are work done on the chain. ``residual`` is the remainder of the balance, which is the
    error of the run::

        [T + V](t) - [T + V](0) = motor + drive + wind + user
                                  - viscous - dry - drag - impact + residual

    An entry is an attribute, ``ledger.viscous``, and an item, ``ledger["viscous"]``, (n_t,).
    Entries for which the scene has no effect are missing.

    Examples
    --------
    >>> damper = pc.effects.ViscousJoint(joint=1, damping=0.1)
    >>> scene = pc.Scene.textbook().replace(effects=[damper])
    >>> sol = pc.simulate(scene, (0, 5), 0.5, ledger=True)
    >>> ledger = sol.energy().ledger
    >>> [*ledger], f"{ledger.viscous[-1]:.3f} J"
    (['viscous', 'residual'], '1.705 J')
    >>> [*ledger.losses]  # the other entries count work done on the chain
    ['viscous']
    >>> bool(abs(ledger.residual).max() < 1e-6)
    True
    """

    __slots__ = ("_entries",)

    def __init__(self, entries: Mapping[str, Floats]) -> None:
        self._entries = dict(entries)

    @property
    def losses(self) -> frozenset[str]:
        """The names of the entries that count what is lost."""
        return LOSSES.intersection(self)

    def __getitem__(self, name: str) -> Floats:
        if name not in self._entries:
            raise KeyError(self._has_no(name))
        return self._entries[name]

    def __getattr__(self, name: str) -> Floats:
        if name not in self._entries:
            raise AttributeError(self._has_no(name))
        return self._entries[name]

    def _has_no(self, name: str) -> str:
        return f"the ledger has no entry {name!r}: it has {', '.join(self)}"

    def __iter__(self) -> Iterator[str]:
        return iter(self._entries)

    def __len__(self) -> int:
        return len(self._entries)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self]

    __eq__ = object.__eq__  # that of a mapping would compare arrays
    __hash__ = object.__hash__

    def __reduce__(self) -> tuple[type[Ledger], tuple[dict[str, Floats]]]:
        return type(self), (self._entries,)

    def __repr__(self) -> str:
        if not len(self.residual):
            return f"<Ledger: {', '.join(self)} at no times>"
        ends = ", ".join(f"{name} {entry[-1]:.6g}" for name, entry in self.items())
        return f"<Ledger, J, at the last of {len(self.residual)} times: {ends}>"


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Energy:
    """Energies of states; the potential energy is zero at the height of the origin.

    Attributes
    ----------
    kinetic, potential, total : ndarray, (n_t,)
        J; for the members of an ensemble (...). Springs are part of the potential energy, rotors
        and payload of the kinetic one.
    ledger : Ledger or None
        Work and loss of every effect, if the run kept them: ``simulate(..., ledger=True)``.

    Examples
    --------
    >>> energy = pc.Case.textbook().simulate().energy()
    >>> f"T = {energy.kinetic[0]:.3f} J, V = {energy.potential[0]:.3f} J"
    'T = 0.000 J, V = -14.648 J'
    >>> bool(np.ptp(energy.total) < 1e-6)  # nothing takes energy out of this scene
    True
    """

    kinetic: Floats
    potential: Floats
    total: Floats
    ledger: Ledger | None = None

    def __repr__(self) -> str:
        numbers = self.total[~np.isnan(self.total)]
        span = ""
        if numbers.size:
            span = f"; the total is {numbers.min():.6g} to {numbers.max():.6g} J"
        return f"<Energy: kinetic, potential, total, each {self.total.shape}{span}>"


def energy_over(
    scene: Scene,
    asked: Mapping[str, Any],
    t: Floats,
    states: Floats,
    entries: Mapping[str, Floats],
) -> Energy:
    """Return the energies of states (n_t, 2n) of a run, and its ledger where it has entries.

    ``asked`` are the arguments of the run, ``entries`` those of its ledger at these times, J.
    """
    n = len(scene.links)
    kinetic, potential = scene._compiled.energy(t, states[:, :n], states[:, n:])
    with np.errstate(all="ignore"):  # a blow-up's energies may be infinite
        total = kinetic + potential
    if not asked["ledger"]:
        return Energy(kinetic, potential, total)
    start = scene._compiled.energy(*(np.array([asked[x]]) for x in ("t_start", "q0", "qd0")))
    with np.errstate(all="ignore"):
        booked = (-entry if name in LOSSES else entry for name, entry in entries.items())
        residual = total - sum(start) - sum(booked, np.zeros(len(total)))
    residual.flags.writeable = False
    return Energy(kinetic, potential, total, Ledger({**entries, "residual": residual}))
