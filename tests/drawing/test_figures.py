"""Figures show the numbers of the run, with units, y downwards, and shade past the horizon."""

from __future__ import annotations

import numpy as np
import pendcore as pc
import pytest
from matplotlib.figure import Figure
from pendcore.plotting import KINDS, LIGHT, save_figure
from pendcore.plotting.curve import curve_of
from pendcore.plotting.plot import plot
from pendcore.plotting.poses import forces_on_links
from runs_that_kept_little import axes

BOOK = pc.Scene.textbook()
DRAG = pc.effects.RodDrag(link=2, drag_coefficient=1.2, diameter=0.05)


@pytest.fixture(scope="module")
def sol():
    down = pc.events.LinkAngle(1, np.pi / 2)
    return pc.simulate(BOOK, (0, 5), [0.8, 1.0], events=[down], ledger=True)


def legend(axis):
    return [text.get_text() for text in axis.get_legend().get_texts()]


def test_rates_are_those_of_the_run_in_rad_per_second(sol):
    lines = sol.plot("rates", axes(2))
    for i, line in enumerate(lines):
        t, curve = line.get_data()
        assert np.array_equal(curve, sol(t)[2 + i])
        assert line.axes.get_ylabel() == rf"$\dot q_{{{i + 1}}}$ (rad/s)"
    assert line.axes.get_xlabel() == "t (s)"


def test_reactions_have_components_and_sizes_in_newtons(sol):
    lines = sol.plot("reactions", axes(2))
    names = [text.get_text() for text in lines[0].axes.get_legend().get_texts()]
    assert names == ["x", "y, downwards", "$|F|$"]
    x, y, size = (line.get_ydata() for line in lines[:3])
    assert (x[0], y[0]) == pytest.approx(tuple(sol.reactions()[0, 0]))
    assert size == pytest.approx(np.hypot(x, y))
    assert [line.axes.get_ylabel() for line in lines[::3]] == ["$F_{01}$ (N)", "$F_{12}$ (N)"]


def test_the_energy_has_its_ledger_below(sol):
    damped = BOOK.replace(effects=[pc.effects.ViscousJoint(joint=1, damping=0.5)])
    run = pc.simulate(damped, q0=0.5, t_span=(0, 5), ledger=True)
    lines = run.plot("energy", axes(3))
    assert lines[-1].axes.get_ylabel() == "residual (nJ)"
    drawn = lines[-1].axes
    drawn.figure.canvas.draw()
    ticks = [
        float(text.get_text().replace("\N{MINUS SIGN}", "-")) for text in drawn.get_yticklabels()
    ]
    assert ticks == pytest.approx(1e9 * drawn.get_yticks())
    assert not drawn.yaxis.get_offset_text().get_visible()
    rough = pc.simulate(damped, q0=0.5, t_span=(0, 5), ledger=True, method="rk4", step=0.05)
    rough.plot("energy", [line.axes for line in (lines[0], lines[3], lines[4])])
    assert drawn.get_ylabel() == "residual (\N{MICRO SIGN}J)"
    found = {line.get_label().lstrip("_"): line.get_data() for line in lines}
    assert set(found) == {"kinetic", "potential", "total", "viscous (lost)", "residual"}
    t, total = found["total"]
    lost = np.interp(t, *found["viscous (lost)"])
    assert total + lost == pytest.approx(np.full(len(t), total[0]), abs=0.05)
    assert found["kinetic"][1][0] == 0.0
    assert len({line.get_color() for line in lines[:4]}) == 4
    bare = pc.simulate(damped, q0=0.5, t_span=(0, 5))
    assert len(bare.plot("energy", axes())) == 3


def test_a_ledger_with_nothing_booked_has_its_residual_alone():
    run = pc.simulate(BOOK, (0, 2), 0.5, ledger=True)
    lines = run.plot("energy", axes(2))
    assert [line.axes.get_ylabel() for line in lines[2:]] == ["energy (J)", "residual (pJ)"]
    (alone,) = {line.axes for line in run.plot("energy", axes(1))}
    assert alone.get_ylabel() == "energy (J)"


def test_given_axes_keep_their_labels_and_ticks(sol):
    left, right = Figure().subplots(1, 2)
    sol.plot("path", left)
    sol.plot("angles", right)
    assert (right.get_xlabel(), right.get_ylabel()) == ("t (s)", "$q$ (deg)")
    assert right.yaxis.get_tick_params()["labelleft"]


