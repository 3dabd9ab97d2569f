"""Lyapunov exponents agree with closed forms, known sums and neighbours in many digits."""

from __future__ import annotations

import pickle
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pendcore as pc
import pytest
from chaotic_starts import EACH, T_END, ChaoticStart, chaotic_starts
from matplotlib.figure import Figure
from numpy.typing import NDArray

E = pc.effects
GRAVITY = 9.807
TIGHT: dict[str, Any] = {"rtol": 1e-14, "atol": 1e-16}
FAST, SLOW = (np.sqrt(GRAVITY * (3 + sign * 6 / np.sqrt(7))) for sign in (1, -1))
"""Two equal upright rods of 1 m grow at these rates; hanging, they have these frequencies."""


def rods(n: int, *effects: pc.effects.Effect, gravity: float = GRAVITY) -> pc.Scene:
    return pc.Scene(
        links=[pc.Link(mass=1.0, length=1.0)] * n, gravity=gravity, effects=list(effects)
    )


def growth_of(linear: NDArray[np.float64], t: float) -> NDArray[np.float64]:
    """Return ln |R_ii| of exp(linear t) = Q R, which is what the exponents sum up."""
    values, vectors = np.linalg.eig(linear)
    flow = (vectors * np.exp(values * t)) @ np.linalg.inv(vectors)
    return np.log(np.abs(np.diagonal(np.linalg.qr(flow.real)[1])))


def linearised(stiffness: NDArray[np.float64]) -> NDArray[np.float64]:
    n = len(stiffness)
    return np.block([[np.zeros((n, n)), np.eye(n)], [stiffness, np.zeros((n, n))]])


# M = ((4/3, 1/2), (1/2, 1/3)) and V = -g (3/2 sin q_1 + 1/2 sin q_2) near q = -pi/2
STANDING = linearised(
    np.linalg.solve([[4 / 3, 1 / 2], [1 / 2, 1 / 3]], GRAVITY * np.diag([3 / 2, 1 / 2]))
)


def test_upright_the_exponents_are_the_roots_of_the_textbook() -> None:
    roots = [FAST, SLOW, -SLOW, -FAST]
    assert np.sort(np.linalg.eigvals(STANDING))[::-1] == pytest.approx(roots, rel=1e-12)
    found = pc.lyapunov(rods(2), (0, 2.0), -np.pi / 2, transient=1.5)
    assert found.exponents == pytest.approx(roots, rel=2e-3)


@pytest.mark.parametrize(("angle", "sign"), [(-np.pi / 2, 1), (np.pi / 2, -1)])
def test_at_an_equilibrium_the_growth_is_that_of_the_matrix_exponential(
    angle: float, sign: int
) -> None:
    found = pc.lyapunov(rods(2), q0=angle, t_span=(0, 0.8), t_eval=[0.2, 0.5, 0.8], rtol=1e-11)
    linear = STANDING.copy()
    linear[2:] *= sign
    for t, growth in zip(found.t[1:], found.growth[1:], strict=True):
        assert growth == pytest.approx(growth_of(linear, t), abs=1e-8)


def test_a_single_pendulum_is_not_chaotic() -> None:
    found = pc.lyapunov(rods(1), q0=0.3, t_span=(0, 1000))
    t = found.t[1:]
    # Neighbours swing with another period and part in proportion to time: ln(1 + c t)/t at most.
    assert (np.abs(found.finite_time[1:, 0]) <= np.log(1 + 10 * t) / t).all()
    assert found.exponents.sum() == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("n", [2, 3])
