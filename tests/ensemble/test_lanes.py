"""Members in lanes have the bits of `pc.simulate`, whatever happens in the lanes beside."""

from __future__ import annotations

import numpy as np
import pendcore as pc
import pytest
from members_and_runs import (
    ALL,
    BOOK,
    EFFECTS,
    assert_runs,
    chain,
    has_lanes,
    lanes_of,
    starts,
)

METHODS = ["dopri5", "dop853", "taylor", "dopri5-radau5", "dop853-radau5", "taylor-radau5"]
LIGHT = pc.Scene(links=[pc.Link(mass=1e-3, length=1.0), pc.Link(mass=1.0, length=0.01)])


def long_chain(n):
    return pc.Scene(links=[pc.Link(mass=0.1, length=0.1)] * n)


@pytest.mark.few_cases
@pytest.mark.parametrize("name", ALL)
def test_scenes_have_lanes_up_to_100_links_unless_they_switch(name):
    for n in (1, 2, 3, 4, 5, 9):
        told, lanes = chain(n, name).explain(), lanes_of(n, name)
        assert told.lanes == (lanes if has_lanes() else ())
        assert told.to_dict()["lanes"] == list(told.lanes)
        if not lanes:
            assert "runs its members one by one" in str(told)


def test_which_methods_have_lanes_is_told():
    for n in (100, 101):
        assert long_chain(n).explain().lanes == (("taylor",) if n == 100 and has_lanes() else ())
    if has_lanes():
        book, five = (" ".join(str(one.explain()).split()) for one in (BOOK, chain(5)))
        assert "a lane each, by dopri5, dop853 or taylor; one by one with ev" in book
        assert "and for the drift of energy with losses" in book
        assert "a lane each, by taylor; one by one" in five


@pytest.mark.few_cases
@pytest.mark.every_value("name", "n")
@pytest.mark.parametrize("rtol", [1e-2, 1e-3, 1e-7, 1e-12])
@pytest.mark.parametrize("n", [1, 2, 3, 4, 5, 8, 9])
@pytest.mark.parametrize("name", EFFECTS)
def test_members_in_lanes_are_single_runs(name, n, rtol):
    lanes = lanes_of(n, name)
    scene = chain(n, name)
    q0, qd0 = starts(21, n, 2, np.pi), starts(21, n, 3, 9.0 if n == 2 else 4.0)
    q0[5], qd0[5] = 0.0, 0.0
    for method in [*lanes, *(f"{method}-radau5" for method in lanes), "auto"]:
        how = {"method": method, "rtol": rtol, "atol": rtol / 10}
        assert assert_runs(scene, q0, qd0, (0.3, 2.3), **how).success.all()
        assert_runs(scene, q0, qd0, (1.0, -0.5), **how, max_steps=11)
        # Steps so small look whether the equations are stiff.
        assert_runs(scene, q0[:3], qd0[:3], (0.0, 1.0), **how, max_step=0.007)


@pytest.mark.parametrize("n", [33, 100, 101])
def test_members_of_long_chains_are_single_runs(n):
    ends = (0, 0.2 if n <= 100 else 0.05)
    found = assert_runs(long_chain(n), starts(11, n, 2, 0.5), 0.0, ends, method="taylor", rtol=1e-6)
    assert found.success.all()


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    "options",
    [
        {"max_step": 0.01}, {"max_steps": 57}, {"max_steps": 1},
        {"rtol": [1e-5, 1e-7, 1e-4, 1e-6], "atol": [1e-9, 1e-6, 1e-8, 0.0]},
    ],
    ids=lambda options: next(iter(options)),
)  # fmt: skip
def test_options_and_a_backward_run(method, options):
    for t_span in ((0.0, 2.0), (5.0, 3.5), (1e6, 1e6 + 1)):
        assert_runs(BOOK, starts(13, 2, 4, 2.0), 0.1, t_span, method=method, **options)


@pytest.mark.parametrize("times", [None, np.linspace(0, 1, 5)], ids=["end", "times"])
@pytest.mark.parametrize("rtol", [1e-3, 1e-9])
@pytest.mark.parametrize("method", METHODS)
def test_what_is_odd_beside_what_is_usual(method, rtol, times):
    q0, qd0 = starts(13, 2, 5, 2.0), np.full((13, 2), 0.3)
    q0[1] = np.nan
    q0[3], qd0[3] = np.pi / 2, 0.0  # rests
    qd0[4] = 1e160  # not finite at once
    qd0[5] = 1e4  # fast
    qd0[8] = [1e9, -1e9]  # so fast that its first step is odd
    q0[6] = 1e300  # far
    qd0[7] = -0.0
    how = {"method": method, "rtol": rtol, "max_steps": 20_000 if rtol == 1e-9 else 300}
    found = assert_runs(BOOK, q0, qd0, (0, 1), times=times, **how)
    assert {"finished", "refused"} < set(found.counts())


@pytest.mark.parametrize("method", METHODS)
def test_a_stiff_looking_member_among_others(method):
    qd0 = np.zeros((9, 2))
    qd0[4] = (0.0, 300.0)
    assert_runs(LIGHT, [0.3, 0.2], qd0, (0, 2), method=method, rtol=1e-3, atol=1e-2)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("count", [0, 1, 2, 3, 5, 9])
