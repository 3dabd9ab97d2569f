"""Films of the site: the gallery's pages, and a small film for each effect.

Every file of examples/gallery is run as it stands, as a reader would run it; it writes its film and
its page. An effect is shown by the first of its own examples, on two rods, above what its page
says. Nothing of that is committed.
"""

from __future__ import annotations

import math
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pendcore as pc
from pages_of_files import parts_of, toctree
from sphinx.application import Sphinx

FILMS = Path("_static/gallery")
GROUPS = {
    "Order and chaos": "released_rods three_starts triple two_modes locked_elbow chain_of_100",
    "Driven": "kapitza parametric clock trapeze golf_swing whip",
    "Friction, contact and wind": "stick_slip with_and_without bouncing_rod bell in_the_wind",
    "Held and controlled": "caught swing_up wrecking_ball",
}


def write(examples: Path, folder: Path, site: Path) -> None:
    """Run the files; write their pages into a folder, and films and live pages beside the site."""
    static = site / FILMS
    folder.mkdir(parents=True, exist_ok=True)
    static.mkdir(parents=True, exist_ok=True)
    files = [examples / f"{name}.py" for names in GROUPS.values() for name in names.split()]
    if set(files) != set(examples.glob("*.py")):
        raise ValueError("each file of examples/gallery has to be in one of GROUPS")
    with ThreadPoolExecutor(os.cpu_count()) as workers:
        list(workers.map(lambda file: _run(file, static), files))
    cards = {}
    for file in files:
        told, code = parts_of(file)
        title, about = told.split(".\n\n", 1)
        cards[file.stem] = _card(file.stem, title, about)
        (folder / f"{file.stem}.md").write_text(_page(file.stem, title, about, code))
    (folder / "index.md").write_text(_index(cards))
    for kind, effect in pc.effects.kinds().items():
        _film_of_effect(effect.description, static / f"effect_{kind}.mp4")


def _run(file: Path, static: Path) -> None:
    """Run a file; it has to write its film and its page, and to say nothing of what is wrong."""
    command = [sys.executable, str(file)]
    done = subprocess.run(command, cwd=static, capture_output=True, text=True, timeout=300)
    made = all((static / f"{file.stem}{kind}").is_file() for kind in (".mp4", ".html"))
    if done.returncode or done.stderr or not made:
        raise RuntimeError(f"{file.name}: {done.stderr[-2000:] or 'it wrote no film or no page'}")
    # The card of the gallery shows the chain alone: the square on the left, but for chains side by
    # side; and a picture until it plays.
    film, card = static / f"{file.stem}.mp4", static / f"{file.stem}_card.mp4"
    square = "" if "beside=True" in file.read_text() else "crop=ih:ih:0:0,"
    _convert(film, "-vf", f"{square}scale=-2:360", "-crf", "26", str(card))
    _convert(card, "-frames:v", "1", str(card.with_suffix(".jpg")))


def _convert(film: Path, *options: str) -> None:
    command = ["ffmpeg", "-loglevel", "error", "-y", "-i", str(film), *options]
    subprocess.run(command, check=True)


def _film_of_effect(told: Any, path: Path) -> None:
    """Film the textbook's rods with an effect."""
    names: dict[str, Any] = {**vars(pc.effects), "inf": math.inf}
    before, call, _ = told.examples.partition(told.calls[0])
    exec(before, names)
    free = pc.Scene.textbook()
    scene = free.replace(effects=[eval(call, names)])
    sol, without = (
        pc.simulate(one, (0, 6), [0.5, 1.0], on_failure="ignore") for one in (scene, free)
    )
    sol.to_video(path, without, names=("with it", "without"), size=(640, 360))


def add_film(app: Sphinx, page: str, source: list[str]) -> None:
    """Put the film of an effect below the title of its page."""
    name = page.removeprefix("effects/")
    film = Path(app.confdir) / FILMS / f"effect_{name}.mp4"
    if page != name and film.is_file():
        shown = player(f"effect_{name}", name.replace("_", " "))
        title, rest = source[0].split("\n", 1)
        source[0] = f"{title}\n\n```{{raw}} html\n{shown}\n```\n{rest}"


def player(name: str, title: str) -> str:
    """Return a film as it plays in a page; it waits where less motion is wanted."""
    return (
        f'<video class="film" src="../{FILMS}/{name}.mp4" muted loop playsinline controls '
        f'preload="metadata" aria-label="{title}"></video>'
    )


def _card(name: str, title: str, about: str) -> str:
    """Return the card of a scene: its small film, with a picture until it plays."""
    source = f"../{FILMS}/{name}_card"
    return f""":::{{grid-item-card}} {title}
:link: {name}
:link-type: doc

```{{raw}} html
<video class="film card-film" src="{source}.mp4" poster="{source}.jpg" muted loop
playsinline preload="none" aria-label="{title}"></video>
```

{about.partition(". ")[0].partition(": ")[0].rstrip(".")}.
:::
"""


def _page(name: str, title: str, about: str, code: str) -> str:
    code = code.removeprefix("from __future__ import annotations").strip()
    return f"""# {title}

{about}

```{{raw}} html
{player(name, title)}
```

<p><a class="reference external" href="../{FILMS}/{name}.html">Change it in your
browser</a>: a page with the core inside.</p>

```python
{code}
```

{{download}}`{name}.py <../../examples/gallery/{name}.py>`
"""


def _index(cards: dict[str, str]) -> str:
    parts = ["# Gallery", "Each is a dozen lines of Python, a film, and a page to change it in."]
    for title, names in GROUPS.items():
        shown = "".join(cards[name] for name in names.split())
        parts += [f"## {title}", f"::::{{grid}} 1 2 2 3\n:gutter: 3\n\n{shown}::::"]
    return "\n\n".join([*parts, toctree(cards, ":hidden:")])
