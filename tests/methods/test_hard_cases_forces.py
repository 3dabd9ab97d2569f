"""Forces that go wrong, are too large, or are many: blow-ups, stiff joints, heavy payloads."""

from __future__ import annotations

from typing import Any

import mpmath  # type: ignore[import-untyped]
import numpy as np
import pendcore as pc
import pytest
from pendcore import _core
from pendcore import effects as fx
from unit_rods import rod

BOOK = pc.Scene.textbook()


@pytest.mark.filterwarnings("ignore::pendcore.PendcoreWarning")  # coefficient < 0; the end
@pytest.mark.parametrize("rate", [1.0, -3.0, 1e-3])
def test_a_blow_up_ends_at_its_pole(rate: float) -> None:
    """W' = w^3: the pole is at 1/(2 w_0^2)."""
    scene = rod(fx.ViscousJoint(joint=1, damping=0, damping3=-1.0))
    pole = 1 / (2 * rate**2)
    sol = pc.simulate(scene, q0=0, qd0=rate, t_span=(0, 3 * pole), rtol=1e-12, atol=1e-14)
    assert sol.status in {"step_too_small", "non_finite"}
    assert not sol.success
    assert np.isfinite(sol.y).all()
    assert sol.t[-1] == pytest.approx(pole, rel=1e-10)
    before = np.linspace(0, 0.999 * pole, 20)
    exact = rate / np.sqrt(1 - 2 * rate**2 * before)
    np.testing.assert_allclose(sol(before)[1], exact, rtol=1e-8)


@pytest.mark.parametrize("at", [0.5, 1.7])
def test_what_is_no_number_beyond_a_time_or_an_angle_ends_there(at: float) -> None:
    """A rod that turns freely at 1 rad/s, under a couple 0 sqrt(at - q) or 0 sqrt(at - t)."""

    def by_angle(t: float, q: Any, qd: Any) -> Any:
        with np.errstate(invalid="ignore"):
            return 0 * np.sqrt(at - q)

    def by_time(t: float, q: Any, qd: Any) -> Any:
        with np.errstate(invalid="ignore"):
            return 0 * np.sqrt(np.array([at - t]))

    for law in (by_angle, by_time):
        sol = pc.simulate(rod(fx.User(law)), q0=0, qd0=1, t_span=(0, 5), on_failure="ignore")
        assert sol.status == "non_finite"
        np.testing.assert_allclose(sol.y[:, -1], [sol.t[-1], 1], rtol=1e-9)
        assert sol.t[-1] == pytest.approx(at, abs=1e-6)
        assert sol.t[-1] <= at + np.spacing(at)


@pytest.mark.parametrize("ratio", [1e3, 1e6])
def test_a_payload_of_a_million_links_swings_as_a_pendulum_on_a_string(ratio: float) -> None:
    """The slow mode of two rods and what hangs below them, from the linearised equations.

    The fast one is sqrt(3 ratio g/L); for ratio -> inf the slow one is sqrt(g/2L).
    """
    scene = BOOK.replace(effects=[fx.Payload(mass=ratio)])
    g = BOOK.gravity
    a = np.array([1.5 + ratio, 0.5 + ratio])
    m = np.array([[4 / 3 + ratio, 0.5 + ratio], [0.5 + ratio, 1 / 3 + ratio]])
    squares, modes = np.linalg.eig(np.linalg.solve(m, np.diag(a) * g))
    slow, fast = np.argsort(squares)
    assert squares[fast] == pytest.approx(3 * ratio * g, rel=0.02)
    assert squares[slow] == pytest.approx(g / 2, rel=1 / ratio)
    shape = modes[:, slow] / modes[0, slow]
    amplitude = 1e-3
    period = 2 * np.pi / np.sqrt(squares[slow])
    start = np.pi / 2 + amplitude * shape
    sol = pc.simulate(scene, q0=start, t_span=(0, period), rtol=1e-10, atol=1e-13, store="end")
    assert sol.success
    # to the second order of the amplitude
    np.testing.assert_allclose(sol.q[-1], start, atol=amplitude**2)


