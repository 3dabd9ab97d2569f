"""The defect is the torques that would make a computed curve an exact motion."""

from __future__ import annotations

from typing import Any

import mpmath  # type: ignore[import-untyped]
import numpy as np
import pendcore as pc
import pytest
from pendcore import _core
from pendcore import effects as fx

METHODS = {method["name"]: method for method in _core.methods()}
BOOK = pc.Scene.textbook()
START = [np.pi / 4, np.pi / 3]
UNEVEN = pc.Scene(
    links=[
        pc.Link(mass=1.3, length=0.8, center=0.3, inertia=0.11),
        pc.Link(mass=0.4, length=1.1),
        pc.Link(mass=2.1, length=0.5, center=0.45, inertia=0.04),
    ],
    gravity=9.81,
)


def run(scene: pc.Scene, method: str, t_end: float = 1.0, **options: Any) -> pc.Solution:
    n = len(scene.links)
    if not METHODS[method]["error_order"]:
        options = {"step": 0.01}
    q0, qd0 = [0.4, -0.9, 1.3][:n], [2.0, -1.0, 3.0][:n]
    return pc.simulate(scene, q0=q0, qd0=qd0, t_span=(0, t_end), method=method, **options)


def joint_couples(scene: pc.Scene, q: list[Any], qd: list[Any], qdd: list[Any]) -> list[Any]:
    """Return the couple of each joint on the link beyond it that a motion takes, N m.

    It carries all that lies beyond it: about the joint, where it is at that moment,

        tau_j = sum over i >= j of  I_i alpha_i + (C_i - P_j) x m_i (a_Ci - g).

    Vectors are complex numbers x + i y: a x b = Im(conj(a) b).
    """
    joint = moving = mpmath.mpc(0)  # where the joint is, and its acceleration
    found = []
    for link, angle, rate, acceleration in zip(scene.links, q, qd, qdd, strict=True):
        along = mpmath.expj(angle)
        turning = along * (1j * acceleration - rate**2)  # of a point at unit distance
        pull = link.mass * (moving + link.center * turning - 1j * mpmath.mpf(scene.gravity))
        found.append((joint, joint + link.center * along, pull, link.inertia * acceleration))
        joint += link.length * along
        moving += link.length * turning
    couples = []
    for j, (pivot, *_) in enumerate(found):
        beyond = [spin + (mpmath.conj(c - pivot) * pull).imag for _, c, pull, spin in found[j:]]
        couples.append(sum(beyond))
    return couples


def exact_couples(sol: pc.Solution) -> np.ndarray:
    """Return each step's largest couples on the same curve and grid, in forty digits."""
    state, n = sol._run.__getstate__(), len(sol.scene.links)
    steps = len(state["dense_h"])
    rows = np.asarray(state["dense_coefficients"]).reshape(steps, -1, 2 * n)
    grid = 4 * rows.shape[1]
    largest = np.zeros((steps, n))

    def value(coefficients: list[Any], theta: Any) -> Any:
        return mpmath.polyval(coefficients[::-1], theta)

    with mpmath.workdps(40):
        angles = [mpmath.mpf(x) for x in rows[0, 0, :n]]
        for step, h in enumerate(map(mpmath.mpf, state["dense_h"])):
            rates = [[mpmath.mpf(c) for c in rows[step, :, n + i]] for i in range(n)]
            slopes = [[p * c for p, c in enumerate(w)][1:] for w in rates]
            sums = [[0, *(c / (p + 1) for p, c in enumerate(w))] for w in rates]
            for k in range(grid):
                theta = mpmath.mpf(2 * k + 1) / (2 * grid)
                q = [a + h * value(s, theta) for a, s in zip(angles, sums, strict=True)]
                qd = [value(w, theta) for w in rates]
                qdd = [value(s, theta) / h for s in slopes]
                couples = joint_couples(sol.scene, q, qd, qdd)
                largest[step] = np.maximum(largest[step], [float(abs(c)) for c in couples])
            angles = [a + h * value(s, 1) for a, s in zip(angles, sums, strict=True)]
    return largest


@pytest.mark.few_cases
@pytest.mark.parametrize("scene", [BOOK, UNEVEN], ids=["two", "three"])
@pytest.mark.parametrize("method", METHODS)
def test_it_is_what_the_equations_of_each_link_say_in_forty_digits(
    method: str, scene: pc.Scene
) -> None:
    sol = run(scene, method, 0.25, rtol=1e-6, atol=1e-8)
    found = sol.defect()
    # the slope of a rate of some rad/s, in steps of h, has a rounding error of 1e-15/h
    rounding = 1e-12 / np.diff(sol.t).min()
    np.testing.assert_allclose(found.torque, exact_couples(sol), rtol=1e-7, atol=rounding)
    assert found.largest > 100 * rounding


