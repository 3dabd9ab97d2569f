"""Members in lanes have the bits of `pc.simulate`, whatever happens in the lanes beside."""

from __future__ import annotations

import os
import subprocess
import sys

import numpy as np
import pendcore as pc
import pytest

BOOK = pc.Scene.textbook()
METHODS = ["dopri5", "dop853", "taylor", "dopri5-radau5", "dop853-radau5", "taylor-radau5"]
LIGHT = pc.Scene(links=[pc.Link(mass=1e-3, length=1.0), pc.Link(mass=1.0, length=0.01)])


def assert_same(scene, q0, qd0, t_span, **options):
    """Assert that every member is the run of `simulate`; return the ensemble.

    With one thread, lanes are full whatever the number of processors.
    """
    options = {"workers": 1} | options
    found = pc.ensemble(scene, q0=q0, qd0=qd0, t_span=t_span, on_failure="ignore", **options)
    evaluations = 0
    q, qd = (np.broadcast_to(x, (*found.shape, len(scene.links))) for x in (q0, qd0))
    for i in np.ndindex(found.shape):
        options.pop("workers", None)
        if found.status[i] == "refused":
            with pytest.raises(ValueError, match="must be"):
                pc.simulate(scene, q0=q[i], qd0=qd[i], t_span=t_span, **options)
            continue
        alone = pc.simulate(
            scene, q0=q[i], qd0=qd[i], t_span=t_span, on_failure="ignore", store="end", **options
        )
        evaluations += alone.stats.nfev
        assert found.status[i] == alone.status, i
        assert found.t[i] == alone.t[-1], i
        assert np.array_equal([*found.q[i], *found.qd[i]], alone.y[:, -1], equal_nan=True), i
    assert found.statistics["nfev"] == evaluations
    return found


@pytest.mark.parametrize("rtol", [1e-2, 1e-5, 1e-8, 1e-12])
@pytest.mark.parametrize("method", METHODS)
def test_starts_over_the_whole_circle(method, rtol):
    q0 = pc.sampling.uniform(-np.pi, np.pi, (41, 2), seed=2)
    qd0 = pc.sampling.uniform(-9.0, 9.0, (41, 2), seed=3)
    found = assert_same(BOOK, q0, qd0, (0, 3), method=method, rtol=rtol, atol=rtol / 10)
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
    q0 = pc.sampling.uniform(-2.0, 2.0, (13, 2), seed=4)
    for t_span in ((0.0, 2.0), (5.0, 3.5), (1e6, 1e6 + 1)):
        assert_same(BOOK, q0, 0.1, t_span, method=method, **options)


@pytest.mark.parametrize("method", METHODS)
def test_what_is_odd_beside_what_is_usual(method):
    q0 = pc.sampling.uniform(-2.0, 2.0, (12, 2), seed=5)
    qd0 = np.zeros((12, 2))
    q0[1] = np.nan
    q0[3] = np.pi / 2  # rests
    qd0[4] = 1e160  # not finite at once
    qd0[5] = 1e4  # fast
    q0[6] = 1e300  # far
    qd0[7] = -0.0
    found = assert_same(BOOK, q0, qd0, (0, 1), method=method, max_steps=20_000)
    assert {"finished", "refused"} < set(found.counts())


@pytest.mark.parametrize("method", METHODS)
def test_a_stiff_looking_member_among_others(method):
    qd0 = np.zeros((9, 2))
    qd0[4] = (0.0, 300.0)
    assert_same(LIGHT, [0.3, 0.2], qd0, (0, 2), method=method, rtol=1e-3, atol=1e-2)


@pytest.mark.parametrize("method", METHODS)
def test_parameters_differ_from_lane_to_lane(method):
    values = pc.sampling.uniform(0.5, 2.0, (11, 3), seed=6)
    vary = {
        name: values[:, k] for k, name in enumerate(["link[1].mass", "link[2].length", "gravity"])
    }
    found = pc.ensemble(BOOK, q0=[0.5, 1.0], t_span=(0, 3), vary=vary, method=method)
    for i in range(11):
        scene = BOOK.with_parameters({name: x[i] for name, x in vary.items()})
        alone = pc.simulate(scene, q0=[0.5, 1.0], t_span=(0, 3), method=method)
        assert np.array_equal(found.q[i], alone.q[-1])


SAME = """
import hashlib, numpy as np, pendcore as pc
q0 = pc.sampling.uniform(-np.pi, np.pi, (200, 2), seed=7)
for method in {methods}:
    for rtol in (1e-3, 1e-9):
        found = pc.ensemble(pc.Scene.textbook(), (0, 5), q0, 0.5, method=method, rtol=rtol,
                            workers={workers})
        print(hashlib.sha256(found.q.tobytes() + found.qd.tobytes()).hexdigest())
"""