def test_few_members_which_finish_alone(count, method):
    q0 = starts(count, 2, 10 + count, 2.0)
    assert_runs(BOOK, q0, 0.3, (0, 3), method=method, rtol=1e-6, max_steps=150)
    assert_runs(BOOK, q0, 0.3, (3, 0), method=method, rtol=1e-10)
    assert_runs(BOOK, q0, 0.3, (0, 4), method=method, times=np.linspace(0, 4, 17))
    assert_runs(BOOK, q0, 0.3, (0, 0), method=method)
    event = pc.events.LinkAngle(2, 0.5, terminal=2)
    gravity = {"gravity": np.linspace(9.0, 10.0, count)}
    assert_runs(BOOK, q0, method=method, vary=gravity, events=[event])


LINKS = ["link[1].mass", "link[1].length", "gravity"]
VARIED = {  # links, effects, methods, and the parameters that differ from lane to lane
    "links": (2, "bare", METHODS, [*LINKS[:2], "link[2].length"]),
    "waves of one": (
        1, "two shaken pivots and two motors", METHODS[:2],
        ["effect[1].sinusoid.amplitude", "effect[2].y.amplitude"],
    ),
    "waves of two": (
        2, "waves and damping", ["dop853", "taylor"],
        ["effect[1].sinusoid.amplitude", "effect[2].sinusoid.angular_frequency",
         "effect[3].damping"],
    ),
    "a wave of three": (3, "waves and damping", ["taylor"], ["effect[2].sinusoid.amplitude"]),
    "a wave of four": (4, "waves and damping", ["taylor"], ["effect[2].sinusoid.amplitude"]),
    "a pivot of two": (
        2, "shaken along x", ["taylor"], ["effect[1].x.amplitude", "effect[1].x.angular_frequency"],
    ),
    "a pivot of nine": (9, "shaken along x", ["taylor"], ["effect[1].x.amplitude"]),
    "a cube": (
        5, "a spring and the cube of a rate", ["taylor"],
        ["effect[1].stiffness", "effect[2].damping3"],
    ),
    "a rotor": (6, "a rotor between links", ["taylor"], ["effect[1].armature"]),
    "three waves": (
        5, "three waves", ["taylor"],
        ["effect[3].sinusoid.amplitude", "effect[1].sinusoid.phase"],
    ),
    "a limit": (2, "a motor at its limit", ["dopri5", "taylor"], ["effect[1].limit"]),
    **{
        f"{what}, {n} links": (n, effects, METHODS[:2], names)
        for n in (1, 2, 3, 4)
        for what, effects, names in [
            ("wind", "drag and wind, a motor and damping", [
                "effect[1].diameter", "effect[1].wind.x", "effect[1].air_density",
                "effect[2].sinusoid.amplitude", "effect[4].damping",
            ]),
            ("drag", "drag, rotors and damping", [
                "effect[1].armature", f"effect[{n + 1}].drag_coefficient",
            ]),
        ]
    },
}  # fmt: skip


@pytest.mark.parametrize("name", VARIED)
def test_parameters_differ_from_lane_to_lane(name):
    """A wave or a drag of 0 gives its member other equations: it runs alone."""
    n, effects, methods, names = VARIED[name]
    names = [*LINKS, *(each for each in names if each not in LINKS)]
    values = pc.sampling.uniform(0.5, 2.0, (21, len(names)), seed=6)
    if name == "a limit":
        values[::3, 3] = 9.0  # which is not reached
    else:
        values[4, 3] = values[7, -1] = 0.0
        values[9, 0] = -1.0  # which is not allowed
    vary = {each: values[:, k] for k, each in enumerate(names)}
    for method in methods:
        start = np.linspace(0.4, 1.2, n)
        found = assert_runs(chain(n, effects), start, method=method, vary=vary)
        assert ("refused" in found.counts()) == (name != "a limit")


def test_stiffness_is_that_of_the_member_of_the_lane():
    """A stiff member among others, whose equations were made after its own."""
    scene = BOOK.replace(effects=[pc.effects.ViscousJoint(joint=2, damping=0.1)])
    damping = np.tile([200.0, 60.0, 0.1, 0.2, 0.3, 0.4, 0.5], 6)
    vary = {"effect[1].damping": damping}
    assert_runs(scene, [0.5, 1.0], 0.0, (0, 20), vary=vary, method="taylor-radau5")


def test_a_heavy_payload_on_light_links_agrees_with_another_method():
    """The factors of the inverse lose nothing where the links are light."""
    light = [pc.Link(mass=1e-3, length=1.0)] * 3
    scene = pc.Scene(links=light, gravity=9.807, effects=[pc.effects.Payload(mass=10.0)])
    ends = [
        pc.simulate(scene, q0=[0.3, 0.9, -0.2], t_span=(0, 2), method=m, rtol=1e-13, atol=1e-13).q[
            -1
        ]
        for m in ("taylor", "dop853")
    ]
    np.testing.assert_allclose(*ends, rtol=0, atol=5e-10)
