"""`pc.ensemble`: members have the bits of `simulate`, broadcast, fail alone, and can be rerun."""

from __future__ import annotations

import itertools
import math
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pendcore as pc
import pytest

BOOK = pc.Scene.textbook()
E = pc.effects
UPRIGHT = pc.events.LinkAngle(2, -np.pi / 2, every_turn=True)
DAMPED = BOOK.replace(effects=[E.ViscousJoint(joint=2, damping=0.1)])
SCENES = {
    "bare": BOOK,
    "damped": DAMPED,
    "one link": BOOK.replace(links=BOOK.links[:1]),
    "motor": BOOK.replace(effects=[E.Motor(joint=1, sinusoid=E.Sinusoid(3.0, 6.0))]),
    "friction": BOOK.replace(effects=[E.DryJointFriction(joint=2, coulomb=0.2)]),
    "stop": BOOK.replace(effects=[E.JointStop(joint=2, range=(-4.0, 4.0), restitution=0.5)]),
    "own": BOOK.replace(effects=[E.User(lambda t, q, qd: -0.1 * qd)]),
    "three links": BOOK.replace(links=[*BOOK.links, pc.Link(mass=0.5, length=0.6)]),
}


def starts(count, n, seed=1):
    return pc.sampling.uniform(-2.0, 2.0, (count, n), seed=seed)


@pytest.mark.parametrize("workers", [1, 2, 5])
@pytest.mark.parametrize("name", SCENES)
def test_a_member_has_the_bits_of_simulate(name, workers):
    scene = SCENES[name]
    q0 = starts(7, len(scene.links))
    found = pc.ensemble(scene, q0=q0, qd0=0.5, t_span=(0.5, 3), workers=workers)
    for i, start in enumerate(q0):
        alone = pc.simulate(scene, q0=start, qd0=0.5, t_span=(0.5, 3))
        assert found.status[i] == alone.status
        assert (found.t[i], *found.q[i], *found.qd[i]) == (alone.t[-1], *alone.y[:, -1])


@pytest.mark.parametrize("method", ["dopri5", "dop853", "taylor", "radau5", "dopri5-radau5"])
@pytest.mark.parametrize("rtol", [1e-3, 1e-6, 1e-10])
def test_so_it_has_with_every_method_and_tolerance(method, rtol):
    q0 = starts(5, 2, seed=3)
    found = pc.ensemble(BOOK, q0=q0, t_span=(0, 4), method=method, rtol=rtol, atol=rtol / 100)
    for i in range(5):
        alone = pc.simulate(
            BOOK, q0=q0[i], t_span=(0, 4), method=method, rtol=rtol, atol=rtol / 100
        )
        assert np.array_equal(found.q[i], alone.q[-1])
        assert np.array_equal(found.member(i).y, alone.y)


def test_starts_and_parameters_broadcast():
    masses = np.array([0.5, 1.0, 2.0])[:, None]
    gravity = np.array([9.8, 1.6])
    found = pc.ensemble(
        DAMPED, q0=[0.3, 0.8], t_span=(0, 2),
        vary={"link[2].mass": masses, "gravity": gravity, "effect[1].damping": 0.2},
    )  # fmt: skip
    assert found.shape == (3, 2)
    assert found.q.shape == (3, 2, 2)
    for i, j in itertools.product(range(3), range(2)):
        scene = DAMPED.with_parameters(
            {"link[2].mass": masses[i, 0], "gravity": gravity[j], "effect[1].damping": 0.2}
        )
        alone = pc.simulate(scene, q0=[0.3, 0.8], t_span=(0, 2))
        assert np.array_equal(found.q[i, j], alone.q[-1])
        assert np.array_equal(found.member((i, j)).q[-1], alone.q[-1])
    assert pc.ensemble(BOOK, q0=[0.1, 0.2], t_span=(0, 1)).shape == ()


