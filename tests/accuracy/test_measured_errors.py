"""What simulate(error=...) keeps and tells is no less than the error that better runs measure."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import mpmath
import numpy as np
import pendcore as pc
import pytest

E = pc.effects
BOOK = pc.Scene.textbook()
ROD = pc.Link(mass=1.0, length=1.0)
DOP853 = {"method": "dop853", "rtol": 1e-13, "atol": 1e-16}
RADAU5 = DOP853 | {"method": "radau5"}
TAYLOR = {"method": "taylor", "rtol": 1e-15, "atol": 1e-18}


def tips(scene: pc.Scene, q: Any) -> Any:
    lengths = np.array([link.length for link in scene.links])
    return np.cumsum(lengths * np.exp(1j * np.asarray(q)), axis=-1) / lengths.sum()


@pytest.mark.parametrize("name", ["textbook", "unequal", "fast_spin", "three_links", "single_rod"])
@pytest.mark.parametrize("error", [1e-3, 1e-6, 1e-9])
def test_the_error_is_kept_against_multiple_precision(reference_case, name, error):
    known = reference_case(name)
    scene = known.scene
    span = (known.t[0], known.t[-1])
    sol = pc.simulate(scene, q0=known.q0, qd0=known.qd0, t_span=span, t_eval=known.t, error=error)
    apart = abs(tips(scene, sol.q) - tips(scene, known.q)).max()
    assert apart <= sol.accuracy.achieved <= error


@dataclass
class Measured:
    """A run, the method that measures its error, and why it is here."""

    scene: pc.Scene
    span: tuple[float, float]
    q0: Any
    errors: tuple[float, ...]
    truth: dict[str, Any]
    qd0: Any = 0.0
    options: dict[str, Any] = field(default_factory=dict)
    is_case: Callable[[pc.Solution], bool] = lambda sol: not sol.stats.stiff


def in_pieces(*effects: Any) -> Measured:
    times = {"t_eval": np.linspace(0, 3, 101)}
    scene = BOOK.replace(effects=effects)
    return Measured(scene, (0, 3), [0.7, 1.0], (1e-3, 1e-8), DOP853, options=times)


def in_steps_of(max_step: float) -> Measured:
    """A tighter run of the same method would take the same steps and report no error."""
    options = {"t_eval": np.linspace(0, 5, 101), "max_step": max_step}
    return Measured(BOOK, (0, 5), [-0.6, -0.4], (1e-6,), DOP853, options=options)


def at_rest_after_two_steps(static: float, rate: float) -> Measured:
    friction = E.DryJointFriction(1, coulomb=10.0, static=static, stribeck_velocity=1.0)
    scene = pc.Scene(links=[ROD], gravity=0.0, effects=[friction])
    truth = DOP853 | {"max_step": 1e-3}
    return Measured(scene, (0, 10), 0.3, (1e-5,), truth, rate, {"store": "end"})


def stiff(damping: float, t_end: float, errors: tuple[float, ...], **options: Any) -> Measured:
    scene = BOOK.replace(effects=[E.ViscousJoint(joint=2, damping=damping)])
    times = {"t_eval": np.linspace(0, t_end, 101)}
    return Measured(
        scene, (0, t_end), [0.7, 1.0], errors, RADAU5, options=times | options,
        is_case=lambda sol: sol.stats.stiff or sol.method == "radau5",
    )  # fmt: skip


def limited_by_max_step() -> Measured:
    """No other method gets through, so the method verifies itself, in shorter steps."""
    case = stiff(1e5, 2, (1e-6,), max_step=0.05, t_eval=np.linspace(0, 2, 41))
    case.is_case = lambda sol: sol.stats.stiff and sol.stats.limited_by_max_step > 10
    return case


def bouncing_ever_faster() -> Measured:
    """It bounces until it stays: all runs by one method would take the same steps."""
    effects = [
        E.TorsionalSpring(joint=1, stiffness=170.0, rest_angle=-0.95),
        E.DryJointFriction(joint=1, coulomb=0.65),
        E.JointStop(joint=1, range=(2.5, 3.7), restitution=0.85),
    ]
    rod = pc.Link(mass=0.25, length=0.8, center=0.35, inertia=0.004)
    scene = pc.Scene(links=[rod], effects=effects)
    return Measured(
        scene, (5.3, 10.3), [2.8], (1e-3, 1e-6), TAYLOR, [2.0],
        is_case=lambda sol: 2 * sol.stats.limited_by_break > sol.stats.accepted,
    )  # fmt: skip


def with_a_lost_link() -> Measured:
    """The last link is 4 mm long; its angle is lost at 1.15 s, while positions are still right."""
    links = [pc.Link.point_mass(mass=1, length=length) for length in (1, 0.004)]
    truth = {"method": "dop853", "rtol": 1e-14}
    return Measured(pc.Scene(links=links), (0, 20), (0.3, 2.0), (0.01,), truth)


def of_a_stiff_spring() -> Measured:
    """Series at rtol 1e-14 share a truncation of 5.6e-11 here, more than the error asked for."""
    links = [
        pc.Link(
            mass=0.04602293018960736, length=0.16517151492763457, center=0.09491503985719417,
            inertia=2.3219145115356827e-06,
        ),
        pc.Link(mass=0.5316393466490769, length=0.7327071171056337),
    ]  # fmt: skip
    spring = E.TorsionalSpring(2, 492.85686576460034, rest_angle=0.1618594017886068)
    scene = pc.Scene(links=links, effects=[spring], gravity=1.62)
    q0, truth = [2.3462883317744248, 1.5554941614334186], DOP853 | {"rtol": 1e-15, "atol": 1e-18}
    errors = (3.694588949553511e-11,)
    return Measured(scene, (12.5, 9.5), q0, errors, truth | {"compensated": True})


MEASURED = {
    "rubbed": in_pieces(*(E.DryJointFriction(joint=j, coulomb=c) for j, c in ((1, 2.0), (2, 1.0)))),
    "stopped": in_pieces(E.JointStop(joint=2, range=(-0.5, 0.5), restitution=0.5)),
    "stiff": stiff(1e7, 3, (1e-3, 1e-8)),
    "stiff, in steps of max_step": limited_by_max_step(),
    **{f"in steps of {max_step}": in_steps_of(max_step) for max_step in (0.1, 0.02, 0.01)},
    "at rest after two steps": at_rest_after_two_steps(15.0, 1.0),
    "at rest after two fast steps": at_rest_after_two_steps(30.0, 2.0),
    "bouncing ever faster": bouncing_ever_faster(),
    "a lost link": with_a_lost_link(),
    "a stiff spring": of_a_stiff_spring(),
}


@pytest.mark.parametrize("name", MEASURED)
def test_the_measured_error_is_at_most_what_is_told(name):
    case = MEASURED[name]
    for error in case.errors:
        sol = pc.simulate(case.scene, case.span, case.q0, case.qd0, error=error, **case.options)
        t = sol.t if case.options else np.linspace(case.span[0], sol.t[-2], 5001)
        q = sol.q if case.options else sol(t)[: len(case.scene.links)].T
        truth = pc.simulate(case.scene, case.span, case.q0, case.qd0, t_eval=t, **case.truth)
        apart = abs(tips(case.scene, q) - tips(case.scene, truth.q)).max()
        assert 1e-15 < apart <= sol.accuracy.achieved <= error
        assert sol.accuracy.until == case.span[1]
        assert case.is_case(sol)


def test_an_error_in_step_with_a_grid_of_times_is_seen():
    """After 50 whole periods an error of the phase hardly shows at 101 evenly spaced times."""
    period = 4 * float(mpmath.ellipk(math.sin(0.5) ** 2)) / math.sqrt(9.807)
    rod = pc.Scene(links=[pc.Link.point_mass(mass=1.0, length=1.0)])
    span = (0, 50 * period)
    sol = pc.simulate(rod, q0=np.pi / 2 - 1, t_span=span, error=1e-6)
    t = np.linspace(*span, 4001)
    exact = pc.simulate(rod, q0=np.pi / 2 - 1, t_span=span, t_eval=t, method="taylor", rtol=1e-14)
    apart = abs(tips(rod, sol(t).T[:, :1]) - tips(rod, exact.q))
    assert apart[::40].max() < apart.max() / 5
    assert 0.5 * sol.accuracy.achieved < apart.max() <= sol.accuracy.achieved <= 1e-6


@pytest.mark.parametrize("t_start", [0.0, 12.5, -70.0])
@pytest.mark.parametrize("error", [3e-12, 1e-11, 1e-10])
def test_the_last_bit_of_a_time_is_a_part_of_the_error(t_start, error):
    """A state is stored at the double nearest its time; at 1e5 rad/s a rod turns in between."""
    rod, stiffness = pc.Link.point_mass(mass=1.0, length=1.0), 1e10
    spring = E.TorsionalSpring(joint=1, stiffness=stiffness)
    scene = pc.Scene(links=[rod], effects=[spring], gravity=0.0)
    try:
        sol = pc.simulate(scene, q0=1.0, t_span=(t_start, t_start + 2.0**-10), error=error)
    except pc.AccuracyError as refusal:
        sol = refusal.solution
    exact = np.cos(np.sqrt(np.longdouble(stiffness)) * (sol.t - np.longdouble(t_start)))
    apart = float(abs(2 * np.sin((sol.q[:, 0] - exact) / 2)).max())
    least = 1e5 * np.spacing(abs(t_start)) / 2
    assert max(apart, 0.9 * least) <= sol.accuracy.achieved <= 20 * max(error, least)
