"""What acts on a chain besides gravity, as an exercise states it: in words, with the law's formula.

The formulas are those of the laws themselves, in the angle of a joint and its rate.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import degrees
from typing import cast

from sympy import Abs, Add, Expr, Symbol

from pendcore.derive.algebra import Algebra
from pendcore.derive.chain import Chain, Vector
from pendcore.derive.laws import Law
from pendcore.derive.narration.page import Page
from pendcore.derive.notation import Notation
from pendcore.derive.report.quantities import number
from pendcore.derive.writing import ANGLE, RATE

COUPLES = {
    "viscous_joint": r"viscous damping, ${}$",
    "torsional_spring": r"a torsional spring, ${}$",
}
MOTORS = {
    "constant": r"a motor of constant torque, ${}$",
    "sinusoid": r"a motor, ${}$",
    "pd": r"a motor with a controller, ${}$",
}


class JointsByName:
    """Stands in for a chain where a law asks for the angle and the rate of its joint."""

    def __init__(self, notation: Notation) -> None:
        self.notation = notation

    def joint_angle(self, joint: int) -> Symbol:
        """Return phi_j."""
        return self.notation.symbol(f"phi{joint}", rf"\varphi_{{{joint}}}", ANGLE, joint)

    def joint_rate(self, joint: int) -> Symbol:
        """Return the rate of phi_j."""
        return self.notation.symbol(f"phid{joint}", rf"\dot{{\varphi}}_{{{joint}}}", RATE, joint)


def what_acts(derivation: Algebra, q: Sequence[float]) -> Iterator[str]:
    """Yield the paragraphs that state the effects, with every symbol that they bring.

    Parameters
    ----------
    derivation : Algebra
        The derivation of the scene.
    q : sequence of float, (n,)
        Angles at the start, rad; a lock keeps that of its joint.
    """
    laws, s = derivation.equations.laws, derivation.symbols
    page = Page(derivation)
    if not laws:
        gravity = "gravity and " if derivation.scene.gravity else ""
        weightless = "" if gravity else " Gravity is 0."
        yield f"Nothing acts on the chain but {gravity}the joint that holds it.{weightless}"
        return
    if derivation.equations.torques or derivation.equations.locked or _rotors(laws):
        yield _joint_angles(derivation)
    if derivation.equations.torques:
        yield " ".join(_torques(derivation))
    if moved := [path for law in laws if (path := law.pivot()) is not None]:
        yield _path(moved, s)
    for law in laws:
        match law.effect.kind:
            case "rotor_inertia":
                yield _rotor(law, s)
            case "lock":
                yield _lock(law, q)
            case "payload":
                yield _payload(law, s, page.joint(derivation.n).latex)
            case "rod_drag":
                yield _drag(law, derivation, page)
            case _:
                pass


def _rotors(laws: Sequence[Law]) -> bool:
    return any(law.armature() is not None for law in laws)


def _joint_angles(derivation: Algebra) -> str:
    s = derivation.symbols
    first = f"$\\varphi_{{1}} = {s.latex(s.q[0])}$"
    if derivation.n == 1:
        return f"The angle of the joint is {first}."
    return (
        f"The angle of joint $j$ is $\\varphi_{{j}} = q_{{j}} - q_{{j-1}}$, and the angle of the "
        f"first joint is {first}. A couple at joint $j$ acts on link $j$, and the opposite couple "
        "on link $j - 1$, which for the first joint is the ground. Turning from $x$ to $y$ is "
        "positive."
    )


def _torques(derivation: Algebra) -> Iterator[str]:
    """Yield, for every joint with a torque, the sum that the torque is."""
    s = derivation.symbols
    chain = cast("Chain", JointsByName(s))
    for joint in sorted(int(d.symbol.name[3:]) for d in derivation.equations.torques):
        parts = []
        for law in derivation.equations.laws:
            if getattr(law.effect, "joint", 0) != joint:
                continue
            couple = law.couple(chain)
            if couple is not None:
                kind = law.effect.kind
                words = COUPLES[kind] if kind in COUPLES else MOTORS[_drive(law)]
                rest = ", which is at rest at the angle 0"
                at_zero = kind == "torsional_spring" and law.effect.rest_angle == 0.0
                parts.append(words.format(s.latex(couple)) + (rest if at_zero else ""))
        several = "the sum of " if len(parts) > 1 else "that of "
        yield f"The couple at joint {joint} is $\\tau_{{{joint}}}$, {several}{_listed(parts)}."


def _drive(law: Law) -> str:
    return next(name for name in MOTORS if getattr(law.effect, name) is not None)


def _listed(parts: Sequence[str]) -> str:
    *most, last = parts
    return f"{'; '.join(most)}; and {last}" if most else last


def _rotor(law: Law, s: Notation) -> str:
    rotor = law.armature()
    assert rotor is not None
    joint, inertia = rotor
    return (
        f"A rotor with the moment of inertia ${s.latex(inertia)}$ turns with joint {joint}, by the "
        f"joint's angle $\\varphi_{{{joint}}}$: the joint has to supply the couple "
        f"${s.latex(inertia)}\\,\\ddot{{\\varphi}}_{{{joint}}}$ that accelerates the rotor."
    )


def _lock(law: Law, q: Sequence[float]) -> str:
    joint = law.effect.joint
    angle = degrees(q[joint - 1] - (q[joint - 2] if joint > 1 else 0.0))
    return (
        f"Joint {joint} is locked: its angle stays "
        f"$\\varphi_{{{joint}}} = {number(angle)}^\\circ$, "
        f"kept by a couple $\\Lambda_{{{joint}}}$ that is one more unknown."
    )


def _path(paths: Sequence[Vector], s: Notation) -> str:
    path = [Add(*along) for along in zip(*paths, strict=True)]
    moved = [rf"{axis}_{{A}}(t) = {s.latex(e)}" for axis, e in zip("xy", path, strict=True) if e]
    rests = [rf"{axis}_{{A}} = 0" for axis, e in zip("xy", path, strict=True) if not e]
    return f"The pivot $A$ is moved along the path ${', '.join(moved + rests)}$."


def _payload(law: Law, s: Notation, tip: str) -> str:
    body = law.payload()
    assert body is not None
    mass, inertia = body
    turning = (
        f"; its moment of inertia about that point is ${s.latex(inertia)}$, and it turns with link "
        f"{s.n}"
        if inertia
        else ", a point mass"
    )
    return (
        f"A payload of mass ${s.latex(mass)}$ is fixed to the tip, with its mass centre at "
        f"${tip}${turning}."
    )


def _drag(law: Law, derivation: Algebra, page: Page) -> str:
    i, s = law.effect.link, derivation.symbols
    w0, w1, force, moment = (d.symbol for d in law.definitions(derivation.chain))
    begin, end = page.joint(i - 1).latex, page.joint(i).latex
    load = law.load(derivation.chain)
    assert load is not None
    w = s.symbol("w", "w")
    density, coefficient, diameter = (
        s.latex(getattr(law, name)) for name in ("density", "coefficient", "diameter")
    )
    wind: tuple[Expr, ...] = getattr(law, "wind", ())
    blows = (
        rf"the wind $({', '.join(s.latex(v) for v in wind)})$" if any(wind) else "the air, at rest"
    )
    return (
        f"The air resists the motion of link {i} across the rod. The force on each length "
        f"$\\mathrm{{d}}s$ of the rod is $-\\frac{{1}}{{2}} {density} {coefficient} {diameter} "
        f"{s.latex(Abs(w))} w\\,\\mathrm{{d}}s$ along the unit vector $\\mathbf{{n}}_{{{i}}} = "
        f"(-\\sin q_{{{i}}}, \\cos q_{{{i}}})$, where $w(s)$ is the speed of the rod along "
        f"$\\mathbf{{n}}_{{{i}}}$ relative to {blows}; it is ${s.latex(w0)}$ at ${begin}$, "
        f"${s.latex(w1)}$ at ${end}$, and linear between them. ${s.latex(force)}$ is the sum of "
        f"these forces, and ${s.latex(moment)}$ is the sum of their moments about ${begin}$; "
        f"${page.load(load).latex} = {s.latex(force)}\\,\\mathbf{{n}}_{{{i}}}$."
    )
