"""Derivatives of runs: those of the reference, exact answers, where they are kept and refused.

The reference's equations are integrated with one number of the start or the scene moved by 1e-30 i:
the imaginary part of the states is then the derivative, without a difference. The integration is
Gragg's extrapolated midpoint rule, in steps that are far too short.
"""

from __future__ import annotations

import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from described_scenes import scene_of
from numpy.typing import NDArray
from reference.complex_runs import LITTLE, midpoint_rule
from reference.effects import Described
from reference.named_numbers import Numbers
from reference.newton_euler import Body

E = pc.effects
TEXTBOOK = pc.Scene.textbook()
BODIES = [Body(1.0, 0.9, 0.4, 0.09), Body(0.7, 1.1, 0.6, 0.08), Body(0.4, 0.5, 0.2, 0.01)]
ACTING: list[Described] = [
    ("viscous_joint", {"joint": 2, "damping": 0.1, "damping3": 0.02}),
    ("torsional_spring", {"joint": 1, "stiffness": 2.0, "rest_angle": 0.3}),
    ("motor", {"joint": 1, "sinusoid": {"amplitude": 2.0, "angular_frequency": 3.0, "phase": 0.2}}),
    ("motor", {"joint": 2, "sinusoid": {"amplitude": 1.0, "angular_frequency": 7.0}}),
    ("payload", {"mass": 0.3, "inertia": 0.02}),
    ("rotor_inertia", {"joint": 2, "armature": 0.05}),
    ("driven_pivot", {"y": {"amplitude": 0.05, "angular_frequency": 5.0}}),
]


def exact(
    n: int, described: list[Described], y0: list[float], name: str, times: Any
) -> NDArray[np.float64]:
    """d(q, qd)/d(name) at some times, from the reference."""
    numbers = Numbers(BODIES[:n], 9.807, described, y0)
    numbers.move(name, LITTLE)
    rig, y = numbers.rig(), numbers.y

    def rates(t: float, y: Any) -> Any:
        return np.array([*y[n:], *rig.accelerations(t, list(y[:n]), list(y[n:]))])

    found, t = [], 0.0
    for end in times:
        steps = max(1, round((end - t) / 0.03))
        for k in range(steps):
            y = midpoint_rule(rates, t + k * (end - t) / steps, y, (end - t) / steps)
        t = end
        found.append(y.imag / LITTLE.imag)
    return np.array(found)


