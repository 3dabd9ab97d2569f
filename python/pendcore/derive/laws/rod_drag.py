"""Air drag along a rod: f(s) = -k abs(w) w across it, k = rho C_d d / 2.

w(s) = w_0 + (w_1 - w_0) s/L is the speed across the rod relative to the wind; w_0 and w_1 are the
speeds of its ends. The resultant F (across the rod) and the moment T about the joint where the rod
begins are integrals of f. With D = abs(w_0) + abs(w_1) they are, for all signs of w_0 and w_1:

    F = -k L   (w_0 + w_1)/D (w_0^2 + abs(w_0 w_1) + w_1^2) / 3
    T = -k L^2 ((w_0 abs(w_0)^3 + w_1 w_1^2 (4 abs(w_0) + 3 abs(w_1)))/D^2
                + 2 (w_0 w_1 + abs(w_0 w_1)) (w_0 + w_1)/D) / 12

F and T are as smooth as f: differentiable once, also where a speed changes its sign. As in the
core, 1e-100 m/s is added to D, so that a rod at rest has no drag instead of 0/0.
"""

from __future__ import annotations

from typing import Any

from sympy import Abs, Expr, Integer, Symbol

from pendcore.derive.chain import Chain, Vector, across, dot, minus
from pendcore.derive.laws.law import Law, LinkLoad
from pendcore.derive.notation import RATE, Notation

AT_REST = 1e-100
"""The speed that keeps D from 0, m/s."""


def rod_drag(effect: Any, s: Notation) -> Law:
    """See the core's effect of that name; its power is F n . v + T qd."""
    i, write = effect.link, s.latex
    length, turning, normal = s.lengths[i - 1], s.qd[i - 1], across(s.q[i - 1])

    def parameter(name: str, latex: str, value: float, unit: str, meaning: str) -> Symbol:
        return s.parameter(f"{name}_{i}", f"{latex}{i}}}", value, unit, meaning)

    drag = parameter("Cd", "C_{d,", effect.drag_coefficient, "1", f"drag coefficient of rod {i}")
    diameter = parameter("d", "d_{", effect.diameter, "m", f"diameter of rod {i}")
    words = f"density of the air around rod {i}"
    density = parameter("rho", r"\rho_{", effect.air_density, "kg/m^3", words)
    wind = tuple(
        parameter(f"v{axis}", f"v_{{{axis},", v, "m/s", f"wind along {axis} at rod {i}")
        if v != 0.0
        else Integer(0)
        for axis, v in zip("xy", effect.wind, strict=True)
    )
    words = "avoids 0/0 for a rod at rest"
    at_rest = parameter("eps", r"\varepsilon_{", AT_REST, "m/s", words)
    w0, w1, force, moment = (
        s.symbol(*s.fresh(f"{name}_{i}", f"{latex},{i}}}"))
        for name, latex in (("w0", "w_{0"), ("w1", "w_{1"), ("Fd", "F_{d"), ("Td", "T_{d"))
    )
    begins, rod = f"where rod {i} begins", f"rod {i}"
    s.meanings |= {
        w0: f"speed across the rod {begins}, relative to the wind, m/s",
        w1: f"the same where {rod} ends, m/s",
        force: f"drag on {rod}, across it, N",
        moment: f"its moment about the joint {begins}, N m",
    }
    k = density * drag * diameter / 2

    def definitions(chain: Chain) -> dict[Symbol, Expr]:
        near = dot(normal, minus(chain.joint_velocities[i - 1], wind))
        size = Abs(w0) + Abs(w1) + at_rest
        direction = (w0 + w1) / size
        ends = w0 * Abs(w0) ** 3 + w1**3 * (4 * Abs(w0) + 3 * Abs(w1))
        between = 2 * (w0 * w1 + Abs(w0) * Abs(w1)) * direction
        resultant = -k * length / 3 * direction * (w0**2 + Abs(w0) * Abs(w1) + w1**2)
        turn = -k * length**2 / 12 * (ends / size**2 + between)
        return {w0: near, w1: w0 + length * turning, force: resultant, moment: turn}

    def power(chain: Chain, ground_force: Vector) -> Expr:
        return force * dot(normal, chain.joint_velocities[i - 1]) + moment * turning

    w = s.symbol("w", "w", RATE)
    air = f"the wind $({', '.join(map(write, wind))})$" if any(wind) else "the air"
    unit_vector = rf"\mathbf{{n}}_{{{i}}}"
    statement = (
        f"The air resists the motion of link {i}: the force on each length $\\mathrm{{d}}s$ of the "
        f"rod is ${write(-k * Abs(w) * w)} \\,\\mathrm{{d}}s$ along the unit vector ${unit_vector} "
        f"= (-\\sin q_{{{i}}}, \\cos q_{{{i}}})$ across the rod, where $w$ is the speed of that "
        f"length along ${unit_vector}$ relative to {air}. It is ${write(w0)}$ where the link "
        f"begins, ${write(w1)}$ where the link ends, and linear between them. The sum of these "
        f"forces is ${write(force)} \\,{unit_vector}$, and ${write(moment)}$ is the sum of their "
        "moments about the joint where the link begins."
    )
    load = LinkLoad(i, (force * normal[0], force * normal[1]), moment)
    return Law(effect, statement, definitions=definitions, load=load, power=power)