def test_states_at_times():
    times = np.linspace(0, 2, 5)
    found = pc.ensemble(BOOK, q0=starts(4, 2), t_span=(0, 2), keep="times", t_eval=times)
    assert found.q.shape == (4, 5, 2)
    assert np.array_equal(found.t, times)
    for i in range(4):
        alone = pc.simulate(BOOK, q0=starts(4, 2)[i], t_span=(0, 2), t_eval=times)
        assert np.array_equal(found.q[i], alone.q)
        assert np.array_equal(found.qd[i], alone.qd)


def test_the_first_event_of_each_member():
    q0 = starts(30, 2, seed=5)
    last = pc.events.LinkAngle(1, np.pi / 2, terminal=3)
    found = pc.ensemble(
        BOOK, q0=q0, t_span=(0, 10), events=[last], keep={"over": pc.reducers.FirstEvent(UPRIGHT)}
    )
    assert set(found.counts()) == {"event", "finished"}
    over = found["over"]
    for i in range(30):
        alone = pc.simulate(BOOK, q0=q0[i], t_span=(0, 10), events=[last, UPRIGHT])
        first = alone.events[1].t[0] if len(alone.events[1].t) else math.nan
        assert over[i] == first or (math.isnan(over[i]) and math.isnan(first))
        assert found.t[i] == alone.t[-1]
    assert 5 < np.isfinite(over).sum() < 30
    with pytest.raises(KeyError, match="no reducer is called 'under': 'over'"):
        found["under"]


def test_members_fail_alone():
    q0 = np.array([[1.5, 1.5], [np.nan, 1.0], [0.5, 1.0]])
    short = pc.ensemble(BOOK, q0=q0, t_span=(0, 9), max_steps=100, on_failure="ignore")
    assert short.status.tolist() == ["finished", "refused", "max_steps"]
    assert short.success.tolist() == [True, False, False]
    assert short.failed.tolist() == [[1], [2]]
    assert short.message(1) == "q0[0] = nan: must be finite (rad)"
    assert "raise max_steps" in short.message(2)
    assert np.isnan(short.q[1]).all()
    assert np.isfinite(short.q[2]).all()
    again = short.rerun(max_steps=10_000, on_failure="ignore")
    assert again.status.tolist() == ["refused", "finished"]
    assert np.array_equal(again.q[1], pc.simulate(BOOK, q0=q0[2], t_span=(0, 9)).q[-1])
    with pytest.warns(pc.PendcoreWarning, match=r"of 3 members 1 finished, 1 max_steps, 1 refused"):
        pc.ensemble(BOOK, q0=q0, t_span=(0, 9), max_steps=100)
    with pytest.raises(RuntimeError, match="the first is") as raised:
        pc.ensemble(BOOK, q0=q0, t_span=(0, 9), max_steps=100, on_failure="raise")
    assert raised.value.ensemble.success[0]  # type: ignore[attr-defined]


def test_a_function_that_raises_ends_its_member_alone():
    def torque(t, q, qd):
        if q[0] > 1.5:
            raise RuntimeError("too far")
        return [0.0, 0.0]

    scene = BOOK.replace(effects=[E.User(torque)])
    found = pc.ensemble(scene, q0=[[0.5, 1.0], [1.56, 1.57]], t_span=(0, 0.1), on_failure="ignore")
    assert found.status.tolist() == ["finished", "callback_error"]


def test_ctrl_c_and_a_time_limit_keep_what_is_done():
    def stop(fraction):
        if fraction > 0.1:
            raise KeyboardInterrupt

    q0 = starts(100_000, 2)
    with pytest.raises(KeyboardInterrupt) as raised:
        pc.ensemble(BOOK, q0=q0, t_span=(0, 100), progress=stop)
    found = raised.value.ensemble  # type: ignore[attr-defined]
    counts = found.counts()
    assert counts["finished"] > 1000
    assert counts["not_run"] > 1000
    done = np.flatnonzero(found.success)[-1]
    assert np.array_equal(found.q[done], pc.simulate(BOOK, q0=q0[done], t_span=(0, 100)).q[-1])
    limited = pc.ensemble(BOOK, q0=q0, t_span=(0, 100), time_limit=0.2, on_failure="ignore")
    assert limited.ending == "time_limit"
    assert limited.counts()["not_run"] > 1000