def test_without_losses_the_spectrum_is_symmetric_and_adds_up_to_nothing(n: int) -> None:
    scene = rods(n)
    found = pc.lyapunov(scene, q0=np.linspace(-2.0, -1.0, n), t_span=(0, 150))
    assert found.largest > 0.5
    # By Liouville det Phi = det M(start)/det M(end) in angles and rates, as momenta are M qd.
    _, log_det = np.linalg.slogdet(scene.mass_matrix(found.q))
    assert found.growth.sum(axis=1) == pytest.approx(log_det[0] - log_det, abs=1e-6)
    pairs = found.exponents + found.exponents[::-1]
    assert np.abs(pairs).max() < 8 / 150  # at a finite time t a number over t remains
    assert np.abs(found.exponents[n - 1 : n + 1]).max() < 12 / 150  # along the flow and across


@pytest.mark.parametrize("dampings", [[0.2], [0.05, 0.03]], ids=["one link", "two links"])
def test_with_damping_the_exponents_add_up_to_it(dampings: list[float]) -> None:
    n = len(dampings)
    scene = rods(n, *(E.ViscousJoint(joint=j, damping=b) for j, b in enumerate(dampings, 1)))
    times = np.linspace(0, 10, 4001)
    found = pc.lyapunov(scene, (0, 10), [-2.0, -1.0][:n], t_eval=times, rtol=1e-11)
    joints = np.eye(n) - np.eye(n, k=-1)
    damping = joints.T @ np.diag(dampings) @ joints  # tau = -b phid, on absolute angles
    mass = scene.mass_matrix(found.q)
    loss = np.trace(np.linalg.solve(mass, np.broadcast_to(damping, mass.shape)), axis1=1, axis2=2)
    h = times[1]
    simpson = h / 3 * (loss[0] + 4 * loss[1::2].sum() + 2 * loss[2:-1:2].sum() + loss[-1])
    _, log_det = np.linalg.slogdet(mass)
    assert found.growth[-1].sum() == pytest.approx(log_det[0] - log_det[-1] - simpson, abs=1e-8)


