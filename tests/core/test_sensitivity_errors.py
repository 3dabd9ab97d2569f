"""What runs say of the error of their derivatives, and what else has a derivative."""

from __future__ import annotations

from typing import Any

import numpy as np
import pendcore as pc
import pytest
from pendcore._run.call import run_again

E = pc.effects
TEXTBOOK = pc.Scene.textbook()
BUMPY = TEXTBOOK.replace(
    effects=[
        E.JointStop(joint=2, range=(-0.5, 0.8), restitution=0.4),
        E.DryJointFriction(joint=1, coulomb=1.0, static=1.4),
    ]
)
NAMES = ["q0[1]", "gravity", "torque[2]"]
START: Any = {"t_span": (0, 2), "q0": [0.3, 0.5], "qd0": [0.0, 1.0], "sensitivities": NAMES}


@pytest.mark.parametrize("scene", [TEXTBOOK, BUMPY], ids=["smooth", "bumpy"])
@pytest.mark.parametrize(
    "options",
    [{"rtol": 1e-6}, {"method": "dop853", "rtol": 1e-9}, {"error": 1e-7},
     {"method": "rk4", "step": 1e-3}],
    ids=["loose", "usual", "to an error", "fixed steps"],
)  # fmt: skip
def test_the_error_of_derivatives_is_known(scene: pc.Scene, options: dict[str, Any]) -> None:
    sol = pc.simulate(scene, **START, **options)
    told = sol.sensitivity_errors()
    assert told.shape == (len(sol.t), 3)
    best = pc.simulate(scene, **START, rtol=1e-14, atol=1e-17, t_eval=np.unique(sol.t))
    end = np.abs(sol.sensitivities[-1] - best.sensitivities[-1]).max(axis=0)
    assert (end <= 3 * told[-1] + 1e-12).all()
    assert (told[-1] <= 3 * end + 1e-11).all()


def test_of_a_run_at_the_limit_of_rounding_and_backward() -> None:
    for span in ((0, 2), (2, 0)):
        sol = pc.simulate(TEXTBOOK, **START | {"t_span": span}, rtol=1e-13, atol=1e-16)
        assert sol.sensitivity_errors().max() < 1e-9


def test_a_run_to_an_error_has_the_derivatives_of_its_own_steps() -> None:
    sol = pc.simulate(BUMPY, **START, error=1e-8)
    how = {name: sol._run.arguments[name] for name in ("method", "rtol", "atol")}
    plain = pc.simulate(BUMPY, **START, **how)
    np.testing.assert_array_equal(plain.t, sol.t)
    np.testing.assert_array_equal(plain.sensitivities, sol.sensitivities)
    with pytest.raises(
        ValueError, match=r'"lnk\[1\].*others are q0\[i\], qd0\[i\], torque'
    ) as told:
        pc.simulate(BUMPY, (0, 1), 0.3, error=1e-8, sensitivities=["lnk[1].mass"])
    assert not hasattr(told.value, "solution")  # nothing has run by then


def test_xarray_has_them() -> None:
    pytest.importorskip("xarray")
    sol = pc.simulate(TEXTBOOK, **START)
    data = sol.to_xarray()
    by_gravity = data.sensitivities.sel(component="qd_2", by="gravity")
    np.testing.assert_array_equal(by_gravity, sol.sensitivities[:, 3, 1])
    assert "sensitivities" not in pc.simulate(TEXTBOOK, (0, 1), 0.3).to_xarray()


def test_a_limit_of_time_leaves_the_derivatives_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    """The limit is that of the run to its error, which may take all of it."""
    limits = []

    def noted(solution: pc.Solution, watch: Any, **changed: Any) -> pc.Solution:
        limits.append(changed["time_limit"])
        return run_again(solution, watch, **changed)

    monkeypatch.setattr("pendcore._run.sensitivities.run_again", noted)
    sol = pc.simulate(TEXTBOOK, **START, error=1e-6, time_limit=30)
    assert len(sol.sensitivities) == len(sol.t)
    sol.sensitivity_errors()
    assert limits == [None, None]