class OwnReducer(pc.reducers.Reducer):
    usual_name = "own"
    unit = "rad"


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"q0": np.zeros((3, 3))}, r"q0: shape \(3, 3\): must be \(\.\.\., 2\)"),
        ({"q0": np.zeros((3, 2)), "qd0": np.zeros((4, 2))}, r"do not broadcast: q0 \(3,\), qd0"),
        ({"vary": {"link[3].mass": 1.0}}, r'\[3\].mass".*name: it has 2 links, counted from 1'),
        ({"vary": {"link[0].mass": 1.0}}, "that name: it has 2 links, counted from 1"),
        ({"vary": {"effect[1].damping": 1.0}}, "that name: it has no effects"),
        ({"vary": {"link[1].damping": 1.0}}, r"that name: parameters\(\) lists those that it has"),
        ({"vary": {"mass": 1.0}}, r'did you mean "link\[1\].mass"'),
        ({"vary": {"q0[1]": 1.0}}, "starts are not parameters: give them as q0 and qd0"),
        ({"vary": {"damping": 1.0}}, r"that name: parameters\(\) lists those that it has"),
        ({"vary": {"gravty": 1.0}}, 'did you mean "gravity"'),
        ({"keep": "all"}, 'keep = \'all\': must be "end", "times"'),
        ({"keep": "times"}, "t_eval is missing"),
        ({"t_eval": [0.5]}, "is kept only with"),
        ({"workers": 0}, "workers = 0: must be 1 or more"),
        ({"method": "euler"}, 'method = "euler": must be one of'),
        ({"rtol": -1.0}, "rtol"),
        ({"max_steps": 0}, "max_steps"),
        ({"keep": "ends"}, 'keep = \'ends\': must be "end", "times"'),
        ({"keep": pc.reducers.Extremes}, r"Extremes'>: call it: must be"),
        ({"keep": {"a": pc.reducers.Extremes}}, r"keep\['a'\] = .*: call it: must be one of pc"),
        ({"keep": OwnReducer()}, "the core does not know this class: must be one of pc.reducers"),
        ({"keep": {"a": 1}}, r"keep\['a'\] = 1: must be one of pc.reducers.FirstEvent"),
        ({"keep": {1: pc.reducers.Extremes()}}, r"keep\[1\]: the name must be a text"),
        ({"t_span": (0, np.inf)}, "must be finite"),
    ],
)  # fmt: skip
def test_bad_input_is_refused_in_words(changes, words):
    arguments = {"q0": [0.5, 1.0], "t_span": (0, 1)} | changes
    with pytest.raises((ValueError, TypeError), match=words):
        pc.ensemble(BOOK, **arguments)


def test_parameters_have_names():
    scene = BOOK.replace(
        effects=[
            E.Motor(joint=1, sinusoid=E.Sinusoid(3.0, 6.0)),
            E.RodDrag(link=2, drag_coefficient=1.2, diameter=0.03, wind=(4.0, 0.0)),
            E.JointStop(joint=2, range=(-0.5, 4.0)),
        ]
    )
    known = scene.parameters()
    assert known["effect[1].sinusoid.amplitude"] == 3.0
    assert known["effect[2].wind.x"] == 4.0
    assert known["effect[3].range.upper"] == 4.0
    for k, name in enumerate(known):
        changed = scene.with_parameters({name: known[name] * 1.25 + 0.01 * k})
        assert changed.parameters()[name] == known[name] * 1.25 + 0.01 * k
        others = {x for x in known if changed.parameters()[x] != known[x]} - {name}
        rod = {"link[1].mass", "link[1].length", "link[2].mass", "link[2].length"}
        assert all(x.endswith(("center", "inertia")) for x in others)
        assert name in rod or not others


