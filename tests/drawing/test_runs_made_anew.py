"""A run is made anew for pages, thumbnails and figures where that is needed, and can be had."""

from __future__ import annotations

import json
import re
from functools import partial

import numpy as np
import pendcore as pc
import pytest
from pendcore._run import dense_output
from pendcore.page import html
from runs_that_kept_little import (
    BOTTOM,
    SWINGING,
    TEXTBOOK,
    axes,
    few,
    places,
    simulate,
    stage,
    trace_of,
)


def test_a_page_that_plays_back_has_the_dense_output(monkeypatch):
    monkeypatch.setattr(html, "core_for_browsers", lambda: None)
    for rate, frames in ((0.0, 600), (25.0, 2500)):  # one whenever a link has turned by 0.1 rad
        kept, dense = few(SWINGING, qd0=rate), simulate(SWINGING, qd0=rate)
        played = data_of(kept)["recording"]["moments"]
        assert frames <= len(played["t"]) <= 1.2 * frames
        true = dense(played["t"])
        states = np.hstack([played["q"], played["qd"]]).T
        assert np.abs(states - true).max() <= 1e-5 * np.abs(true).max()


def data_of(run):
    """Return what the page of a run is given."""
    (data,) = re.findall(r'id="data">(.*?)</script>', html.page_of(run), re.DOTALL)
    return json.loads(data)


def test_a_page_ends_where_an_event_ended_the_run():
    run = few(TEXTBOOK, events=[BOTTOM])
    told = data_of(run)["case"]["run"]
    assert told["t_end"] == run._run.t_reached < 10
    assert "t_eval" not in told
    assert data_of(few(TEXTBOOK))["case"]["run"]["t_end"] == 10


def thumbnail(run):
    """Return the tip's path and the poses of a drawing, in pixels, and its title."""
    told = run._repr_html_()
    lines = [
        np.array([pair.split(",") for pair in line.split()], dtype=float)
        for line in re.findall(r"<polyline points='([^']+)'", told)
    ]
    return lines, re.findall(r"<title>(.*)</title>", told)[0]


@pytest.mark.parametrize("keep", [{"store": "end"}, {"t_eval": [0.0, 5.0, 10.0]}, {}])
def test_a_thumbnail_is_the_dense_output(keep):
    run = simulate(SWINGING, **keep)
    (path, *poses), title = thumbnail(run)
    assert title == "the chain at 6 times, the last of them plainest, and the path of its tip"
    assert len(poses) == 6
    length = np.hypot(*(poses[0][1] - poses[0][0]))
    assert np.hypot(*(path - poses[0][0]).T) == pytest.approx(length, abs=0.2)
    true = places(simulate(SWINGING), np.linspace(0, 10, 6))
    for pose, place in zip(poses, true, strict=True):
        assert pose[1] - pose[0] == pytest.approx(length * (place[1] - place[0]), abs=0.2)


class Counted:
    """A law that counts its calls."""

    calls = 0

    def __call__(self, t, q, qd):
        self.calls += 1
        return -0.1 * qd


def test_a_notebook_waits_for_no_long_second_run_and_calls_no_function_of_ones_own():
    law = Counted()
    own = simulate(SWINGING.replace(effects=[pc.effects.User(law)]), store="end")
    long = simulate(SWINGING, store="end", t_span=(0, 400), method="dopri5", rtol=1e-12)
    before = law.calls
    for run in (own, long):
        lines, title = thumbnail(run)
        assert len(lines) == 1
        assert title == "the chain at one time"
    assert law.calls == before


def test_times_that_were_kept_close_together_are_drawn_without_a_second_run():
    law, t = Counted(), np.linspace(0, 10, 3001)
    run = simulate(SWINGING.replace(effects=[pc.effects.User(law)]), t_eval=t)
    before = law.calls
    assert np.array_equal(run.plot(ax=axes(1))[0].get_xdata(), t)
    assert law.calls == before


