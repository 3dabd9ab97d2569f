"""An explanation of a scene: what it holds, its text for people, and its JSON."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass, fields
from textwrap import wrap
from typing import Any, NamedTuple

from pendcore import Mobility, Scene, effects
from pendcore.explanation.equilibria import Equilibrium, Mode
from pendcore.messages import as_json, beside, in_a_row, table

STEPS_A_PERIOD = 500
"""The number of steps in a period of the fastest oscillation that avoids rejected steps, at the
default tolerances of `simulate`, from a start at rest up to half a radian from an equilibrium."""
_WIDTH = 80
_NAME = 58


class Cost(NamedTuple):
    """What a part of a right-hand side takes.

    Attributes
    ----------
    what : str
        ``"links"`` (with gravity), an effect by its number and kind, or ``"all"``.
    operations : int or None
        Additions, multiplications, divisions and the like that an effect adds; None where they are
        not counted, as in a function of the user's.
    nanoseconds : float
        Measured on the spot; for an effect, what it adds to the links alone.
    """

    what: str
    operations: int | None
    nanoseconds: float


class Absence(NamedTuple):
    """Something that is not simulated.

    Attributes
    ----------
    kind : str
        The kind of an effect that the scene could have, or a word for physics without an effect.
    sentence : str
        What would be simulated.
    available : bool
        Whether there is such an effect.
    """

    kind: str
    sentence: str
    available: bool


@dataclass(frozen=True, slots=True, repr=False)
class Explanation:
    """What `Scene.explain` finds. It prints as a table.

    Attributes
    ----------
    scene : Scene
        The scene that is explained.
    t : float
        Time at which motors and pivot were looked at, s.
    costs : tuple of Cost
        The links, each effect, all.
    mobility : Mobility
        The textbook's count.
    constraint_rank : int or None
        Rank of the constraint Jacobian of the hinges and locks, on 3 coordinates a link; None
        where the links are too many.
    degrees_of_freedom : int or None
        Coordinates less constraints, ``3 n - rank``; None where the rank is None.
    equilibria : tuple of Equilibrium
        Hanging, upright and the start, where they are in balance, or what Newton's method finds
        from there; each with its natural frequencies. Dry friction is left out.
    stiffest_rate : float or None
        The largest eigenvalue about any equilibrium, 1/s; None if there is no equilibrium.
    fastest_drive : float
        The largest angular frequency of a sinusoid, rad/s; 0 if there is no sinusoid.
    first_step : float or None
        The period of the faster of these two over `STEPS_A_PERIOD`, s: safe for a start at rest
        near an equilibrium, at the default tolerances. None where no equilibrium is known.
    not_simulated : tuple of Absence
        What the program knows and the scene does not have, then what the program does not know.
    lanes : tuple of str
        The methods by which `ensemble` runs several members at once, a lane of the processor's
        registers each; it runs others one by one.
    remarks : tuple of str
        What was left out here, and why.

    Examples
    --------
    >>> told = pc.Scene.textbook().explain()
    >>> [(found.name, found.stability) for found in told.equilibria]
    [('hanging', 'stable'), ('upright', 'unstable')]
    >>> f"{told.stiffest_rate:.2f} 1/s, {told.degrees_of_freedom} degrees of freedom"
    '7.19 1/s, 2 degrees of freedom'
    """

    scene: Scene
    t: float
    costs: tuple[Cost, ...]
    mobility: Mobility
    constraint_rank: int | None
    degrees_of_freedom: int | None
    equilibria: tuple[Equilibrium, ...]
    stiffest_rate: float | None
    fastest_drive: float
    first_step: float | None
    not_simulated: tuple[Absence, ...]
    lanes: tuple[str, ...]
    remarks: tuple[str, ...]

    def to_dict(self) -> dict[str, Any]:
        """Return the same as JSON can hold it; None where there is no number."""
        told = {
            "links": [asdict(link) for link in self.scene.links],
            "gravity": self.scene.gravity,
            "effects": [repr(effect) for effect in self.scene.effects],
        }
        own = (one.name for one in fields(self) if one.name != "scene")
        return dict(as_json(told | {name: getattr(self, name) for name in own}))

    def _repr_html_(self) -> str:
        costs = [[x, "" if n is None else str(n), f"{ns:.0f}"] for x, n, ns in self.costs]
        found = []
        for one in self.equilibria:
            shown = [x.angular_frequency for x in one.modes if x.angular_frequency > 0]
            found.append([one.name, one.stability, ", ".join(f"{x:.4g}" for x in shown)])
        return beside(
            table(costs, ("simulated", "operations", "ns")),
            table(found, ("equilibrium", "", "frequencies (rad/s)")),
            table([[one.sentence] for one in self.not_simulated], ("not simulated",)),
        )

    def __repr__(self) -> str:
        n, at = len(self.scene.links), f"t = {self.t:.6g} s"
        is_frozen = self.equilibria and may_change_with_time(self.scene)
        frozen = f", with all drives held as they are at {at}" if is_frozen else ""
        head = f"{n} link{'s'[: n > 1]}, gravity {self.scene.gravity:.6g} m/s^2, explained at {at}"
        blocks = [
            [head],
            ["What is simulated, and what it costs in a right-hand side", *_costs(self)],
            ["What is not simulated", *_absences(self)],
            ["Freedom", *_freedom(self)],
            [f"Equilibria{frozen}", *_equilibria(self)],
            ["How fast", *_rates(self)],
            ["Many at once", *_lanes(self)],
        ]
        if self.remarks:
            blocks.append(["Remarks", *(line for told in self.remarks for line in _bullet(told))])
        return "\n\n".join("\n".join(block) for block in blocks)


def may_change_with_time(scene: Scene) -> bool:
    """Return whether an effect has a table, a spline or a sinusoid, or is a function, of t too."""
    changing = effects.Sinusoid | effects.Table | effects.Spline
    return any(
        effect.description.is_function
        or any(isinstance(part, changing) for part in effect.parts().values())
        for effect in scene.effects
    )


def _costs(told: Explanation) -> Iterator[str]:
    yield f"  {'':{_NAME}} operations       ns"
    names = ["links, gravity", *map(repr, told.scene.effects), "all together"]
    for name, cost in zip(names, told.costs, strict=True):
        *more, last = wrap(name, _NAME, subsequent_indent="    ", max_lines=4, placeholder=" ...")
        operations = "" if cost.operations is None else cost.operations
        yield from (f"  {line}" for line in more)
        yield f"  {last:{_NAME}} {operations:>10} {cost.nanoseconds:8.1f}"
    yield "  (measured just now: a difference of a ns or two is noise)"


def _freedom(told: Explanation) -> Iterator[str]:
    n, c5, c4, freedom = told.mobility
    yield f"  the textbook's count       M = 3 n - 2 c5 - c4 = 3*{n} - 2*{c5} - {c4} = {freedom}"
    if told.constraint_rank is not None:
        found = f"{3 * len(told.scene.links)} - {told.constraint_rank} = {told.degrees_of_freedom}"
        yield f"  the constraints' Jacobian  3 n - rank = {found}"


def _equilibria(told: Explanation) -> Iterator[str]:
    for found in told.equilibria:
        angles = ", ".join(f"{x:.6g}" for x in found.q[:4]) + ", ..." * (len(found.q) > 4)
        yield f"  {found.name}, {found.stability}: q = ({angles}) rad"
        motions = [_motion(mode) for mode in found.modes]
        if len(motions) > 8:
            motions[4:-4] = [f"... {len(motions) - 8} more"]
        yield from (f"    {motion}" for motion in motions)
    if not told.equilibria:
        yield "  none was found"


def _motion(mode: Mode) -> str:
    if mode.damping_ratio is not None:
        ratio = 0.0 if abs(mode.damping_ratio) < 1e-9 else mode.damping_ratio
        how = f"damping ratio {ratio:.3g}"
        return f"{mode.angular_frequency:11.6g} rad/s = {mode.frequency:.6g} Hz, {how}"
    word = "grows" if mode.rate > 0 else "decays" if mode.rate < 0 else "stays"
    return f"{abs(mode.rate):11.6g} 1/s, {word} without oscillating"


def _rates(told: Explanation) -> Iterator[str]:
    if told.stiffest_rate is not None:
        yield f"  stiffest rate   {told.stiffest_rate:.6g} 1/s, about the equilibria"
    if told.fastest_drive:
        yield f"  fastest drive   {told.fastest_drive:.6g} rad/s"
    if told.first_step is None:
        yield "  first step      nothing is known here to choose it by"
    else:
        share = f"1/{STEPS_A_PERIOD} of the fastest period"
        yield f"  first step      {told.first_step:.3g} s, {share}: safe for a start at"
        yield "                  rest near an equilibrium, at the default tolerances"


def _absences(told: Explanation) -> Iterator[str]:
    ready = [x.kind.replace("_", " ") for x in told.not_simulated if x.available]
    never = [x.sentence.rstrip(".") for x in told.not_simulated if not x.available]
    if ready:
        yield from _bullet(f"effects that the scene could have: {', '.join(ready)}")
    yield from _bullet(f"never: {'; '.join(x[0].lower() + x[1:] for x in never)}")


def _lanes(told: Explanation) -> list[str]:
    if not told.lanes:
        return _bullet("an ensemble runs its members one by one in each thread")
    return _bullet(
        f"an ensemble runs several members at once, a lane each, by {in_a_row(told.lanes, 'or')}; "
        "one by one with events of your own, for the largest exponent, and for the drift of energy "
        "with losses"
    )


def _bullet(remark: str) -> list[str]:
    return wrap(remark, _WIDTH, initial_indent="  ", subsequent_indent="  ")
