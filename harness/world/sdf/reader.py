"""XML from elsewhere: opened without entities, of bounded size and depth; plain texts and numbers."""

import math
import re
from pathlib import Path
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

from harness.base.documents import read_bytes
from harness.base.errors import UsageError, how_many
from rover_metrics.number import number

MOST_BYTES = 64 * 2**20
DEEPEST = 100  # elements within elements
MODEL = re.compile(rb"\s*<model\b")
DECLARATION = re.compile(rb"^\s*<\?xml[^>]*\?>")
# Behind a comment or a line of nothing, where TinyXML takes it and XML has none.
LATE = re.compile(rb"\A(?=\s|<!--)(?>\s+|<!--.*?-->)*+<\?xml[^>]*\?>", re.DOTALL)
# An attribute without a value, as DynaBARN's worlds have and TinyXML reads; no XML has one in a tag.
BARE = re.compile(rb"(<[\w:.-]+ [\w:.-]+=)(?=\s*/?>)")
MOST_ELEMENTS = 4_000_000  # a million way points have three each


def read_xml(path: Path, most_bytes: int = MOST_BYTES) -> Element:
    """Returns the root of an XML file, of which no entity is expanded; UsageError if it is unusable."""
    data = read_bytes(path, most_bytes)
    try:
        return parse_xml(data)
    except UsageError as error:
        raise UsageError(f"{path}: {error}") from error


def read_list(path: Path) -> Element | None:
    """Returns an <sdf> around the models that stand in a file without a root; None if there are none."""
    data = DECLARATION.sub(b"", read_bytes(path, MOST_BYTES), count=1)
    return parse_xml(b"<sdf>" + data + b"</sdf>") if MODEL.match(data) else None


def parse_xml(data: bytes) -> Element:
    """Returns the root of a document; UsageError if it is too deep, has a DOCTYPE, or is no XML."""
    parser, builder, depth, count = expat.ParserCreate(), TreeBuilder(), 0, 0

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal depth, count
        depth, count = depth + 1, count + 1
        if depth > DEEPEST:
            raise UsageError(f"its elements are nested more than {DEEPEST} deep; that is no world")
        if count > MOST_ELEMENTS:
            raise UsageError(f"it has more than {MOST_ELEMENTS:,} elements; take some out")
        builder.start(tag, {name: _plain(value) for name, value in attributes.items()})

    def end(tag: str) -> None:
        nonlocal depth
        depth -= 1
        builder.end(tag)

    def refuse(*_: object) -> None:
        raise UsageError("it declares a document type or entities (<!DOCTYPE ...>); take that out")

    parser.StartElementHandler, parser.EndElementHandler = start, end
    parser.CharacterDataHandler = builder.data
    parser.StartDoctypeDeclHandler = parser.EntityDeclHandler = refuse
    try:
        parser.Parse(BARE.sub(rb'\1""', LATE.sub(b"", data)), True)
    except expat.ExpatError as error:
        raise UsageError(f"it is not XML: {error}") from error
    return builder.close()


def text_of(element: Element | None, tag: str, default: str = "") -> str:
    """Returns the text of a child, stripped.

    Args:
        element: The parent; None has no children.
        tag: The child's.
        default: Where there is no child, or none with a text.
    """
    child = None if element is None else element.find(tag)
    return default if child is None else _plain(child.text or "").strip() or default


def _plain(text: str) -> str:
    """A text in which a space stands for whatever moves a terminal's cursor or begins a line."""
    return text if text.isprintable() else "".join(c if c.isprintable() else " " for c in text)


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
