"""The built site on a phone and on a desk: nothing scrolls sideways, complains, or shuts out."""

from __future__ import annotations

from pathlib import Path

import pytest

SITE = Path(__file__).parents[2] / "build/site/html"
pytestmark = [
    pytest.mark.unsanitized,
    pytest.mark.skipif(not (SITE / "index.html").is_file(), reason="`make site` builds it"),
]
LOOKED_INTO = (
    *("index", "gallery/index", "gallery/kapitza", "effects/dry_joint_friction"),
    *("reference/style", "tutorials/worksheet_chaos", "how_to/see_it", "comparison/textbook"),
    *("reference/python/pendcore.simulate", "background/accuracy_cost", "notebooks/index"),
)
LARGEST_PAINT = """
const done = arguments[0];
const told = (entries) => done(Math.max(...entries.getEntries().map((one) => one.startTime)));
new PerformanceObserver(told).observe({ type: "largest-contentful-paint", buffered: true });
"""
BROKEN = """
const done = arguments[0];
const told = ({ violations }) => done(violations.map(({ id, nodes }) => [id, nodes[0].html]));
axe.run({ iframes: false }).then(told);
"""


@pytest.fixture(autouse=True)
def in_full(pytestconfig):
    """Look at the site where all is looked at: it takes minutes."""
    if not pytestconfig.getoption("--full"):
        pytest.skip("takes --full")


def test_no_page_is_wider_than_a_phone_or_writes_to_the_console(browser, sized):
    sized("phone")
    pages = [page for page in SITE.rglob("*.html") if "_static" not in page.parts]
    assert len(pages) > 150
    wide, told = [], []
    browser.get_log("browser")
    for page in pages:
        browser.get(page.as_uri())
        if browser.execute_script("return document.documentElement.scrollWidth > innerWidth"):
            wide.append(page.name)
        told += [(page.name, one["message"]) for one in browser.get_log("browser")]
    assert (wide, told) == ([], [])


@pytest.mark.parametrize("theme", ["light", "dark"])
@pytest.mark.parametrize("size", ["desktop", "phone"])
def test_axe_finds_nothing(browser, sized, size, theme):
    axe = pytest.importorskip("axe_core_python")
    script = (Path(axe.__file__).parent / "axe.min.js").read_text()
    sized(size)
    features = [{"name": "prefers-color-scheme", "value": theme}]
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": features})
    try:
        for page in LOOKED_INTO:
            browser.get((SITE / f"{page}.html").as_uri())
            browser.execute_script(script)
            assert browser.execute_async_script(BROKEN) == [], page
    finally:
        browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})


def test_the_first_page_is_there_within_a_second(browser):
    browser.get((SITE / "index.html").as_uri())
    assert browser.execute_async_script(LARGEST_PAINT) < 1000  # ms; some 200 are usual
