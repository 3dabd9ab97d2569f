"""Which members are resolved, events that energy forbids, figures."""

from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np
import pendcore as pc
import pytest
from members_and_runs import BOOK, starts
from pendcore._ensemble.trust import second
from pendcore.cli.map.forbidden import is_forbidden
from pendcore.cli.map.refinement import refined
from stored_ensembles import OVER

FIRST = {"keep": pc.reducers.FirstEvent(OVER)}


def plane(count, span=np.pi):
    """Starts from hanging, centres of even pixels, (count, count, 2)."""
    theta = span * (2 * np.arange(count) + 1 - count) / count
    return np.pi / 2 + np.stack(np.meshgrid(theta, theta, indexing="ij"), axis=-1)


def test_a_chaotic_motion_is_resolved_as_long_as_doubles_know_it():
    asked = {"q0": [[1.5, 1.5], [0.0, 0.0]]}  # regular, chaotic
    assert pc.ensemble(BOOK, **asked, t_span=(0, 10)).resolved().tolist() == [True, True]
    assert pc.ensemble(BOOK, **asked, t_span=(0, 100)).resolved().tolist() == [True, False]
    assert 10 < pc.simulate(BOOK, q0=[0.0, 0.0], t_span=(0, 100)).valid_until() < 100


def test_a_coarse_run_is_not_resolved_at_its_own_fault():
    coarse, fine = (
        pc.ensemble(BOOK, q0=plane(4), t_span=(0, 20), rtol=tolerance, atol=tolerance)
        for tolerance in (1e-3, 1e-12)
    )
    told = coarse.resolved()
    wrong = np.abs(coarse.q - fine.q).max(axis=-1) > 0.2
    assert wrong.any()
    assert not told[wrong].any()
    assert told[~wrong].mean() > 0.8


def test_the_second_ensemble_has_another_method_and_other_bits():
    scene = BOOK.replace(effects=[pc.effects.ViscousJoint(joint=1, damping=0.1)])
    found = pc.ensemble(scene, q0=plane(2), t_span=(0, 1), vary={"gravity": [9.0, 8.0]}, rtol=1e-6)
    members, request = second(found)
    first = pc.simulate(scene, q0=plane(2)[0, 0], t_span=(0, 1), rtol=1e-6).method
    assert request.options["method"].partition("-")[0] != first.partition("-")[0]
    assert request.options["rtol"] == pytest.approx(1e-8)
    assert 0 < np.abs(members.q0 - found.members.q0).max() < 2e-14
    assert 0 < np.abs(members.vary["gravity"] - [9.0, 8.0]).max() < 2e-14
    moved, own = members.scene.links[0], scene.links[0]
    assert 0 < abs(moved.inertia - own.inertia) < 1e-15
    assert members.scene.effects == scene.effects


def test_the_second_ensemble_keeps_series_that_find_events():
    found = pc.ensemble(BOOK, q0=plane(2), t_span=(0, 1), **FIRST)
    _, request = second(found)
    assert request.options["method"] == pc.simulate(BOOK, q0=plane(2)[0, 0], t_span=(0, 1)).method
    assert request.options["rtol"] == pytest.approx(0.01 * found.request.options["rtol"])
    found.request = found.request.with_options(rtol=1e-14, atol=1e-14)  # nothing is tighter
    _, request = second(found)
    assert request.options["method"].partition("-")[0] != "taylor"


def test_events_are_compared_by_their_times():
    found = pc.ensemble(BOOK, q0=plane(4), t_span=(0, 10), **FIRST)
    other = found.second()
    assert found.resolved(other).all()
    assert np.nanmax(np.abs(found["first_event"] - other["first_event"])) > 0
    assert not found.resolved(other, within=0.0).all()
    assert found.resolved(other, name="q").all()
    with pytest.raises(ValueError, match=r"name = 'p': must be one of 'first_event', 'q', 'qd'"):
        found.resolved(other, name="p")


