"""Events refuse what is wrong, print, compare, pickle, and stand in a case file."""

from __future__ import annotations

import copy
import pickle
import re
from itertools import chain
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from pendcore import _core
from pendcore import events as ev
from pendcore.events import *  # noqa: F403  (what a repr is read back with)

BOOK = pc.Scene.textbook()
KEPT = [
    ev.JointAngle(2, 0.1),
    ev.JointAngle(joint=1, value=-3, every_turn=True, direction=-1, terminal=3, name="flip"),
    ev.LinkAngle(1, np.pi / 3, terminal=True),
    ev.LinkAngle(2, 1e-300, direction=1, name='"quoted" \\ é'),
    ev.RateZero(joint=2),
    ev.RateZero(link=1, direction=1),
    ev.TipLine((0.1, 1.5), (1, 0), name="tip"),
    ev.TipLine(point=np.array([0.1, 0.2]), normal=[0, -1e-3], terminal=7),
]


def case_of(*events):
    return pc.Case(scene=BOOK, q0=(0.8, 1.0), t_span=(0, 3), options={"events": events})


@pytest.mark.parametrize("event", KEPT, ids=repr)
def test_an_event_comes_back_from_its_repr_pickle_copy_and_toml(event):
    assert eval(repr(event)) == event
    assert pickle.loads(pickle.dumps(event)) == event
    assert copy.deepcopy(event) == event
    assert hash(event.replace()) == hash(event)
    case = case_of(event, KEPT[0])
    assert pc.read_case(case.to_toml()) == case
    assert eval(repr(case), {**vars(pc), **vars(ev)}) == case
    assert event.replace(name="other") != event


def test_a_repr_shows_what_was_given():
    assert repr(KEPT[4]) == "RateZero(joint=2)"
    shown = "joint=1, value=-3.0, every_turn=True, direction=-1, terminal=3, name='flip'"
    assert repr(KEPT[1]) == f"JointAngle({shown})"


def test_a_solution_keeps_what_was_asked_for_and_found(tmp_path):
    free = [event.replace(terminal=False) for event in KEPT]
    sol = pc.simulate(BOOK, (0, 3), [0.8, 1.0], events=free)
    sol.save(tmp_path / "run.npz")
    pickled = pickle.loads(pickle.dumps(sol))
    for other in (pickled, pc.load(tmp_path / "run.npz"), sol.case().simulate()):
        assert other.case() == sol.case()
        assert other.case().options["events"] == tuple(free)
        assert [len(found) for found in other.events] == [len(found) for found in sol.events]
        for found, same in zip(chain(*sol.events), chain(*other.events), strict=True):
            assert (found.t, found.direction) == (same.t, same.direction)
            assert np.array_equal(found.y, same.y)
            assert found.y_before is found.y_after is same.y_before is same.y_after is None
    found = sol.events[0][0]
    assert np.array_equal(found.y, np.concatenate([found.q, found.qd]))
    assert repr(found) == f"<Found: t = {found.t!r} s, falling>"


def run(events):
    return pc.simulate(BOOK, (0, 1), 1, events=events)


def as_for_scipy(t, q, qd):
    return q[0]


as_for_scipy.terminal = True


BAD: dict[str, Any] = {
    "JointAngle: joint = 0: must be >= 1": lambda: ev.JointAngle(0, 1.0),
    "JointAngle: joint = 1.5: must be a whole": lambda: ev.JointAngle(1.5, 1.0),
    "LinkAngle: value = nan: must be finite": lambda: ev.LinkAngle(1, np.nan),
    "LinkAngle: value = '1': must be a real": lambda: ev.LinkAngle(1, "1"),
    "LinkAngle: every_turn = 1: must be": lambda: ev.LinkAngle(1, 1, every_turn=1),
    "RateZero: needs joint or link, one": ev.RateZero,
    "RateZero: needs joint or link, one of the two": lambda: ev.RateZero(joint=1, link=1),
    "RateZero: joint = -1: must be >= 1": lambda: ev.RateZero(joint=-1),
    "TipLine: normal = (0.0, 0.0): must": lambda: ev.TipLine((0, 0), (0, 0)),
    "TipLine: point[1] = inf: must be": lambda: ev.TipLine((0, np.inf), (0, 1)),
    "TipLine: point: shape (3,): must": lambda: ev.TipLine((0, 1, 2), (0, 1)),
    "Function: f = 'f': must be a function of": lambda: ev.Function("f"),
    "Function: f.terminal = True: is not read": lambda: ev.Function(as_for_scipy),
    "Function: f takes (t, y): must take (t, q, qd)": lambda: ev.Function(lambda t, y: t),
    "Function: samples = 0: must be 1 to": lambda: ev.Function(print, samples=0),
    "Function: max_step = 0.0: must be > 0": lambda: ev.Function(print, max_step=0),
    "RateZero: direction = 2: must be 1": lambda: ev.RateZero(joint=1, direction=2),
    "RateZero: terminal = 0: must be": lambda: ev.RateZero(joint=1, terminal=0),
    "RateZero: terminal = 'k': must": lambda: ev.RateZero(joint=1, terminal="k"),
    "RateZero: name = 'a\\nb': must be": lambda: ev.RateZero(joint=1, name="a\nb"),
    "event 1 (joint_angle): joint = 3: must be 1 to 2": lambda: run([ev.JointAngle(3, 0)]),
    "event 2 (rate_zero, 'x'): link = 3: must be 1 to 2": lambda: run(
        [KEPT[0], ev.RateZero(link=3, name="x")]
    ),
    "must be a list of pendcore.events: put it in brackets": lambda: run(KEPT[0]),
    "events = 3: must be a list of pendcore.events": lambda: run(3),
    "event 1 = LinkAngle: must be a pendcore.events object": lambda: run([ev.LinkAngle]),
    "event 1 = 1: must be a list of pendcore.events": lambda: case_of(1),
    "is a function: give pendcore.events.Function(f)": lambda: run([as_for_scipy]),
}


