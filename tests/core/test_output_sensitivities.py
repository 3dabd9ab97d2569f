"""How places, velocities and energies change along a run: exact answers, and slopes of runs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from slopes_of_runs import assert_slopes

E = pc.effects
ROD = pc.Link(mass=1.0, length=1.0)
TEXTBOOK = pc.Scene.textbook()
EXACTLY: Any = {"rtol": 1e-13, "atol": 1e-16}


# Exact answers ----------------------------------------------------------------------------------


def test_the_tip_and_the_energy_of_a_rod_that_turns_freely() -> None:
    """The angle is q0 + w t, and the energy m l^2 w^2 / 6."""
    m, length, q0, w = 1.3, 0.8, 0.2, 3.0
    scene = pc.Scene(links=[pc.Link(mass=m, length=length)], gravity=0.0)
    names = ["q0[1]", "qd0[1]", "link[1].length", "link[1].mass"]
    sol = pc.simulate(scene, (0, 2), q0, w, sensitivities=names, **EXACTLY)
    found = sol.output_sensitivities(["x[1]", "y[1]", "vx[1]", "vy[1]", "energy", "phid[1]"])
    assert found.shape == (len(sol.t), 6, 4)
    s, c, t = np.sin(q0 + w * sol.t), np.cos(q0 + w * sol.t), sol.t
    none = 0 * t
    right = [
        [-length * s, -length * t * s, c, none],
        [length * c, length * t * c, s, none],
        [-length * w * c, -length * (s + w * t * c), -w * s, none],
        [-length * w * s, length * (c - w * t * s), w * c, none],
        none + np.array([[0], [m * length**2 * w / 3], [m * length * w**2 / 3],
                         [length**2 * w**2 / 6]]),
        none + np.array([[0], [1], [0], [0]]),
    ]  # fmt: skip
    np.testing.assert_allclose(found, np.moveaxis(right, -1, 0), rtol=0, atol=1e-11)


def test_a_pivot_that_is_pushed_carries_all_along() -> None:
    """A wheel that turns about its mass centre, at the pivot, is one mass that falls a t^2 / 2."""
    m, g, start = 1.4, 9.807, 0.5
    wheel = pc.Link(mass=m, length=1.2, center=0.0, inertia=0.0)
    scene = pc.Scene(links=[wheel], gravity=g, effects=[E.RotorInertia(joint=1, armature=0.2)])
    line = pc.events.TipLine(point=(0.3, 0.1), normal=(1.0, 0.5))
    names = ["pivot.x", "pivot.y"]
    how: Any = {"events": [line], "sensitivities": names} | EXACTLY
    sol = pc.simulate(scene, (start, 3), 0.1, 1.5, **how)
    found = sol.output_sensitivities(["x[1]", "y[1]", "vx[1]", "vy[1]", "kinetic", "potential"])
    since = sol.t - start
    none, way = 0 * since, since**2 / 2
    places, rates = [[way, none], [none, way]], [[since, none], [none, since]]
    right = [*places, *rates, [m * 0 * since, none], [none, -m * g * way]]
    np.testing.assert_allclose(found, np.moveaxis(right, -1, 0), rtol=0, atol=1e-11)
    (moved,) = sol.event_sensitivities()
    at, angle = sol.events[0].t, sol.events[0].q[:, 0]
    speed = 1.2 * 1.5 * (0.5 * np.cos(angle) - np.sin(angle))  # of the tip, along the normal
    by = -0.5 * (at - start) ** 2 / speed
    assert len(at)
    np.testing.assert_allclose(moved.t, np.stack([by, 0.5 * by], axis=-1), rtol=1e-10)


def test_the_energy_of_a_free_chain_is_that_of_its_start() -> None:
    scene, q0, qd0 = TEXTBOOK, np.array([0.5, 1.1]), np.array([0.3, -2.0])
    names = ["q0[1]", "q0[2]", "qd0[1]", "qd0[2]", "gravity", "link[1].mass"]
    sol = pc.simulate(scene, (0, 5), q0, qd0, sensitivities=names, **EXACTLY)
    found = sol.output_sensitivities(["energy"])[:, 0]
    by_q = np.array([-1.5, -0.5]) * 9.807 * np.cos(q0) + 0.5 * np.prod(qd0) * np.sin(
        q0[1] - q0[0]
    ) * np.array([1, -1])
    by_gravity = -1.5 * np.sin(q0[0]) - 0.5 * np.sin(q0[1])
    by_mass = qd0[0] ** 2 / 6 - 0.5 * 9.807 * np.sin(q0[0])  # as long as the rod stays uniform
    right = [*by_q, *(scene.mass_matrix(q0) @ qd0), by_gravity, by_mass]
    np.testing.assert_allclose(found, np.tile(right, (len(sol.t), 1)), rtol=0, atol=1e-10)


def test_energies_of_a_linear_system_are_weights_and_momenta() -> None:
    spring = E.TorsionalSpring(joint=2, stiffness=3.0, rest_angle=0.4)
    rotor, payload = E.RotorInertia(joint=2, armature=0.1), E.Payload(mass=0.3, inertia=0.02)
    scene = TEXTBOOK.replace(effects=[spring, rotor, payload])
    q, qd = np.array([0.7, -2.3]), np.array([1.0, -0.5])
    at_rest = scene.linearize(q, outputs=["potential", "kinetic"])
    held = scene.trim(q, inputs=[1, 2])
    np.testing.assert_allclose(at_rest.C[0, :2], [held[0] - held[1], held[1]], atol=1e-13)
    np.testing.assert_allclose(at_rest.C[1], 0, atol=1e-14)
    moving = scene.linearize(q, qd, outputs=["energy", "kinetic", "potential"])
    np.testing.assert_allclose(moving.C[0, 2:], scene.mass_matrix(q) @ qd, atol=1e-13)
    np.testing.assert_allclose(moving.C[0], moving.C[1] + moving.C[2], atol=1e-13)
    kinetic, potential = scene.energy(0.0, q, qd)
    np.testing.assert_allclose(moving.outputs_there, [kinetic + potential, kinetic, potential])


# Differences ------------------------------------------------------------------------------------

LINKS = [
    pc.Link(mass=1.0, length=0.8, center=0.3, inertia=0.1),
    pc.Link(mass=0.5, length=1.2),
    pc.Link(mass=0.7, length=0.6, center=0.6, inertia=0.01),
]
WAVE = E.Sinusoid(amplitude=0.1, angular_frequency=3.0, phase=0.3)
ACTING: dict[str, Any] = {
    "driven_pivot": E.DrivenPivot(x=WAVE, y=WAVE.replace(amplitude=0.2, angular_frequency=5.0)),
    "dry_joint_friction": E.DryJointFriction(joint=1, coulomb=0.3, static=0.4),
    "joint_stop": E.JointStop(joint=2, range=(-9, 9), restitution=0.5),
    "lock": E.Lock(joint=3, angle=0.2),
    "motor": E.Motor(joint=1, pd=E.PD(kp=2.0, kd=0.1, reference=0.3)),
    "payload": E.Payload(mass=0.3, inertia=0.02),
    "rod_drag": E.RodDrag(link=1, drag_coefficient=1.2, diameter=0.05, wind=(1.0, 0.3)),
    "rotor_inertia": E.RotorInertia(joint=3, armature=0.05),
    "torsional_spring": E.TorsionalSpring(joint=2, stiffness=3.0, rest_angle=0.4),
    "user": E.User(function=lambda t, q, qd: 0.0 * qd),
    "viscous_joint": E.ViscousJoint(joint=1, damping=0.1),
}
WEIGHTS = (4 / 5, -1 / 5, 4 / 105, -1 / 280)  # of differences of the eighth order


def slope(f: Callable[[float], Any], step: float) -> Any:
    sides = ((w, f(k * step) - f(-k * step)) for k, w in enumerate(WEIGHTS, 1))
    return sum(w * difference for w, difference in sides) / step


@pytest.mark.filterwarnings("ignore::pendcore.PendcoreWarning")
@pytest.mark.parametrize("kind", ACTING)
def test_every_number_of_every_effect_changes_energies_as_differences_say(kind: str) -> None:
    scene = pc.Scene(links=LINKS, effects=[ACTING[kind]])
    known = scene.parameters()
    names = [name for name, value in known.items() if np.isfinite(value)]
    random = np.random.default_rng(1)
    t, q, qd = random.uniform(0, 3, 5), random.normal(size=(5, 3)), random.normal(size=(5, 3))
    for time, angles, rates in zip(t, q, qd, strict=True):
        if kind == "lock":
            angles[2], rates[2] = angles[1] + 0.2, rates[1]
        how: Any = {"inputs": names, "outputs": ["kinetic", "potential"]}
        found = scene.linearize(angles, rates, time, **how)
        for k, name in enumerate(names):
            step = 2e-3 * max(abs(known[name]), 0.1)

            def changed(by: float, name: str = name, at: Any = (time, angles, rates)) -> Any:
                values = {one: known[one] for one in names} | {name: known[name] + by}
                return np.array(scene.with_parameters(values).energy(*at))

            np.testing.assert_allclose(
                found.D[:, k], slope(changed, step), rtol=0, atol=1e-10, err_msg=name
            )


def test_no_effect_is_left_out() -> None:
    assert ACTING.keys() | {"compiled_user"} == pc.effects.kinds().keys()


OUTPUTS = ["x[2]", "y[1]", "vx[2]", "vy[1]", "phi[2]", "phid[2]", "q[1]", "qd[2]", "qdd[1]",
           "kinetic", "potential", "energy"]  # fmt: skip
DRIVEN = [
    E.DrivenPivot(x=WAVE, y=WAVE.replace(angular_frequency=5.0)),
    E.Payload(mass=0.4),
    E.TorsionalSpring(joint=2, stiffness=3.0, rest_angle=0.4),
    E.ViscousJoint(joint=1, damping=0.2),
]
STOP = E.JointStop(joint=2, range=(-0.5, 0.8), restitution=0.4)
NAMES = ["q0[1]", "qd0[2]", "gravity", "link[2].length", "link[1].mass", "torque[1]"]
COMPARED: dict[str, tuple[list[Any], Any, list[str]]] = {
    "a free chain": ([], (0, 2.2), NAMES),
    "a driven chain": (
        DRIVEN, (0, 2.2),
        [*NAMES, "effect[1].x.amplitude", "effect[1].y.angular_frequency", "effect[1].x.phase",
         "effect[2].mass", "effect[3].stiffness", "effect[4].damping"],
    ),
    "back in time": (DRIVEN, (2.2, 0), NAMES),
    "rods with a centre": ([], (0, 2.2), [*NAMES, "link[2].center", "link[1].inertia"]),
    "after impacts": ([STOP], (0, 2.2), [*NAMES, "effect[1].restitution"]),
}  # fmt: skip


@pytest.mark.filterwarnings("ignore:outputs. qdd:pendcore.PendcoreWarning")  # at the impacts
@pytest.mark.parametrize("case", COMPARED)
def test_derivatives_are_the_slopes_of_runs(case: str) -> None:
    effects, span, names = COMPARED[case]
    scene, start = TEXTBOOK.replace(effects=effects), [0.3, 0.6, 0.5, 0.0]
    sol = pc.simulate(scene, span, start[:2], start[2:], sensitivities=names, **EXACTLY)
    found = sol.output_sensitivities(OUTPUTS)

    def end(there: pc.Scene, y: list[float]) -> Any:
        run = pc.simulate(there, span, y[:2], y[2:], **EXACTLY)
        places, energy = run.positions()[-1], run.energy()
        moved = there.velocities(run.t[-1], run.q[-1], run.qd[-1])
        phi, phid = np.diff(run.q[-1])[0], np.diff(run.qd[-1])[0]
        return np.array([places[2, 0], places[1, 1], moved[2, 0], moved[1, 1], phi, phid,
                         run.q[-1, 0], run.qd[-1, 1], run.accelerations()[-1, 0],
                         energy.kinetic[-1], energy.potential[-1], energy.total[-1]])  # fmt: skip

    assert_slopes(found[-1], end, scene, start, names, held=names)


# Where they are asked for -----------------------------------------------------------------------


def test_other_times_than_those_kept() -> None:
    sol = pc.simulate(TEXTBOOK, (0, 2), 0.5, sensitivities=NAMES, t_eval=[0.5, 1.0, 2.0])
    there = sol.output_sensitivities(OUTPUTS)
    assert there.shape == (3, len(OUTPUTS), len(NAMES))
    np.testing.assert_array_equal(sol.output_sensitivities(OUTPUTS, [2.0, 0.5]), there[[2, 0]])
    np.testing.assert_array_equal(sol.output_sensitivities(OUTPUTS, 1.0), there[1])
    ends = pc.simulate(TEXTBOOK, (0, 2), 0.5, sensitivities=NAMES, store="end")
    np.testing.assert_array_equal(ends.output_sensitivities(OUTPUTS, [1.0]), there[1:2])
    assert sol.output_sensitivities(["energy"], []).shape == (0, 1, len(NAMES))


def test_accelerations_of_a_joint_that_sticks_have_none() -> None:
    scene = TEXTBOOK.replace(effects=[E.DryJointFriction(joint=2, coulomb=8.0)])
    sol = pc.simulate(scene, (0, 1), 0.3, [0.5, 3.0], sensitivities=["q0[1]", "effect[1].coulomb"])
    turns = np.abs(sol.qd[:, 1] - sol.qd[:, 0]) > 1e-12
    assert 0 < turns.sum() < len(turns)
    said = r"qdd\[i\] have no derivative at \d+ times"
    with pytest.warns(pc.PendcoreWarning, match=said) as told:
        found = sol.output_sensitivities(["qdd[2]", "energy"])
    assert len(told) == 1
    assert "joint 2 is at rest" in str(told[0].message)
    np.testing.assert_array_equal(np.isfinite(found[:, 0]).all(axis=1), turns)
    assert np.isfinite(found[:, 1]).all()


@pytest.mark.parametrize(
    ("outputs", "told"),
    [
        (["x[3]"], r"outputs: 'x\[3\]': must be one of q\[i\], .*, i from 1 to 2, or kinetic, "
                   r"potential, energy: did you mean 'x\[\d\]'\?"),
        (["kinetik"], "'kinetik': .*: did you mean 'kinetic'"),
        (["x[0]"], r"'x\[0\]': must be one of"),
        ([["x[1]"]], r"outputs: \['x\[1\]'\]: must be one of"),
        (["of all"], "'of all': must be one of .* or kinetic, potential, energy$"),
        (["energy", "energy"], "'energy' stands twice"),
    ],
)  # fmt: skip
def test_unknown_outputs_are_refused(outputs: list[str], told: str) -> None:
    sol = pc.simulate(TEXTBOOK, (0, 1), 0.5, sensitivities=["q0[1]"])
    with pytest.raises(ValueError, match=told):
        sol.output_sensitivities(outputs)
    with pytest.raises(ValueError, match=told):
        TEXTBOOK.linearize([0.0, 0.0], outputs=outputs)


def test_a_time_beyond_the_run_and_one_text_are_refused() -> None:
    sol = pc.simulate(TEXTBOOK, (0, 1), 0.5, sensitivities=["q0[1]"])
    with pytest.raises(ValueError, match=r"must be within the run, 0\.0 to 1\.0 s"):
        sol.output_sensitivities(["energy"], 1.5)
    with pytest.raises(TypeError, match="outputs = 'energy': must be a list of names"):
        sol.output_sensitivities("energy")