@pytest.mark.parametrize(
    "effect", [pc.effects.JointStop(1, range=(0.5, 2.5)), pc.effects.Lock(1, angle=1.0)]
)
def test_scenes_that_bound_the_start_are_resolved(effect):
    scene = BOOK.replace(effects=[effect])
    starts = [[0.0, 1.0], [np.nan, 1.0], [1.0, 1.0]]  # two are refused
    found = pc.ensemble(scene, (0, 1), starts, on_failure="ignore")
    assert found.resolved().tolist() == [False, False, True]
    none = pc.ensemble(scene, (0, 1), starts[:2], on_failure="ignore")
    assert none.resolved().tolist() == [False, False]


def test_only_the_same_request_confirms_members():
    asked = {"scene": BOOK, "t_span": (0, 1), "q0": np.ones((4, 2))}
    chain = BOOK.replace(links=[*BOOK.links, pc.Link(mass=1.0, length=1.0)])
    times = asked | {"keep": "times", "t_eval": [0.2, 0.5]}
    for one, changed, told in (
        (asked, {"q0": [1.0, 1.0]}, r"shape = \(\): must be \(4,\): found.second\(\) makes"),
        (asked, {"scene": chain, "q0": np.ones((4, 3))}, "number of links = 3: must be 2"),
        (asked, {"t_span": (0, 2)}, r"t_span = \(0.0, 2.0\): must be \(0.0, 1.0\)"),
        (times, {"t_eval": [0.2, 0.6]}, r"t_eval = \[0.2, 0.6\]: must be \[0.2, 0.5\]"),
        (asked, FIRST, "reducers = {'first_event': .*}: must be {}"),
    ):
        found, other = pc.ensemble(**one), pc.ensemble(**(one | changed))
        with pytest.raises(ValueError, match=f"^other: {told}"):
            found.resolved(other)
    found = pc.ensemble(**asked, **FIRST)
    with pytest.raises(TypeError, match="other: is of type Solution: must be an ensemble"):
        found.resolved(found.member(0))
    for within, name, error, told in (
        ("x", None, TypeError, "within = 'x': must be a real number"),
        (np.nan, "q", ValueError, r"within = nan: must be >= 0 \(rad\)"),
        (-1, None, ValueError, r"within = -1: must be >= 0 \(s\)"),
    ):
        with pytest.raises(error, match=told):
            found.resolved(name=name, within=within)


def test_energy_forbids_what_does_not_happen():
    q0 = plane(20)
    theta = q0 - np.pi / 2
    forbidden = is_forbidden(BOOK, q0, 0.0, OVER)
    heyl = 3 * np.cos(theta[..., 0]) + np.cos(theta[..., 1]) > 2  # Heyl (2008)
    assert np.array_equal(forbidden, heyl)
    found = pc.ensemble(BOOK, q0=q0, t_span=(0, 15), **FIRST)
    assert np.isnan(found["first_event"][forbidden]).all()
    assert np.isfinite(found["first_event"]).mean() > 0.5


@pytest.mark.filterwarnings("ignore:link 1. center")
@pytest.mark.parametrize("value", [-np.pi / 2, -0.3, 2.9])
@pytest.mark.parametrize("link", [1, 2, 3])
def test_nothing_that_happens_is_called_forbidden(link, value):
    links = [pc.Link(mass=0.7, length=0.4, center=-0.1), *BOOK.links]
    scene = pc.Scene(links=links, gravity=5.0)
    event = OVER.replace(link=link, value=value)
    q0, qd0 = starts(60, 3, link, 3.0), starts(60, 3, link + 9, 2.0)
    forbidden = is_forbidden(scene, q0, qd0, event)
    found = pc.ensemble(scene, (0, 10), q0, qd0, keep=pc.reducers.FirstEvent(event))
    assert not np.isfinite(found["first_event"][forbidden]).any()


def test_nothing_is_known_of_scenes_with_effects_or_lines():
    driven = BOOK.replace(effects=[pc.effects.Motor(joint=1, constant=30.0)])
    line = pc.events.TipLine(point=(0.0, -9.0), normal=(0.0, 1.0))
    for scene, event in ((driven, OVER), (BOOK, line)):
        assert not is_forbidden(scene, plane(4), 0.0, event).any()


