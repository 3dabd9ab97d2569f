"""An explanation is right where the answer is known, and says what it leaves out."""

from __future__ import annotations

import json
from math import pi, sqrt
from pathlib import Path

import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx
from pendcore._explanation.constraints import constraint_jacobian
from pendcore._explanation.equilibria import FreeAngles
from pendcore.cli import main

G = 9.807
ROD = pc.Link(mass=1.0, length=1.0)
TEXTBOOK = pc.Scene.textbook()


def rods(n, *effects, gravity=G):
    return pc.Scene(links=[ROD] * n, gravity=gravity, effects=effects)


def named(scene, name, **asked):
    (found,) = [e for e in scene.explain(**asked).equilibria if e.name == name]
    return found


def test_the_textbooks_natural_frequencies():
    hanging = named(TEXTBOOK, "hanging")
    expected = [sqrt(G * (3 + sign * 6 / sqrt(7))) for sign in (-1, 1)]
    np.testing.assert_allclose([m.angular_frequency for m in hanging.modes], expected, rtol=1e-8)
    np.testing.assert_allclose([m.frequency for m in hanging.modes], np.array(expected) / (2 * pi))
    assert all(abs(mode.damping_ratio) < 1e-9 for mode in hanging.modes)
    assert hanging.stable
    assert hanging.q == (pi / 2, pi / 2)
    assert hanging.stiffest_rate == pytest.approx(expected[1])


def test_the_same_rates_grow_about_the_upright_position():
    upright = named(TEXTBOOK, "upright")
    expected = [sqrt(G * (3 + sign * 6 / sqrt(7))) for sign in (-1, 1)]
    rates = sorted(mode.rate for mode in upright.modes)
    np.testing.assert_allclose(rates, [-expected[1], -expected[0], *expected], rtol=1e-8)
    assert not upright.stable
    assert all(mode.damping_ratio is None for mode in upright.modes)


def test_a_hanging_chains_slowest_mode_is_that_of_the_bessel_function():
    slowest = named(rods(20), "hanging").modes[0].angular_frequency
    assert slowest == pytest.approx(1.2024128 * sqrt(G / 20), rel=0.05 / 20**2)


@pytest.mark.parametrize("damping", [0.3, 5.0])
def test_a_damped_rods_eigenvalues(damping):
    inertia, weight = 1 / 3, G / 2
    hanging = named(rods(1, fx.ViscousJoint(1, damping)), "hanging")
    critical = 2 * sqrt(inertia * weight)
    if damping < critical:
        (mode,) = hanging.modes
        assert mode.angular_frequency == pytest.approx(sqrt(weight / inertia), rel=1e-8)
        assert mode.damping_ratio == pytest.approx(damping / critical, rel=1e-8)
    else:
        expected = np.roots([inertia, damping, weight])
        rates = [mode.rate for mode in hanging.modes]
        np.testing.assert_allclose(sorted(rates), sorted(expected), rtol=1e-7)
        assert {mode.angular_frequency for mode in hanging.modes} == {0.0}
    assert hanging.stable


def test_an_equilibrium_is_found_where_a_spring_and_the_weight_balance():
    scene = rods(1, fx.TorsionalSpring(1, stiffness=20.0, rest_angle=0.0))
    found = named(scene, "found from hanging")
    assert 20 * found.q[0] == pytest.approx(G / 2 * np.cos(found.q[0]), rel=1e-9)
    assert found.modes[0].angular_frequency == pytest.approx(
        sqrt(3 * (20 + G / 2 * np.sin(found.q[0]))), rel=1e-7
    )


def test_a_constant_motor_shifts_the_equilibrium_and_a_strong_one_leaves_none():
    weak = named(rods(1, fx.Motor(1, constant=-2.0)), "found from hanging")
    assert G / 2 * np.cos(weak.q[0]) == pytest.approx(2.0)
    strong = rods(1, fx.Motor(1, constant=50.0)).explain()
    assert strong.equilibria == ()
    assert strong.stiffest_rate is strong.first_step is None
    assert "no equilibrium was found from hanging at t = 0 s" in strong.remarks
    assert "none was found" in repr(strong)
    json.dumps(strong.to_dict(), allow_nan=False)