@pytest.mark.parametrize("method", METHODS)
def test_it_falls_at_the_order_of_the_interpolant(method: str) -> None:
    is_series = method.startswith("taylor")  # a series chooses its order by the tolerances
    how = {"rtol": 1e-3, "atol": 1e-3} if is_series else {"rtol": 1e-13, "atol": 1e-16}
    counts = np.array([6, 8, 10, 12, 14, 16, 20, 24] if is_series else [20, 28, 40])
    found = [
        pc.simulate(BOOK, (0, 0.5), START, method=method, step=0.5 / n, **how).defect()
        for n in counts
    ]
    slope = -np.polyfit(np.log(counts), np.log([one.largest for one in found]), 1)[0]
    assert found[0].order == (10 if is_series else METHODS[method]["interpolant_order"])
    assert slope == pytest.approx(found[0].order, abs=0.35)
    assert found[-1].largest > 1e-11  # well above rounding


@pytest.mark.parametrize("method", [name for name, m in METHODS.items() if m["kind"] == "pair"])
def test_the_defect_of_a_pair_that_changed_over_is_that_of_its_second_method(method: str) -> None:
    """Before the change a run has the defect of the first method; resumed past it, the second's."""
    stiff = BOOK.replace(effects=[fx.ViscousJoint(joint=2, damping=1e6 / 3)])
    first, second = method.split("-")
    before, short = (
        pc.simulate(stiff, (0, 1e-5), [0.8, 1.0], 0.1, method=one) for one in (method, first)
    )
    alone = short.defect()
    assert not before.stats.stiff
    assert (before.defect().order, before.defect().is_bound) == (alone.order, alone.is_bound)
    after = before.resume(1.0)
    assert after.stats.stiff
    assert after.success
    found = after.defect()
    assert found.order == METHODS[second]["interpolant_order"]
    assert found.is_bound
    assert f"with at most {found.largest:.1e} N m" in str(found)


@pytest.mark.parametrize("effects", [[], [fx.Motor(joint=1, constant=2.0)]], ids=["free", "pushed"])
def test_a_polynomial_motion_has_none_but_rounding(effects: list[Any]) -> None:
    rod = pc.Scene(links=[pc.Link(mass=3, length=1)], gravity=0.0, effects=effects)
    found = pc.simulate(rod, q0=0.3, qd0=1.5, t_span=(0, 2), method="dopri5").defect()
    assert found.largest < 1e-13
    assert found.apart.max() < 1e-14
    assert found.share == (0.0 if found.largest == 0 else np.inf)


def test_tighter_tolerances_mean_less_torque_and_a_share_of_the_weight() -> None:
    loose, tight = (run(BOOK, "dopri5", rtol=rtol, atol=rtol).defect() for rtol in (1e-5, 1e-9))
    assert tight.largest < 1e-2 * loose.largest
    assert loose.weight == pytest.approx(2 * 2 * BOOK.gravity)
    assert loose.share == loose.largest / loose.weight
    assert loose.is_bound
    assert loose.torque[:, loose.joint - 1].max() == loose.largest
    assert "at most" in str(loose)
    assert f"{loose.largest:.1e} N m" in str(loose)


def test_what_holds_a_joint_takes_any_torque() -> None:
    """Where a joint is stuck, at a stop or locked, only the other joints can lack torques."""
    held = [fx.DryJointFriction(joint=1, coulomb=30.0), fx.JointStop(2, range=(-0.5, 0.9))]
    stick = BOOK.replace(effects=held)
    sol = pc.simulate(stick, (0, 3), [0.4, 0.8], [0.0, 2.0], rtol=1e-10, atol=1e-12)
    found = sol.defect()
    assert found.largest < 1e-5
    assert (np.diff(sol(found.t + 1e-9).T[:, 2:], axis=1) == 0).any()


def test_a_run_that_an_event_ends_counts_as_far_as_it_went() -> None:
    """The last polynomial continues past the end; that part does not belong to the curve."""
    how = {"method": "dop853", "step": 0.1}
    whole = pc.simulate(BOOK, (0, 1), START, **how)
    here = pc.events.LinkAngle(2, float(whole(0.501)[1]), terminal=True)
    sol = pc.simulate(BOOK, (0, 1), START, **how, events=[here])
    cut = sol.defect().torque
    assert sol.t[-1] == pytest.approx(0.501)
    np.testing.assert_allclose(cut[:5], whole.defect().torque[:5], rtol=1e-9)
    assert cut[5].max() < 0.5 * whole.defect().torque[5].max()


def test_many_steps_are_added_up_as_a_few_are(monkeypatch: pytest.MonkeyPatch) -> None:
    sol = run(UNEVEN, "dopri5")
    at_once = sol.defect()
    monkeypatch.setattr("pendcore._accuracy.defect.STEPS_AT_ONCE", 7)
    fractions: list[float] = []
    in_parts = sol.defect(progress=fractions.append)
    assert np.array_equal(at_once.torque, in_parts.torque)
    assert np.array_equal(at_once.apart, in_parts.apart)
    assert fractions[-1] == 1.0
    assert len(fractions) == -(-len(at_once.t) // 7)


@pytest.mark.parametrize("store", ["end", "steps"])
def test_without_dense_output_it_says_so(store: str) -> None:
    with pytest.raises(ValueError, match="defect: this solution keeps no dense output"):
        pc.simulate(BOOK, (0, 1), START, store=store).defect()


def test_backward_is_the_mirror_of_forward() -> None:
    forward, backward = (pc.simulate(BOOK, (0, end), START).defect() for end in (1, -1))
    np.testing.assert_allclose(backward.torque, forward.torque, rtol=1e-6, atol=1e-12)
