"""The page of a run, opened and used in a headless Chromium while the run goes on."""

import io
import json
import re
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from PIL import Image

from harness import Run, run_episode
from rover_metrics.core.columns import COLUMNS
from rover_metrics.core.thresholds import DEFAULT_THRESHOLDS
from tests.support.browser import NEEDS_CHROMIUM
from tests.support.forked_program import ForkedProgram
from tests.support.visitor import Visitor
from tests.support.waiting import PATIENCE, free_port, wait_until

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

pytest.importorskip("viser", reason="needs viser: pip install -e '.[live]'")
pytestmark = NEEDS_CHROMIUM

WORDS = ("--direct", "--terrain-size", "10", "--lidar-beams", "45", "--duration", "600", "--rate", "2")
TIME = re.compile(r"([\d.]+) s of 600 s")
MIDDLE = 125, 300  # of the scene [pixels]
SMALL, SCALE = {"width": 600, "height": 360}, 0.5  # few points to draw: a processor does
# A processor draws: neither shadows nor the light of the sky, which are not on the screen, and nothing
# but while the scene is looked at.
SHORT = """window.isSeen = false
for (const name in WebGL2RenderingContext.prototype) if (/^draw(Arrays|Elements)/.test(name)) {
  const draw = WebGL2RenderingContext.prototype[name]
  WebGL2RenderingContext.prototype[name] = function (...all) {
    if (window.isSeen && !this.getParameter(this.FRAMEBUFFER_BINDING)) draw.apply(this, all)
  }
}"""
COLLISION = DEFAULT_THRESHOLDS.collision_threshold
SCENE = (0, 100, 125, 180)  # left, top, right, bottom: where no panel is [points]


class Watched:
    """A run in a process of its own, and its page."""

    def __init__(self, run: ForkedProgram, folder: Path, browser: "Browser") -> None:
        self.run, self.folder, self._browser = run, folder, browser
        wait_until(self._told)
        self.address = self._told()[0]

    def _told(self) -> list[str]:
        return re.findall(r"^live: (\S+)\n", self.run.said.read_text(), re.MULTILINE)

    def open(self) -> "Page":
        page = self._browser.new_page(viewport=SMALL, device_scale_factor=SCALE)  # type: ignore[arg-type] # a ViewportSize
        page.set_default_timeout(1000 * PATIENCE)  # the processor draws, beside all other tests
        page.add_init_script(SHORT)
        page.goto(self.address)
        page.get_by_text(TIME).wait_for()
        return page

    def rows(self) -> int:
        """How many rows the log has."""
        (log,) = self.folder.glob("metrics_log_*.csv")
        return log.read_bytes().count(b"\n") - 1

    def ended(self) -> dict[str, object]:
        """The manifest, once Ctrl-C has ended the run."""
        self.run.send_signal(signal.SIGINT)
        assert self.run.wait(PATIENCE) == 130
        (file,) = (f for f in self.folder.glob("metrics_log_*.json"))
        manifest: dict[str, object] = json.loads(file.read_text())
        return manifest


@contextmanager
def watched(browser: "Browser", folder: Path, *words: str) -> Iterator[Watched]:
    hills = 0.15 * np.outer(
        *(np.sin(np.linspace(0.0, 12.0, 41)),) * 2
    )  # few triangles: drawn in software
    np.save(folder / "hills.npy", hills.astype(np.float32))
    more = (
        "--terrain",
        str(folder / "hills.npy"),
        "--log-dir",
        str(folder),
        *words,
        "--live",
        f":{free_port()}",
    )
    with ForkedProgram("harness.run", [*WORDS, *more], folder / "said.txt") as run:
        yield Watched(run, folder, browser)


def time_on(page: "Page") -> float:
    found = TIME.search(page.get_by_text(TIME).inner_text())
    assert found is not None
    return float(found[1])


def test_a_page_draws_pauses_drives_and_survives_being_closed(webgl: "Browser", tmp_path: Path) -> None:
    with watched(webgl, tmp_path) as seen:
        page = seen.open()
        page.evaluate("window.isSeen = true")
        wait_until(lambda: colours_of(page) > 200)  # ground in the sun: in the dark it has four
        page.evaluate("window.isSeen = false")
        before = time_on(page)
        wait_until(lambda: time_on(page) > before + 1.0)
        page.get_by_role("button", name="Pause").click()
        page.get_by_role("button", name="Go on").wait_for()
        wait_until(lambda: stands_still(page))
        page.get_by_role("button", name="Go on").click()
        still = time_on(page)
        wait_until(lambda: time_on(page) > still + 0.5)
        page.keyboard.down("Shift")
        page.mouse.click(*MIDDLE)
        page.keyboard.up("Shift")
        ordered = time_on(page)
        wait_until(lambda: time_on(page) > ordered + 1.0)
        page.keyboard.press("i")
        wait_until(lambda: "0.00 m/s" in page.get_by_text(TIME).inner_text())  # let go of
        page.get_by_role("tab", name="Charts").click()
        wait_until(lambda: page.locator(".uplot").count() == len(COLUMNS) - 2)  # time, and Notes
        rows = seen.rows()
        page.get_by_role("tab", name="Thresholds").click()
        page.get_by_role("slider").first.focus()
        page.keyboard.press("ArrowRight")
        with Visitor(seen.address) as other:
            wait_until(lambda: other.value("collision_threshold [m]") > COLLISION)
            page.close()
            judged_at = seen.rows()
            wait_until(lambda: seen.rows() > judged_at + 1)  # the run goes on
            manifest = seen.ended()  # with somebody looking
    arguments = manifest["arguments"]
    assert isinstance(arguments, dict)
    assert [driver for _, driver in arguments["drivers"]] == ["goal", "cmd_vel"]
    ((_, x, y, _),) = arguments["goals"]
    assert max(abs(x), abs(y)) < 5.0  # on the ground that was clicked
    judged = manifest["thresholds"]
    assert isinstance(judged, dict)
    assert judged["collision_threshold"] > COLLISION
    speeds = [speed for _, speed, _ in arguments["commands"]]
    assert speeds[0] > 0.0 == speeds[-1]  # nobody held the key any more
    assert "steered by hand" in str(manifest["mode"])
    assert float(str(manifest["paused_s"])) > 0.1
    assert_repeated(manifest, tmp_path, rows)


def assert_repeated(manifest: dict[str, object], folder: Path, rows: int) -> None:
    """That the arguments of a run that was steered give its log again, up to a row."""
    arguments = manifest["arguments"]
    assert isinstance(arguments, dict)
    values = {k: v for k, v in arguments.items() if k not in ("number", "world_robot")}
    values["duration"] = round(float(str(manifest["simulated_s"])), 2)  # the log ended there
    again = run_episode(Run.of(**values), folder / "again")
    assert again.log_path is not None
    logs = again.log_path, Path(str(manifest["log"]))
    first, second = (log.read_bytes().splitlines()[: 1 + rows] for log in logs)
    assert first == second
    assert len(first) == 1 + rows > 4


def colours_of(page: "Page") -> int:
    """How many colours the scene has."""
    image = Image.open(io.BytesIO(page.screenshot())).convert("RGB").crop(SCENE)
    return len(np.unique(np.asarray(image).reshape(-1, 3), axis=0))


def stands_still(page: "Page") -> bool:
    before = time_on(page)
    page.wait_for_timeout(600.0)
    return time_on(page) == before
