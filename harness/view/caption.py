"""What stands in the lower left corner of a video's frames: simulated time, speed, how fast it plays."""

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

FONT_SIZE, MARGIN, PADDING = 20, 12, 8  # [pixels]
TIME_ENDS, SPEED_ENDS, RATE_BEGINS = 90, 200, 220  # [pixels] in the panel: what changes does not jump
PANEL, INK = (20, 22, 26, 150), (255, 255, 255, 255)  # RGBA
BASELINE = 0.78  # of the font's size, below the top of the text

Pixels = NDArray[np.uint8]


def captioned(pixels: Pixels, time: float, speed: float, rate: int) -> Pixels:
    """Returns a frame with its caption.

    Args:
        pixels: The frame, RGB, shape (height, width, 3).
        time: Of the simulation [s].
        speed: Of the rover [m/s].
        rate: How many times as fast as the simulation the video plays; 1 is not shown.
    """
    image, font = Image.fromarray(pixels), ImageFont.load_default(FONT_SIZE)
    draw = ImageDraw.Draw(image, "RGBA")
    played = f"played {rate}\N{MULTIPLICATION SIGN} as fast" if rate != 1 else ""
    width = RATE_BEGINS + font.getlength(played) if played else SPEED_ENDS
    left, top = MARGIN, image.height - MARGIN - 2 * PADDING - FONT_SIZE
    panel = (left, top, left + width + 2 * PADDING, image.height - MARGIN)
    draw.rounded_rectangle(panel, radius=PADDING, fill=PANEL)
    x, y = left + PADDING, top + PADDING + BASELINE * FONT_SIZE
    for place, text, anchor in (
        (TIME_ENDS, f"{time:.1f} s", "rs"),
        (SPEED_ENDS, f"{speed:.2f} m/s", "rs"),
        (RATE_BEGINS, played, "ls"),
    ):
        draw.text((x + place, y), text, fill=INK, font=font, anchor=anchor)
    return np.asarray(image)
