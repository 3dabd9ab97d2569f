"""An explanation is right where the answer is known, and says what it leaves out."""

from __future__ import annotations

import json
from math import pi, sqrt
from pathlib import Path

import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx
from pendcore.explanation.constraints import constraint_jacobian

G = 9.807
ROD = pc.Link(mass=1.0, length=1.0)
TEXTBOOK = pc.Scene.textbook()


def rods(n, *effects, gravity=G):
    return pc.Scene(links=[ROD] * n, gravity=gravity, effects=effects)


def named(scene, name, **asked):
    (found,) = [e for e in scene.explain(**asked).equilibria if e.name == name]
    return found


BOOKS = [sqrt(G * (3 + sign * 6 / sqrt(7))) for sign in (-1, 1)]


def damped_rod(b, sign):
    """Roots of J x^2 + b x = sign m g L / 2, without cancellation, the slow one first."""
    inertia, torque = 1 / 3, sign * G / 2
    slow = 2 * torque / (b + sqrt(b * b + 4 * inertia * torque))
    return [slow, -torque / (inertia * slow)]


# For each the scene, the name and the stability of an equilibrium, its angular frequencies and the
# rates of what does not oscillate.
MODES = {
    "textbook": (TEXTBOOK, "hanging", "stable", BOOKS, []),
    "textbook, upright": (
        TEXTBOOK, "upright", "unstable", [], [-BOOKS[1], -BOOKS[0], *BOOKS]
    ),
    "locked hinge": (rods(2, fx.Lock(2, angle=0.0)), "hanging", "stable", [sqrt(3 * G / 4)], []),
    "damped": (rods(1, fx.ViscousJoint(1, 0.3)), "hanging", "stable", [sqrt(1.5 * G)], []),
} | {
    f"{name} in honey of {b:g}": (
        rods(1, fx.ViscousJoint(1, b)), name, stability, [], sorted(damped_rod(b, sign))
    )
    for b in (5.0, 10.0, 1e6, 1e12)
    for name, stability, sign in (("upright", "unstable", 1), ("hanging", "stable", -1))
}  # fmt: skip


@pytest.mark.parametrize("case", MODES)
def test_natural_frequencies_rates_and_stability_are_the_exact_ones(case):
    scene, name, stability, frequencies, rates = MODES[case]
    found = named(scene, name)
    assert found.stability == stability
    oscillating = [mode for mode in found.modes if mode.angular_frequency > 0]
    angular = np.array([mode.angular_frequency for mode in oscillating])
    np.testing.assert_allclose(angular, frequencies, rtol=1e-8)
    np.testing.assert_allclose([mode.frequency for mode in oscillating], angular / (2 * pi))
    still = [mode for mode in found.modes if mode.angular_frequency == 0]
    np.testing.assert_allclose(sorted(mode.rate for mode in still), rates, rtol=1e-8)
    assert len(found.modes) == len(frequencies) + len(rates)
    if name == "upright":
        assert all(mode.damping_ratio is None for mode in still)
    critical = 2 * sqrt(1 / 3 * G / 2)
    ratio = 0.3 / critical if case == "damped" else 0.0
    for mode in oscillating:
        assert mode.damping_ratio == pytest.approx(ratio, rel=1e-8, abs=1e-9)


def test_a_hanging_chains_slowest_mode_is_that_of_the_bessel_function():
    slowest = named(rods(20), "hanging").modes[0].angular_frequency
    assert slowest == pytest.approx(1.2024128 * sqrt(G / 20), rel=0.05 / 20**2)


WINDING = fx.Motor(1, table=fx.Table([0, 1, 2], [0, 2, 0]))
# For each the scene of a rod, the time, and the torque that acts at its angle.
BALANCED = {
    "spring": (rods(1, fx.TorsionalSpring(1, 20.0, rest_angle=0.0)), 0.0, lambda q: -20 * q),
    "motor": (rods(1, fx.Motor(1, constant=-2.0)), 0.0, lambda q: -2.0),
    "table, half way": (rods(1, WINDING), 0.5, lambda q: 1.0),
    "table, at its top": (rods(1, WINDING), 1.0, lambda q: 2.0),
}