def test_every_parameter_varies_in_the_core_as_in_python():
    scene = BOOK.replace(
        effects=[
            E.Motor(joint=1, sinusoid=E.Sinusoid(3.0, 6.0)),
            E.RodDrag(link=2, drag_coefficient=1.2, diameter=0.03, wind=(4.0, 0.0)),
            E.DryJointFriction(joint=2, coulomb=0.1, static=0.2),
        ]
    )
    for name, value in scene.parameters().items():
        found = pc.ensemble(
            scene, q0=[0.5, 1.0], t_span=(0, 1), vary={name: [value, 1.01 * value + 0.01]}
        )
        alone = pc.simulate(
            scene.with_parameters({name: 1.01 * value + 0.01}), q0=[0.5, 1.0], t_span=(0, 1)
        )
        assert np.array_equal(found.q[1], alone.q[-1]), name


def test_samples_are_functions_of_seed_and_index_alone():
    for draw in (pc.sampling.uniform, pc.sampling.normal):
        few, many = draw(0.0, 1.0, (3, 2), seed=4), draw(0.0, 1.0, (500, 2), seed=4)
        assert np.array_equal(few, many[:3])
        assert not np.array_equal(few, draw(0.0, 1.0, (3, 2), seed=5))
    drawn = pc.sampling.normal(2.0, 0.5, 100_000, seed=1)
    assert abs(drawn.mean() - 2.0) < 0.01
    assert abs(drawn.std() - 0.5) < 0.01
    assert abs(np.mean(((drawn - 2.0) / 0.5) ** 4) - 3.0) < 0.1
    with pytest.raises(ValueError, match="seed = -1"):
        pc.sampling.uniform(0, 1, 3, seed=-1)


def test_samples_that_cannot_be_drawn():
    with pytest.raises(ValueError, match=r"mean: shape \(2,\): does not broadcast to size = \(10,"):
        pc.sampling.normal([0.0, 1.0], 0.1, (10, 3))
    with pytest.raises(ValueError, match=r"high: shape \(2, 1\): does not broadcast to size"):
        pc.sampling.uniform(0.0, [[1.0], [2.0]], 1)
    with pytest.raises(ValueError, match=r"deviation = -0\.1: must be >= 0"):
        pc.sampling.normal(0.0, [0.2, -0.1], (10, 2))


def test_xarray_has_units_and_coordinates():
    pytest.importorskip("xarray")
    found = pc.ensemble(BOOK, q0=[0.5, 1.0], t_span=(0, 1), vary={"gravity": [1.6, 9.8, 3.7]})
    data = found.to_xarray()
    assert data.q.dims == ("member_0", "link")
    assert data.gravity.attrs["units"] == "m/s^2"
    assert data.sel(link=2).q.values.tolist() == found.q[:, 1].tolist()


def test_starts_in_degrees_are_told_once():
    with pytest.warns(pc.PendcoreWarning, match=r"q0\[0, 0\] = 45.0 rad: that is 2578 deg") as told:
        pc.ensemble(BOOK, q0=[[45, 60], [30, 90]], t_span=(0, 0.1))
    assert len(told) == 1
    with pytest.warns(pc.PendcoreWarning, match=r"^q0\[1\] = 60.0 rad"):  # as it was given
        pc.ensemble(BOOK, q0=[0, 60], t_span=(0, 0.1), vary={"gravity": [9.8, 1.6]})
    with pytest.warns(pc.PendcoreWarning, match=r"^q0 = 45.0 rad"):
        pc.ensemble(BOOK, q0=45, t_span=(0, 0.1))
    pc.ensemble(BOOK, q0=[[45.5, 60], [30, 90]], t_span=(0, 0.1))
    pc.ensemble(BOOK, q0=[[0, 5], [10, 0]], t_span=(0, 0.1))


def test_one_member_without_axes_is_run_once_more():
    short = pc.ensemble(BOOK, q0=[1.0, 1.0], t_span=(0, 5), max_steps=3, on_failure="ignore")
    assert short.rerun(max_steps=1000).status == ["finished"]


def test_a_member_that_was_not_run_says_so():
    with ThreadPoolExecutor(1) as pool:
        found = pc.ensemble(
            BOOK,
            q0=starts(5, 2),
            t_span=(0, 1),
            time_limit=1e-9,
            on_failure="ignore",
            executor=pool,
            chunk=1,
        )
    assert found.status[4] == "not_run"
    assert found.message(4).startswith("was not run: ")