@pytest.mark.parametrize(("n", "acting"), [(1, ACTING), (2, ACTING), (2, ACTING[:-1]), (3, ACTING)])
def test_derivatives_are_those_of_the_reference(n: int, acting: list[Described]) -> None:
    """Two links whose pivot stands still have a closed form."""
    described = [one for one in acting if one[1].get("joint", 1) <= n]
    scene = scene_of(BODIES[:n], 9.807, described)
    q0, qd0 = [0.4, -0.9, 1.3][:n], [0.5, 1.0, -2.0][:n]
    times = np.array([0.0, 0.15, 0.4])
    # abs() has no derivative in complex numbers; an infinite limit has none at all.
    parameters = [x for x in scene.parameters() if not x.endswith(("damping2", "limit"))]
    names = [*(f"q0[{i}]" for i in range(1, n + 1)), f"qd0[{n}]", *parameters[:: 1 + n // 3]]
    sol = pc.simulate(scene, (0, 0.4), q0, qd0, rtol=1e-13, atol=1e-16, t_eval=times,
                      sensitivities=names)  # fmt: skip
    assert sol.sensitivities.shape == (3, 2 * n, len(names))
    for column, name in enumerate(names):
        right = exact(n, described, [*q0, *qd0], name, times)
        error = np.abs(sol.sensitivities[:, :, column] - right).max()
        assert error <= 1e-11 * max(1.0, np.abs(right).max()), name


@pytest.mark.parametrize("method", ["taylor", "dop853", "radau5"])
def test_a_free_rotation_has_all_of_its_derivatives(method: str) -> None:
    """Changes are polynomials in time, or nothing but rounding, and no corners."""
    link = pc.Link(mass=2.0, length=1.022, center=0.349, inertia=0.1)
    names = ["link[1].center", "q0[1]", "qd0[1]", "gravity", "torque[1]", "link[1].inertia"]
    sol = pc.simulate(pc.Scene(links=[link], gravity=0.0), (0, 2), 1.1467, -3.686, method=method,
                      rtol=1e-9, store="end", sensitivities=names)  # fmt: skip
    of_mass, of_joint, angle = 2.0 * 0.349, 0.1 + 2.0 * 0.349**2, 1.1467 - 3.686 * 2.0
    by_gravity = of_mass / of_joint * (np.sin(angle) - np.sin(1.1467)) / -3.686
    right = [0.0, 0.0, 1.0, by_gravity, 2.0 / of_joint, 0.0]
    np.testing.assert_allclose(sol.sensitivities[-1, 1], right, rtol=1e-8, atol=1e-13)


@pytest.mark.parametrize("links", [1, 2, 4])
@pytest.mark.parametrize("where_laws_switch", [False, True])
def test_a_pivot_that_is_pushed_is_gravity_turned(links: int, where_laws_switch: bool) -> None:
    """Gravity g and an acceleration (a_x, a_y) of the pivot act as the gravity (-a_x, g - a_y)."""
    bodies = [pc.Link(mass=1.0 + 0.1 * i, length=0.5, center=0.2) for i in range(links)]
    effects: list[E.Effect] = [E.ViscousJoint(joint=1, damping=0.05)]
    if where_laws_switch:
        friction = {"coulomb": 0.2, "static": 0.3, "stribeck_velocity": 0.1}
        effects.append(E.DryJointFriction(joint=1, **friction))
    start = np.linspace(0.4, 1.1, links)

    def by(name: str, gravity: float, q0: NDArray[np.float64]) -> NDArray[np.float64]:
        scene = pc.Scene(links=bodies, gravity=gravity, effects=effects)
        names = ["q0[1]", "effect[1].damping", name, "torque[1]"]
        how: Any = {"rtol": 1e-11, "atol": 1e-14, "store": "end"}
        among, alone = (
            pc.simulate(scene, (0, 0.3), q0, 3.0, sensitivities=which, **how).sensitivities[-1]
            for which in (names, [name])
        )
        np.testing.assert_allclose(alone[:, 0], among[:, 2], rtol=1e-9)
        return among[:, 2]

    down, across = by("gravity", 9.8, start), by("gravity", 0.0, start - np.pi / 2)
    np.testing.assert_allclose(by("pivot.y", 9.8, start), -down, rtol=1e-9, atol=1e-11)
    np.testing.assert_allclose(by("pivot.x", 0.0, start), across, rtol=1e-9, atol=1e-11)


@pytest.mark.parametrize("begin", [100.0, -3.0])
def test_a_pivot_is_pushed_from_rest_whenever_a_run_begins(begin: float) -> None:
    """Air feels the velocity of the pivot, which was that of a push since t = 0."""
    drag = E.RodDrag(link=1, drag_coefficient=1.0, diameter=0.3, air_density=5.0)
    scene = pc.Scene(links=[pc.Link(mass=1.0, length=0.7)], effects=[drag])

    def by_push(start: float) -> NDArray[np.float64]:
        sol = pc.simulate(scene, (start, start + 1), 0.3, 1.0, sensitivities=["pivot.x", "pivot.y"],
                          rtol=1e-11, atol=1e-13)  # fmt: skip
        return sol.sensitivities[-1]

    np.testing.assert_allclose(by_push(begin), by_push(0.0), rtol=1e-9)


@pytest.mark.parametrize("method", ["auto", "dopri5", "dop853", "taylor", "radau5"])
@pytest.mark.parametrize("links", [1, 2, 4])
def test_a_chain_at_rest_has_nothing_but_rounding(links: int, method: str) -> None:
    """Changes by parameters of a chain that hangs are zero, but for the run's own errors."""
    effects: list[E.Effect] = [E.ViscousJoint(joint=1, damping=0.1)]
    names = ["gravity", "link[1].mass", f"link[{links}].length", "effect[1].damping"]
    if links > 1:
        effects.append(E.TorsionalSpring(joint=links, stiffness=0.5))
        names.append("effect[2].stiffness")
    scene = pc.Scene(links=[pc.Link(mass=1.3, length=0.7)] * links, effects=effects)
    sol = pc.simulate(scene, (0, 4), np.pi / 2, method=method, sensitivities=names)
    assert np.abs(sol.sensitivities).max() < 1e-8
    assert np.isfinite(sol.extreme_sensitivities().sensitivities[:, :links]).all()


def test_a_chain_of_many_links_keeps_within_its_memory() -> None:
    """Effects of joints beyond the second once had places in rows of two: processes crashed."""
    n = 200
    links = [pc.Link(mass=0.001, length=0.1)] * n
    effects = [E.ViscousJoint(joint=j + 1, damping=1e-5) for j in range(n)]
    scene = pc.Scene(links=links, effects=effects)
    for _ in range(3):
        sol = pc.simulate(scene, (0, 0.001), 0.2, 0.0, sensitivities=["q0[1]"])
        assert sol.sensitivities[-1, 0, 0] == pytest.approx(1.0, abs=1e-2)


@pytest.mark.parametrize("method", ["taylor", "dop853", "dopri5", "radau5"])
def test_methods_and_what_is_kept_agree(method: str) -> None:
    scene = TEXTBOOK.replace(effects=[E.ViscousJoint(joint=2, damping=0.2)])
    names, times = ["q0[1]", "link[2].length"], [0.1, 1.0, 2.5]
    asked: Any = {"method": method, "rtol": 1e-11, "atol": 1e-14, "sensitivities": names}

    def run(**options: Any) -> pc.Solution:
        return pc.simulate(scene, (0, 2.5), [0.5, 1.0], 0.0, **asked, **options)

    steps, end, chosen = run(), run(store="end"), run(t_eval=times)
    assert len(steps.sensitivities) == len(steps.t)
    np.testing.assert_array_equal(steps.sensitivities[-1], end.sensitivities[0])
    np.testing.assert_allclose(chosen.sensitivities[-1], end.sensitivities[0], rtol=1e-12)
    best = pc.simulate(scene, (0, 2.5), [0.5, 1.0], 0.0, rtol=1e-14, atol=1e-17, t_eval=times,
                       sensitivities=names)  # fmt: skip
    np.testing.assert_allclose(chosen.sensitivities, best.sensitivities, rtol=0, atol=1e-8)
    # The motion has the bits that it has without.
    del asked["sensitivities"]
    assert steps.fingerprint == run().fingerprint


def test_a_transition_matrix_is_a_product_and_keeps_the_volume() -> None:
    """By Liouville, det(M) det(dy/dy0) is that of the start, for every conservative motion."""
    names = ["q0[1]", "q0[2]", "qd0[1]", "qd0[2]"]
    exactly: Any = {"rtol": 1e-13, "atol": 1e-16, "store": "end", "sensitivities": names}
    first = pc.simulate(TEXTBOOK, (0, 1.5), [2.0, 2.5], [1.0, 0.0], **exactly)
    then = pc.simulate(TEXTBOOK, (1.5, 3), first.q[-1], first.qd[-1], **exactly)
    whole = pc.simulate(TEXTBOOK, (0, 3), [2.0, 2.5], [1.0, 0.0], **exactly)
    back = pc.simulate(TEXTBOOK, (3, 0), whole.q[-1], whole.qd[-1], **exactly)
    matrices = [one.sensitivities[-1] for one in (first, then, whole, back)]
    size = np.abs(matrices[2]).max()
    np.testing.assert_allclose(matrices[1] @ matrices[0], matrices[2], rtol=0, atol=1e-9 * size)
    np.testing.assert_allclose(matrices[3] @ matrices[2], np.eye(4), rtol=0, atol=1e-9 * size**2)
    volume = [np.linalg.det(TEXTBOOK.mass_matrix(q)) for q in ([2.0, 2.5], whole.q[-1])]
    assert np.linalg.det(matrices[2]) * volume[1] == pytest.approx(volume[0], rel=1e-9 * size)


def test_they_are_kept_by_files_and_copies(tmp_path: Path) -> None:
    sol = pc.simulate(TEXTBOOK, (0, 1), [0.3, 0.5], sensitivities=["q0[1]", "gravity"])
    sol.save(tmp_path / "run.npz")
    for again in (pc.load(tmp_path / "run.npz"), pickle.loads(pickle.dumps(sol))):
        assert again.sensitivity_names == ("q0[1]", "gravity")
        np.testing.assert_array_equal(again.sensitivities, sol.sensitivities)
    assert pc.simulate(TEXTBOOK, (0, 1), 0.5).sensitivities is None


def test_a_state_where_an_event_ends_a_run_changes_by_the_time_too() -> None:
    """As docs/how_to/linearize.md says: S - f (g_x S)/(g_x f), where S is at a fixed time."""
    down, by = pc.events.LinkAngle(1, np.pi / 2, terminal=True), 1e-6

    def end(q1: float) -> Any:
        run = pc.simulate(TEXTBOOK, (0, 5), [q1, 0.5], events=[down], rtol=1e-13, atol=1e-16)
        return run.y[:, -1]

    sol = pc.simulate(TEXTBOOK, (0, 5), [0.3, 0.5], events=[down], sensitivities=["q0[1]"],
                      rtol=1e-13, atol=1e-16)  # fmt: skip
    S = sol.sensitivities[-1, :, 0]
    f = np.hstack([sol.qd[-1], sol.accelerations()[-1]])
    exact = (end(0.3 + by) - end(0.3 - by)) / (2 * by)
    np.testing.assert_allclose(S - f * S[0] / f[0], exact, rtol=0, atol=1e-7)


def test_a_jump_that_a_function_hides_is_seen_by_its_slope() -> None:
    """Over a millionth of a radian per second, the differences see a steep slope, and no jump."""
    scene = TEXTBOOK.replace(effects=[E.User(lambda t, q, qd: [-3.0 * np.sign(qd[0]), 0.0])])

    def run(q1: float, **options: Any) -> pc.Solution:
        return pc.simulate(scene, (0, 1.5), [q1, 0.2], [3.0, 0.0], rtol=1e-10, **options)

    sol, by = run(0.5, sensitivities=["q0[1]"]), 1e-4
    slope = (run(0.5 + by).y[:, -1] - run(0.5 - by).y[:, -1]) / (2 * by)
    np.testing.assert_allclose(sol.sensitivities[-1, :, 0], slope, rtol=1e-3)


def test_what_grows_beyond_numbers_is_said() -> None:
    with pytest.warns(pc.PendcoreWarning, match=r"sensitivities: none after t = \d+\.\d* s"):
        sol = pc.simulate(TEXTBOOK, (0, 900), [0.0, 0.0], t_eval=[1.0, 900.0],
                          sensitivities=["q0[1]"])  # fmt: skip
    assert sol.success
    assert np.all(np.isfinite(sol.sensitivities[0]))
    assert np.all(np.isnan(sol.sensitivities[1]))


def test_cases_and_files_say_what_was_asked_for(tmp_path: Path) -> None:
    case = pc.Case(scene=TEXTBOOK, q0=0.5, t_span=(0, 1), options={"sensitivities": ["q0[1]"]})
    (tmp_path / "case.toml").write_text(case.to_toml())
    again = pc.read_case(tmp_path / "case.toml")
    assert again == case
    sol = again.simulate()
    assert sol.case().options["sensitivities"] == ("q0[1]",)
    np.testing.assert_array_equal(sol.case().simulate().sensitivities, sol.sensitivities)
    kept = pc.simulate(TEXTBOOK, (0, 1), 0.5, sensitivities=["q0[1]"], store="end")
    dense = kept.with_dense_output().sensitivities
    np.testing.assert_array_equal(dense[-1], kept.sensitivities[-1])


def test_a_run_with_them_is_not_resumed_without_a_word() -> None:
    with pytest.warns(pc.PendcoreWarning, match="cannot be resumed: simulate again") as told:
        short = pc.simulate(TEXTBOOK, (0, 5), 0.5, max_steps=9, sensitivities=["q0[1]"])
    assert "solution.resume" not in str(told[0].message)
    assert not short.can_resume
    with pytest.raises(ValueError, match=r"sensitivities = .*: are not continued"):
        short.resume(5.0)


@pytest.mark.parametrize(
    ("entry", "value"),
    [
        ("sensitivities", np.zeros((2, 4, 1), dtype=int)),
        ("sensitivities", np.zeros((1, 4, 2))),
        ("sensitivity_names", np.array(["lnk[1].mass"])),
        ("sensitivity_names", np.array([1.0])),
    ],
)
def test_a_damaged_file_is_refused(tmp_path: Path, entry: str, value: Any) -> None:
    sol = pc.simulate(TEXTBOOK, (0, 1), 0.5, t_eval=[0, 1], sensitivities=["q0[1]"])
    sol.save(tmp_path / "run.npz")
    with np.load(tmp_path / "run.npz") as file:
        entries = dict(file)
    np.savez(tmp_path / "run.npz", **(entries | {entry: value}))
    with pytest.raises(ValueError, match="is not a solution that pendcore saved"):
        pc.load(tmp_path / "run.npz")


PAYLOAD = E.Payload(mass=1.0)
REFUSED: dict[str, tuple[E.Effect | None, list[str], str]] = {
    "no such link": (PAYLOAD, ["q0[3]"], r"q0\[3\].*must be q0\[1\] to q0\[2\]"),
    "no number": (PAYLOAD, ["qd0[x]"], r"must be qd0\[1\] to qd0\[2\]"),
    "a state": (PAYLOAD, ["q[1]"], r"a start is named q0\[i\] or qd0\[i\]"),
    "no such joint": (PAYLOAD, ["torque[3]"], r"must be torque\[1\] to torque\[2\]"),
    "a locked joint": (E.Lock(joint=1), ["torque[1]"], "a Lock holds this joint"),
    "a corner": (
        E.Motor(joint=1, constant=2.0, limit=2.0), ["effect[1].constant"], "has a corner",
    ),
    "the angle of a lock": (
        E.Lock(joint=2, angle=0.2), ["effect[1].angle"], r"a run starts at the angle of effect 1",
    ),
    "a law without sides": (
        E.ViscousJoint(joint=1, damping=0.1), ["effect[1].damping2"],
        "is 0.0, where its law has one piece; .*leave this name out",
    ),
    "no parameter": (PAYLOAD, ["lnk[1].mass"], r'did you mean "link\[1\]\.mass"'),
    "no torque": (PAYLOAD, ["torqe[1]"], r'did you mean "torque\[1\]"'),
    "no start": (PAYLOAD, ["qdo[1]"], r'did you mean "qd0\[1\]"'),
    "the effect of a pushed pivot": (
        None, ["pivot.x", "effect[1].y"], r"effect\[1\].*it has no effects",
    ),
    "the effect of a torque": (
        None, ["torque[1]", "effect[1].constant"], r"effect\[1\].*it has no effects",
    ),
    **{f"{name}, twice": (PAYLOAD, [name, name], "stands twice: leave one out")
       for name in ("gravity", "pivot.x", "q0[1]", "torque[1]")},
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_what_has_no_derivative_is_refused(name: str) -> None:
    effect, names, told = REFUSED[name]
    scene = TEXTBOOK.replace(effects=[effect] if effect else [])
    with pytest.raises(ValueError, match=told):
        pc.simulate(scene, (0, 1), [0.3, 0.5], sensitivities=names)


FOLLOWING: dict[str, tuple[Any, ...]] = {
    "event_sensitivities": (), "extreme_sensitivities": (), "output_sensitivities": (["energy"],),
    "sensitivities_at": (0.5,), "sensitivity_errors": (), "sensitivities_valid_until": (),
}  # fmt: skip


@pytest.mark.parametrize("name", FOLLOWING)
def test_only_a_run_with_derivatives_has_what_follows_from_them(name: str) -> None:
    sol = pc.simulate(TEXTBOOK, (0, 1), 0.5, events=[pc.events.RateZero(link=1)])
    with pytest.raises(ValueError, match=r"the run has no sensitivities: simulate\(\.\.\., sens"):
        getattr(sol, name)(*FOLLOWING[name])


def test_a_limit_at_its_corner_has_one_slope_on_each_side() -> None:
    def slope(limit: float) -> NDArray[np.float64]:
        motor = E.Motor(joint=1, constant=2.0, limit=limit)
        scene = TEXTBOOK.replace(effects=[motor])
        return scene.linearize([0.3, 0.4], inputs=["effect[1].constant"]).B

    with pytest.raises(ValueError, match="a law has a corner at this value"):
        slope(2.0)
    assert np.abs(slope(2.0 + 1e-6)).max() > 0.1
    assert not slope(2.0 - 1e-6).any()