@pytest.mark.parametrize("case", BALANCED)
def test_an_equilibrium_is_found_where_a_torque_and_the_weight_balance(case):
    scene, t, torque = BALANCED[case]
    found = named(scene, "found from hanging", t=t)
    (q,) = found.q
    assert G / 2 * np.cos(q) == pytest.approx(-torque(q), rel=1e-7)
    stiffness = 20 if case == "spring" else 0
    expected = sqrt(3 * (stiffness + G / 2 * np.sin(q)))
    assert found.modes[0].angular_frequency == pytest.approx(expected, rel=1e-7)


def test_a_strong_motor_leaves_no_equilibrium():
    strong = rods(1, fx.Motor(1, constant=50.0)).explain()
    assert strong.equilibria == ()
    assert strong.stiffest_rate is strong.first_step is None
    assert "no equilibrium was found from hanging at t = 0 s" in strong.remarks
    assert "none was found" in repr(strong)
    json.dumps(strong.to_dict(), allow_nan=False)


def test_the_start_is_one_more_place_to_look_from():
    level = rods(2).explain(q=[pi / 2, -pi / 2])
    assert [found.name for found in level.equilibria] == ["hanging", "upright", "start"]
    assert level.equilibria[0].q == (pi / 2, pi / 2)
    assert level.equilibria[2].stability == "unstable"
    near = rods(2).explain(q=[pi / 2 + 0.1, pi / 2]).equilibria
    assert [found.name for found in near] == ["hanging", "upright"]  # it leads to one of them


def test_without_gravity_nothing_has_a_rate_and_no_pose_is_stable_or_unstable():
    free = rods(2, gravity=0.0).explain()
    assert (free.stiffest_rate, free.first_step) == (0.0, None)
    assert "stiffest rate   0 1/s, about the equilibria" in repr(free)
    assert "first step      nothing is known here to choose it by" in repr(free)
    equilibria = rods(1, gravity=0.0).explain(q=[0.3]).equilibria
    assert {x.stability for x in equilibria} == {"indifferent"}
    damped = repr(rods(2, fx.ViscousJoint(1, 1.0), gravity=0.0).explain())
    assert "hanging, indifferent: q" in damped
    assert "hanging, stable: q" in repr(rods(1, fx.Lock(1), gravity=0.0).explain())  # all is held


def test_a_driven_pivot_that_falls_takes_the_weight_away():
    falling = fx.DrivenPivot(y=fx.Sinusoid(amplitude=-G / 4, angular_frequency=2.0))
    scene = rods(1, falling)  # at t = pi/4 it accelerates downward with g
    assert scene.explain(t=0.0).stiffest_rate == pytest.approx(sqrt(1.5 * G), rel=1e-7)
    assert scene.explain(t=pi / 4).stiffest_rate < 1e-3


