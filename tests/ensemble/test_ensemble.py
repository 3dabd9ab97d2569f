"""`pc.ensemble`: members broadcast, fail alone, and can be rerun; refusals; parameters, samples."""

from __future__ import annotations

import itertools
from concurrent.futures import ThreadPoolExecutor
from inspect import signature

import numpy as np
import pendcore as pc
import pytest
from members_and_runs import BOOK, assert_runs, starts
from pendcore._ensemble.request import OPTIONS
from pendcore._ensemble.whole_run import Execution

E = pc.effects
UPRIGHT = pc.events.LinkAngle(2, -np.pi / 2, every_turn=True)
DAMPED = BOOK.replace(effects=[E.ViscousJoint(joint=2, damping=0.1)])
DRIVEN = BOOK.replace(
    effects=[
        E.Motor(joint=1, sinusoid=E.Sinusoid(3.0, 6.0)),
        E.RodDrag(link=2, drag_coefficient=1.2, diameter=0.03, wind=(4.0, 0.0)),
        E.JointStop(joint=2, range=(-0.5, 4.0)),
        E.DryJointFriction(joint=2, coulomb=0.1, static=0.9),
    ]
)
HALF = {"q0": [0.5, 1.0], "t_span": (0, 1)}


@pytest.mark.parametrize("t_eval", [None, np.linspace(0, 2, 5)], ids=["end", "times"])
def test_starts_and_parameters_broadcast(t_eval):
    masses, gravity = np.array([0.5, 1.0, 2.0])[:, None], np.array([9.8, 1.6])
    vary = {"link[2].mass": masses, "gravity": gravity, "effect[1].damping": 0.2}
    found = assert_runs(DAMPED, [0.3, 0.8], t_span=(0, 2), vary=vary, times=t_eval)
    assert found.shape == (3, 2)
    assert found.q.shape == ((3, 2, 2) if t_eval is None else (3, 2, 5, 2))
    if t_eval is not None:
        assert np.array_equal(found.t, t_eval)
    for i, j in itertools.product(range(3), range(2)):
        assert np.array_equal(found.member((i, j)).q[-1], found.q[i, j].reshape(-1, 2)[-1])
    one = pc.ensemble(BOOK, **HALF)
    assert one.shape == ()
    assert np.array_equal(one.member(()).y, pc.simulate(BOOK, **HALF).y)


def test_the_first_event_of_each_member():
    last = pc.events.LinkAngle(1, np.pi / 2, terminal=3)
    firsts = {"over": UPRIGHT}
    found = assert_runs(BOOK, starts(30, 2, 5, 2.0), 0.0, (0, 10), events=[last], firsts=firsts)
    assert set(found.counts()) == {"event", "finished"}
    assert 5 < np.isfinite(found["over"]).sum() < 30
    with pytest.raises(KeyError, match="no reducer is called 'under': 'over'"):
        found["under"]
    with pytest.raises(KeyError, match=r"'over'; a member is found.member\(3\)"):
        found[3]


def test_members_fail_alone_and_are_rerun():
    asked = {"q0": [[1.5, 1.5], [np.nan, 1.0], [0.5, 1.0]], "t_span": (0, 9), "max_steps": 100}
    short = pc.ensemble(BOOK, **asked, on_failure="ignore")
    assert short.status.tolist() == ["finished", "refused", "max_steps"]
    assert short.success.tolist() == [True, False, False]
    assert short.failed.tolist() == [[1], [2]]
    assert short.message(1) == "q0[0] = nan: must be finite (rad)"
    assert "raise max_steps" in short.message(2)
    assert np.isnan(short.q[1]).all()
    assert np.isfinite(short.q[2]).all()
    again = short.rerun(max_steps=10_000, on_failure="ignore")
    assert again.status.tolist() == ["refused", "finished"]
    assert np.array_equal(again.q[1], pc.simulate(BOOK, q0=[0.5, 1.0], t_span=(0, 9)).q[-1])
    one = pc.ensemble(BOOK, q0=[1.0, 1.0], t_span=(0, 5), max_steps=3, on_failure="ignore")
    assert one.rerun(max_steps=1000).status == ["finished"]
    with pytest.warns(pc.PendcoreWarning, match=r"of 3 members 1 finished, 1 max_steps, 1 refused"):
        pc.ensemble(BOOK, **asked)
    with pytest.raises(RuntimeError, match="the first is") as raised:
        pc.ensemble(BOOK, **asked, on_failure="raise")
    assert raised.value.ensemble.success[0]


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

    q0 = starts(100_000, 2, 1, 2.0)
    with pytest.raises(KeyboardInterrupt) as raised:
        pc.ensemble(BOOK, q0=q0, t_span=(0, 100), progress=stop)
    found = raised.value.ensemble
    counts = found.counts()
    assert counts["finished"] > 1000
    assert counts["not_run"] > 1000
    done = np.flatnonzero(found.success)[-1]
    assert np.array_equal(found.q[done], pc.simulate(BOOK, q0=q0[done], t_span=(0, 100)).q[-1])
    limited = pc.ensemble(BOOK, q0=q0, t_span=(0, 100), time_limit=0.2, on_failure="ignore")
    assert limited.ending == "time_limit"
    assert limited.counts()["not_run"] > 1000


