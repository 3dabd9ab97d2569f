"""Makes pages of the site of those that are written to be read in the repository, too.

A link to an example leads to its page. A link to a folder, or to a Markdown file outside docs/,
becomes plain text. A README lists the pages of its folder for the site's navigation, in its order.
MyST makes a download of a link to another file that is no page (a test, a header, a case).
"""

from __future__ import annotations

import re
from pathlib import Path

from pages_of_files import toctree
from sphinx.application import Sphinx

LINK = re.compile(r"(?<!!)\[([^\]]*)\]\(((?!https?://|mailto:|#)[^)#\s]+)(#[^)\s]*)?\)")


def for_the_site(app: Sphinx, page: str, source: list[str]) -> None:
    if not (Path(app.srcdir) / f"{page}.md").exists() or page.startswith("examples/"):
        return
    folder = (Path(app.srcdir) / page).parent

    def replaced(match: re.Match[str]) -> str:
        words, target, _ = match.groups()
        path = (folder / target).resolve()
        is_page = path.suffix in {".md", ".rst"} and path.is_relative_to(Path(app.srcdir).resolve())
        if path.exists() and not is_page:
            if path.is_dir() or path.suffix == ".md":
                return words
            if (Path(app.srcdir) / f"examples/{path.stem}.md").exists() and path.suffix == ".py":
                return f"[{words}](/examples/{path.stem}.md)"
        return match.group()

    source[0] = LINK.sub(replaced, source[0])
    if page.endswith("/README"):
        pages = dict.fromkeys(re.findall(r"\]\((\w+)\.md\)", source[0]))
        source[0] += f"\n\n{toctree(pages, ':hidden:')}"