def test_motors_are_looked_at_at_the_time_asked_for():
    scene = rods(1, fx.Motor(1, table=fx.Table([0, 1, 2], [0, 2, 0])))
    assert named(scene, "hanging", t=0.0).q == (pi / 2,)
    for t, torque in ((0.5, 1.0), (1.0, 2.0)):
        q = named(scene, "found from hanging", t=t).q[0]
        assert G / 2 * np.cos(q) == pytest.approx(-torque)


def test_the_start_is_one_more_place_to_look_from():
    scene = rods(2, gravity=G)
    level = scene.explain(q=[pi / 2, -pi / 2])
    assert [found.name for found in level.equilibria] == ["hanging", "upright", "start"]
    assert not level.equilibria[2].stable
    near = scene.explain(q=[pi / 2 + 0.1, pi / 2]).equilibria
    assert [found.name for found in near] == ["hanging", "upright"]  # it leads to one of them


def test_without_gravity_nothing_has_a_rate():
    free = rods(2, gravity=0.0).explain()
    assert free.stiffest_rate == 0.0
    assert free.first_step is None
    assert "first step      nothing is known here to choose it by" in repr(free)


def test_a_pose_that_nothing_holds_is_neither_stable_nor_unstable():
    for found in rods(1, gravity=0.0).explain(q=[0.3]).equilibria:
        assert not found.stable
    free = repr(rods(2, fx.ViscousJoint(1, 1.0), gravity=0.0).explain())
    assert "hanging, indifferent: q" in free
    assert "hanging, stable: q" in repr(rods(1, fx.Lock(1), gravity=0.0).explain())  # all is held


@pytest.mark.parametrize("b", [10.0, 1e6, 1e12])
@pytest.mark.parametrize(("name", "sign"), [("upright", 1), ("hanging", -1)])
def test_a_rod_in_honey_falls_slowly_and_is_still_told_to_fall(b, name, sign):
    inertia, torque = 1 / 3, sign * G / 2  # J lambda^2 + b lambda = +-m g L / 2
    slow = 2 * torque / (b + sqrt(b * b + 4 * inertia * torque))
    found = named(rods(1, fx.ViscousJoint(1, b), gravity=G), name)
    assert found.stability == ("unstable" if sign > 0 else "stable")
    assert found.modes[0].rate == pytest.approx(slow, rel=1e-9)
    assert found.modes[1].rate == pytest.approx(-torque / (inertia * slow), rel=1e-9)


def test_what_changes_with_time_is_told_to_be_looked_at_for_an_instant():
    for drive in (
        fx.DrivenPivot(y=fx.Sinusoid(0.01, 350.0)),
        fx.Motor(1, sinusoid=fx.Sinusoid(0.1, 2.0)),
        fx.Motor(1, table=fx.Table([0, 1], [0, 1])),
    ):
        remarks = rods(2, drive).explain(t=0.5).remarks
        assert any("those of the instant t = 0.5 s" in remark for remark in remarks)
    assert rods(2, fx.Motor(1, pd=fx.PD(40, 2, 1.5))).explain().remarks == ()


def test_a_driven_pivot_that_falls_takes_the_weight_away():
    falling = fx.DrivenPivot(y=fx.Sinusoid(amplitude=-G / 4, angular_frequency=2.0))
    scene = rods(1, falling)  # at t = pi/4 it accelerates downward with g
    assert scene.explain(t=0.0).stiffest_rate == pytest.approx(sqrt(1.5 * G), rel=1e-7)
    assert scene.explain(t=pi / 4).stiffest_rate < 1e-3


@pytest.mark.parametrize(
    ("effect", "words"),
    [
        (fx.DryJointFriction(1, 5.0), "dry friction is left out"),
        # It touches where the scene hangs, and upright lies beyond it.
        (fx.JointStop(1, range=(0.0, pi / 2)), "stops are left out"),
    ],
)
def test_what_holds_joints_is_left_out_of_the_equilibria_and_it_says_so(effect, words):
    told = rods(2, effect).explain()
    assert told.equilibria == TEXTBOOK.explain().equilibria
    (remark,) = told.remarks
    assert words in remark
    assert "Remarks" in repr(told)