@pytest.mark.parametrize("rate", [0.0, 3.0])
def test_bodies_without_weight_have_no_arrow_of_it(rate):
    free = pc.simulate(BOOK.replace(gravity=0.0), (0, 1), [0.5, 0.9], rate)
    texts = [text.get_text() for text in free.plot("free_bodies", axes())]
    assert not [text for text in texts if "g" in text]
    assert bool([text for text in texts if "F_" in text]) == bool(rate)


def test_the_path_is_that_of_the_tip_and_y_points_down(sol):
    ax = axes()
    (line,), (other,) = (sol.plot("path", ax) for _ in range(2))
    x, y = line.get_data()
    assert (x[-1], y[-1]) == pytest.approx(tuple(sol.positions()[-1, -1]), abs=1e-12)
    assert line.axes.yaxis_inverted()  # after the second path too
    assert line.axes.get_aspect() == 1.0
    assert line.axes.get_ylabel() == "y (m), downwards"
    poses = [one for one in ax[0].lines if one.get_marker() == "o"]
    assert [one.get_color() for one in poses[::2]] == [LIGHT.lost] * 2
    assert [one.get_color() for one in poses[1::2]] == [line.get_color(), other.get_color()]
    assert (line.get_color(), other.get_color()) == (LIGHT.link(1), LIGHT.run(1))


