"""The largest joint force of a run is that of the whole curve, on both sides of every jump."""

from __future__ import annotations

import tracemalloc
from itertools import pairwise
from math import pi, sqrt
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from pendcore._run import largest_reactions
from pendcore.cli import main
from pendcore.cli.summary import facts, text

fx = pc.effects
ROD = pc.Link(mass=1.0, length=1.0)
G = 9.807
ROD_ALONE = pc.Scene(links=[ROD], gravity=G)
TWO = pc.Scene.textbook()
RUBBED = TWO.replace(
    effects=[
        *(fx.DryJointFriction(joint=j, coulomb=c) for j, c in ((1, 5.0), (2, 1.5))),
        fx.Motor(joint=1, sinusoid=fx.Sinusoid(10.0, angular_frequency=1.0)),
    ]
)
BOUNCING = TWO.replace(effects=[fx.JointStop(joint=2, range=(-0.3, 0.3), restitution=0.3)])


def forces_at(solution: pc.Solution, t: Any) -> Any:
    """By the balance of forces of the links beyond each joint, with the scene's accelerations."""
    scene, states = solution.scene, solution(t).T
    n = len(scene.links)
    q, qd = states[:, :n], states[:, n:]
    qdd = scene.accelerations(t, q, qd)
    along = np.stack([np.cos(q), np.sin(q)], axis=-1)
    across = np.stack([-np.sin(q), np.cos(q)], axis=-1)
    turning = qdd[..., None] * across - (qd**2)[..., None] * along
    length = np.array([link.length for link in scene.links])[:, None]
    center = np.array([link.center for link in scene.links])[:, None]
    mass = np.array([link.mass for link in scene.links])[:, None]
    a = np.cumsum(length * turning, axis=1) - (length - center) * turning
    loads = mass * (a - np.array([0.0, scene.gravity]))
    return np.linalg.norm(np.cumsum(loads[:, ::-1], axis=1)[:, ::-1], axis=-1)


@pytest.mark.parametrize("method", ["auto", "dopri5", "dop853"])
@pytest.mark.parametrize(
    ("scene", "q0", "t_span"),
    [
        (TWO, [pi / 4, pi / 3], (0, 5)),
        (TWO, [1.0, 2.0], (3, 0)),
        (RUBBED, pi / 2, (0, 9)),
        (BOUNCING, [0.1, 0.3], (0, 5)),
    ],
    ids=["textbook", "backward", "friction", "stop"],
)
def test_it_is_that_of_a_far_finer_evaluation(
    scene: pc.Scene, q0: Any, t_span: Any, method: str
) -> None:
    solution = pc.simulate(scene, q0=q0, t_span=t_span, method=method)
    at_kept_times = np.linalg.norm(solution.reactions(), axis=-1).max(axis=0)
    for one, kept in zip(solution.largest_reactions(), at_kept_times, strict=True):
        assert kept <= one.force
        t = np.linspace(*t_span, 100_001)
        k = int(forces_at(solution, t)[:, one.joint - 1].argmax())
        around = np.linspace(t[max(k - 1, 0)], t[min(k + 1, len(t) - 1)], 10_001)
        finest = forces_at(solution, around)[:, one.joint - 1].max()
        assert one.force == pytest.approx(finest, rel=1e-10)
        assert abs(one.t - t[k]) <= 2 * abs(t[1] - t[0])


def test_a_rod_that_falls_from_the_horizontal_pulls_with_five_halves_of_its_weight() -> None:
    solution = pc.simulate(ROD_ALONE, q0=0.0, t_span=(0, 3))
    (one,) = solution.largest_reactions()
    assert one.force == pytest.approx(2.5 * G, rel=1e-9)
    bottom = np.cos(solution(one.t)[0])
    assert abs(bottom) < 1e-6
    assert not one.steady
    assert not one.just_before


def test_the_side_before_an_impact_counts() -> None:
    """At the stop it is caught, and from then on carries the weight alone."""
    scene = ROD_ALONE.replace(effects=[fx.JointStop(joint=1, range=(-1.0, pi / 2))])
    solution = pc.simulate(scene, q0=0.0, t_span=(0, 1))
    (one,) = solution.largest_reactions()
    assert one.force == pytest.approx(2.5 * G, rel=1e-9)
    assert one.just_before
    assert one.t in solution.t
    assert forces_at(solution, np.array([one.t]))[0, 0] == pytest.approx(G, rel=1e-12)
    assert f"24.5175 N just before t = {one.t:.6g} s" in text(facts(solution))


def test_the_side_after_an_impact_counts_as_that_before_it_does() -> None:
    """An elastic impact backward in time is one as well, its two sides the other way round."""
    scene = TWO.replace(
        gravity=0.0, effects=[fx.JointStop(joint=2, range=(-1.0, 0.0), restitution=1.0)]
    )
    there = pc.simulate(scene, q0=[0.0, -0.2], qd0=[-1.0, 2.0], t_span=(0, 0.3), method="dop853")
    back = pc.simulate(scene, q0=there.q[-1], qd0=-there.qd[-1], t_span=(0, 0.3), method="dop853")
    before, after = there.largest_reactions()[0], back.largest_reactions()[0]
    assert before.just_before
    assert not after.just_before
    assert after.force == pytest.approx(before.force, rel=1e-9)
    assert after.t == pytest.approx(0.3 - before.t, rel=1e-9)


