"""Films show the run in true time; files are whole, of the size asked for, and stop at Ctrl-C."""

from __future__ import annotations

import json
import shutil
import subprocess
from itertools import combinations

import matplotlib.pyplot as plt
import numpy as np
import pendcore as pc
import pytest
from matplotlib.text import Text
from pendcore.cli import main
from pendcore.plotting import LIGHT, video
from pendcore.plotting.frames import frame_times, moves_of
from PIL import Image
from runs_that_kept_little import chain_of, stage, trace_of

SMALL = {"size": (160, 90), "fps": 10}


@pytest.fixture(scope="module")
def sol():
    return pc.simulate(pc.Scene.textbook(), q0=[0.8, 1.0], t_span=(0, 2))


@pytest.mark.parametrize(
    ("speed", "fps", "span"),
    [(1.0, 30.0, (0, 2)), (0.5, 25.0, (0, 2)), (3.0, 60.0, (0, 2)), (1.0, 30.0, (2, 0))],
)
def test_a_frame_is_shown_for_as_long_as_the_motion_takes(speed, fps, span):
    run = pc.simulate(pc.Scene.textbook(), span, 0.8)
    times = frame_times([run], fps, speed)
    begin, end = span
    assert np.diff(times) == pytest.approx(np.sign(end - begin) * speed / fps)
    assert times[0] == begin
    assert 2.0 - speed / fps < abs(times[-1] - begin) <= 2.0 + 1e-12


def test_two_runs_last_as_long_as_the_longer_one(sol):
    longer = pc.simulate(sol.scene, q0=1.0, t_span=(0, 3))
    film = stage(sol, longer)
    assert len(film.times) == 91
    assert np.array_equal(
        chain_of(film, 80), chain_of(film, 90)
    )  # the shorter one stays where it ends


@pytest.mark.parametrize(
    ("count", "given", "panels"),
    [
        (2, {}, ["$q_{2}$ (deg)"]),
        (2, {"beside": True}, []),
        (1, {}, ["$q_{1}$ (deg)", "$q_{2}$ (deg)"]),
        (1, {"energy": True, "reactions": True}, ["energy (J)", "force (N)"]),
        (1, {"size": (4.0, 4.0)}, []),
        (1, {"size": (4.0, 6.0), "energy": True}, ["energy (J)"]),
    ],
)
def test_several_runs_and_energies_have_their_axes_and_nothing_leaves_the_picture(
    sol, count, given, panels
):
    film = stage(*[sol] * count, **given)
    scenes = [one for one in film.figure.axes if one.get_aspect() == 1.0]
    assert [one.get_ylabel() for one in film.figure.axes if one not in scenes] == panels
    assert len(scenes) == (count if given.get("beside") else 1)
    places = moves_of(sol, film.times).places.reshape(-1, 2)
    for axis in scenes:
        assert axis.get_xlim()[0] < places[:, 0].min() <= places[:, 0].max() < axis.get_xlim()[1]
        low, high = sorted(axis.get_ylim())
        assert low < places[:, 1].min() <= places[:, 1].max() < high
        assert axis.yaxis_inverted()


def test_arrows_neither_vanish_nor_leave_the_picture(sol):
    """Free fall has no forces to show; a peak is no reason to hide all others."""
    fast = pc.simulate(sol.scene, (0, 5), [-0.3, -0.8])
    film = stage(fast, reactions=True)
    forces, lengths = [], []
    for k in range(len(film.times)):
        arrows = film.show(k)[4]
        lengths += [*np.hypot(arrows.U, arrows.V)]
        forces += [*np.hypot(*moves_of(fast, film.times).reactions[k].T)]
    assert max(forces) > 1.3 * np.percentile(forces, 95) > 20 * min(forces)
    assert min(lengths) == pytest.approx(0.14 * 2)
    assert max(lengths) == pytest.approx(0.4 * 2)
    assert np.mean(np.array(lengths) > 0.39 * 2) == pytest.approx(0.05, abs=0.01)


@pytest.mark.parametrize("span", [(5, 7), (7, 5), (-7, -5)])
def test_the_curves_of_a_film_have_the_times_of_the_run(sol, span):
    film = stage(pc.simulate(sol.scene, span, 0.8), energy=True)
    (curves,) = [one for one in film.figure.axes if one.get_ylabel() == "energy (J)"]
    assert sorted(curves.get_xlim()) == sorted(span)


def test_no_text_of_a_film_is_cut_off(sol):
    fast = pc.simulate(sol.scene, (0, 5), [-0.3, -0.8])
    for given in ({"reactions": True}, {"reactions": True, "beside": True}, {"energy": True}):
        film = stage(*[fast] * (1 + ("beside" in given)), **given)
        film.figure.canvas.draw()
        for k in range(0, len(film.times), 10):
            for text in film.show(k):
                if isinstance(text, Text) and text.get_text():
                    box = text.get_window_extent()
                    assert (box.min >= -1).all(), (given, k, text)
                    assert (box.max <= film.figure.bbox.max + 1).all(), (given, k, text)