@pytest.mark.parametrize(
    ("effects", "freedom"),
    [
        ([], 3),
        ([fx.Lock(2, angle=0.5)], 2),
        ([fx.Lock(1)], 2),
        ([fx.Lock(1), fx.Lock(3)], 1),
        ([fx.Lock(1), fx.Lock(2), fx.Lock(3)], 0),
    ],
    ids=["none", "joint 2", "joint 1", "joints 1 and 3", "all"],
)
def test_the_rank_of_the_constraints_agrees_with_the_textbooks_count(effects, freedom):
    told = rods(3, *effects).explain(q=[0.5, 1.0, 1.5])
    assert told.degrees_of_freedom == told.mobility.degrees_of_freedom == freedom
    assert told.constraint_rank == 9 - freedom
    assert len(FreeAngles(told.scene, 0.0, np.zeros(3)).leaders) == freedom


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


def test_a_locked_hinge_swings_as_one_rod():
    locked = named(rods(2, fx.Lock(2, angle=0.0)), "hanging")
    (mode,) = locked.modes
    assert mode.angular_frequency == pytest.approx(sqrt(3 * G / 4), rel=1e-8)
    bent = rods(2, fx.Lock(2)).explain(q=[1.0, 1.5])
    start = [found for found in bent.equilibria if "start" in found.name]
    for found in start:
        assert found.q[1] - found.q[0] == pytest.approx(0.5)


def test_many_links_are_explained_without_their_matrices():
    told = rods(100, fx.ViscousJoint(7, 0.1)).explain()
    assert told.equilibria == ()
    assert told.constraint_rank is told.degrees_of_freedom is None
    assert told.mobility.degrees_of_freedom == 100
    assert any(remark.startswith("more than 60 links") for remark in told.remarks)
    assert len(rods(60).explain().equilibria) == 2
    assert max(map(len, repr(told).splitlines())) <= 100


def test_costs_are_of_the_links_of_each_effect_and_of_all():
    scene = rods(2, fx.ViscousJoint(1, 0.1), fx.Payload(0.5), fx.User(lambda t, q, qd: 0 * q))
    costs = scene.explain().costs
    assert [cost.what for cost in costs] == [
        "links",
        "effect 1 (viscous_joint)",
        "effect 2 (payload)",
        "effect 3 (user)",
        "all",
    ]
    assert costs[1].operations > 0
    assert costs[2].operations == 0
    assert costs[3].operations is None
    assert costs[0].nanoseconds > 1
    assert costs[4].nanoseconds > costs[3].nanoseconds / 2 > 100


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
    for found in told.equilibria:
        for off in rng.uniform(-0.5, 0.5, (20, len(scene.links))):
            step = told.first_step
            for method in ("auto", "dopri5"):
                how = {"method": method, "first_step": step}
                run = pc.simulate(scene, q0=found.q + off, t_span=(0, step), **how)
                assert (run.stats.accepted, run.stats.rejected) == (1, 0)
    bold = 10 * told.first_step
    how = {"method": "dopri5", "first_step": bold}
    assert pc.simulate(scene, q0=found.q + off, t_span=(0, bold), **how).stats.rejected


def test_the_fastest_of_nature_and_drives_chooses_the_first_step():
    slow, fast = (rods(2, fx.DrivenPivot(y=fx.Sinusoid(1e-3, w))).explain() for w in (1.0, 200.0))
    assert slow.first_step == pytest.approx(2 * pi / 500 / slow.stiffest_rate)
    assert fast.first_step == pytest.approx(2 * pi / 500 / 200.0)
    assert (slow.fastest_drive, fast.fastest_drive) == (1.0, 200.0)
    assert "s, 1/500 of the fastest period: safe for a start at" in repr(slow)


def test_a_drive_alone_does_not_choose_the_first_step():
    """The natural rates of so long a chain are not known, and may be faster than the drive."""
    told = rods(61, fx.DrivenPivot(y=fx.Sinusoid(1e-3, 1.0))).explain()
    assert told.fastest_drive == 1.0
    assert told.first_step is None


def test_what_is_absent_is_told_and_what_is_present_is_not():
    bare = {absence.kind for absence in TEXTBOOK.explain().not_simulated}
    assert bare > {"viscous_joint", "motor", "bending", "third_dimension"}
    assert not bare & {"user", "compiled_user"}
    damped = rods(2, fx.ViscousJoint(1, 0.1)).explain().not_simulated
    assert {absence.kind for absence in damped} == bare - {"viscous_joint"}
    for absence in damped:
        assert absence.available == (absence.kind in fx.kinds())


