"""The caption of a video's frames."""

import numpy as np
import pytest
from PIL import ImageDraw

from harness.view.caption import captioned

FRAME = np.full((480, 960, 3), 200, np.uint8)


@pytest.mark.parametrize(
    ("time", "speed", "rate", "words"),
    [
        (0.04, 0.004, 1, ["0.0 s", "0.00 m/s", ""]),
        (59.96, 1.237, 6, ["60.0 s", "1.24 m/s", "played 6\N{MULTIPLICATION SIGN} as fast"]),
    ],
)
def test_caption_tells_time_speed_and_how_fast_it_plays(
    time: float, speed: float, rate: int, words: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    written: list[str] = []
    draw = ImageDraw.ImageDraw.text

    def text(self: ImageDraw.ImageDraw, place: object, text: str, **style: object) -> None:
        written.append(text)
        draw(self, place, text, **style)  # type: ignore[arg-type]  # as it was called

    monkeypatch.setattr(ImageDraw.ImageDraw, "text", text)
    captioned(FRAME, time, speed, rate)
    assert written == words


def test_caption_covers_a_corner_and_nothing_else() -> None:
    frame = captioned(FRAME, 1234.5, 0.25, 12)
    rows, columns = np.nonzero((frame != FRAME).any(axis=2))
    assert frame.shape == FRAME.shape
    assert 420 < rows.min() < rows.max() < 480
    assert 0 < columns.min() < columns.max() < 480
    panel = frame[rows.min() : rows.max(), columns.min() : columns.max()]
    assert panel.min() < 110  # a darkened ground
    assert panel.max() > 250  # and white on it
    assert not (panel[:, -9:] > 230).any(), "the text ends within the panel"
