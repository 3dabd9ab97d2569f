"""Derivatives of members: those of the run alone, to the bit, or none."""

from __future__ import annotations

from _thread import interrupt_main
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from threading import Timer

import numpy as np
import pendcore as pc
import pytest
from members_and_runs import BOOK, chain, starts
from stored_ensembles import contents, stop_early

E, R = pc.effects, pc.reducers
LIMITED = BOOK.replace(effects=[E.Motor(joint=1, constant=2.0, limit=2.0)])
LEVEL = pc.Scene(links=[pc.Link(mass=1.0, length=1.0)], gravity=9.807)
SIX = np.linspace(0.3, 0.8, 6)
SCENES = {
    "bare": (BOOK, {}, ["q0[1]", "q0[2]", "qd0[1]", "qd0[2]"]),
    "a mass varies": (BOOK, {"link[2].mass": SIX}, ["link[2].mass", "link[1].length", "q0[1]"]),
    "damping": (chain(3, "damping"), {"effect[1].damping": SIX}, ["effect[1].damping", "qd0[3]"]),
    "a stop": (chain(2, "a stop"), {"effect[1].restitution": SIX}, ["effect[1].restitution"]),
    "friction": (chain(2, "friction"), {"gravity": 20 * SIX}, ["q0[1]", "effect[1].coulomb"]),
}
ASKED = {"t_span": (0, 1), "keep": R.Sensitivities(["q0[1]", "gravity"])}


def assert_those_of_simulate(found, name, names):
    members = found.members
    for i, q0 in enumerate(members.q0):
        alone = pc.simulate(
            members.scene_of((i,)), found.request.t_span, q0, sensitivities=names, store="end",
            **found.request.of_simulate(),
        )  # fmt: skip
        assert np.array_equal(found[name][i], alone.sensitivities[-1]), i


@pytest.mark.parametrize("workers", [1, 4])
@pytest.mark.parametrize("name", SCENES)
def test_they_are_those_of_simulate(name, workers):
    scene, vary, names = SCENES[name]
    q0 = starts(6, len(scene.links), 5, 0.5)
    how = {"t_span": (0, 3), "q0": q0, "vary": vary, "workers": workers}
    found = pc.ensemble(scene, keep=R.Sensitivities(names), **how)
    assert found["sensitivities"].any(axis=(0, 1)).all()
    assert_those_of_simulate(found, "sensitivities", names)
    assert np.array_equal(found.member(2).sensitivities[-1], found["sensitivities"][2])
    assert np.array_equal(found.q, pc.ensemble(scene, **how).q)  # the motion has its bits
    first = R.FirstEvent(pc.events.RateZero(link=1, terminal=3))
    beside = {"drift": R.EnergyDrift(), "span": R.Extremes(), "first": first}
    if name not in ("a stop", "friction"):
        beside["exponent"] = R.LargestExponent()
    own = {"by_name": R.Sensitivities(names), "again": R.Sensitivities(tuple(names))}
    found, without = (pc.ensemble(scene, keep=x, **how) for x in (own | beside, beside))
    assert found.success.all()
    assert_those_of_simulate(found, "by_name", names)
    assert np.array_equal(found["again"], found["by_name"])
    for one in beside:
        assert np.array_equal(found[one], without[one], equal_nan=True), one


def test_a_member_without_derivatives_has_none():
    keep, q0 = R.Sensitivities(["q0[1]"]), [[1.5, 1.5], [0.1, 0.1], [0.1, np.nan]]
    found = pc.ensemble(BOOK, (0, 9), q0, keep=keep, max_steps=100, on_failure="ignore")
    assert list(found.status) == ["finished", "max_steps", "refused"]
    assert list(np.isnan(found["sensitivities"]).all(axis=(1, 2))) == [False, True, True]
    assert "sensitivities: in 1 of 3\n" in str(found)
    vary = {"effect[1].constant": [1.0, 2.0, np.nan]}
    how = {"keep": R.Sensitivities([*vary]), "on_failure": "ignore"}
    found = pc.ensemble(LIMITED, (0, 1), 0.5, vary=vary, **how)
    assert list(found.status) == ["finished", "refused", "refused"]
    assert "a law has a corner at this value" in found.message(1)
    held = E.DryJointFriction(joint=1, coulomb=9.807 / 2)  # just holds it, level
    found = pc.ensemble(LEVEL.replace(effects=[held]), (0, 1), [[0.0], [1.0]], keep=keep)
    assert found.success.all()
    assert list(np.isnan(found["sensitivities"]).all(axis=(1, 2))) == [True, False]
    with pytest.warns(pc.PendcoreWarning, match="sensitivities: none: .* only just hold it"):
        found.member(0)