def test_a_member_that_was_not_run_says_so():
    how = {"time_limit": 1e-9, "on_failure": "ignore", "chunk": 1}
    with ThreadPoolExecutor(1) as pool:
        found = pc.ensemble(BOOK, q0=starts(5, 2, 1, 2.0), t_span=(0, 1), executor=pool, **how)
    assert found.ending == "time_limit"
    assert found.status[4] == "not_run"
    assert found.message(4).startswith("was not run: ")


def test_what_does_not_change_members_has_one_list():
    own = list(signature(pc.ensemble).parameters.values())
    begin = [one.name for one in own].index("workers")
    assert {one.name: one.default for one in own[begin:]} == Execution()._asdict()
    assert pc.ensemble(BOOK, (0, 1), [1.0, 1.0]).request.options.keys() == OPTIONS


class OwnReducer(pc.reducers.Reducer):
    usual_name = "own"
    unit = "rad"


REFUSED = [
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
    ({"keep": "ends"}, 'keep = \'ends\': must be "end", "times"'),
    ({"store": "dense"}, "store = 'dense': is a folder for the results here"),
    ({"keep": "times"}, "t_eval is missing"),
    ({"t_eval": [0.5]}, "is kept only with"),
    ({"workers": 0}, "workers = 0: must be >= 1"),
    ({"method": "euler"}, 'method = "euler": must be one of'),
    ({"rtol": -1.0}, "rtol"),
    ({"max_steps": 0}, "max_steps"),
    ({"keep": {"q": pc.reducers.EnergyDrift()}}, r"keep\[.q.\]: this name is taken"),
    ({"t_span": (0, np.inf)}, "must be finite"),
    ({"keep": pc.reducers.Extremes}, r"Extremes'>: call it: must be"),
    ({"keep": {"a": pc.reducers.Extremes}}, r"keep\['a'\] = .*: call it: must be one of pc"),
    ({"keep": OwnReducer()}, "the core does not know this class: must be one of pc.reducers"),
    ({"keep": {"a": 1}}, r"keep\['a'\] = 1: must be one of pc.reducers.FirstEvent"),
    ({"keep": {1: pc.reducers.Extremes()}}, r"keep\[1\]: the name must be a text"),
    ({"vary": {1: [1.0]}}, "parameter 1: must be a name, such as"),
    ({"executor": 3}, r"executor = 3: must be an executor of concurrent"),
    ({"chunk": 3}, "chunk: counts only with"),
]


def test_bad_input_is_refused_in_words():
    for changes, words in REFUSED:
        with pytest.raises((ValueError, TypeError), match=words):
            pc.ensemble(BOOK, **(HALF | changes))


def test_a_parameter_of_another_part_is_named():
    shaken = BOOK.replace(effects=[E.DrivenPivot(x=E.Sinusoid(0.1, 9.0))])
    for scene, name, meant in (
        (DAMPED, "link[1].damping", r"effect\[1\].damping"),
        (shaken, "effect[1].x", r"effect\[1\].x.amplitude"),
    ):
        with pytest.raises(ValueError, match=f'did you mean "{meant}"'):
            scene.with_parameters({name: 0.1})
    with pytest.raises(TypeError, match="parameter 1: must be a name, such as"):
        BOOK.with_parameters({1: 1.0})