def test_every_instruction_set_and_number_of_workers_gives_the_same_bits():
    def printed(instruction_set, workers):
        return subprocess.run(
            [sys.executable, "-c", SAME.format(methods=METHODS[:3], workers=workers)],
            env=os.environ | {"PENDCORE_INSTRUCTION_SET": instruction_set},
            capture_output=True, text=True, check=True,
        ).stdout  # fmt: skip

    reference = printed("baseline", 1)  # one by one
    assert len(set(reference.split())) == 6
    for instruction_set in ("x86-64-v3", "x86-64-v4"):
        for workers in (1, 2, 5):
            assert printed(instruction_set, workers) == reference


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("count", [1, 2, 3, 5, 9])
def test_few_members_which_finish_alone(count, method):
    q0 = pc.sampling.uniform(-2.0, 2.0, (count, 2), seed=10 + count)
    assert_same(BOOK, q0, 0.3, (0, 3), method=method, rtol=1e-6, max_steps=150)
    assert_same(BOOK, q0, 0.3, (3, 0), method=method, rtol=1e-10)
    gravity = np.linspace(9.0, 10.0, count)
    event = pc.events.LinkAngle(2, 0.5, terminal=2)
    found = pc.ensemble(
        BOOK, q0=q0, t_span=(0, 3), method=method, vary={"gravity": gravity}, events=[event]
    )
    for i in range(count):
        scene = BOOK.replace(gravity=gravity[i])
        alone = pc.simulate(scene, q0=q0[i], t_span=(0, 3), method=method, events=[event])
        assert (found.status[i], found.t[i]) == (alone.status, alone.t[-1])
        assert np.array_equal(found.q[i], alone.q[-1])


def test_a_single_member_and_none():
    assert_same(BOOK, np.array([[0.5, 1.0]]), 0.0, (0, 2), method="dopri5")
    assert pc.ensemble(BOOK, q0=np.zeros((0, 2)), t_span=(0, 2), method="dopri5").q.shape == (0, 2)
    assert pc.ensemble(BOOK, q0=np.zeros((3, 2)), t_span=(0, 0), method="dop853").success.all()


EVENTS = {
    "turns": pc.events.LinkAngle(2, -np.pi / 2, every_turn=True),
    "joint": pc.events.JointAngle(2, 0.0, direction=-1),
    "rate": pc.events.RateZero(link=1),
    "joint rate": pc.events.RateZero(joint=2, direction=1),
    "level": pc.events.LinkAngle(1, 0.4),
    "tip": pc.events.TipLine(point=(0.3, 0.5), normal=(1.0, 0.2)),
}


@pytest.mark.parametrize("method", ["dopri5", "dop853", "taylor", "auto"])
@pytest.mark.parametrize("rtol", [1e-3, 1e-10])
@pytest.mark.parametrize("terminal", [False, True, 3])
@pytest.mark.parametrize("name", EVENTS)
def test_first_events_are_those_of_simulate(name, terminal, rtol, method):
    event = EVENTS[name].replace(terminal=terminal)
    q0 = pc.sampling.uniform(-3.0, 3.0, (23, 2), seed=8)
    q0[3, 0] = 0.4  # begins at a level
    how = {"method": method, "rtol": rtol, "atol": rtol}
    for t_span in ((0, 4), (1e5, 1e5 - 3)):
        found = pc.ensemble(
            BOOK,
            q0=q0,
            qd0=0.25,
            t_span=t_span,
            keep=pc.reducers.FirstEvent(event),
            workers=1,
            **how,
        )
        evaluations = 0
        for i, start in enumerate(q0):
            alone = pc.simulate(
                BOOK, q0=start, qd0=0.25, t_span=t_span, store="end", events=[event], **how
            )
            evaluations += alone.stats.nfev
            first = alone.events[0].t[:1]
            assert np.array_equal(found["first_event"][i : i + 1][: len(first)], first)
            assert len(first) or np.isnan(found["first_event"][i])
            assert found.status[i] == alone.status
            assert (found.t[i], *found.q[i], *found.qd[i]) == (alone.t[-1], *alone.y[:, -1])
        assert found.statistics["nfev"] == evaluations


def test_several_events_of_which_one_ends_the_run():
    events = [EVENTS["rate"], EVENTS["joint"].replace(terminal=True)]
    q0 = pc.sampling.uniform(-3.0, 3.0, (23, 2), seed=9)
    keep = {
        "turns": pc.reducers.FirstEvent(EVENTS["turns"]),
        "rate": pc.reducers.FirstEvent(EVENTS["rate"]),
    }
    found = pc.ensemble(BOOK, q0=q0, t_span=(0, 6), events=events, keep=keep)
    for i, start in enumerate(q0):
        alone = pc.simulate(BOOK, q0=start, t_span=(0, 6), events=[*events, EVENTS["turns"]])
        for name, which in (("turns", 2), ("rate", 0)):
            first = alone.events[which].t[:1]
            assert np.array_equal(found[name][i : i + 1][: len(first)], first)
        assert (found.status[i], found.t[i]) == (alone.status, alone.t[-1])


TIP = pc.events.TipLine(point=(0.3, 0.5), normal=(1.0, 0.2))


@pytest.mark.parametrize("method", ["dopri5", "dop853", "taylor"])
def test_events_of_members_with_lengths_of_their_own(method):
    """Where the tip is depends on the lengths."""
    q0 = pc.sampling.uniform(-3.0, 3.0, (19, 2), seed=10)
    length = pc.sampling.uniform(0.5, 1.5, 19, seed=11)
    found = pc.ensemble(
        BOOK, q0=q0, t_span=(0, 3), vary={"link[2].length": length}, method=method,
        keep=pc.reducers.FirstEvent(TIP), workers=1,
    )  # fmt: skip
    for i, start in enumerate(q0):
        scene = BOOK.replace(links=[BOOK.links[0], BOOK.links[1].replace(length=length[i])])
        alone = pc.simulate(scene, q0=start, t_span=(0, 3), method=method, events=[TIP])
        first = alone.events[0].t[:1]
        assert np.array_equal(found["first_event"][i : i + 1][: len(first)], first)
        assert np.array_equal(found.q[i], alone.q[-1])