AN_INSTANT = "those of the instant t = 0.5 s"
OUTSIDE = "s is outside the {} of effect 2 ({}), 0 to 2 s: no equilibria are computed there"
TABLE = fx.Motor(1, table=fx.Table([0, 2], [0, 1]))
SPLINE = fx.DrivenPivot(spline=fx.Spline([0, 2], [0, 1], [0, 0]))
# For each the scene, the time, and what its only remark says; the first four look at an instant.
REMARKS = {
    "shaken": (rods(2, fx.DrivenPivot(y=fx.Sinusoid(0.01, 350.0))), 0.5, AN_INSTANT),
    "sinusoid": (rods(2, fx.Motor(1, sinusoid=fx.Sinusoid(0.1, 2.0))), 0.5, AN_INSTANT),
    "table": (rods(2, fx.Motor(1, table=fx.Table([0, 1], [0, 1]))), 0.5, AN_INSTANT),
    "function": (rods(2, fx.User(lambda t, q, qd: np.sin(t) * np.ones(2))), 0.5, AN_INSTANT),
    "controller": (rods(2, fx.Motor(1, pd=fx.PD(40, 2, 1.5))), 0.5, None),
    "friction": (rods(2, fx.DryJointFriction(1, 5.0)), 0, "dry joint friction is left out"),
    # It touches where the scene hangs, and upright lies beyond it.
    "stop": (rods(2, fx.JointStop(1, range=(0.0, pi / 2))), 0, "joint stop is left out"),
    "locks": (rods(3, fx.Lock(1), fx.Lock(3)), 0, "joints 1, 3: a lock takes its angle from"),
    "lock, given": (rods(2, fx.Lock(2, angle=0.0)), 0, None),
    "before": (rods(1, fx.Payload(0.1), TABLE), -0.1, OUTSIDE.format("table", "motor")),
    "after": (rods(1, fx.Payload(0.1), SPLINE), 5.0, OUTSIDE.format("spline", "driven_pivot")),
    "within": (rods(2, fx.Payload(0.1), TABLE), 0.5, AN_INSTANT),
}


@pytest.mark.parametrize("case", REMARKS)
def test_what_is_left_out_and_for_when_and_where_it_holds_is_told(case):
    scene, t, words = REMARKS[case]
    told = scene.explain(t=t)
    assert len(told.remarks) == (words is not None)
    assert words is None or words in told.remarks[0]
    assert ("Remarks" in repr(told)) == (words is not None)
    held = f"Equilibria, with all drives held as they are at t = {t:g} s"
    assert (held in repr(told).splitlines()) == (words == AN_INSTANT)
    if case in ("friction", "stop"):
        assert told.equilibria == TEXTBOOK.explain().equilibria
    if case in ("before", "after"):
        assert (told.equilibria, told.constraint_rank) == ((), 2)


LOCKS = {
    "none": ([], None, {}),
    "given": ([fx.Lock(2, angle=0.5)], None, {1: 0.5}),
    "given, with a start": ([fx.Lock(2, angle=0.5)], [1.0, 1.5, 1.7], {1: 0.5}),
    "of the start": ([fx.Lock(2)], [1.0, 1.5, 1.7], {1: 0.5}),
    "of the start, first": ([fx.Lock(1)], [1.0, 1.5, 1.7], {0: 1.0}),
    "both kinds": ([fx.Lock(1), fx.Lock(3, angle=-0.2)], [1.0, 1.5, 1.7], {0: 1.0, 2: -0.2}),
    "all": ([fx.Lock(j, angle=0.5) for j in (1, 2, 3)], None, {0: 0.5, 1: 0.5, 2: 0.5}),
}


@pytest.mark.parametrize("case", LOCKS)
def test_equilibria_have_their_locked_joints_where_they_are_locked(case):
    locks, start, joints = LOCKS[case]
    told = rods(3, *locks).explain(q=start)
    freedom = 3 - len(locks)
    assert told.degrees_of_freedom == told.mobility.degrees_of_freedom == freedom
    assert told.constraint_rank == 9 - freedom
    assert told.equilibria
    for found in told.equilibria:
        phi = np.diff(found.q, prepend=0.0)
        for joint, angle in joints.items():
            assert phi[joint] == pytest.approx(angle)
        straight = np.abs(np.sin(phi[1:])).max(initial=0.0) < 1e-6
        assert straight or found.name not in ("hanging", "upright")
    assert told.remarks == ()


def test_many_links_are_explained_without_their_matrices():
    told = rods(100, fx.ViscousJoint(7, 0.1)).explain()
    assert told.equilibria == ()
    assert told.constraint_rank is told.degrees_of_freedom is None
    assert told.mobility.degrees_of_freedom == 100
    assert any(remark.startswith("more than 60 links") for remark in told.remarks)
    assert len(rods(60).explain().equilibria) == 2