def test_a_map_is_refined_where_neighbours_differ():
    asked = []

    def disc(level, wanted):
        asked.append(int(wanted.sum()))
        x, y = ((np.arange(size) + 0.5) / size - 0.5 for size in level)
        i, k = np.nonzero(wanted)
        inside = np.hypot(x[i], y[k]) < 0.3
        return inside + 1.0, inside

    *_, (values, resolved, computed) = refined((256, 256), 4, disc)
    x = (np.arange(256) + 0.5) / 256 - 0.5
    assert np.array_equal(values, (np.hypot(x[:, None], x) < 0.3) + 1.0)
    assert np.array_equal(resolved, values > 1.0)
    assert sum(asked) < 0.2 * values.size
    assert asked[-1] == computed.sum()
    with pytest.raises(ValueError, match="count = 100: must be a multiple of 8"):
        list(refined((100, 104), 3, disc))


def test_a_figure_of_two_axes_is_an_image_with_names_and_units():
    found = pc.ensemble(BOOK, q0=plane(6), t_span=(0, 10), **FIRST)
    image, *_ = found.plot()
    assert image.axes.get_xlabel() == "$q_{1}(0)$ (rad)"
    assert image.axes.get_ylabel() == "$q_{2}(0)$ (rad)"
    assert image.colorbar.ax.get_ylabel() == "first event (s)"
    shown = image.get_array().filled(np.nan)
    assert np.array_equal(shown, found["first_event"].T, equal_nan=True)
    mask = found.resolved()
    mask[2, 3] = False
    image, unresolved = found.plot("qd[2]", resolved=mask)
    assert image.colorbar.ax.get_ylabel() == r"$\dot q_{2}$ at the end (rad/s)"
    squares = [square[:4] for square in unresolved.get_path().to_polygons()]
    marked = sorted(map(tuple, np.mean(squares, axis=1)))
    assert np.array(marked) == pytest.approx(plane(6)[~mask])
    assert unresolved.get_hatch()  # which print without colours shows, too
    with pytest.raises(TypeError, match="shading"):
        found.plot("qd[2]", shading="gouraud")
    plt.close("all")


def test_a_figure_of_one_axis_is_a_line():
    how = {"q0": [0.5, 1.0], "t_span": (0, 1)}
    swept = pc.ensemble(BOOK, **how, vary={"link[2].mass": [0.5, 1.0, 2.0]})
    [line] = swept.plot("q[2]")
    assert line.axes.get_xlabel() == "link[2].mass (kg)"
    assert np.array_equal(line.get_ydata(), swept.q[:, 1])
    own = plt.figure().add_subplot()
    line, marks = swept.plot("q[2]", own, resolved=[True, False, True], color="k")
    assert line.axes is own
    assert marks.get_xdata().tolist() == [1.0]
    [line] = pc.ensemble(BOOK, q0=[[1.0, 0.5], [0.5, 0.5], [0.2, 0.5]], t_span=(0, 0.1)).plot(
        "q[1]"
    )
    assert line.axes.get_xlabel() == "$q_{1}(0)$ (rad)"
    assert line.get_xdata().tolist() == [1.0, 0.5, 0.2]  # decreasing starts name an axis too
    times = pc.ensemble(BOOK, q0=[[1.0, 0.5]] * 2, t_span=(0, 1), keep="times", t_eval=[0.5, 1.0])
    several = "keeps states at several times, which are not one"
    for found, name, options, error, told in (
        (swept, "q[3]", {}, ValueError, r"what = 'q\[3\]': must be one of q\[1\], q\[2\]"),
        (swept, None, {"resolved": [True, False]}, ValueError, r"resolved: shape \(2,\): must be "),
        (pc.ensemble(BOOK, **how), None, {}, ValueError, "a figure needs one axis or two"),
        (times, None, {}, ValueError, several),
        (times, "q[1]", {}, ValueError, several),
        (times, times.q, {}, TypeError, "what: is of type ndarray: must name what is"),
    ):
        with pytest.raises(error, match=told):
            found.plot(name, **options)
    plt.close("all")
