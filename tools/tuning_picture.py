"""Makes docs/tuning.png: the F1 curves of a tuning's report, as a browser shows them.

python tools/tuning_picture.py tuning/report.html docs/tuning.png
"""

import shutil
import sys
from pathlib import Path

from playwright.sync_api import sync_playwright

FLAGS = ["--no-sandbox", "--disable-gpu", "--disable-background-networking"]
CURVES = ".robots:has([id$='-f1'])"


def main(report: Path, picture: Path) -> None:
    """Opens the report in a headless Chromium and saves the row of its curves."""
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
        page = browser.new_page(viewport={"width": 1312, "height": 900}, color_scheme="light")
        page.goto(report.resolve().as_uri())
        page.wait_for_selector("html[data-drawn]")
        page.locator(CURVES).screenshot(path=picture)
        browser.close()


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
