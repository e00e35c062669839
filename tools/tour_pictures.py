"""Makes the pictures of docs/tour.md: pages that commands write, as a browser shows them.

python tools/tour_pictures.py docs/tour
"""

import shutil
import sys
from collections.abc import Iterator
from contextlib import chdir
from pathlib import Path
from tempfile import TemporaryDirectory

from playwright.sync_api import sync_playwright

from harness.run import main as run
from harness.scenario.__main__ import main as scenario

FLAGS = ["--no-sandbox", "--disable-gpu", "--disable-background-networking"]
SCENARIOS = Path(__file__).resolve().parents[1] / "docs/tour"
VIEW = {"width": 1200, "height": 720}  # [pixels]


def pages(folder: Path) -> Iterator[tuple[str, Path]]:
    """Yields the name of each picture, and the page that it shows; the working folder is theirs."""
    run(["--direct", "--terrain", "rocky", "--page", "run.html"])
    yield "run", folder / "run.html"
    for name in ("failing", "comparison"):
        file, page = SCENARIOS / f"{name}.scenario.yaml", Path(f"{name}.html")
        scenario([str(file), "--page", str(page), "--out", name])
        yield name, folder / page
    (failed,) = (folder / "failing").rglob("run.html")
    yield "failed_run", failed


def main(pictures: Path) -> None:
    """Drives, and saves what a headless Chromium shows of each page."""
    chromium = shutil.which("chromium") or shutil.which("google-chrome")
    if chromium is None:
        print("tour_pictures: no Chromium here, the pictures stay as they are")
        return
    pictures = pictures.absolute()
    pictures.mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory() as folder, chdir(folder), sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=chromium, args=FLAGS)
        for name, file in pages(Path(folder)):
            page = browser.new_page(viewport=VIEW, color_scheme="light")
            page.goto(file.as_uri())
            page.wait_for_selector("html[data-drawn]")
            page.screenshot(path=pictures / f"{name}.png")
        browser.close()


if __name__ == "__main__":
    main(Path(sys.argv[1]))
