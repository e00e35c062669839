"""What elements of SDF say: texts, flags and numbers; the models of a file without a root."""

import math
import re
from pathlib import Path
from xml.etree.ElementTree import Element

from harness.base.documents import read_bytes
from harness.base.errors import UsageError, how_many
from harness.base.xml import MOST_BYTES, parse_xml, plain
from rover_metrics.number import number

MODEL = re.compile(rb"\s*<model\b")
DECLARATION = re.compile(rb"^\s*<\?xml[^>]*\?>")


def read_list(path: Path) -> Element | None:
    """Returns an <sdf> around the models that stand in a file without a root; None if there are none."""
    data = DECLARATION.sub(b"", read_bytes(path, MOST_BYTES), count=1)
    return parse_xml(b"<sdf>" + data + b"</sdf>") if MODEL.match(data) else None


def text_of(element: Element | None, tag: str, default: str = "") -> str:
    """Returns the text of a child, stripped.

    Args:
        element: The parent; None has no children.
        tag: The child's.
        default: Where there is no child, or none with a text.
    """
    child = None if element is None else element.find(tag)
    return default if child is None else plain(child.text or "").strip() or default


def is_true(text: str) -> bool:
    """Returns what a flag says: SDF's are 1, true, 0, false."""
    return text.strip().lower() in ("1", "true")


def numbers(text: str, count: int, name: str) -> tuple[float, ...]:
    """Returns the finite numbers of a text; UsageError for others, for more or fewer.

    Args:
        text: Separated by white space.
        count: How many there must be.
        name: What they are called in the message.
    """
    words = text.split()
    try:
        values = tuple(map(number, words))
    except ValueError:
        values = ()
    if len(values) != count or not all(map(math.isfinite, values)):
        shown = " ".join(words)[:60]
        raise UsageError(f"{name} '{shown}' is not valid; give {how_many(count, 'finite number')}")
    return values


def color_of(visual: Element) -> tuple[float, float, float, float] | None:
    """Returns the colour of a visual's material, with its alpha; None if it has none."""
    material = visual.find("material")
    text = text_of(material, "diffuse") or text_of(material, "ambient")
    values = text.split()
    if len(values) not in (3, 4):
        return None
    red, green, blue, *alpha = numbers(text, len(values), "colour")
    return red, green, blue, alpha[0] if alpha else 1.0
