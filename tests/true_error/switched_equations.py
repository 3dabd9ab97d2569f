"""The equations of a chain whose joints stick, meet stops, and have laws with kinks.

All that changes at an event is a parameter, so that one system is compiled for all that can happen:

* A joint is held by the factors ``u`` of its row and column, which leave wd_j = 0; the torque that
  holds it is  lambda_j = sum_k R_jk wd_k - r_j.
* Dry friction is  -(fc + fd exp(-(fe w + ff w^2))), its parameters of the sign of the rate.
* Each of `SLOTS` events is a zero of (x - a) (d x - b), where x is a weighted sum of angles, rates
  and holding torques.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import heyoka as hy
import numpy as np
import numpy.typing as npt

from true_error.arithmetic import Arithmetic
from true_error.constants import Parameters
from true_error.equations import (
    Chain,
    Names,
    System,
    balance,
    compile_system,
    smooth_torque,
    solved,
)  # fmt: skip

SLOTS = 3
COOLDOWN = 1e-12
"""s; an event has no second zero so soon."""


@dataclass
class SwitchedSystem(System):
    """A compiled integrator, and a function of what it computes at an instant."""

    instant: Any
    count: int
    """The number of parameters without those of events, which come last."""

    def at(self, t: Any, state: npt.NDArray[Any], values: Parameters) -> npt.NDArray[Any]:
        """Return accelerations, holding torques, rates after unit impulses: (3, n).

        `values` replace some of the parameters.
        """
        parameters = self.integrator.pars[: self.count].copy()
        for name, value in values.items():
            if (place := self.places[name]) < self.count:
                parameters[place] = self.arithmetic.number(value)
        return np.reshape(self.instant(state, pars=parameters, time=t), (3, -1))


@cache
def switched(n: int, arithmetic: Arithmetic) -> SwitchedSystem:
    """Return the system of n links."""
    par, chain = Names(), Chain.of(n)
    R, loads = balance(chain, par, is_driven=True)
    r = [load + torque(chain, j, par) for j, load in enumerate(loads)]
    held = [[par(f"u{j}{k}") * R[j][k] + (par(f"s{j}") if j == k else 0.0) for k in range(n)]
            for j in range(n)]  # fmt: skip
    rates = solved(held, [par(f"u{j}{j}") * r[j] for j in range(n)])
    holding = [hy.sum([R[j][k] * rates[k] for k in range(n)]) - r[j] for j in range(n)]
    after = solved(held, [par(f"i{j}") + 0.0 * chain.w[j] for j in range(n)])
    count = len(par.places)
    events = []
    for slot in range(SLOTS):
        x = hy.sum([
            par(f"{kind}{slot}{j}") * value
            for kind, values in (("ef", chain.phi), ("ew", chain.w), ("el", holding))
            for j, value in enumerate(values)
        ])  # fmt: skip
        bounds = (x - par(f"ea{slot}")) * (par(f"ed{slot}") * x - par(f"eb{slot}"))
        events.append(
            hy.t_event(bounds, fp_type=arithmetic.type, cooldown=arithmetic.type(COOLDOWN))
        )
    system = compile_system(chain, rates, par, arithmetic, t_events=events)
    instant = hy.cfunc(
        [*rates, *holding, *after], [*chain.phi, *chain.w], fp_type=arithmetic.type,
        compact_mode=True,
    )  # fmt: skip
    return SwitchedSystem(system.integrator, par.places, arithmetic, instant, count)


def torque(chain: Chain, j: int, par: Names) -> Any:
    """Return all that acts in joint j."""
    phi, w = chain.phi[j], chain.w[j]
    square = w * w
    friction = par(f"fc{j}") + par(f"fd{j}") * hy.exp(-(par(f"fe{j}") * w + par(f"ff{j}") * square))
    pulse = (hy.time - par(f"gm{j}")) * par(f"gi{j}")
    return hy.sum([
        smooth_torque(chain, j, par),
        par(f"d{j}") * hy.time,
        -friction,
        -par(f"b2{j}") * square,
        -par(f"k3{j}") * (phi * phi * phi),
        -par(f"us{j}") * hy.sin(par(f"ut{j}") * phi),
        par(f"gh{j}") * hy.exp(-(pulse * pulse)),
    ])  # fmt: skip