TWO = {"a": R.Sensitivities(["q0[1]"]), "b": R.Sensitivities(["q0[2]"])}
REFUSED = {
    "a text": ("q0[1]", r"^names = 'q0\[1\]': must be a list of names"),
    "a number": ([1], r'^names = \[1\]: must be a list of names, such as \["q0\[1\]"\]'),
    "none": ([], r'^names = \[\]: must have one or more, such as \["q0\[1\]"\]'),
    "misspelt": (["gravty"], 'parameter "gravty": .*: did you mean "gravity"'),
    "a third link": (["q0[3]"], r'sensitivities: "q0\[3\]": must be q0\[1\] to q0\[2\]'),
}


@pytest.mark.parametrize(("names", "words"), REFUSED.values(), ids=REFUSED)
@pytest.mark.parametrize("by", ["memory", "store", "executor"])
def test_a_wrong_name_is_refused_before_anything_runs(names, words, by, tmp_path):
    with ThreadPoolExecutor(1) as pool:
        given = {"store": tmp_path / "a.zarr", "executor": pool}
        how = {by: given[by], "chunk": 1} if by in given else {}
        with pytest.raises((TypeError, ValueError), match=words) as refused:
            pc.ensemble(BOOK, (0, 1), 0.5, keep=R.Sensitivities(names), **how)
    assert not (tmp_path / "a.zarr").exists()
    if names:
        with pytest.raises(refused.type) as same:
            pc.simulate(BOOK, (0, 1), 0.5, sensitivities=names)
        assert str(same.value).replace("sensitivities =", "names =") == str(refused.value)
    for keep, words in ((TWO, "keep: has .* twice: give one with"), ({"by": TWO["a"]}, "is taken")):
        with pytest.raises(ValueError, match=words):
            pc.ensemble(BOOK, (0, 1), 0.5, keep=keep)


@pytest.mark.unsanitized
def test_files_executors_and_xarray_keep_them(tmp_path):
    xr = pytest.importorskip("xarray", exc_type=ImportError)
    pytest.importorskip("zarr", exc_type=ImportError)
    q0 = starts(12, 2, 3, 2.0).reshape(3, 4, 2)
    plain, store = pc.ensemble(BOOK, q0=q0, **ASKED), {"store": tmp_path / "a.zarr", "chunk": 2}
    whole = pc.ensemble(BOOK, q0=q0, store=tmp_path / "whole.zarr", chunk=2, **ASKED)
    with pytest.raises(KeyboardInterrupt):
        pc.ensemble(BOOK, q0=q0, progress=stop_early, **store, **ASKED)
    with pytest.warns(pc.PendcoreWarning, match="members were not run"):
        part = pc.load(store["store"])
    assert np.isnan(part["sensitivities"][-1]).all()
    other = ASKED | {"keep": R.Sensitivities(["q0[1]", "link[1].mass"])}
    with pytest.raises(ValueError, match="has results of other reducers"):
        pc.ensemble(BOOK, q0=q0, **store, **other)
    pc.ensemble(BOOK, q0=q0, **store, **ASKED)
    assert contents(store["store"]) == contents(tmp_path / "whole.zarr")
    plain.save(tmp_path / "a.npz")
    found = [whole, pc.load(store["store"]), pc.load(tmp_path / "a.npz")]
    with ProcessPoolExecutor(2) as pool:
        found.append(pc.ensemble(BOOK, q0=q0, executor=pool, chunk=5, **ASKED))
    for one in found:
        assert np.array_equal(one["sensitivities"], plain["sensitivities"])
        assert one.request.reducers == plain.request.reducers
        assert one.resolved().all()
    for data in (plain.to_xarray(), xr.open_zarr(store["store"])):
        values = data["sensitivities"]
        assert values.dims == ("member_0", "member_1", "component", "by")
        assert values.attrs["units"] == "rad, rad/s per unit of each name"
        one = values.sel(component="qd_2", by="gravity")
        assert np.array_equal(one, plain["sensitivities"][..., 3, 1])


def test_ctrl_c_ends_it_and_leaves_what_is_done():
    Timer(0.3, interrupt_main).start()
    with pytest.raises(KeyboardInterrupt) as raised:
        pc.ensemble(BOOK, (0, 20), starts(3000, 2, 1, 1.0), keep=ASKED["keep"], workers=2)
    found = raised.value.ensemble
    done = found.status == "finished"
    assert 0 < done.sum() < 3000
    assert np.array_equal(np.isfinite(found["sensitivities"]).all(axis=(1, 2)), done)