def test_parameters_have_names_and_vary_in_the_core_as_in_python():
    known = DRIVEN.parameters()
    assert known["effect[1].sinusoid.amplitude"] == 3.0
    assert known["effect[2].wind.x"] == 4.0
    assert known["effect[3].range.upper"] == 4.0
    rod = {"link[1].mass", "link[1].length", "link[2].mass", "link[2].length"}
    for k, (name, value) in enumerate(known.items()):
        other = value * 1.25 + 0.01 * k
        changed = DRIVEN.with_parameters({name: other}).parameters()
        assert changed[name] == other
        others = {x for x in known if changed[x] != known[x]} - {name}
        assert all(x.endswith(("center", "inertia")) for x in others)
        assert name in rod or not others
        assert_runs(DRIVEN, [0.5, 1.0], t_span=(0, 1), vary={name: [value, 1.01 * value + 0.01]})


def test_samples_are_functions_of_seed_and_index_alone():
    for draw in (pc.sampling.uniform, pc.sampling.normal):
        few, many = draw(0.0, 1.0, (3, 2), seed=4), draw(0.0, 1.0, (500, 2), seed=4)
        assert np.array_equal(few, many[:3])
        assert not np.array_equal(few, draw(0.0, 1.0, (3, 2), seed=5))
    drawn = pc.sampling.normal(2.0, 0.5, 100_000, seed=1)
    assert abs(drawn.mean() - 2.0) < 0.01
    assert abs(drawn.std() - 0.5) < 0.01
    assert abs(np.mean(((drawn - 2.0) / 0.5) ** 4) - 3.0) < 0.1
    normal, uniform = pc.sampling.normal, pc.sampling.uniform
    for draw, low, high, size, seed, told in (
        (uniform, 0, 1, 3, -1, "seed = -1"),
        (normal, [0.0, 1.0], 0.1, (10, 3), 0, r"mean: shape \(2,\): does not broadcast to size = "),
        (uniform, 0.0, [[1.0], [2.0]], 1, 0, r"high: shape \(2, 1\): does not broadcast to size"),
        (normal, 0.0, [0.2, -0.1], (10, 2), 0, r"deviation = -0\.1: must be >= 0"),
    ):
        with pytest.raises(ValueError, match=told):
            draw(low, high, size, seed=seed)


def test_xarray_has_units_and_coordinates():
    pytest.importorskip("xarray")
    found = pc.ensemble(BOOK, **HALF, vary={"gravity": [1.6, 9.8, 3.7]})
    data = found.to_xarray()
    assert data.q.dims == ("member_0", "link")
    assert data.gravity.attrs["units"] == "m/s^2"
    assert data.sel(link=2).q.values.tolist() == found.q[:, 1].tolist()


def test_starts_in_degrees_are_told_once():
    for q0, vary, told in (
        ([[45, 60], [30, 90]], None, r"q0\[0, 0\] = 45.0 rad: that is 2578 deg"),
        ([0, 60], {"gravity": [9.8, 1.6]}, r"^q0\[1\] = 60.0 rad"),  # as it was given
        (45, None, r"^q0 = 45.0 rad"),
    ):
        with pytest.warns(pc.PendcoreWarning, match=told) as warned:
            pc.ensemble(BOOK, q0=q0, t_span=(0, 0.1), vary=vary)
        assert len(warned) == 1
    pc.ensemble(BOOK, q0=[[45.5, 60], [30, 90]], t_span=(0, 0.1))
    pc.ensemble(BOOK, q0=[[0, 5], [10, 0]], t_span=(0, 0.1))


def test_a_member_is_the_run_that_it_was_with_its_method_and_tolerances():
    how = {"method": "radau5", "rtol": 1e-3, "atol": 1e-5}
    found = pc.ensemble(BOOK, (0, 5), [[0.4, 0.5], [1.0, -1.0]], **how)
    alone = pc.simulate(BOOK, (0, 5), [1.0, -1.0], **how)
    assert np.array_equal(found.member(1).y, alone.y)
