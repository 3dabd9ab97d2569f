"""The equations of motion as heyoka compiles them: relative angles, a dense mass matrix.

The state is phi_j = q_j - q_{j-1} and its rate w_j, so that the torque of a joint stands in one
equation alone:

    sum_k R_jk wd_k = r_j,   R_jk = sum_{a >= j, b >= k} K_ab cos(q_a - q_b)  (+ J_j where j = k),
    r_j = tau_j + sum_{i >= j} [h_i ((g - ydd_0) cos q_i + xdd_0 sin q_i)
                                - sum_b K_ib sin(q_i - q_b) qd_b^2].

It is solved from the tip to the base, R = L^T D L. All constants are parameters: a system is
compiled once for a number of links.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import heyoka as hy

from true_error.arithmetic import Arithmetic
from true_error.constants import Parameters

COMPACT_FROM = 2
"""Links from which it takes too long to compile loops unrolled."""


@dataclass
class System:
    """A compiled integrator, and where each of its parameters stands."""

    integrator: Any
    places: dict[str, int]
    arithmetic: Arithmetic

    def begin(self, values: Parameters) -> None:
        """Set parameters, and all others to zero."""
        self.integrator.pars[:] = self.arithmetic.type(0.0)
        self.set(values)

    def set(self, values: Parameters) -> None:
        """Set parameters; those that are not compiled into the system must be zero."""
        for name, value in values.items():
            if name in self.places:
                self.integrator.pars[self.places[name]] = self.arithmetic.number(value)
            elif value:
                raise KeyError(f"{name} = {value}: this system was compiled without it")


class Names:
    """Parameters of a system, in the order in which they are first asked for."""

    def __init__(self) -> None:
        self.places: dict[str, int] = {}

    def __call__(self, name: str) -> hy.expression:
        return hy.par[self.places.setdefault(name, len(self.places))]


@dataclass
class Chain:
    """Angles and rates of a chain's joints and links, in symbols."""

    phi: list[Any]
    w: list[Any]
    q: list[Any]
    qd: list[Any]

    @classmethod
    def of(cls, n: int) -> Chain:
        phi = [hy.expression(f"phi{j}") for j in range(n)]
        w = [hy.expression(f"w{j}") for j in range(n)]
        q = [hy.sum(phi[: i + 1]) for i in range(n)]
        qd = [hy.sum(w[: i + 1]) for i in range(n)]
        return cls(phi, w, q, qd)


@cache
def smooth(n: int, acted_on: bool, arithmetic: Arithmetic) -> System:
    """Return the system of a chain, with the torques of `constants.smooth_torques` or without."""
    par, chain = Names(), Chain.of(n)
    torques = [smooth_torque(chain, j, par) for j in range(n)] if acted_on else [0.0] * n
    matrix, loads = balance(chain, par, acted_on)
    rates = solved(matrix, [load + torque for load, torque in zip(loads, torques, strict=True)])
    return compile_system(chain, rates, par, arithmetic)


def compile_system(
    chain: Chain, rates: list[Any], par: Names, arithmetic: Arithmetic, **more: Any
) -> System:
    """Compile phi' = w, w' = rates."""
    n = len(chain.phi)
    equations = [*zip(chain.phi, chain.w, strict=True), *zip(chain.w, rates, strict=True)]
    integrator = hy.taylor_adaptive(
        equations, [arithmetic.type(0.0)] * (2 * n), fp_type=arithmetic.type,
        compact_mode=n >= COMPACT_FROM, high_accuracy=True, **more,
    )  # fmt: skip
    return System(integrator, par.places, arithmetic)


def smooth_torque(chain: Chain, j: int, par: Names) -> Any:
    """Return c - k phi - b w - b3 w^3 + A sin(o t + p) of joint j."""
    phi, w = chain.phi[j], chain.w[j]
    drive = par(f"A{j}") * hy.sin(par(f"o{j}") * hy.time + par(f"p{j}"))
    linear = par(f"c{j}") - par(f"k{j}") * phi - par(f"b{j}") * w
    return linear - par(f"b3{j}") * (w * w * w) + drive


def balance(chain: Chain, par: Names, is_driven: bool) -> tuple[list[list[Any]], list[Any]]:
    """Return R (n, n) and what gravity, the pivot and the rates add to r (n,)."""
    n, q = len(chain.q), chain.q
    K = [[par(f"K{min(i, j)}{max(i, j)}") for j in range(n)] for i in range(n)]
    cos = {(i, j): hy.cos(hy.sum(chain.phi[j + 1 : i + 1])) for i in range(n) for j in range(i)}
    sin = {(i, j): hy.sin(hy.sum(chain.phi[j + 1 : i + 1])) for i in range(n) for j in range(i)}
    square = [rate * rate for rate in chain.qd]
    loads = []
    for i in range(n):
        terms = [par(f"h{i}") * _weight(q[i], par, is_driven)]
        terms += [-K[i][j] * (sin[i, j] * square[j]) for j in range(i)]
        terms += [K[i][j] * (sin[j, i] * square[j]) for j in range(i + 1, n)]
        loads.append(hy.sum(terms))
    M = [[K[i][i] if i == j else K[i][j] * cos[max(i, j), min(i, j)] for j in range(n)]
         for i in range(n)]  # fmt: skip
    R = [[hy.sum([M[a][b] for a in range(j, n) for b in range(k, n)]) for k in range(n)]
         for j in range(n)]  # fmt: skip
    for j in range(n):
        R[j][j] = R[j][j] + par(f"J{j}")
    return R, [hy.sum(loads[j:]) for j in range(n)]


def _weight(q: Any, par: Names, is_driven: bool) -> Any:
    if not is_driven:
        return par("g") * hy.cos(q)
    x, y = (
        par(axis + "c") + par(axis + "d") * hy.time
        + par(axis + "A") * hy.sin(par(axis + "o") * hy.time + par(axis + "p"))
        for axis in "xy"
    )  # fmt: skip
    return (par("g") - y) * hy.cos(q) + x * hy.sin(q)


def solved(R: list[list[Any]], r: list[Any]) -> list[Any]:
    """Return the solution of R x = r, with R's upper triangle eliminated from the last row on."""
    n = len(r)
    R, x = [row[:] for row in R], r[:]
    factor = {}
    for k in reversed(range(n)):
        for i in range(k):
            factor[k, i] = R[k][i] / R[k][k]
        for i in range(k):
            for j in range(i + 1):
                R[i][j] = R[j][i] = R[i][j] - factor[k, i] * R[k][j]
            x[i] = x[i] - factor[k, i] * x[k]
    for k in range(n):
        x[k] = x[k] / R[k][k]
        for i in range(k):
            x[k] = x[k] - factor[k, i] * x[i]
    return x
