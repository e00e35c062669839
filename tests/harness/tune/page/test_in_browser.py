"""The report of a tuning, opened and used in a headless Chromium."""

from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from tests.support.browser import NEEDS_CHROMIUM, Visit, drag, wait_for, x_range

if TYPE_CHECKING:
    from playwright.sync_api import Browser

pytestmark = NEEDS_CHROMIUM

# Labels of hazards that cover each other.
OVERLAPS = """[...document.querySelectorAll("[id$=-side]")].flatMap((plot) => {
  const boxes = [...plot.querySelectorAll(".xtick text")].map((t) => t.getBoundingClientRect());
  return boxes.slice(1).filter((box, i) => box.left < boxes[i].right).map(() => plot.id);
})"""
SMALLEST = """Math.min(...[...document.querySelectorAll("td, th, p, li, pre, .plot text")].map((e) =>
  parseFloat(getComputedStyle(e).fontSize)))"""


@pytest.fixture(scope="module")
def page_file(small_page: str, tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("tuning") / "report.html"
    file.write_text(small_page, encoding="utf-8")
    return file


@pytest.fixture(scope="module")
def visit(browser: "Browser", page_file: Path) -> Visit:
    return Visit(browser, page_file)


def test_every_figure_is_drawn_without_a_complaint_or_a_request(visit: Visit, page_file: Path) -> None:
    page = visit.page
    assert page.title() == "Thresholds of leo and rover_zero4wd"
    empty = "[...document.querySelectorAll('.plot')].filter((p) => !p.querySelector('.trace, .points'))"
    assert page.evaluate(f"{empty}.map((plot) => plot.id)") == []
    assert page.locator(".plot .main-svg").count() >= 10
    assert visit.said == []
    assert [url for url in visit.asked_for if not url.startswith("data:")] == [page_file.as_uri()]


def test_drag_zooms_a_figure_and_a_double_click_shows_all_of_it(visit: Visit) -> None:
    page = visit.page
    area, whole = page.locator("#leo-f1 .nsewdrag").first, x_range(page, "leo-f1")
    drag(page, "leo-f1")
    wait_for(page, "document.getElementById('leo-f1').layout.xaxis.range[0] > 0.2")
    assert x_range(page, "leo-f1") == pytest.approx([0.3 * whole[1], 0.6 * whole[1]], abs=0.01)
    # A machine that is busy may take the two clicks for single ones.
    wait_for(page, "document.getElementById('leo-f1').layout.xaxis.range[0] < 0.1", area.dblclick)
    assert visit.said == []


def test_the_button_copies_or_selects_the_file(visit: Visit) -> None:
    page, copied = visit.page, ""
    visit.context.grant_permissions(["clipboard-read", "clipboard-write"])
    for robot, done in (("leo", "Copied"), ("rover_zero4wd", "Selected")):
        page.locator(f"button[data-copies=file-{robot}]").click()
        wait_for(page, f"document.querySelector('[data-copies=file-{robot}]').textContent === '{done}'")
        copied = copied or page.evaluate("navigator.clipboard.readText()")
        page.evaluate("Object.defineProperty(navigator, 'clipboard', { value: undefined })")
    assert copied == page.locator("#file-leo").text_content()
    selected, file = page.evaluate("getSelection().toString()"), page.locator("#file-rover_zero4wd")
    assert selected.strip() == (file.text_content() or "").strip()
    assert "ros__parameters:" in copied + selected


def test_colours_follow_the_system(visit: Visit) -> None:
    page = visit.page
    paper = "document.getElementById('leo-f1').layout.paper_bgcolor"
    words = "getComputedStyle(document.querySelector('#leo-side .xtick text')).fill"
    light, ink = page.evaluate(paper), page.evaluate(words)
    assert page.evaluate(OVERLAPS) == []
    page.emulate_media(color_scheme="dark")
    wait_for(page, f"{paper} !== '{light}'")
    assert page.evaluate(words) != ink
    assert visit.said == []


def test_page_is_readable_on_a_phone(browser: "Browser", page_file: Path) -> None:
    with Visit(browser, page_file, phone=True) as visit:
        widths = "[document.documentElement.scrollWidth, document.documentElement.clientWidth]"
        assert visit.page.evaluate(widths) == [360, 360]
        assert visit.page.evaluate(SMALLEST) >= 11
        assert visit.page.evaluate(OVERLAPS) == []
        assert visit.page.evaluate("document.getElementById('leo-f1').layout.dragmode") is False
        assert visit.said == []
