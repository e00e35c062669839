"""Makes docs/live.webp: the page of `--live`, as a browser shows it some seconds into a run.

python tools/live_picture.py docs/live.webp
"""

import io
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image
from playwright.sync_api import sync_playwright

FLAGS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
RUN = (
    *("--direct", "--terrain", "rocky", "--robot", "leo", "--seed", "0", "--duration", "900"),
    *("--actor", "anna=random", "--actor", "ben=random", "--live"),
)
SECONDS, SETTLED = 30.0, 5.0  # [s] of wall time until the picture, and with the run paused
PATIENCE = 300.0  # [s]: the processor draws


def main(picture: Path) -> None:
    """Starts a run, opens its page in a headless Chromium, and saves what it shows."""
    with tempfile.TemporaryDirectory() as folder:
        words = [sys.executable, "-m", "harness.run", *RUN, "--log-dir", folder]
        with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as run:
            try:
                address = next(
                    m[1] for line in run.stdout or () if (m := re.match(r"live: (\S+)", line))
                )
                image = _seen(address)
            finally:
                run.terminate()
    image.save(picture, quality=85)


def _seen(address: str) -> Image.Image:
    """The page, some time after it was opened, with the run paused."""
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
        page = browser.new_page(viewport={"width": 1280, "height": 720})
        page.goto(address)
        page.set_default_timeout(1000 * PATIENCE)
        page.wait_for_timeout(1000 * SECONDS)
        page.get_by_role("button", name="Pause").click()
        page.get_by_role("button", name="Go on").wait_for()
        for notice in page.locator(".mantine-Notification-closeButton").all():
            notice.click()  # that the processor draws
        page.wait_for_timeout(1000 * SETTLED)
        shot = page.screenshot()
        browser.close()
    return Image.open(io.BytesIO(shot))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
