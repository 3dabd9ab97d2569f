"""A browser for pages of runs: Debian's Chromium, driven by selenium."""

from __future__ import annotations

import shutil

import pendcore as pc
import pytest
from pendcore.page.html import core_for_browsers

CHROMIUM = shutil.which("chromium")
DRIVER = shutil.which("chromedriver")
SIZES = {"desktop": (1280, 900), "phone": (390, 844)}


@pytest.fixture(scope="session")
def browser():
    """Return a browser without a window, and skip the test where there is none."""
    selenium = pytest.importorskip("selenium.webdriver")
    if CHROMIUM is None or DRIVER is None:
        pytest.skip("chromium or chromedriver is missing (Debian: chromium chromium-driver)")
    options = selenium.ChromeOptions()
    options.binary_location = CHROMIUM
    for flag in (
        "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
        "--disable-background-networking", "--disable-component-update", "--disable-sync",
    ):  # fmt: skip
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    from selenium.webdriver.chrome.service import Service

    driver = selenium.Chrome(options=options, service=Service(DRIVER))
    driver.set_window_size(*SIZES["desktop"])
    yield driver
    driver.quit()


@pytest.fixture
def sized(browser):
    """Return what makes the window as large as a "desktop" or a "phone", until the test ends."""
    yield lambda size: browser.set_window_size(*SIZES[size])
    browser.set_window_size(*SIZES["desktop"])


@pytest.fixture
def core():
    """Skip a test of the core in a page where the install has none."""
    if core_for_browsers() is None:
        pytest.skip("`make page` builds the core for browsers and installs it")


class Opened:
    """A page in the browser."""

    def __init__(self, browser, file, fragment=""):
        self.browser = browser
        browser.get("about:blank")
        browser.get_log("browser")
        browser.get_log("performance")
        browser.get(file.as_uri() + fragment)
        self.wait("window.pendcorePage !== undefined || message.textContent !== ''")

    def ask(self, expression):
        return self.browser.execute_script(f"return {expression}")

    def do(self, statement):
        self.browser.execute_script(statement)

    def wait(self, condition, seconds=20.0):
        from selenium.webdriver.support.ui import WebDriverWait

        WebDriverWait(self.browser, seconds, 0.05).until(lambda _: self.ask(condition))

    def text(self, name):
        return str(self.ask(f"document.getElementById({name!r}).textContent"))

    def state(self, run, t):
        """Return the angles and rates at a time of a run that the page shows."""
        return self.ask(f"(({{ q, qd }}) => [...q, ...qd])(pendcorePage.{run}.at({t}))")

    def click(self, name):
        self.browser.find_element("id", name).click()

    def enter(self, selector, value, event="change"):
        """Give a menu or a field a value, as its reader does."""
        self.do(
            f"const one = document.querySelector({selector!r}); one.value = {value!r};"
            f"one.dispatchEvent(new Event({event!r}, {{ bubbles: true }}))"
        )

    def drag(self, *places):
        """Press at the first place of the window, move to the others, and let go."""
        from selenium.webdriver.common.action_chains import ActionChains

        mouse = ActionChains(self.browser)
        pointer = mouse.w3c_actions.pointer_action
        for k, (x, y) in enumerate(places):
            pointer.move_to_location(round(x), round(y))
            if k == 0:
                pointer.pointer_down()
        pointer.pointer_up()
        mouse.perform()

    def copied(self, button):
        self.do("pendcorePage.copied = null")
        self.do(f"document.getElementById({button!r}).click()")
        self.wait("pendcorePage.copied !== null")
        return str(self.ask("pendcorePage.copied"))

    def complaints(self):
        """Return what the page said in the console."""
        return [one["message"] for one in self.browser.get_log("browser")]


@pytest.fixture
def opened(browser, tmp_path):
    """Return what writes the page of a solution and opens it from disk."""

    def open_page(solution, fragment=""):
        return Opened(browser, solution.to_html(tmp_path / "run.html"), fragment)

    return open_page


@pytest.fixture(scope="session")
def sol():
    damped = pc.Scene.textbook().replace(effects=[pc.effects.ViscousJoint(joint=2, damping=0.05)])
    return pc.simulate(damped, q0=[0.8, 1.0], t_span=(0, 8))


@pytest.fixture(scope="session")
def file(sol, tmp_path_factory):
    """Write the page of this solution."""
    return sol.to_html(tmp_path_factory.mktemp("page") / "run.html")


@pytest.fixture
def page(browser, file):
    """Return the page of this solution, opened."""
    return Opened(browser, file)
