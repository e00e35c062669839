"""The run report, opened and used in a headless Chromium."""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from harness.run import main
from tests.support.browser import NEEDS_CHROMIUM, Visit, drag, wait_for, x_range
from tests.support.once import made_once

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

pytestmark = NEEDS_CHROMIUM


@pytest.fixture(scope="module")
def page_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The report of a run that ends at a wall of the maze."""
    file = tmp_path_factory.mktemp("report") / "report.html"

    def make() -> Path:
        words = ["--direct", "--terrain", "maze", "--driver", "straight", "--duration", "22"]
        assert main([*words, "--log-dir", str(file.parent), "--report", str(file)]) == 0
        return file

    return made_once(tmp_path_factory, "run_report", make)


@pytest.fixture(scope="module")
def desktop(browser: "Browser", page_file: Path) -> Iterator[Visit]:
    with Visit(browser, page_file) as visit:
        yield visit


@pytest.fixture
def visit(desktop: Visit) -> Iterator[Visit]:
    """The page on a desktop, light and whole again after each test; what that asked for is forgotten."""
    opened = len(desktop.asked_for)
    yield desktop
    desktop.page.emulate_media(color_scheme="light")
    wait_for(desktop.page, "matchMedia('(prefers-color-scheme: light)').matches")
    for button in ("Whole run", "Path"):
        desktop.page.get_by_role("button", name=button).click()
    wait_for(desktop.page, "document.getElementById('series-9').layout.xaxis.range[0] === 0")
    assert desktop.said == []
    del desktop.asked_for[opened:]


def test_page_opens_without_a_complaint_and_asks_for_nothing_but_itself(
    visit: Visit, page_file: Path
) -> None:
    assert visit.page.title() == "leo on maze, seed 0: complete"
    assert visit.page.locator(".plot .main-svg").count() >= 11
    assert [url for url in visit.asked_for if not url.startswith("data:")] == [page_file.as_uri()]
    visit.page.locator("#series-5").hover()
    with visit.page.expect_download() as saved:
        visit.page.locator("#series-5 .modebar-btn").first.click()
    assert saved.value.suggested_filename.endswith(".png")


def test_drags_zoom_time_and_map_their_buttons_zoom_out_and_the_pointer_shows_on_the_map(
    visit: Visit,
) -> None:
    page = visit.page
    whole, path = x_range(page, "series-0"), x_range(page, "map")
    visit.page.locator("#series-5 .nsewdrag").first.hover()
    note = "document.querySelector('#map .annotation-text')?.textContent"
    wait_for(visit.page, f"/^1[01]\\.\\d s$/.test({note})")
    drag(page, "series-5")
    wait_for(page, "document.getElementById('series-0').layout.xaxis.range[0] > 1")
    zoomed = x_range(page, "series-0")
    assert zoomed[1] - zoomed[0] == pytest.approx(0.3 * (whole[1] - whole[0]), rel=0.1)
    assert x_range(page, "series-9") == zoomed
    page.get_by_role("button", name="Whole run").click()
    wait_for(page, "document.getElementById('series-9').layout.xaxis.range[0] === 0")
    assert x_range(page, "series-5") == whole
    drag(page, "map")
    wait_for(page, f"document.getElementById('map').layout.xaxis.range[0] > {path[0] + 0.5}")
    page.get_by_role("button", name="Whole map").click()
    wait_for(page, "document.getElementById('map').layout.xaxis.range[0] < -11.9")
    page.get_by_role("button", name="Path").click()
    wait_for(page, f"document.getElementById('map').layout.xaxis.range[0] > {path[0] - 0.5}")


def test_page_is_readable_on_a_phone_and_a_finger_scrolls_it(
    browser: "Browser", page_file: Path
) -> None:
    with Visit(browser, page_file, phone=True) as visit:
        visit.page.evaluate("document.querySelector('h1').textContent += '_a_rover'.repeat(12)")
        widths = "[document.documentElement.scrollWidth, document.documentElement.clientWidth]"
        assert visit.page.evaluate(widths) == [360, 360]
        assert visit.page.evaluate("document.getElementById('map').layout.dragmode") is False
        smallest = "Math.min(...[...document.querySelectorAll('td, p, li, figcaption')].map("
        assert visit.page.evaluate(smallest + "e => parseFloat(getComputedStyle(e).fontSize)))") >= 12
        assert visit.said == []


def test_colours_follow_the_system_with_enough_contrast_and_the_view_stays(visit: Visit) -> None:
    page = visit.page
    assert_contrast(page)
    drag(page, "series-5")
    wait_for(page, "document.getElementById('series-0').layout.xaxis.range[0] > 1")
    light, zoomed = colours(page), x_range(page, "series-0")
    page.emulate_media(color_scheme="dark")
    wait_for(page, f"document.getElementById('map').layout.paper_bgcolor !== '{light[2]}'")
    dark = colours(page)
    assert_contrast(page)
    assert all(before != after for before, after in zip(light, dark, strict=True))
    assert x_range(page, "series-0") == zoomed


def assert_contrast(page: "Page") -> None:
    """Of every text on every ground: WCAG 2.2, success criterion 1.4.3."""
    style = "getComputedStyle(document.documentElement).getPropertyValue"
    names = ("ink", "muted", "panel", "page")
    ink, muted, *grounds = (page.evaluate(f"{style}('--{name}').trim()") for name in names)
    assert min(contrast(text, ground) for text in (ink, muted) for ground in grounds) >= 4.5


def colours(page: "Page") -> tuple[str, str, str]:
    """Of the page, of its text and of a plot."""
    body = "getComputedStyle(document.body)"
    return (
        page.evaluate(f"{body}.backgroundColor"),
        page.evaluate(f"{body}.color"),
        page.evaluate("document.getElementById('map').layout.paper_bgcolor"),
    )


def contrast(one: str, other: str) -> float:
    """Contrast ratio of two colours #rrggbb (WCAG 2.2)."""
    dark, light = sorted((luminance(one), luminance(other)))
    return (light + 0.05) / (dark + 0.05)


def luminance(color: str) -> float:
    parts = [int(color[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    linear = [p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
