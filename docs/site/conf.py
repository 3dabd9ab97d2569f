"""Sphinx's configuration of the site: `make site` builds it, without network.

The pages are the Markdown files of docs/, as they read in the repository; the modules beside this
one write the others. The first page shows a run alive. Colours and sizes are the house's.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(HERE))

import cpp_reference  # noqa: E402
import executed  # noqa: E402
import gallery_pages  # noqa: E402
import mathml  # noqa: E402
import pages_of_files  # noqa: E402
import pendcore as pc  # noqa: E402
import python_reference  # noqa: E402
import repository_pages  # noqa: E402
from pendcore.page.html import core_for_browsers  # noqa: E402
from pendcore.plotting import css_variables  # noqa: E402
from sphinx.application import Sphinx  # noqa: E402

project = "pendcore"
copyright = "pendcore maintainers"
version = release = pc.__version__

extensions = [
    "myst_parser",
    "numpydoc",
    "sphinx.ext.autodoc",
    "sphinx_copybutton",
    "sphinx_design",
]
exclude_patterns = ["site", "generators", "records", "figures"]

myst_enable_extensions = ["colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 4
suppress_warnings = ["myst.header"]

numpydoc_show_class_members = False
autodoc_member_order = "groupwise"
autodoc_typehints = "none"
copybutton_prompt_text = r">>> |\.\.\. |\$ "
copybutton_prompt_is_regexp = True
copybutton_exclude = ".linenos, .gp, .go"

html_theme = "pydata_sphinx_theme"
html_title = "pendcore"
templates_path = [str(HERE / "_templates")]
html_static_path = ["_static"]
html_css_files = ["house.css", "site.css"]
html_js_files = ["site.js"]
html_math_renderer = "mathml"
html_favicon = "_static/favicon.svg"
html_context = {"default_mode": "auto"}
html_show_sourcelink = False
html_copy_source = False
html_theme_options = {
    "navbar_align": "left",
    "navbar_end": ["theme-switcher"],
    "navbar_persistent": ["search-button"],
    "header_links_before_dropdown": 6,
    "show_toc_level": 2,
    "secondary_sidebar_items": {"**": ["page-toc"], "index": [], "gallery/index": []},
    "footer_start": ["copyright"],
    "footer_end": [],
}

(HERE / "_static/house.css").write_text(css_variables(when_dark='html[data-theme="dark"]'))
if core_for_browsers() is None:
    raise RuntimeError("the site's first page runs the core: make page installs it")
swing = pc.simulate(pc.Scene.textbook(), q0=[-0.6, -0.9], t_span=(0, 40))
swing.to_html(HERE / "_static/live.html", title="The textbook's rods")
gallery_pages.write(ROOT / "examples/gallery", ROOT / "docs/gallery", HERE)
python_reference.write(ROOT / "docs/reference/python")
pages_of_files.write_notebooks(ROOT / "examples/notebooks", ROOT / "docs/notebooks")
pages_of_files.write_examples(ROOT / "examples", ROOT / "docs/examples")
cpp_reference.write(ROOT / "cpp/include/pendcore", ROOT / "docs/reference/cpp")


def every_picture(app: Sphinx) -> Iterator[tuple[str, dict[str, str], str]]:
    """Yield the page that shows every picture and film of the site, in the look of the reader."""
    shown = [
        f'<a href="../{min(pages)}.html"><img src="../_images/{name}" alt="{min(pages)}"></a>'
        for _, (pages, name) in sorted(app.env.images.items())
    ]
    films = sorted((HERE / gallery_pages.FILMS).glob("*.mp4"))
    shown += [gallery_pages.player(x.stem, x.stem) for x in films if "_card" not in x.stem]
    body = f'<h1>Every picture</h1><div class="films">{"".join(shown)}</div>'
    yield "reference/pictures", {"title": "Every picture", "body": body}, "page.html"


def quiet(app: Sphinx, failure: Exception | None) -> None:
    """Take the theme's messages out of the console of whoever reads the site."""
    if failure:
        return
    for name in ("_static/scripts/pydata-sphinx-theme.js", "search.html"):
        path = Path(app.outdir) / name
        path.write_text(path.read_text().replace("console.log(", "void ("))


def setup(app: Sphinx) -> None:
    app.add_html_math_renderer("mathml", (mathml.inline, None), (mathml.displayed, None))
    app.connect("source-read", gallery_pages.add_film)
    app.connect("source-read", repository_pages.for_the_site)
    # Before Sphinx collects images, so that it copies these as well.
    app.connect("doctree-read", executed.execute_page, priority=100)
    app.connect("html-collect-pages", every_picture)
    app.connect("build-finished", quiet)
