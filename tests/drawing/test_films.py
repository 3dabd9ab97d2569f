"""Films show the run in true time; files are whole, of the size asked for, and stop at Ctrl-C."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from matplotlib.figure import Figure
from pendcore.cli import main
from pendcore.films import video
from pendcore.films.frames import frame_times, moves_of
from pendcore.films.stage import Choices, Stage
from PIL import Image


@pytest.fixture(scope="module")
def sol() -> pc.Solution:
    return pc.simulate(pc.Scene.textbook(), q0=[0.8, 1.0], t_span=(0, 2))


@pytest.fixture(scope="module")
def bouncing() -> pc.Solution:
    """Return a run that hits a stop, and comes to rest on it."""
    effects = [
        pc.effects.JointStop(joint=1, range=(-1.0, 1.9), restitution=0.4),
        pc.effects.DryJointFriction(joint=1, coulomb=0.6),
    ]
    scene = pc.Scene(links=[pc.Link(mass=1.0, length=1.0)], effects=effects)
    return pc.simulate(scene, q0=0.2, t_span=(0, 8))


def stage(*runs: pc.Solution, **given: Any) -> Stage:
    return Stage(runs, Figure(), Choices(**given), [""] * len(runs))


def chain(of: Stage, k: int) -> np.ndarray[Any, Any]:
    """Return the places of the first chain in frame k."""
    return np.array(of.show(k)[1].get_data()).T


@pytest.mark.parametrize(("speed", "fps"), [(1.0, 30.0), (0.5, 25.0), (3.0, 60.0)])
def test_a_frame_is_shown_for_as_long_as_the_motion_takes(
    sol: pc.Solution, speed: float, fps: float
) -> None:
    times = frame_times([sol], fps, speed)
    assert np.diff(times) == pytest.approx(speed / fps)
    assert times[0] == 0
    assert 2.0 - speed / fps < times[-1] <= 2.0 + 1e-12


def test_each_frame_shows_the_chain_at_its_time(sol: pc.Solution) -> None:
    film = stage(sol)
    k = 37
    exact = sol.scene._compiled.positions(film.times[k : k + 1], sol(film.times[k])[None, :2])
    assert np.array_equal(chain(film, k), exact[0])


def test_a_run_that_goes_backward_is_shown_backward() -> None:
    back = pc.simulate(pc.Scene.textbook(), q0=0.8, t_span=(2, 0))
    times = frame_times([back], 30.0, 1.0)
    assert (times[0], np.sign(times[1] - times[0])) == (2.0, -1.0)
    assert moves_of(back, times).places.shape == (61, 3, 2)


def test_impacts_and_rest_are_shown_where_they_are(bouncing: pc.Solution) -> None:
    assert bouncing.status == "at_rest"
    film = stage(bouncing)
    angle = np.array([np.arctan2(*chain(film, k)[1, ::-1]) for k in range(len(film.times))])
    assert angle.max() <= 1.9 + 1e-9  # no frame shows a link inside its stop
    assert angle[-1] == angle[-40]  # it rests to the end
    assert angle[:60] == pytest.approx(bouncing(film.times[:60])[0], abs=1e-12)


def test_two_runs_last_as_long_as_the_longer_one(sol: pc.Solution) -> None:
    longer = pc.simulate(sol.scene, q0=1.0, t_span=(0, 3))
    film = stage(sol, longer)
    assert len(film.times) == 91
    assert np.array_equal(chain(film, 80), chain(film, 90))  # the shorter one stays where it ends


def test_several_runs_stand_on_top_of_each_other_or_side_by_side(sol: pc.Solution) -> None:
    assert len(stage(sol, sol).figure.axes) == 1
    assert len(stage(sol, sol, beside=True).figure.axes) == 2
    assert len(stage(sol, energy=True).figure.axes) == 2


def test_the_whole_path_can_be_shown(sol: pc.Solution) -> None:
    film = stage(sol, trace=np.inf)
    assert len(film.show(60)[0].get_xdata()) == 4 * 60 + 1


def test_arrows_are_the_reactions(sol: pc.Solution) -> None:
    film = stage(sol, reactions=True)
    arrows = film.show(20)[2]
    at = film.times[20:21]
    q, qd = sol(at)[:2].T.copy(), sol(at)[2:].T.copy()
    force = sol.scene._compiled.reactions(at, q, qd)[0]
    assert pytest.approx(force[:, 0] / force[:, 1]) == arrows.U / arrows.V
    assert np.array_equal(arrows.get_offsets(), chain(film, 20)[:-1])
    sizes = [text.get_text() for text in film.show(20)[3:5]]
    assert sizes == [f" {np.hypot(*one):.3g} N" for one in force]


def test_a_run_is_pale_past_its_horizon() -> None:
    chaotic = pc.simulate(pc.Scene.textbook(), q0=0.0, t_span=(0, 30))
    film = stage(chaotic, horizon=0.1)
    until = chaotic.valid_until()
    right, wrong = (int(np.searchsorted(film.times, until)) + k for k in (-2, 2))
    assert film.show(right)[1].get_color() != "0.72"
    assert film.show(wrong)[1].get_color() == "0.72"


def test_nothing_leaves_the_picture(sol: pc.Solution) -> None:
    film = stage(sol, sol, beside=True)
    places = moves_of(sol, film.times).places.reshape(-1, 2)
    for axis in film.figure.axes:
        assert axis.get_xlim()[0] < places[:, 0].min() <= places[:, 0].max() < axis.get_xlim()[1]
        low, high = sorted(axis.get_ylim())
        assert low < places[:, 1].min() <= places[:, 1].max() < high
        assert axis.yaxis_inverted()


def test_a_gif_has_the_frames_the_size_and_the_time(sol: pc.Solution, tmp_path: Path) -> None:
    file = sol.to_video(tmp_path / "swing.gif", fps=25)
    with Image.open(file) as gif:
        frames = getattr(gif, "n_frames")  # noqa: B009  Pillow's types lack it
        assert gif.size == (640, 360)
        total = 0.0
        for k in range(frames):
            gif.seek(k)
            total += gif.info["duration"]
    assert total == pytest.approx(1000 * 51 / 25, abs=10)
    assert file.stat().st_size < 3_000_000


def test_the_pixels_of_a_gif_are_the_chain(sol: pc.Solution, tmp_path: Path) -> None:
    """The last picture differs from the first where the chain was, and nowhere else."""
    file = sol.to_video(tmp_path / "swing.gif", trace=None)
    with Image.open(file) as gif:
        first = np.asarray(gif.convert("L"), dtype=float)
        gif.seek(getattr(gif, "n_frames") - 1)  # noqa: B009
        last = np.asarray(gif.convert("L"), dtype=float)
    changed = np.abs(first - last) > 60
    assert 0.002 < changed.mean() < 0.08


needs_ffmpeg = pytest.mark.skipif(video._ffmpeg() is None, reason="ffmpeg is missing")


@needs_ffmpeg
def test_an_mp4_has_the_frames_the_size_and_the_time(sol: pc.Solution, tmp_path: Path) -> None:
    file = sol.to_video(tmp_path / "swing.mp4", size=(640, 480), reactions=True, energy=True)
    assert file == tmp_path / "swing.mp4"
    probe = shutil.which("ffprobe")
    if probe is None:
        pytest.skip("ffprobe is missing")
    entries = "stream=width,height,nb_frames,r_frame_rate,codec_name,pix_fmt"
    told = subprocess.run(
        [probe, "-v", "error", "-show_entries", entries, "-of", "json", file],
        capture_output=True,
        check=True,
        text=True,
    )
    (stream,) = json.loads(told.stdout)["streams"]
    assert stream == {
        "codec_name": "h264", "width": 640, "height": 480, "pix_fmt": "yuv420p",
        "r_frame_rate": "30/1", "nb_frames": "61",
    }  # fmt: skip


def test_without_ffmpeg_a_gif_is_written_and_a_sentence_says_so(
    sol: pc.Solution, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(video, "_ffmpeg", lambda: None)
    with pytest.warns(pc.PendcoreWarning, match=r"ffmpeg is not installed.*swing.gif is written"):
        file = sol.to_video(tmp_path / "swing.mp4")
    assert [file] == [*tmp_path.iterdir()]


@needs_ffmpeg
def test_what_ffmpeg_complains_of_is_told(
    sol: pc.Solution, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(video, "_ffmpeg", lambda: shutil.which("false"))
    with pytest.raises(RuntimeError, match="ffmpeg ended with 1"):
        sol.to_video(tmp_path / "swing.mp4")
    assert not [*tmp_path.iterdir()]


@pytest.mark.parametrize("suffix", ["gif", pytest.param("mp4", marks=needs_ffmpeg)])
def test_a_film_that_is_stopped_leaves_no_file(
    sol: pc.Solution, tmp_path: Path, suffix: str
) -> None:
    seen: list[float] = []

    def stop(fraction: float) -> None:
        seen.append(fraction)
        if len(seen) == 10:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        sol.to_video(tmp_path / f"swing.{suffix}", progress=stop)
    assert seen == pytest.approx(np.arange(1, 11) / 61)
    assert not [*tmp_path.iterdir()]


@pytest.mark.parametrize(
    ("given", "error", "message"),
    [
        ({"path": "a.avi"}, ValueError, "must end with .mp4 or .gif"),
        ({"speed": 0.0}, ValueError, "speed = 0.0: must be > 0"),
        ({"speed": 1e-4}, ValueError, "give speed=0.0333 for one of a minute"),
        ({"fps": -1}, ValueError, "fps = -1.0: must be > 0"),
        ({"size": (641, 360)}, ValueError, r"size\[0\] = 641: must be even"),
        ({"size": 640}, TypeError, "size = 640: must be"),
        ({"trace": -1}, ValueError, r"trace = -1.0: must be >= 0 \(s\); inf shows"),
        ({"trace": "all"}, TypeError, "trace = 'all': must be a real number"),
        ({"fps": 60}, ValueError, r"fps = 60: must be at most 50 \(1/s\) in a GIF"),
        ({"speed": 0.01}, ValueError, "6001 frames: a GIF is made in memory"),
        ({"names": ("a", "b")}, ValueError, "must be 1, one for each run"),
    ],
)
def test_what_cannot_be_filmed_is_refused(
    sol: pc.Solution, tmp_path: Path, given: dict[str, Any], error: type[Exception], message: str
) -> None:
    path = tmp_path / given.pop("path", "a.gif")
    with pytest.raises(error, match=message):
        sol.to_video(path, **given)
    assert not [*tmp_path.iterdir()]


def test_what_is_no_solution_is_refused(sol: pc.Solution, tmp_path: Path) -> None:
    with pytest.raises(TypeError, match="must be a Solution"):
        sol.to_video(tmp_path / "a.gif", sol.scene)  # type: ignore[arg-type]


def test_an_animation_draws_its_frames(sol: pc.Solution) -> None:
    animation = sol.animate(sol, names=("one", "again"), energy=True)
    assert animation._fig.axes[0].get_legend() is not None  # type: ignore[attr-defined]
    shown = animation._func(10)  # type: ignore[attr-defined]
    assert len(shown) == 6
    animation._draw_was_started = True  # type: ignore[attr-defined]  nobody looks at it


@pytest.mark.parametrize(
    ("name", "options"), [("swing.gif", ["--speed", "4", "--fps", "10"]), ("swing.png", [])]
)
def test_the_command_writes_films_and_strips(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str, options: list[str]
) -> None:
    out = tmp_path / name
    assert main(["show", "-o", str(out), "--json", *options]) == 0
    told = capsys.readouterr()
    assert json.loads(told.out) == {"file": str(out), "status": "finished"}
    assert told.err == f"written to {out}\n"
    with Image.open(out) as image:
        assert image.width > 600


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["show", "-o", "a.png", "--reactions"], "--reactions: is for films"),
        (["show", "-o", "a.html", "--speed", "0.5"], "--speed: is for films"),
        (["plot", "run.npz", "--what", "path", "--at", "1"], "t: belongs to what = 'strip' and"),
        (["plot", "run.npz", "--what", "strip", "--horizon", "0.1"], "horizon: what = 'strip'"),
    ],
)
def test_the_command_refuses_options_that_show_nothing(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    arguments: list[str],
    told: str,
    sol: pc.Solution,
) -> None:
    monkeypatch.chdir(tmp_path)
    sol.save("run.npz")
    assert main(arguments) == 2
    assert told in capsys.readouterr().err
    assert [one.name for one in tmp_path.iterdir()] == ["run.npz"]


def test_the_command_refuses_other_files(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["show", "-o", str(tmp_path / "swing.avi")]) == 2
    assert "must end with .html, .mp4, .gif or .png" in capsys.readouterr().err