@pytest.mark.parametrize("message", BAD)
def test_what_is_no_event_is_refused_by_name(message):
    with pytest.raises((ValueError, TypeError), match=re.escape(message)):
        BAD[message]()


FILES = {
    'kind = "joint_angle"\njoint = 1': "line 7: event 1 (joint_angle) needs value",
    "joint = 1": "line 7: event 1 needs kind: joint_angle, link_angle, rate_zero",
    'kind = "joint_angel"': "line 8: kind = 'joint_angel': is no event: did you mean 'join",
    'kind = "function"': "line 8: kind = 'function': is a function, which a file cannot",
    'kind = "link_angle"\nlink = 1\nvalue = "1"': "line 10: event 1 (link_angle): value",
    'kind = "link_angle"\nlink = 0\nvalue = 1': "line 9: event 1 (link_angle): link = 0: must",
    'kind = "link_angle"\nlink = 1\nvalu = 1': "line 10: unknown key 'valu' in [event]: did",
    'kind = "rate_zero"\nlink = 1\nterminal = -2': "line 10: event 1 (rate_zero): terminal =",
    'kind = "rate_zero"\nmass = 1': "unknown key 'mass' in [event]: it belongs in [link]",
}
FILE = "\n[[link]]\nmass = 1\nlength = 1\n[start]\nq = 1\n[[event]]\n{}\n[run]\nt_end = 1\n"


@pytest.mark.parametrize("table", FILES)
def test_what_is_no_event_in_a_file_is_told_with_its_line(table):
    with pytest.raises(ValueError, match=re.escape(FILES[table])):
        pc.read_case(FILE.format(table))


def test_a_file_runs_with_its_events_and_tells_the_line_of_one_that_cannot_be(tmp_path, capsys):
    from pendcore.cli import main

    path = tmp_path / "case.toml"
    path.write_text(FILE.format('kind = "link_angle"\nlink = 1\nvalue = 1.5\nterminal = 1'))
    assert pc.read_case(path).options["events"] == (ev.LinkAngle(1, 1.5, terminal=1),)
    assert main(["run", str(path), "-o", str(tmp_path / "out")]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "stopped at a terminal event (at t = 0.385179" in said
    assert "LinkAngle(link=1, value=1.5, terminal=True): 1 found, t = 0.38518 s" in said
    path.write_text(FILE.format('kind = "link_angle"\nlink = 2\nvalue = 1.5'))
    assert main(["run", str(path), "-o", str(tmp_path / "out")]) == 2
    assert "line 9: event 1 (link_angle): link = 2: must be 1 to 1" in capsys.readouterr().err


DAMAGE: dict[str, Any] = {
    "found_event": [9.0], "found_t": [], "found_direction": [7.0], "found_y": [1.0],
    "found_y_before": [], "resumable_found": 99,
    "events": '[["function", {"f": "print", "samples": 8, "max_step": 1.0}]]',
}  # fmt: skip


@pytest.mark.parametrize("field", DAMAGE)
def test_damaged_events_are_refused(field):
    sol = pc.simulate(BOOK, (0, 1), [0.8, 1.0], events=[ev.LinkAngle(1, 1.0)])
    assert len(sol.events[0]) == 1
    state = sol._run.__getstate__() | {field: DAMAGE[field]}
    with pytest.raises(ValueError, match=r"do not fit together|cannot come from a file"):
        _core.Run.__new__(_core.Run).__setstate__(state)
