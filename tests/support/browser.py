"""Pages, opened and used in a headless Chromium."""

import shutil
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from tests.support.waiting import PATIENCE

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page, ViewportSize

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
NEEDS_CHROMIUM = pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium: apt-get install chromium")
DESKTOP: "ViewportSize" = {"width": 1366, "height": 900}
PHONE: "ViewportSize" = {"width": 360, "height": 740}
FLAGS = ["--no-sandbox", "--disable-gpu", "--disable-background-networking"]
WEBGL = [*FLAGS, "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]  # drawn by the processor


class Visit:
    """An opened page and everything that it said or asked for.

    Args:
        browser: Where it is opened.
        file: The page.
        phone: Whether the screen is small and is touched.
    """

    def __init__(self, browser: "Browser", file: Path, *, phone: bool = False) -> None:
        self.context = browser.new_context(
            viewport=PHONE if phone else DESKTOP, is_mobile=phone, has_touch=phone, color_scheme="light"
        )
        self.context.set_default_timeout(1000 * PATIENCE)
        self.page = self.context.new_page()
        self.said: list[str] = []
        self.asked_for: list[str] = []
        self.page.on("console", lambda message: self.said.append(message.text))
        self.page.on("pageerror", lambda error: self.said.append(str(error)))
        self.page.on("request", lambda request: self.asked_for.append(request.url))
        self.page.goto(file.as_uri())
        self.page.wait_for_selector("html[data-drawn]")

    def __enter__(self) -> "Visit":
        return self

    def __exit__(self, *_: object) -> None:
        self.context.close()


def wait_for(page: "Page", condition: str, act: Callable[[], None] = lambda: None) -> None:
    """Acts and looks each frame whether a condition holds; pages forbid Playwright's own way."""
    deadline = time.monotonic() + PATIENCE
    while not page.evaluate(condition):
        assert time.monotonic() < deadline, f"did not come true: {condition}"
        act()
        page.evaluate("new Promise(requestAnimationFrame)")


def x_range(page: "Page", plot: str) -> list[float]:
    """What the x axis of a plot shows."""
    found: list[float] = page.evaluate(f"document.getElementById('{plot}').layout.xaxis.range")
    return found


def drag(page: "Page", plot: str) -> None:
    """Draws a box over the middle of a plot, from 30 % to 60 % of it."""
    area = page.locator(f"#{plot} .nsewdrag").first
    area.scroll_into_view_if_needed()
    box = area.bounding_box()
    assert box is not None
    x, y, width, height = box["x"], box["y"], box["width"], box["height"]
    page.mouse.move(x + 0.3 * width, y + 0.3 * height)
    page.mouse.down()
    page.mouse.move(x + 0.6 * width, y + 0.6 * height, steps=4)
    page.mouse.up()