def test_forces_are_written_off_the_rods_where_there_is_room(sol):
    fast = pc.simulate(sol.scene, (0, 5), [-0.3, -0.8])
    film = stage(fast, reactions=True)
    film.figure.canvas.draw()
    lies_on_a_rod = []
    for k in range(0, len(film.times), 10):
        ends = fast.scene.positions(film.times[k], fast(film.times[k])[:2])
        for text in film.show(k):
            if isinstance(text, Text) and text.get_text().endswith(" N") and text.get_visible():
                rods = np.linspace(ends[:-1], ends[1:], 30).reshape(-1, 2)
                box, places = text.get_window_extent(), text.axes.transData.transform(rods)
                lies_on_a_rod.append(any(box.contains(x, y) for x, y in places))
    assert len(lies_on_a_rod) > 30
    assert np.mean(lies_on_a_rod) < 0.1


def test_names_stand_beside_their_tips_and_not_on_each_other(sol):
    film = stage(sol, sol, sol, names=("one", "two", "three"))
    texts = [x for x in film.show(20) if isinstance(x, Text)][:3]
    film.figure.canvas.draw()
    boxes = [text.get_window_extent() for text in texts]
    assert [text.get_text() for text in texts] == ["one", "two", "three"]
    assert not any(one.overlaps(other) for one, other in combinations(boxes, 2))
    stage_box = texts[0].axes.get_window_extent()
    assert all(stage_box.containsx(box.x0) and stage_box.containsx(box.x1) for box in boxes)


def test_the_whole_path_can_be_shown(sol):
    trace = trace_of(stage(sol, trace=np.inf), 60)
    assert trace[0] == pytest.approx(sol.positions()[0, -1])
    assert trace[-1] == pytest.approx(sol.positions()[-1, -1])
    assert np.hypot(*np.diff(trace, axis=0).T).max() < 0.01


def test_a_run_is_pale_past_its_horizon():
    chaotic = pc.simulate(pc.Scene.textbook(), q0=0.0, t_span=(0, 30))
    film = stage(chaotic, horizon=0.1)
    until = chaotic.valid_until()
    right, wrong = (int(np.searchsorted(film.times, until)) + k for k in (-2, 2))
    assert film.show(right)[1].get_color() == LIGHT.red
    assert film.show(wrong)[1].get_color() == LIGHT.lost
    said = [text.get_text() for text in film.figure.subfigs[0].axes[0].texts]
    assert f"right to 0.1 rad until {until:.4g} s" in said
    fast = stage(chaotic, chaotic, horizon=0.1, speed=4).figure.subfigs[0].axes[0]
    told = f"4 \N{MULTIPLICATION SIGN} real time\nall right to 0.1 rad until {until:.4g} s"
    assert told in [text.get_text() for text in fast.texts]
    short = pc.simulate(pc.Scene.textbook(), q0=1.0, t_span=(0, 1))
    beside = stage(short, horizon=0.1).figure.subfigs[0].axes[0]
    assert "right to 0.1 rad to the end" in [text.get_text() for text in beside.texts]


def test_a_gif_has_the_frames_the_size_the_time_and_the_chain(sol, tmp_path):
    """The last picture differs from the first where the chain was, and nowhere else."""
    file = sol.to_video(tmp_path / "swing.gif", fps=2, trace=None)
    total, pictures = 0.0, []
    with Image.open(file) as gif:
        assert gif.size == (640, 360)
        for k in range(getattr(gif, "n_frames")):  # noqa: B009  Pillow's types lack it
            gif.seek(k)
            total += gif.info["duration"]
            pictures.append(np.asarray(gif.convert("L"), dtype=float))
    assert total == pytest.approx(1000 * 5 / 2, abs=10)
    assert 0.002 < (np.abs(pictures[0] - pictures[-1]) > 60).mean() < 0.08
    assert file.stat().st_size < 3_000_000


needs_ffmpeg = pytest.mark.skipif(video._ffmpeg() is None, reason="ffmpeg is missing")


@needs_ffmpeg
def test_an_mp4_has_the_frames_the_size_and_the_time(sol, tmp_path):
    shown = {"size": (640, 480), "fps": 10, "reactions": True, "energy": True}
    file = sol.to_video(tmp_path / "swing.mp4", **shown)
    assert file == tmp_path / "swing.mp4"
    probe = shutil.which("ffprobe")
    if probe is None:
        pytest.skip("ffprobe is missing")
    entries = "stream=width,height,nb_frames,r_frame_rate,codec_name,pix_fmt"
    command = [probe, "-v", "error", "-show_entries", entries, "-of", "json", file]
    told = subprocess.run(command, capture_output=True, check=True, text=True)
    (stream,) = json.loads(told.stdout)["streams"]
    assert stream == {
        "codec_name": "h264", "width": 640, "height": 480, "pix_fmt": "yuv420p",
        "r_frame_rate": "10/1", "nb_frames": "21",
    }  # fmt: skip