def test_costs_are_of_the_links_of_each_effect_and_of_all():
    scene = rods(2, fx.ViscousJoint(1, 0.1), fx.Payload(0.5), fx.User(lambda t, q, qd: 0 * q))
    costs = scene.explain().costs
    effects = ["effect 1 (viscous_joint)", "effect 2 (payload)", "effect 3 (user)"]
    assert [cost.what for cost in costs] == ["links", *effects, "all"]
    assert costs[1].operations > costs[2].operations == 0
    assert costs[3].operations is None
    assert costs[0].nanoseconds > 0  # those of an effect are a difference of times
    assert costs[4].nanoseconds > 100  # a call of Python alone takes longer


STARTED = {
    "textbook": TEXTBOOK,
    "a stiff spring": rods(3, fx.TorsionalSpring(2, 300.0)),
    "damping": rods(1, fx.ViscousJoint(1, 1.0)),
    "strong damping": rods(2, fx.ViscousJoint(2, 50.0)),
    "ten links": rods(10),
    "controllers": rods(2, fx.Motor(1, pd=fx.PD(400, 20, 1.0)), fx.Motor(2, pd=fx.PD(100, 5, 0.3))),
    "wind": rods(2, fx.RodDrag(1, 1.2, 0.05, wind=(5.0, 0.0))),
    "a shaken pivot": rods(2, fx.DrivenPivot(y=fx.Sinusoid(0.05, 40.0))),
    "a light link": pc.Scene(links=[ROD, pc.Link(mass=1e-3, length=0.05)]),
}


@pytest.mark.parametrize("scene", STARTED.values(), ids=STARTED)
def test_the_first_step_is_safe_at_rest_near_an_equilibrium(scene):
    """It is accepted at the default tolerances; dopri5 rejects one that is ten times as long."""
    told, rng = scene.explain(), np.random.default_rng(7)

    def rejected(q0, method, step):
        how = {"method": method, "first_step": step}
        return pc.simulate(scene, q0=q0, t_span=(0, step), **how).stats.rejected

    for found in told.equilibria:
        for off in rng.uniform(-0.5, 0.5, (20, len(scene.links))):
            for method in ("auto", "dopri5"):
                assert rejected(found.q + off, method, told.first_step) == 0
    assert rejected(found.q + off, "dopri5", 10 * told.first_step)


def test_the_fastest_of_nature_and_drives_chooses_the_first_step():
    slow, fast = (rods(2, fx.DrivenPivot(y=fx.Sinusoid(1e-3, w))).explain() for w in (1.0, 200.0))
    assert slow.first_step == pytest.approx(2 * pi / 500 / slow.stiffest_rate)
    assert fast.first_step == pytest.approx(2 * pi / 500 / 200.0)
    assert (slow.fastest_drive, fast.fastest_drive) == (1.0, 200.0)
    assert "s, 1/500 of the fastest period: safe for a start at" in repr(slow)
    # The natural rates of so long a chain are not known, and may be faster than the drive.
    long = rods(61, fx.DrivenPivot(y=fx.Sinusoid(1e-3, 1.0))).explain()
    assert (long.fastest_drive, long.first_step) == (1.0, None)


def test_what_is_absent_is_told_and_what_is_present_is_not():
    bare = {absence.kind for absence in TEXTBOOK.explain().not_simulated}
    assert bare > {"viscous_joint", "motor", "bending", "third_dimension"}
    assert not bare & {"user", "compiled_user"}
    damped = rods(2, fx.ViscousJoint(1, 0.1)).explain().not_simulated
    assert {absence.kind for absence in damped} == bare - {"viscous_joint"}
    for absence in damped:
        assert absence.available == (absence.kind in fx.kinds())