def growth(case: ChaoticStart, moved: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the growth at each half second of a tight run whose start is off by ``moved``."""
    start = np.split(np.array([*case.q0, *case.qd0]) + moved, 2)
    how = {"count": 1, "t_eval": np.arange(1, len(case.growth) + 1) / 2, **TIGHT}
    return pc.lyapunov(case.scene, (0, T_END), *start, **how).growth[1:, 0]


def spread_of_roundings(case: ChaoticStart) -> NDArray[np.float64]:
    """Return how far the random walk of the run's roundings moves its growth at those times.

    A component is rounded by up to EPS/2 of its size, and the effect of a change of it at the start
    is measured. A rounding at a later time s grows by e^growth(s) less.
    """
    small = 1e-12
    changes = small * np.eye(2 * len(case.q0))
    slopes = [np.abs(growth(case, one) - growth(case, -one)) / (2 * small) for one in changes]
    at_most = np.maximum.accumulate(slopes, axis=1)
    run = pc.simulate(case.scene, (0, T_END), case.q0, case.qd0, method="dop853", **TIGHT)
    of_components = np.finfo(float).eps / 2 / np.sqrt(3) * np.abs(run.y).max(axis=1)
    of_a_step = np.linalg.norm(of_components[:, np.newaxis] * at_most, axis=0)
    left = np.exp(-np.array([0.0, *case.growth[:-1]]))
    steps = run.stats.accepted / len(left)
    return np.asarray(of_a_step * np.sqrt(steps * np.cumsum(left**2)))


@pytest.mark.few_cases
@pytest.mark.parametrize("case", chaotic_starts(), ids=lambda case: str(case.q0))
def test_a_neighbour_in_many_digits_parts_at_that_rate(case: ChaoticStart) -> None:
    """The growths agree to the record's twelve decimals and the rounding of the run itself."""
    assert len(case.growth) == 2 * T_END
    assert EACH % 2 == 0
    exact = np.array(case.growth)
    known = np.maximum.accumulate(exact) < 20
    assert known.sum() > 6
    off = np.abs(growth(case, np.zeros(2 * len(case.q0))) - exact)
    allowed = 0.51e-12 + 3 * spread_of_roundings(case)
    assert (off < allowed)[known].all()


def differences(scene: pc.Scene, q0: list[float], t: float) -> float:
    """Return the ln of how much longer a change of q_1 has become, from two runs."""
    small, fine = 1e-6, {"rtol": 1e-12, "atol": 1e-14}
    one, other = (
        pc.simulate(scene, (0, t), [q0[0] + change, *q0[1:]], **fine).y[:, -1]
        for change in (small, -small)
    )
    return float(np.log(np.linalg.norm(one - other) / (2 * small)))


def spring(t: float, q: NDArray[np.float64], qd: NDArray[np.float64]) -> list[float]:
    return [-2.0 * np.sin(q[0]), -0.1 * qd[1] ** 3]


SMOOTH: dict[str, list[pc.effects.Effect]] = {
    "none": [],
    "springs": [E.TorsionalSpring(joint=2, stiffness=3.0), E.RotorInertia(1, 0.2)],
    "drag": [E.RodDrag(link=2, drag_coefficient=1.2, diameter=0.3, wind=(2.0, 0.0))],
    "three damping terms": [E.ViscousJoint(1, 0.1, damping2=0.2, damping3=0.1)],
    "clipped": [E.Motor(joint=2, pd=E.PD(kp=30.0, kd=1.0, reference=0.5), limit=4.0)],
    "table": [E.Motor(joint=1, table=E.Table([0.0, 0.7, 2.0], [0.0, 5.0, -3.0]))],
    "driven": [E.DrivenPivot(y=E.Sinusoid(amplitude=0.1, angular_frequency=9.0))],
    "spline": [E.DrivenPivot(spline=E.Spline([0.0, 1.0, 2.0], [0.0, 0.1, 0.0], [0.0, 0.1, 0.3]))],
    "payload": [E.Payload(mass=0.5, inertia=0.02)],
    "user": [E.User(spring)],
    "damped, sprung and driven": [
        E.ViscousJoint(1, 0.1),
        E.TorsionalSpring(2, 3.0, 0.2),
        E.Motor(1, sinusoid=E.Sinusoid(2.0, 3.0)),
    ],
}


@pytest.mark.parametrize("name", SMOOTH)
def test_under_effects_neighbours_part_at_that_rate(name: str) -> None:
    for n in (2,) if name == "user" else (2, 3, 4):
        scene, q0 = rods(n, *SMOOTH[name]), [0.3, 1.1, 0.7, -0.4][:n]
        found = pc.lyapunov(scene, q0=q0, t_span=(0, 2.0), rtol=1e-11)
        assert found.growth[-1, 0] == pytest.approx(differences(scene, q0, 2.0), abs=2e-5)
        alone = pc.lyapunov(scene, q0=q0, t_span=(0, 2.0), rtol=1e-11, count=1)
        assert alone.growth.shape == (201, 1)
        assert alone.growth[-1, 0] == pytest.approx(found.growth[-1, 0], abs=1e-7)
        if name == "none":
            _, log_det = np.linalg.slogdet(scene.mass_matrix(found.q))
            assert found.growth.sum(axis=1) == pytest.approx(log_det[0] - log_det, abs=1e-8)
        if name in ("none", "damped, sprung and driven"):
            # Two to four links take one series a step; one of Runge-Kutta would count as twelve.
            assert found.stats.nfev < 4 * found.stats.accepted


def test_changes_that_shrink_by_many_powers_of_ten_shrink_at_the_linear_rates() -> None:
    scene = rods(2, E.ViscousJoint(joint=1, damping=12.0), E.ViscousJoint(joint=2, damping=3.0))
    mass = np.array([[4 / 3, 1 / 2], [1 / 2, 1 / 3]])
    linear = linearised(-np.linalg.solve(mass, GRAVITY * np.diag([3 / 2, 1 / 2])))
    linear[2:, 2:] = -np.linalg.solve(mass, [[15.0, -3.0], [-3.0, 3.0]])
    rates = np.linalg.eigvals(linear).real
    found = pc.lyapunov(scene, q0=np.pi / 2, t_span=(0, 10), t_eval=[5.0, 10.0], rtol=1e-11)
    # In the first half the changes turn into their directions.
    later = (found.growth[2] - found.growth[1]) / 5
    assert later.sum() == pytest.approx(rates.sum(), abs=1e-6)
    assert later[-1] == pytest.approx(rates.min(), abs=1e-6)
    assert found.growth[2, -1] < -500.0


def test_what_is_locked_has_no_exponents() -> None:
    locked = pc.lyapunov(rods(2, E.Lock(joint=2)), (0, 20), 0.3)
    one = pc.Scene(links=[pc.Link(mass=2.0, length=2.0)], gravity=GRAVITY)
    assert locked.growth == pytest.approx(pc.lyapunov(one, (0, 20), 0.3).growth, abs=1e-7)
    held = pc.lyapunov(rods(2, E.Lock(joint=1)), (0, 1), [0.2, 0.3])
    assert held.exponents.shape == (2,)
    still = (rods(2, E.Lock(joint=1), E.Lock(joint=2)), (0, 1), [0.2, 0.3])
    none = pc.lyapunov(*still)
    assert none.exponents.shape == (0,)
    assert np.isnan(none.largest)
    assert none.time == none.seconds_a_digit == np.inf
    with pytest.raises(ValueError, match="count = 1: must be left out: nothing of the scene can"):
        pc.lyapunov(*still, count=1)


JUMPS = [E.DryJointFriction(joint=2, coulomb=0.1), E.JointStop(joint=2, range=(-1.0, 1.0))]


def test_effects_that_jump_are_refused_by_name() -> None:
    kinds = pc.effects.kinds().values()
    jumps = {one.kind for one in kinds if one.description.jumps_or_sticks}
    assert jumps == {effect.kind for effect in JUMPS}
    for effect in JUMPS:
        scene = rods(2, E.ViscousJoint(joint=1, damping=0.1), effect)
        told = rf"effect 2 \({effect.kind}\): motions jump .*: remove dry friction and stops"
        with pytest.raises(ValueError, match=told):
            pc.lyapunov(scene, q0=[1.0, 1.0], t_span=(0, 1))


def test_backward_the_spectrum_changes_its_sign() -> None:
    there = pc.lyapunov(rods(2), q0=[-2.0, -1.0], t_span=(0, 5), count=4)
    back = pc.lyapunov(rods(2), q0=there.q[-1], qd0=there.qd[-1], t_span=(5, 0))
    assert back.q[-1] == pytest.approx([-2.0, -1.0], abs=1e-5)
    assert back.growth[-1].sum() == pytest.approx(-there.growth[-1].sum(), abs=1e-5)
    assert back.growth[-1, 0] > 1.0


def test_growth_counts_from_the_end_of_the_transient() -> None:
    times = [2.0, 3.0, 5.0]
    whole = pc.lyapunov(rods(2), q0=[-2.0, -1.0], t_span=(0, 5), t_eval=times)
    later = pc.lyapunov(rods(2), q0=[-2.0, -1.0], t_span=(0, 5), transient=2.0, t_eval=times[1:])
    assert whole.t.tolist() == [0.0, *times]
    assert later.t.tolist() == times
    assert later.growth == pytest.approx(whole.growth[1:] - whole.growth[1], abs=1e-12)
    assert later.exponents == pytest.approx(np.sort(later.growth[-1] / 3)[::-1], rel=1e-14)
    assert np.isnan(later.finite_time[0]).all()


def test_exponents_of_a_solution_follow_its_run() -> None:
    sol = pc.simulate(rods(2), q0=[-2.0, -1.0], t_span=(0, 10), method="dop853")
    found = sol.lyapunov(count=2)
    assert found.growth == pytest.approx(
        pc.lyapunov(sol.scene, q0=[-2.0, -1.0], t_span=(0, 10), count=2).growth, abs=1e-12
    )
    assert found.q[20] == pytest.approx(sol(found.t[20])[:2], abs=1e-6)
    assert found.time == 1 / found.largest
    assert found.seconds_a_digit == pytest.approx(np.log(10) / found.largest)
    assert pickle.loads(pickle.dumps(found)).growth.tolist() == found.growth.tolist()


def test_a_run_of_no_length_has_none() -> None:
    with pytest.raises(ValueError, match="lyapunov: the run ended where it began"):
        pc.simulate(rods(2), q0=[1.0, 1.0], t_span=(2, 2)).lyapunov()


LONG = {"q0": [-2.0, -1.0], "t_span": (0, 3000)}


class Enough(Exception):
    pass


def test_an_exception_of_an_effect_is_raised_with_what_was_found() -> None:
    def push(t: float, q: Any, qd: Any) -> Any:
        if t > 2.0:
            raise Enough
        return 0.0 * qd

    pushed = rods(2).replace(effects=[pc.effects.User(push)])
    with pytest.raises(Enough) as raised:
        pc.lyapunov(pushed, (0, 3), [-2.0, -1.0])
    so_far: pc.LyapunovExponents = raised.value.exponents  # type: ignore[attr-defined]
    assert so_far.status == "callback_error"
    assert 1.5 < so_far.t[-1] <= 2.0


def test_what_was_found_before_an_exception_is_not_lost() -> None:
    def stop(fraction: float) -> None:
        if fraction > 0.05:
            raise Enough

    times = np.linspace(0, 3000, 30001)
    with pytest.raises(Enough) as raised:
        pc.lyapunov(rods(2), **LONG, t_eval=times, progress=stop)
    so_far: pc.LyapunovExponents = raised.value.exponents  # type: ignore[attr-defined]
    assert so_far.status == "callback_error"
    assert 100 < len(so_far.t) == len(so_far.growth) < len(times)
    assert so_far.largest > 0.3


def test_exponents_of_a_part_of_the_span_say_so() -> None:
    with pytest.warns(pc.PendcoreWarning, match="not those of the whole span: the cap on steps"):
        limited = pc.lyapunov(rods(2), **LONG, max_steps=1000, transient=1)
    assert (limited.status, limited.success) == ("max_steps", False)
    assert limited.stats.accepted + limited.stats.rejected == 1000
    assert f"from t = 1 to {limited.t[-1]:.6g} s" in str(limited)
    assert str(limited).endswith(f"; max_steps: {limited.message}")


def test_printed_they_say_how_fast_errors_grow_and_how_sure_that_is() -> None:
    found = pc.lyapunov(rods(2), (0, 50), [-2.0, -1.0])
    grows = f"e in {1 / found.largest:.3g} s, tenfold in {np.log(10) / found.largest:.3g} s"
    assert str(found).endswith(f"1/s, from t = 0 to 50 s: an error grows by {grows}")
    regular = pc.lyapunov(rods(2), (0, 100), [np.pi / 4, np.pi / 3])
    assert str(regular).endswith("; the run is too short to tell this from growth that slows down")
    still = pc.lyapunov(rods(1, E.Lock(joint=1)), (0, 1), 0.2)
    assert str(still) == "no Lyapunov exponents: nothing of the scene can move"


def test_the_finite_time_exponents_are_drawn() -> None:
    found = pc.lyapunov(rods(2), (0, 5), [-2.0, -1.0])
    assert len(found.plot()) == 4
    plt.close("all")
    lines = found.plot(Figure().subplots())
    assert len(lines) == 4
    assert lines[0].get_ydata()[-1] == found.finite_time[-1, 0]
    assert lines[0].axes.get_ylabel() == "Lyapunov exponents (1/s)"
    assert len({line.get_color() for line in lines}) == 4
    names = [text.get_text() for text in lines[0].axes.get_legend().get_texts()]
    assert names == [rf"$\lambda_{{{i}}}$" for i in (1, 2, 3, 4)]