def test_without_ffmpeg_a_gif_is_written_and_a_sentence_says_so(sol, tmp_path, monkeypatch):
    monkeypatch.setattr(video, "_ffmpeg", lambda: None)
    with pytest.warns(pc.PendcoreWarning, match=r"ffmpeg is not installed.*swing.gif is written"):
        file = sol.to_video(tmp_path / "swing.mp4", **SMALL)
    assert [file] == [*tmp_path.iterdir()]


@needs_ffmpeg
def test_what_ffmpeg_complains_of_is_told(sol, tmp_path, monkeypatch):
    monkeypatch.setattr(video, "_ffmpeg", lambda: shutil.which("false"))
    with pytest.raises(RuntimeError, match="ffmpeg ended with 1"):
        sol.to_video(tmp_path / "swing.mp4", **SMALL)
    assert not [*tmp_path.iterdir()]


@pytest.mark.parametrize("suffix", ["gif", pytest.param("mp4", marks=needs_ffmpeg)])
def test_a_film_that_is_stopped_leaves_no_file(sol, tmp_path, suffix):
    seen = []

    def stop(fraction):
        seen.append(fraction)
        if len(seen) == 10:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        sol.to_video(tmp_path / f"swing.{suffix}", progress=stop, **SMALL)
    assert seen == pytest.approx(np.arange(1, 11) / 21)
    assert not [*tmp_path.iterdir()]


def test_what_cannot_be_filmed_is_refused(sol, tmp_path):
    for given, message in (
        ({"path": "a.avi"}, "must end with .mp4 or .gif"),
        ({"speed": 0.0}, "speed = 0.0: must be > 0"),
        ({"speed": 1e-4}, "give speed=0.0333 for one of a minute"),
        ({"fps": -1}, "fps = -1.0: must be > 0"),
        ({"fps": "30"}, "fps = '30': must be a real number"),
        (
            {"size": (641, 360)},
            r"size = \(641, 360\): must be \(width, height\) in pixels",
        ),
        ({"size": (640, 36)}, "size = .*: must be .* 64 to 8192"),
        ({"size": 640}, "size = 640: must be"),
        ({"trace": -1}, r"trace = -1.0: must be >= 0 \(s\); inf shows"),
        ({"trace": "all"}, "trace = 'all': must be a real number"),
        ({"fps": 60}, r"fps = 60: must be at most 50 \(1/s\) in a GIF"),
        ({"speed": 0.01}, "6001 frames: a GIF is made in memory"),
        ({"names": ("a", "b")}, "must be 1, one for each run"),
    ):
        with pytest.raises((ValueError, TypeError), match=message):
            sol.to_video(tmp_path / given.pop("path", "a.gif"), **given)
    with pytest.raises(TypeError, match="must be a Solution"):
        sol.to_video(tmp_path / "a.gif", sol.scene)
    assert not [*tmp_path.iterdir()]


@pytest.mark.parametrize(
    "given",
    [{"fps": -1}, {"speed": 1e-4}, {"trace": -1}, {"horizon": "x"}, {"names": ("a", "b")}],
    ids=str,
)
def test_what_cannot_be_animated_opens_no_figure(sol, given):
    plt.close("all")
    with pytest.raises((ValueError, TypeError), match=next(iter(given))):
        sol.animate(**given)
    assert plt.get_fignums() == []


def test_an_animation_draws_its_frames(sol):
    animation = sol.animate(sol, names=("one", "again"), energy=True, fps=30)
    assert animation._interval == pytest.approx(1000 / 30)  # ms
    named = [x.get_text() for x in animation._func(10) if isinstance(x, Text)]
    assert named == ["one", "again", "t = 0.33 s"]
    animation._draw_was_started = True


@pytest.mark.parametrize(
    ("name", "options"), [("swing.gif", ["--speed", "4", "--fps", "3"]), ("swing.png", [])]
)
def test_the_command_writes_films_and_strips(tmp_path, capsys, name, options):
    out = tmp_path / name
    assert main(["show", "-o", str(out), "--json", *options]) == 0
    told = capsys.readouterr()
    assert json.loads(told.out) == {"file": str(out), "status": "finished"}
    assert told.err == f"written to {out}\n"
    with Image.open(out) as image:
        assert image.width > 600


def test_the_command_refuses_options_that_show_nothing_and_other_files(
    tmp_path, monkeypatch, capsys, sol
):
    monkeypatch.chdir(tmp_path)
    sol.save("run.npz")
    for arguments, told in (
        ("show -o a.png --reactions", "--reactions: is for films"),
        ("show -o a.html --speed 0.5", "--speed: is for films"),
        ("show -o swing.avi", "must end with .html, .mp4, .gif or .png"),
        ("plot run.npz --what path --at 1", "t: belongs to what = 'strip' and"),
        ("plot run.npz --what strip --horizon 0.1", "horizon: belongs to what = 'angles' and"),
    ):
        assert main(arguments.split()) == 2
        assert told in capsys.readouterr().err
    assert [one.name for one in tmp_path.iterdir()] == ["run.npz"]