def test_the_summary_of_a_run_tells_the_same():
    scene = rods(2, fx.ViscousJoint(1, 0.1))
    from pendcore.cli.summary import facts, text

    found = facts(pc.simulate(scene, q0=1.0, t_span=(0, 1), ledger=True))
    told = scene.explain().to_dict()["not_simulated"]
    assert found["not_simulated"] == told
    assert found["effects"][0]["kind"] == "viscous_joint"
    assert found["effects"][0]["damping"] == 0.1
    assert set(found["ledger"]) == {"viscous", "residual"}
    said = text(found)
    assert "ViscousJoint(joint=1, damping=0.1)" in said
    assert "  ledger            viscous " in said
    assert "viscous joint" not in said.partition("not simulated")[2].partition("What came")[0]


def test_it_prints_as_a_table():
    lines = repr(rods(2, fx.ViscousJoint(1, 0.1)).explain()).splitlines()
    assert lines[0] == "2 links, gravity 9.807 m/s^2, explained at t = 0 s"
    for line in (
        "  the textbook's count       M = 3 n - 2 c5 - c4 = 3*2 - 2*2 - 0 = 2",
        "  the constraints' Jacobian  3 n - rank = 6 - 4 = 2",
        "  hanging, stable: q = (1.5708, 1.5708) rad",
        "  upright, unstable: q = (-1.5708, -1.5708) rad",
    ):
        assert line in lines
    assert any(line.startswith("  ViscousJoint(joint=1, damping=0.1)") for line in lines)
    long = rods(2, fx.DrivenPivot(y=fx.Sinusoid(amplitude=0.01, angular_frequency=350.0)))
    assert repr(long.effects[0]) in " ".join(repr(long.explain()).split())
    assert any(line.startswith("  motor               A motor in a joint") for line in lines)
    assert max(map(len, lines)) <= 80


def test_the_dictionary_is_what_json_holds():
    told = rods(2, fx.ViscousJoint(1, 0.1)).explain()
    again = json.loads(json.dumps(told.to_dict(), allow_nan=False))
    assert again == told.to_dict()
    assert again["degrees_of_freedom"] == 2
    assert again["equilibria"][0]["modes"][0]["damping_ratio"] > 0
    assert again["first_step"] == told.first_step


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"q": [1, 2, 3]}, r"^q: shape \(3,\): must be \(2,\)"),
        ({"t": float("nan")}, r"^t = nan: must be finite"),
        ({"t": "now"}, r"^t: "),
    ],
)
def test_what_cannot_be_asked_is_refused(asked, message):
    with pytest.raises((ValueError, TypeError), match=message):
        TEXTBOOK.explain(**asked)


def test_the_command_explains_a_case_at_its_start(tmp_path, capsys):
    path = tmp_path / "swing.toml"
    scene = rods(2, fx.Motor(1, table=fx.Table([1, 2], [0, 2])))
    path.write_text(pc.Case(scene=scene, q0=[1, 2], t_span=(1, 2)).to_toml())
    assert main(["explain", str(path)]) == 0
    out, err = capsys.readouterr()
    assert out.startswith("2 links, gravity 9.807 m/s^2, explained at t = 1 s\n")
    assert err == ""
    assert main(["explain", str(path), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["t"] == 1.0
    assert told["not_simulated"] == scene.explain(t=1).to_dict()["not_simulated"]
    assert [*tmp_path.iterdir()] == [path]


def test_a_case_that_cannot_be_explained_is_told_in_a_line(tmp_path, capsys):
    path = Path(tmp_path / "swing.toml")
    path.write_text('[[link]]\nmass = 1\nlength = 1\n[[effect]]\nkind = "viscus_joint"\n')
    assert main(["explain", str(path)]) == 2
    err = capsys.readouterr().err
    assert "swing.toml, line 5: kind = 'viscus_joint': is no effect" in err
    assert "did you mean 'viscous_joint'?" in err
    assert main(["explain", str(tmp_path / "nothing.toml")]) == 2
    assert "No such file" in capsys.readouterr().err