# Stiff ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("damping", [1e3, 1e5, 1e7])
def test_a_stiff_damper_is_flagged_in_bounded_work(damping: float) -> None:
    """Joint 2 damped by up to 1e8 times a second: flagged within 10,000 steps."""
    scene = BOOK.replace(effects=[fx.ViscousJoint(joint=2, damping=damping)])
    start = [np.pi / 4, np.pi / 3]
    how = {"max_steps": 10_000, "store": "steps", "on_failure": "ignore"}
    sol = pc.simulate(scene, q0=start, t_span=(0, 5), method="dopri5", **how)
    assert sol.status == "max_steps"
    assert sol.stats.stiff
    # joint 2 has hardly moved by then: phid decays within 1e-2/damping s
    assert np.abs(np.diff(sol.q[-1]) - np.pi / 12).max() < 1e-2
    assert np.isfinite(sol.y).all()


@pytest.mark.parametrize(
    "effect",
    [
        fx.Motor(joint=2, pd=fx.PD(kp=1e6, kd=1e3, reference=np.pi / 12)),
        fx.TorsionalSpring(joint=2, stiffness=1e8, rest_angle=np.pi / 12),
    ],
    ids=["servo", "spring"],
)
def test_a_stiff_servo_ends_at_the_limit_of_steps_or_gets_there(effect: Any) -> None:
    """The rods move as one bent rod, but for what the servo or spring yields, load/stiffness."""
    start = [np.pi / 4, np.pi / 3]
    stiff = BOOK.replace(effects=[effect])
    sol = pc.simulate(
        stiff, q0=start, t_span=(0, 0.5), max_steps=400_000, store="steps", on_failure="ignore"
    )
    assert sol.status in {"finished", "max_steps"}
    bent = pc.simulate(BOOK.replace(effects=[fx.Lock(joint=2)]), q0=start, t_span=(0, 0.5))
    give = 50 / getattr(effect, "stiffness", 1e6) if effect.kind != "motor" else 50 / 1e6
    np.testing.assert_allclose(sol.q[-1], bent(sol.t[-1])[:2], atol=20 * give)


# Many -------------------------------------------------------------------------------------------


def test_a_chain_of_a_thousand_links_keeps_its_energy() -> None:
    """It hangs in the shape of its slowest mode, J_1(2 w sqrt(x/g))/sqrt(x) from the free end."""
    n, g, length = 1000, 9.81, 10.0
    links = [pc.Link(mass=1e-3, length=length / n)] * n
    scene = pc.Scene(links=links, gravity=g)
    w = float(mpmath.besseljzero(0, 1)) / 2 * np.sqrt(g / length)
    below = length * (1 - (np.arange(n) + 0.5) / n)
    slope = [float(mpmath.besselj(1, 2 * w * np.sqrt(x / g)) / np.sqrt(x)) for x in below]
    shape = np.array(slope) / max(slope)
    amplitude, t_end = 1e-3, 0.3
    sol = pc.simulate(scene, q0=np.pi / 2 + amplitude * shape, t_span=(0, t_end), rtol=1e-9)
    assert sol.success
    energy = sol.energy().total
    assert np.ptp(energy) < 1e-14 * np.abs(energy).max()  # rounding
    # what a mode of links has that one of a chain has not starts at the free end, and goes up
    moved = (sol.q[-1] - np.pi / 2) / amplitude
    assert np.cos(w * t_end) < 0.94
    np.testing.assert_allclose(moved[: n // 2], shape[: n // 2] * np.cos(w * t_end), atol=1e-7)
    np.testing.assert_allclose(moved, shape * np.cos(w * t_end), atol=3e-4)


@pytest.mark.parametrize("method", [method["name"] for method in _core.methods()])
@pytest.mark.parametrize("links", [1, 2, 3])
@pytest.mark.parametrize("rtol", [1e-9, 1.0, 1e30])
def test_what_a_fixed_step_keeps_is_finite_between_its_ends_as_well(
    method: str, links: int, rtol: float
) -> None:
    """Rods under a damper far too strong for the step: the motion grows until it overflows."""
    rng = np.random.default_rng(8)
    ends = set()
    for damping in 10 ** rng.uniform(0.5, 3, 60):
        scene = pc.Scene(
            links=[pc.Link(mass=1, length=0.5)] * links,
            effects=[fx.ViscousJoint(joint=1, damping=damping)],
        )
        sol = pc.simulate(
            scene, q0=0.4, qd0=1.0, t_span=(0, 30), method=method, step=0.3, rtol=rtol, atol=rtol,
            t_eval=np.linspace(0, 30, 301), on_failure="ignore",
        )  # fmt: skip
        ends.add(sol.status)
        assert np.isfinite(sol.y).all(), (sol.status, sol.message)
    if method != "radau5":
        assert "non_finite" in ends