@pytest.mark.parametrize("store", ["dense", "end"])
def test_chords_are_not_seen_where_links_are_fast(store):
    """At 48 rad/s, over more steps than a figure has points."""
    run = simulate(SWINGING, qd0=48.0, t_span=(0, 60), method="taylor", store=store)
    assert run.stats.accepted > 1000
    for what in ("phase", "path"):
        assert len(run.plot(what, axes())[0].get_xdata()) > 60 * 48 / 0.05
    (path, *_), title = thumbnail(run)
    assert re.search(r"the path of its tip in the last [0-9.]+ s$", title)
    center = (path.min(axis=0) + path.max(axis=0)) / 2
    radius = np.hypot(*(path - center).T).max()
    middles = np.hypot(*((path[1:] + path[:-1]) / 2 - center).T)
    assert middles.min() > 0.99 * radius - 0.2
    trace = trace_of(stage(run, trace=1.0), 60)
    assert np.hypot(*((trace[1:] + trace[:-1]) / 2).T).min() > 0.99


def test_a_swing_kept_where_it_turns_is_not_taken_for_rest():
    turn = pc.events.RateZero(link=1)
    turns = simulate(SWINGING, events=[turn]).events[0].t[1::2]
    kept = simulate(SWINGING, t_eval=turns)
    assert np.ptp(kept.q) < 1e-6
    assert np.ptp(kept.plot(ax=axes(1))[0].get_ydata()) > 100  # deg


SENTENCE = r"^t: this solution keeps no dense output: simulate with store=\"dense\"; "


def test_a_run_that_cannot_be_had_again_is_refused_in_the_words_of_its_call(tmp_path):
    damping = [0.1]
    moody = pc.effects.User(function=lambda t, q, qd: -damping[0] * qd)
    run = simulate(SWINGING.replace(effects=[moody]), t_eval=[0.0, 5.0, 10.0])
    damping[0] = 0.2
    figures = ("angles", "rates", "reactions", "energy", "path", "phase", "strip")
    for draw in (
        *(partial(run.plot, what, axes(1)) for what in figures),
        partial(run.plot, "free_bodies", axes(1), t=0.5),
        partial(run.to_video, tmp_path / "run.gif"),
        run.animate,
    ):
        with pytest.raises(ValueError, match=SENTENCE + "simulated anew .* takes another course"):
            draw()
    with pytest.raises(ValueError, match="keeps no dense output") as refused:
        run(0.5)
    with pytest.raises(ValueError, match=re.escape(str(refused.value))):
        html.page_of(run)
    assert not [*tmp_path.iterdir()]


def test_an_archive_of_other_bits_is_refused_and_not_drawn_as_something_else(tmp_path):
    run = few(TEXTBOOK)
    run.save(tmp_path / "run.npz")
    with np.load(tmp_path / "run.npz") as file:
        entries = dict(file)
    entries["run.states"] = np.nextafter(entries["run.states"], np.inf)
    np.savez(tmp_path / "run.npz", **entries)
    other = pc.load(tmp_path / "run.npz")
    with pytest.raises(ValueError, match=SENTENCE + ".*another version of pendcore made it"):
        other.plot(ax=axes(2))
    assert "the path of its tip" not in other._repr_html_()


def test_a_dense_output_that_no_memory_holds_is_refused(monkeypatch):
    run = simulate(TEXTBOOK, store="end")
    needed = 8 * run.stats.accepted * 4 * (simulate(TEXTBOOK)._run.dense_degree + 1)
    monkeypatch.setattr(dense_output, "MOST_BYTES", needed - 1)
    with pytest.raises(ValueError, match=SENTENCE + "made anew, .* GiB: must be at most"):
        run.plot(ax=axes(2))
    monkeypatch.setattr(dense_output, "MOST_BYTES", needed)
    run.plot(ax=axes(2))


def test_an_exception_of_ones_own_function_passes_without_the_inner_run():
    mass = [1.0]
    pull = pc.effects.User(function=lambda t, q, qd: -0.1 / mass[0] * qd)
    run = simulate(SWINGING.replace(effects=[pull]), store="end")
    mass[0] = 0.0
    with pytest.raises(ZeroDivisionError) as stop:
        run.plot(ax=axes(1))
    assert not hasattr(stop.value, "solution")