def test_the_phase_portrait_has_a_curve_for_each_link(sol):
    lines = sol.plot("phase", axes())
    assert len(lines) == 2
    assert lines[1].get_xdata()[0] == sol.q[0, 1]
    assert lines[1].get_ydata()[-1] == sol.qd[-1, 1]
    assert lines[0].axes.get_xlabel() == "$q$ (rad)"
    turning = pc.simulate(BOOK, (0, 3), np.pi / 2, 12.0)
    assert np.ptp(turning.q[:, 0]) > 2 * np.pi
    line = turning.plot("phase", axes(2))[0]
    t, (angle, rate) = curve_of(turning).t, line.get_data()
    assert np.isnan(angle).sum() == (np.diff((turning(t)[0] + np.pi / 2) // (2 * np.pi)) != 0).sum()
    shown = ~np.isnan(angle)
    assert np.sin(angle[shown]) == pytest.approx(np.sin(turning(t)[0][shown]), abs=1e-9)
    assert rate[shown] == pytest.approx(turning(t)[2][shown])
    assert -np.pi / 2 <= np.nanmin(angle) <= np.nanmax(angle) <= 3 * np.pi / 2
    apart = sol.plot("phase", axes(2), label="mine")
    assert [line.axes.get_xlabel() for line in apart] == ["$q_{1}$ (rad)", "$q_{2}$ (rad)"]
    assert [legend(line.axes) for line in apart] == [["mine"], ["mine"]]


def test_a_section_shows_the_states_at_an_event(sol):
    (line,) = sol.plot("section", axes(), link=2)
    assert len(line.get_xdata()) == len(sol.events[0]) > 2
    turns = pc.events.LinkAngle(1, np.pi / 2, direction=1)
    long = pc.simulate(BOOK, q0=1.0, t_span=(0, 2000), store="end", events=[turns])
    (many,) = long.plot("section", axes(), link=2)
    assert many.get_markersize() < line.get_markersize() / 2
    assert np.cos(line.get_xdata()) == pytest.approx(np.cos(sol.events[0].q[:, 1]))
    assert np.array_equal(line.get_ydata(), sol.events[0].qd[:, 1])
    assert legend(line.axes) == ["each time that $q_{1}$ passes 90 deg"]
    *_, at, _ = sol.events[0].t
    (right,) = plot(sol, "section", axes(), {"link": 2}, {}, valid_until=at)
    *_, wrong = right.axes.lines
    assert np.array_equal(right.get_ydata(), sol.events[0].qd[:-1, 1])
    assert np.array_equal(wrong.get_ydata(), sol.events[0].qd[-1:, 1])
    assert legend(right.axes)[1] == f"not right\nafter {at:.4g} s"


def test_a_section_without_events_says_how_to_look_for_them():
    run = pc.Case.textbook().simulate()
    with pytest.raises(ValueError, match=r"looked for no event: give simulate\(\.\.\., events="):
        run.plot("section", axes())


def test_a_strip_has_a_pose_and_its_time_for_each_time(sol):
    artists = sol.plot("strip", axes(), t=[0.0, 1.5, 4.0])
    texts = artists[2::3]
    assert [text.get_text() for text in texts] == ["0 s", "1.5 s", "4 s"]
    first, second = (np.array(line.get_data()).T for line in artists[3:5])
    assert np.array_equal(first[1], second[0])
    pose = np.array([*first, second[1]])
    true = pc.simulate(sol.scene, q0=[0.8, 1.0], t_span=(0, 5), t_eval=[1.5]).positions()[0]
    assert pose - pose[0] == pytest.approx(true - true[0], abs=1e-6)


def test_a_strip_fills_its_figure(sol):
    for t in (None, [0.0, 1.5, 4.0]):
        axis = plot(sol, "strip", None, {"t": t}, {}, new_figure=Figure)[0].axes
        axis.figure.draw_without_rendering()
        assert axis.get_tightbbox().width > 0.9 * axis.figure.bbox.width
        assert axis.dataLim.height > 0.8 * abs(np.subtract(*axis.get_ylim()))


def test_the_forces_on_a_free_body_are_its_mass_times_its_acceleration():
    """By another way: the acceleration of mass centres from their places."""
    drive = pc.effects.DrivenPivot(x=pc.effects.Sinusoid(amplitude=0.05, angular_frequency=7.0))
    scene = BOOK.replace(effects=[DRAG, pc.effects.Payload(mass=0.4), drive])
    run = pc.simulate(scene, q0=[0.3, 0.9], qd0=[2.0, -5.0], t_span=(0, 1), rtol=1e-11, atol=1e-12)
    h, at = 2e-4, 0.6
    times = at + h * np.array([-1, 0, 1])
    states = run(times).T
    q, qd = np.ascontiguousarray(states[:, :2]), np.ascontiguousarray(states[:, 2:])
    centers = scene._compiled.mass_centers(times, q)
    tip = scene._compiled.positions(times, q)[:, -1]
    change = [1.0, -2.0, 1.0]
    momentum = [
        link.mass * np.tensordot(change, centers[:, i], 1) / h**2
        for i, link in enumerate(scene.links)
    ]
    momentum[1] = momentum[1] + 0.4 * np.tensordot(change, tip, 1) / h**2
    forces = forces_on_links(scene, at, q[1], qd[1])
    assert [one.kind for one in forces[1]] == ["force", "weight", "weight", "load"]
    for own, of_link in zip(momentum, forces, strict=True):
        assert sum(one.force for one in of_link) == pytest.approx(own, rel=1e-4, abs=1e-4)
    (drag,) = (one.force for one in forces[1] if one.kind == "load")
    speed = np.gradient(centers[:, 1], h, axis=0)[1]
    assert drag @ speed < 0  # drag brakes


def test_a_fast_pivot_is_no_force_on_a_link():
    shaken = pc.effects.DrivenPivot(y=pc.effects.Sinusoid(amplitude=0.01, angular_frequency=5e3))
    scene = BOOK.replace(effects=[shaken, DRAG])
    state = 1e-3, np.array([0.3, 0.9]), np.array([2.0, -5.0])
    first, second = forces_on_links(scene, *state)
    assert [one.kind for one in first] == ["force", "force", "weight"]
    assert [one.kind for one in second] == ["force", "weight", "load"]
    slow_drag = forces_on_links(scene.replace(effects=[DRAG]), *state)[1][-1].force
    # The pivot's speed is part of the wind that the rod feels, so that the drags are of one size.
    assert 0.1 < np.hypot(*second[-1].force) / np.hypot(*slow_drag) < 1e3


def test_free_bodies_name_each_force_and_say_its_size(sol):
    artists = sol.plot("free_bodies", axes(), t=1.0)
    axis = artists[0].axes
    named = dict(text.get_text().split(" = ") for text in axis.texts if "=" in text.get_text())
    assert set(named) == {"$F_{01}$", "$F_{21}$", "$F_{12}$", "$m_{1} g$", "$m_{2} g$"}
    assert named["$F_{21}$"] == named["$F_{12}$"]  # action and reaction
    assert {text.get_text() for text in axis.texts} >= {"1", "2"}
    assert axis.get_title("left") == "t = 1 s"


def test_what_is_past_the_horizon_is_shaded_or_pale():
    chaotic = pc.simulate(BOOK, q0=0.0, t_span=(0, 30))
    until = chaotic.valid_until()
    assert until < 25
    for what, rows in (("angles", 2), ("rates", 2), ("reactions", 2), ("energy", 1)):
        ax = axes(rows)
        chaotic.plot(what, ax, horizon=0.1)
        for axis in ax:
            (shade,) = axis.patches
            assert shade.get_x() == pytest.approx(until)
            assert shade.get_x() + shade.get_width() == pytest.approx(30)
        said = [text.get_text() for text in ax[0].get_legend().get_texts()]
        assert f"not right to 0.1 rad\nafter {until:.4g} s" in said
    for what in ("path", "phase"):
        line = chaotic.plot(what, axes(), horizon=0.1)[0]
        assert len(line.get_xdata()) < 0.95 * len(chaotic.plot(what, axes())[0].get_xdata())
    lines = chaotic.plot("path", axes(), horizon=0.1)[0].axes.lines
    assert [x.get_color() for x in lines if x.get_marker() == "o"] == [LIGHT.lost] * 2
    right = pc.simulate(BOOK, q0=[1.0, 1.0], t_span=(0, 1))
    lines = right.plot(ax=axes(2), horizon=0.1)
    assert not lines[0].axes.patches
    assert "right to 0.1 rad\nto the end" in legend(lines[0].axes)
    assert right.plot(ax=axes(2))[0].axes.get_legend() is None
    for what in ("angles", "phase"):  # of two runs in one figure, it says whose horizon it is
        (ax,) = axes()
        right.plot(what, ax, label="small", horizon=0.1)
        chaotic.plot(what, ax, label="large", horizon=0.1)
        said = [f"large: not right to 0.1 rad\nafter {until:.4g} s"]
        said.append("small: right to 0.1 rad\nto the end")
        assert sorted(x for x in legend(ax) if "rad" in x) == said, what


REFUSED = [
    ({"wat": "rates"}, r"Solution\.plot has no parameter 'wat': did you mean 'what'\?"),
    ({"colour": "r"}, "no parameter 'colour': did you mean 'color'"),
    ({"data": 1}, "no parameter 'data'"),
    ({"what": Figure().subplots()}, "is of type Axes: must name what is drawn; axes are given by"),
    ({"what": "angle"}, r"what = 'angle': did you mean 'angles'\?"),
    ({"what": "angles", "t": 1.0}, "t: belongs to what = 'strip' and 'free_bodies'"),
    ({"what": "path", "link": 2}, "link: belongs to what = 'section'"),
    ({"what": "strip", "horizon": 0.1}, "horizon: belongs to what = 'angles' and"),
    ({"what": "section", "link": 3}, "link = 3: must be 1 to 2"),
    ({"what": "section", "link": 0}, "link = 0: must be 1 to 2"),
    ({"what": "strip", "label": "mine"}, "label: belongs to what = 'angles' and"),
    ({"what": "free_bodies", "lw": 2.0}, "linewidth: what = 'free_bodies' has no lines"),
    ({"what": "free_bodies", "t": [1.0, 2.0]}, "t: 2 times: must be one"),
    ({"what": "section", "event": 1}, "event = 1: must be 0 to 0"),
    ({"what": "free_bodies", "t": 9.0}, "t = 9"),
]


def test_what_a_figure_cannot_show_is_refused(sol):
    for given, message in REFUSED:
        with pytest.raises((ValueError, TypeError), match=message):
            sol.plot(**{"ax": axes()} | given)


def test_poses_are_at_the_kept_times_unless_others_are_asked_for():
    later = pc.simulate(BOOK, q0=[0.8, 1.0], t_span=(0, 5), t_eval=[1.0, 4.5])
    texts = [text.get_text() for text in later.plot("strip", axes())[2::3]]
    assert texts == ["1 s", "1.5 s", "2 s", "2.5 s", "3 s", "3.5 s", "4 s", "4.5 s"]
    assert later.plot("free_bodies", axes())[0].axes.get_title("left") == "t = 1 s"
    assert len(later.plot("strip", axes(), t=[0.3])) == 3


@pytest.mark.few_cases
@pytest.mark.parametrize("what", [kind for kind in KINDS if kind != "section"])
@pytest.mark.parametrize("links", [1, 3])
def test_every_figure_is_drawn_into_a_file(tmp_path, what, links):
    rods = [pc.Link(mass=1.0, length=0.5)] * links
    run = pc.simulate(pc.Scene(links=rods), q0=0.4, t_span=(0, 2))
    save_figure(run, tmp_path / "figure.png", what=what)
    assert (tmp_path / "figure.png").stat().st_size > 5_000