def test_a_drive_that_is_faster_than_the_steps_is_followed() -> None:
    swing = fx.DrivenPivot(x=fx.Sinusoid(0.5, 200.0))
    scene = ROD_ALONE.replace(effects=[swing, fx.Lock(joint=1)])
    solution = pc.simulate(scene, q0=0.3, t_span=(0, 5))
    assert solution.stats.accepted < 5 * 200 / (2 * pi)
    (one,) = solution.largest_reactions()
    assert one.force == pytest.approx(sqrt((0.5 * 200.0**2) ** 2 + G**2), rel=1e-12)


def test_what_hangs_at_rest_has_its_weight_throughout() -> None:
    solution = pc.simulate(TWO, q0=pi / 2, t_span=(0, 1))
    found = solution.largest_reactions()
    assert [one.steady for one in found] == [True, True]
    assert [one.force for one in found] == pytest.approx([2 * G, G], rel=1e-12)
    assert "joint 1: 19.614 N throughout" in text(facts(solution))


def test_a_joint_that_is_held_is_held_between_the_steps_of_an_implicit_method_too() -> None:
    """The interpolant turns the joint by a last bit, with which it would slide."""
    one, other = (
        [
            x.force
            for x in pc.simulate(RUBBED, q0=pi / 2, t_span=(0, 9), method=m).largest_reactions()
        ]
        for m in ("radau5", "dop853")
    )
    assert one == pytest.approx(other, rel=1e-8)


def test_a_run_that_takes_no_time_has_the_forces_of_its_start() -> None:
    solution = pc.simulate(TWO, q0=[pi / 4, pi / 3], t_span=(2.0, 2.0))
    at_start = np.linalg.norm(solution.reactions()[0], axis=-1)
    found = solution.largest_reactions()
    assert [one.t for one in found] == [2.0, 2.0]
    assert [one.force for one in found] == pytest.approx(at_start, rel=1e-15)


def test_without_interpolants_it_is_the_largest_of_the_kept_times() -> None:
    for kept in ({"store": "steps"}, {"store": "end"}, {"t_eval": [1.0, 2.0]}):
        solution = pc.simulate(TWO, q0=[pi / 4, pi / 3], t_span=(0, 5), **kept)
        sizes = np.linalg.norm(solution.reactions(), axis=-1)
        found = [one.force for one in solution.largest_reactions()]
        assert found == pytest.approx(sizes.max(axis=0), rel=1e-15)
        told = text(facts(solution))
        assert f"among the {len(solution.t)} kept time" in told


def test_times_asked_for_beside_the_interpolants_take_nothing_away() -> None:
    asked = pc.simulate(TWO, q0=[1, 2], t_span=(0, 5), t_eval=[1.0], store="dense")
    whole = pc.simulate(TWO, q0=[1, 2], t_span=(0, 5))
    assert asked.largest_reactions() == whole.largest_reactions()
    assert "kept time" not in text(facts(asked))


@pytest.mark.parametrize("rtol", [1e-3, 1e-4, 1e-6, 1e-9])
def test_as_many_digits_are_printed_as_are_right(
    rtol: float, tmp_path: Any, monkeypatch: Any, capsys: Any
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "swing.toml").write_text(
        pc.Case.textbook().to_toml() + f"rtol = {rtol}\natol = {rtol}\n"
    )
    assert main(["run", "swing.toml"]) == 0
    line = next(x for x in capsys.readouterr().out.splitlines() if "largest reaction" in x)
    printed = line.split("joint 1: ")[1].split(" N")[0]
    right = pc.simulate(TWO, q0=[pi / 4, pi / 3], t_span=(0, 5), method="taylor", rtol=1e-14)
    exact = right.largest_reactions()[0].force
    decimals = len(printed.partition(".")[2])
    assert float(printed) == pytest.approx(exact, abs=0.6 * 10.0**-decimals)
    if rtol == 1e-9:
        assert printed == "31.9307"


def test_a_long_run_takes_no_more_memory_than_a_short_one() -> None:
    peaks = []
    for t_end in (2.0, 20.0):
        solution = pc.simulate(TWO, q0=[1, 2], t_span=(0, t_end), method="rk4", step=2e-4)
        tracemalloc.start()
        solution.largest_reactions()
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    short, long = peaks
    assert long < 1.2 * short


def test_progress_goes_up_to_the_end(monkeypatch: Any) -> None:
    monkeypatch.setattr(largest_reactions, "AT_ONCE", 1)
    solution = pc.simulate(TWO, q0=[1, 2], t_span=(0, 5), method="dopri5")
    told: list[float] = []
    solution.largest_reactions(progress=told.append)
    assert len(told) > 10
    assert all(a < b for a, b in pairwise(told))
    assert told[-1] == 1.0


def test_forces_that_no_double_holds_are_said_to_be_so() -> None:
    solution = pc.simulate(ROD_ALONE, q0=0.0, qd0=1e160, t_span=(0, 1e-170), store="end")
    assert solution.largest_reactions()[0].force == np.inf
    assert "joint 1: beyond the range of doubles at t = " in text(facts(solution))


def test_what_is_known_at_one_time_is_not_told_to_be_steady() -> None:
    sol = pc.simulate(pc.Scene.textbook(), q0=[0.7, 1.2], t_span=(0, 5), store="end")
    assert len(sol.t) == 1
    assert not any(one.steady for one in sol.largest_reactions())
