"""Films in files: MP4 by ffmpeg, GIF by Pillow.

The axes are drawn once. Each frame restores their pixels and draws what moves on top of them,
which takes a tenth of the time of a whole figure.
"""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from pendcore.messages import Progress, reporting, warn, whole_file
from pendcore.plotting.stage import HEIGHT, Film, Stage

Pixels = npt.NDArray[np.uint8]

SIZES = {".mp4": (1920, 1080), ".gif": (640, 360)}
"""The size of a film in pixels, unless another is asked for."""
_SAMPLES = 8
"""The number of frames of which a GIF takes its colours."""
_MOST_GIF_RATE, _MOST_GIF_FRAMES = 50.0, 4000
_GIF_TICK = 10
"""ms, the unit of the times in a GIF."""


def to_video(
    film: Film,
    path: str | os.PathLike[str],
    size: tuple[int, int] | None = None,
    progress: Progress = None,
) -> Path:
    """Write a film and return where it is: where ffmpeg is missing, a GIF in place of an MP4."""
    target = Path(path)
    kind = target.suffix.lower()
    if kind not in SIZES:
        raise ValueError(f"path = {str(target)!r}: must end with .mp4 or .gif")
    ffmpeg = _ffmpeg() if kind == ".mp4" else None
    if kind == ".mp4" and ffmpeg is None:
        target, kind = target.with_suffix(".gif"), ".gif"
        warn(
            f"ffmpeg is not installed, and an MP4 needs it: {target} is written instead "
            "(Debian: ffmpeg; pip: imageio-ffmpeg)"
        )
    if kind == ".gif" and film.fps > _MOST_GIF_RATE:
        raise ValueError(
            f"fps = {film.fps}: must be at most {_MOST_GIF_RATE:g} (1/s) in a GIF: browsers "
            "show shorter frames too slowly"
        )
    width, height = _even_size(SIZES[kind] if size is None else size)
    dpi = min(height, 9 / 16 * width) / HEIGHT
    new_figure = partial(Figure, figsize=(width / dpi, height / dpi), dpi=dpi)
    stage = Stage(film, new_figure)
    frames = range(len(stage.times))
    if kind == ".gif" and len(frames) > _MOST_GIF_FRAMES:
        raise ValueError(
            f"{target}: {len(frames)} frames: a GIF is made in memory and may have "
            f"{_MOST_GIF_FRAMES}: take fewer fps, more speed, or an MP4"
        )
    drawing = reporting(progress, "drawing", len(frames), "frames")
    with drawing as report, whole_file(target) as file:
        pictures = _pictures(stage, frames, report)
        if kind == ".mp4":
            _write_mp4(pictures, str(ffmpeg), file, (width, height), film.fps)
        else:
            samples = _pictures(stage, frames[:: max(len(frames) // _SAMPLES, 1)])
            _write_gif(samples, pictures, file, film.fps)
    return target


def _even_size(given: tuple[int, int]) -> tuple[int, int]:
    pixels = np.asarray(given)
    is_whole = pixels.shape == (2,) and pixels.dtype.kind in "iu"
    if not (is_whole and (pixels % 2 == 0).all() and 64 <= pixels.min() <= pixels.max() <= 8192):
        raise ValueError(
            f"size = {given!r}: must be (width, height) in pixels, both even, and 64 to 8192"
        )
    return int(pixels[0]), int(pixels[1])


def _pictures(
    stage: Stage,
    frames: Sequence[int],
    report: Callable[[float], object] = lambda fraction: None,
) -> Iterator[Pixels]:
    """Yield the pixels of frames, (height, width, 4); they are overwritten by the next."""
    canvas: Any = FigureCanvasAgg(stage.figure)
    canvas.draw()
    still = canvas.copy_from_bbox(stage.figure.bbox)
    count = len(frames)
    for k in frames:
        canvas.restore_region(still)
        for artist in stage.show(k):
            stage.figure.draw_artist(artist)
        yield np.asarray(canvas.buffer_rgba())
        report((k + 1) / count)


def _ffmpeg() -> str | None:
    """Return the path of ffmpeg: the system's, or that of the package imageio-ffmpeg."""
    if found := shutil.which("ffmpeg"):
        return found
    try:
        import imageio_ffmpeg
    except ImportError:
        return None
    return str(imageio_ffmpeg.get_ffmpeg_exe())


def _write_mp4(
    pictures: Iterator[Pixels], ffmpeg: str, file: Path, size: tuple[int, int], fps: float
) -> None:
    command = [
        ffmpeg, "-loglevel", "error", "-y",
        "-f", "rawvideo", "-pix_fmt", "rgba", "-s", f"{size[0]}x{size[1]}", "-r", f"{fps:.10g}",
        "-i", "-",
        "-an", "-c:v", "libx264", "-preset", "veryfast", "-crf", "20", "-pix_fmt", "yuv420p",
        "-movflags", "+faststart", "-f", "mp4", str(file),
    ]  # fmt: skip
    with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdin is not None
        try:
            for picture in pictures:
                process.stdin.write(picture.data)
        except BrokenPipeError:
            pass  # ffmpeg says below why it ended
        except BaseException:
            process.kill()
            raise
        _, told = process.communicate()
    if process.returncode != 0:
        last = told.decode(errors="replace").strip().rpartition("\n")[-1]
        raise RuntimeError(f"ffmpeg ended with {process.returncode}: {last or 'it says nothing'}")


def _write_gif(
    samples: Iterator[Pixels], pictures: Iterator[Pixels], file: Path, fps: float
) -> None:
    """Write a GIF. All frames share the colours of some samples, so that what rests stays equal."""
    palette = _palette(samples)
    first, *rest = (
        Image.fromarray(picture[..., :3].copy()).quantize(palette=palette, dither=Image.Dither.NONE)
        for picture in pictures
    )
    ticks = np.round(np.arange(len(rest) + 2) * 1000 / fps / _GIF_TICK)
    durations = (_GIF_TICK * np.diff(ticks)).astype(int).tolist()
    first.save(
        file, format="GIF", save_all=True, append_images=rest, duration=durations, loop=0,
        optimize=False, disposal=1,
    )  # fmt: skip


def _palette(samples: Iterator[Pixels]) -> Image.Image:
    """Return an image whose palette has white, and the colours of the samples, 64 in all."""
    # As one number of 24 bits, each colour is found once in no time: the thin traces count, too.
    seen = [np.unique(picture[..., :3] @ [1 << 16, 1 << 8, 1]) for picture in samples]
    numbers = np.unique(np.concatenate(seen)).astype(">u4")
    colors = np.ascontiguousarray(numbers.view(np.uint8).reshape(1, -1, 4)[..., 1:])
    median_cut, exact = Image.Quantize.MEDIANCUT, Image.Dither.NONE
    few = Image.fromarray(colors).quantize(63, median_cut, dither=exact)
    palette = Image.new("P", (1, 1))
    palette.putpalette([255, 255, 255, *(few.getpalette() or [])[: 3 * 63]])
    return palette