def test_it_prints_as_a_table_of_plain_numbers_and_fits_into_json():
    told = rods(2, fx.ViscousJoint(1, 0.1)).explain()
    for words in (
        "2 links, gravity 9.807 m/s^2, explained at t = 0 s\n",
        "M = 3 n - 2 c5 - c4 = 3*2 - 2*2 - 0 = 2\n",
        "3 n - rank = 6 - 4 = 2\n",
        "hanging, stable: q = (1.5708, 1.5708) rad\n",
        "upright, unstable: q = (-1.5708, -1.5708) rad\n",
        "  ViscousJoint(joint=1, damping=0.1)",
        "  effects that the scene could have: dry joint friction, ",
    ):
        assert words in repr(told)
    again = json.loads(json.dumps(told.to_dict(), allow_nan=False))
    assert again == told.to_dict()
    assert (again["degrees_of_freedom"], again["first_step"]) == (2, told.first_step)
    assert again["equilibria"][0]["modes"][0]["damping_ratio"] > 0
    for scene in (rods(2), rods(1, fx.ViscousJoint(1, 5.0)), rods(2, fx.Lock(1, angle=-0.0))):
        shown = repr(scene.explain().equilibria)
        assert not any(words in shown for words in ("np.float64", "-0.0,", "-0.0)"))


def test_the_command_explains_a_case_at_its_start_and_warns_as_a_run_would(pendcore):
    scene = rods(2, fx.Motor(1, table=fx.Table([1, 2], [0, 2])))
    Path("swing.toml").write_text(pc.Case(scene=scene, q0=[1, 45], t_span=(1, 5)).to_toml())
    status, out, err = pendcore("explain swing.toml")
    assert status == 0
    assert out.startswith("2 links, gravity 9.807 m/s^2, explained at t = 1 s\n")
    told = json.loads(pendcore("explain swing.toml --json").out)
    assert told["t"] == 1.0
    assert told["not_simulated"] == scene.explain(t=1).to_dict()["not_simulated"]
    assert [*Path().iterdir()] == [Path("swing.toml")]
    warned = [line for line in pendcore("run swing.toml").err.splitlines() if "warning" in line]
    assert err.splitlines() == warned
    assert "effect 1 (motor): its table goes from 1.0 to 2.0 s" in err


WILD = {
    "a length below all measure": (pc.Link(mass=1.0, length=1e-310, inertia=1.0), []),
    "damping beyond all measure": (ROD, [fx.ViscousJoint(1, 1e308)]),
    "gravity beyond all measure": (pc.Link(mass=1e-20, length=1e154), [fx.Motor(1, 1e300)]),
    "a link of nothing": (
        pc.Link(mass=2.7e271, length=3.1e-272, center=2.7e-272, inertia=3.5e-273),
        [fx.ViscousJoint(1, 2e-308, 1e200)],
    ),
}


@pytest.mark.parametrize("case", WILD)
@pytest.mark.filterwarnings("ignore::pendcore.PendcoreWarning")
def test_what_overflows_is_explained_as_well(case):
    """No warning of NumPy's, no error of its algebra: what is no number is left out."""
    link, effects = WILD[case]
    told = pc.Scene(links=[link], effects=effects).explain()
    assert told.mobility.degrees_of_freedom == 1
    assert repr(told)


def test_the_constraint_jacobian_has_no_row_that_a_motion_violates():
    """Any rates of the joints make velocities of the links that all constraints allow."""
    scene = pc.Scene(links=[ROD, pc.Link(mass=1, length=0.3, center=0.1), ROD])
    rng = np.random.default_rng(1)
    q, qd = rng.normal(size=(2, 3))
    step = 1e-6

    def coordinates(q):
        centers = scene._compiled.mass_centers(np.zeros(1), q[np.newaxis])[0]
        return np.column_stack([centers, q]).ravel()

    velocity = (coordinates(q + step * qd) - coordinates(q - step * qd)) / (2 * step)
    jacobian = constraint_jacobian(scene, q)
    assert jacobian.shape == (6, 9)
    assert np.abs(jacobian @ velocity).max() < 1e-8
    assert np.abs(jacobian @ rng.normal(size=9)).max() > 0.1
