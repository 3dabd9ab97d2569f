"""An explanation lists no pose that the scene cannot take, and says for when and where it holds."""

from __future__ import annotations

from math import pi
from pathlib import Path

import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx
from pendcore.cli import main

ROOT = Path(__file__).parents[2]
ROD = pc.Link(mass=1.0, length=1.0)
TABLE = fx.Motor(1, table=fx.Table([0, 2], [0, 1]))


def rods(n, *effects):
    return pc.Scene(links=[ROD] * n, effects=effects)


@pytest.mark.parametrize(
    ("effects", "start", "joints"),
    [
        ([fx.Lock(2, angle=0.5)], None, {1: 0.5}),
        ([fx.Lock(2, angle=0.5)], [1.0, 1.5], {1: 0.5}),
        ([fx.Lock(2)], [1.0, 1.5], {1: 0.5}),
        ([fx.Lock(1), fx.Lock(3, angle=-0.2)], [1.0, 1.5, 1.7], {0: 1.0, 2: -0.2}),
        ([fx.Lock(1, angle=0.3), fx.Lock(2, angle=0.5)], None, {0: 0.3, 1: 0.5}),
    ],
    ids=["given", "given, with a start", "of the start", "both kinds", "all"],
)
def test_equilibria_have_their_locked_joints_where_they_are_locked(effects, start, joints):
    scene = rods(2 if start is None else len(start), *effects)
    told = scene.explain(q=start)
    assert told.equilibria
    for found in told.equilibria:
        phi = np.diff(found.q, prepend=0.0)
        for joint, angle in joints.items():
            assert phi[joint] == pytest.approx(angle)
        straight = np.abs(np.sin(phi[1:])).max(initial=0.0) < 1e-6
        assert straight or found.name not in ("hanging", "upright")
    assert not any("no start was given" in remark for remark in told.remarks)


def test_a_lock_whose_angle_nobody_gave_is_told():
    told = rods(3, fx.Lock(1), fx.Lock(3)).explain()
    (remark,) = told.remarks
    assert remark.startswith("joints 1, 3: a lock takes its angle from the start")
    assert "explain(q=...)" in remark
    assert rods(2, fx.Lock(2, angle=0.0)).explain().remarks == ()


@pytest.mark.parametrize("t", [-0.1, 5.0])
@pytest.mark.parametrize(
    ("effect", "name"),
    [
        (TABLE, "table of effect 2 (motor), 0 to 2 s"),
        (
            fx.DrivenPivot(spline=fx.Spline([0, 2], [0, 1], [0, 0])),
            "spline of effect 2 (driven_pivot), 0 to 2 s",
        ),
    ],
    ids=["table", "spline"],
)
def test_a_time_that_a_table_does_not_reach_is_told(effect, name, t):
    scene = rods(1, fx.Payload(0.1), effect)
    told = scene.explain(t=t)
    assert told.remarks == (f"t = {t:g} s is outside the {name}: no equilibria are computed there",)
    assert told.equilibria == ()
    assert told.constraint_rank == 2
    assert "outside" not in repr(scene.explain(t=0.0))


def test_the_command_warns_as_a_run_would(tmp_path, capsys):
    case = pc.Case(scene=rods(2, TABLE), q0=[1.0, 45.0], t_span=(0, 5))
    path = tmp_path / "swing.toml"
    path.write_text(case.to_toml())
    warned = {}
    for command in ("explain", "run"):
        main([command, str(path), *["-o", str(tmp_path / "out")] * (command == "run")])
        lines = capsys.readouterr().err.splitlines()
        warned[command] = [line for line in lines if "warning" in line]
    assert warned["explain"] == warned["run"]
    assert "effect 1 (motor): its table goes from 0.0 to 2.0 s" in warned["run"][0]


def test_the_heading_of_the_equilibria_says_that_drives_are_held():
    shaken = pc.read_case(ROOT / "examples/cases/kapitza.toml")
    told = repr(shaken.scene.explain(t=0.25, q=shaken.q0)).splitlines()
    assert "Equilibria, with all drives held as they are at t = 0.25 s" in told
    assert "Equilibria" in repr(rods(2).explain()).splitlines()


def test_the_equilibria_print_as_plain_numbers():
    for scene in (rods(2), rods(1, fx.ViscousJoint(1, 5.0)), rods(2, fx.Lock(1, angle=-0.0))):
        shown = repr(scene.explain().equilibria)
        assert "np.float64" not in shown
        assert "-0.0," not in shown
        assert "-0.0)" not in shown
    assert rods(1).explain().equilibria[0].q == (pi / 2,)


WILD = {
    "a length below all measure": (pc.Link(mass=1.0, length=1e-310, inertia=1.0), []),
    "damping beyond all measure": (pc.Link(mass=1.0, length=1.0), [fx.ViscousJoint(1, 1e308)]),
    "gravity beyond all measure": (
        pc.Link(mass=1e-20, length=1e154),
        [fx.Motor(1, constant=1e300)],
    ),
    "a link of nothing": (
        pc.Link(mass=2.7e271, length=3.1e-272, center=2.7e-272, inertia=3.5e-273),
        [fx.ViscousJoint(1, 2e-308, damping2=1e200)],
    ),
}


@pytest.mark.parametrize("case", WILD)
@pytest.mark.filterwarnings("ignore::pendcore.PendcoreWarning")
def test_what_overflows_is_explained_as_well(case: str) -> None:
    """No warning of NumPy's, no error of its algebra: what is no number is left out."""
    link, effects = WILD[case]
    told = pc.Scene(links=[link], effects=effects).explain()
    assert told.mobility.degrees_of_freedom == 1
    assert repr(told)