def test_an_end_at_an_impact_is_no_error() -> None:
    stop = E.JointStop(joint=1, range=(-9, 1.2), restitution=0.6)
    scene = pc.Scene(links=[pc.Link(mass=1.0, length=1.0)], effects=[stop])
    hit = pc.events.LinkAngle(1, 1.2, terminal=True)
    sol = pc.simulate(scene, (0, 0.8), 0.5, 1.0, sensitivities=["q0[1]"], events=[hit], rtol=1e-12)
    assert sol.sensitivity_errors().max() < 1e-5


@pytest.mark.parametrize("scene", [TEXTBOOK, BUMPY], ids=["smooth", "bumpy"])
def test_a_torque_is_that_of_a_motor(scene: pc.Scene) -> None:
    names = {"sensitivities": ["torque[1]", "torque[2]"]}
    sol = pc.simulate(scene, **START | names, rtol=1e-13, atol=1e-16, store="end")
    for joint in (1, 2):
        motor = E.Motor(joint=joint, constant=0.0)
        driven = scene.replace(effects=[*scene.effects, motor])
        name = {"sensitivities": [f"effect[{len(driven.effects)}].constant"]}
        other = pc.simulate(driven, **START | name, rtol=1e-13, atol=1e-16, store="end")
        found = sol.sensitivities[-1, :, joint - 1]
        np.testing.assert_allclose(found, other.sensitivities[-1, :, 0], rtol=0, atol=1e-11)


def test_chaos_ends_what_derivatives_mean_and_print_says_when() -> None:
    sol = pc.simulate(TEXTBOOK, (0, 30), 0.0, sensitivities=["q0[1]", "gravity"])
    told = f"by q0[1] and gravity, up to {np.abs(sol.sensitivities).max():.2g}"
    assert f"{told}; until when, sol.sensitivities_valid_until() says" in str(sol)
    until = sol.sensitivities_valid_until()
    best = pc.simulate(TEXTBOOK, (0, 30), 0.0, sensitivities=sol.sensitivity_names,
                       rtol=1e-14, atol=1e-17, t_eval=sol.t)  # fmt: skip
    for k in range(2):
        right = best.sensitivities[sol.t <= until[k], :, k]
        found = sol.sensitivities[sol.t <= until[k], :, k]
        assert np.abs(found - right).max() < 0.2 * np.abs(right).max()
        later = (sol.t > until[k]) & (sol.t < until[k] + 1)
        apart = np.abs(sol.sensitivities[later, :, k] - best.sensitivities[later, :, k]).max()
        assert apart > 0.05 * np.abs(right).max()
    assert (sol.sensitivities_valid_until(1e-6) < until).all()
    assert (until <= sol.valid_until()).all()
    assert f"{told}, to 10% until {until.min():.4g} s" in str(sol)
    with pytest.raises(ValueError, match=r"limit = 0\.0: must be > 0 \(of the largest sensitivity"):
        sol.sensitivities_valid_until(0)
    with pytest.raises(ValueError, match="limit = inf: must be finite"):
        sol.sensitivities_valid_until(np.inf)


def test_a_name_that_moves_nothing_is_right_to_the_end() -> None:
    """Rods that hang at rest do so in any gravity: what is found by it is nothing but rounding."""
    names = ["q0[1]", "gravity"]
    sol = pc.simulate(pc.Scene.textbook(), (0, 5), np.pi / 2, sensitivities=names)
    np.testing.assert_array_equal(sol.sensitivities_valid_until(), [5.0, 5.0])


