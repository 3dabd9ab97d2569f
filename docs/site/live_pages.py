"""The pages of runs that the site shows alive, in frames."""

from __future__ import annotations

from pathlib import Path

import pendcore as pc
from pendcore.page.html import core_for_browsers


def write(folder: Path) -> None:
    """Write the pages; a site of dead pages is refused."""
    if core_for_browsers() is None:
        raise RuntimeError("the site's first page runs the core: make page installs it")
    swing = pc.simulate(pc.Scene.textbook(), q0=[-0.6, -0.9], t_span=(0, 40))
    swing.to_html(folder / "live.html", title="The textbook's rods")