def test_a_name_that_acts_from_an_impact_on_is_right_from_there() -> None:
    """Just before it the derivative is zero; the error kept for that time is the one after it."""
    names = ["q0[1]", "effect[1].restitution", "effect[1].range.upper", "effect[2].coulomb"]
    sol = pc.simulate(BUMPY, (0, 2), [0.3, 0.5], [0.0, 4.0], sensitivities=names)
    np.testing.assert_array_equal(sol.sensitivities_valid_until(1e-6), [2.0] * 4)


@pytest.mark.parametrize(("load", "slides"), [(1.0001, True), (0.9999, False)])
def test_a_stiff_spring_does_not_hide_what_friction_holds(load: float, slides: bool) -> None:
    """A ten thousandth of a limit is no rounding, whatever a spring would do a radian farther."""
    effects = [
        E.DryJointFriction(joint=1, coulomb=1.0), E.Motor(joint=1, constant=load),
        E.TorsionalSpring(joint=1, stiffness=1e5),
    ]  # fmt: skip
    rod = pc.Scene(links=[pc.Link(mass=1.0, length=1.0)], gravity=0.0, effects=effects)
    sol = pc.simulate(rod, (0, 1e-3), 0.0, 0.0, sensitivities=["torque[1]"], store="end")
    assert (sol.sensitivities[-1, 0, 0] > 0) == slides
    assert np.isfinite(sol.sensitivities).all()


def test_a_graze_ends_them_and_so_does_the_run_of_their_error() -> None:
    """The rod comes to rest just at its stop, where rounding decides: beyond, nothing is known."""
    graze = E.JointStop(joint=1, range=(-9, np.pi - 0.3), restitution=0.5)
    rod = pc.Scene(links=[pc.Link(mass=1.0, length=1.0)], effects=[graze])
    with pytest.warns(pc.PendcoreWarning, match="joint 1 grazes its stop"):
        sol = pc.simulate(rod, (0, 3), 0.3, sensitivities=["q0[1]"])
    errors = sol.sensitivity_errors()
    assert np.isnan(errors[-1]).all()
    assert np.isfinite(errors[0]).all()
    (until,) = sol.sensitivities_valid_until()
    assert 0.8 < until < 0.92  # s; half a period is 0.91 s
    assert f"to 10% until {until:.4g} s" in str(sol)
    errors[:] = 0  # it is the caller's
    assert np.isnan(sol.sensitivity_errors()[-1]).all()


def test_print_says_by_which_names_there_is_no_derivative() -> None:
    rubs = TEXTBOOK.replace(effects=[E.DryJointFriction(joint=1, coulomb=0.5)])
    with pytest.warns(pc.PendcoreWarning, match=r'none by "qd0\[1\]"'):
        sol = pc.simulate(rubs, (0, 1), [0.6, 0.3], sensitivities=["q0[1]", "qd0[1]"])
    assert ", none by qd0[1] from 0 s on; until when" in str(sol)
    np.testing.assert_array_equal(sol.sensitivities_valid_until(), [1.0, 0.0])
    assert "none by qd0[1] from 0 s on, to 10% to the end" in str(sol)
    backward = pc.simulate(TEXTBOOK, (2, 0), 0.3, sensitivities=["gravity"], store="end")
    np.testing.assert_array_equal(backward.sensitivities_valid_until(), [0.0])
    assert "sensitivities" not in str(pc.simulate(TEXTBOOK, (0, 1), 0.3))


@pytest.mark.parametrize("names", ["q0[1]", [1], 5])
def test_names_are_a_list_of_texts(names: Any) -> None:
    with pytest.raises(TypeError, match=r"sensitivities = .*: must be a list of names"):
        pc.simulate(TEXTBOOK, (0, 1), [0.3, 0.5], sensitivities=names)


def test_names_of_an_array_are_texts() -> None:
    sol = pc.simulate(TEXTBOOK, (0, 1), 0.5, sensitivities=np.array(["q0[1]", "gravity"]))
    assert [type(name) for name in sol.sensitivity_names] == [str, str]
    assert pc.simulate(TEXTBOOK, (0, 1), 0.5, sensitivities=[]).sensitivities is None
