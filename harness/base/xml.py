"""XML from elsewhere: opened without entities, of bounded size and depth."""

import re
from pathlib import Path
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

from harness.base.documents import read_bytes
from harness.base.errors import UsageError

MOST_BYTES = 64 * 2**20
DEEPEST = 100  # elements within elements
MOST_ELEMENTS = 4_000_000  # a million way points have three each
# Behind a comment or a line of nothing, where TinyXML takes it and XML has none.
LATE = re.compile(rb"\A(?=\s|<!--)(?>\s+|<!--.*?-->)*+<\?xml[^>]*\?>", re.DOTALL)
# An attribute without a value, as DynaBARN's worlds have and TinyXML reads; no XML has one in a tag.
BARE = re.compile(rb"(<[\w:.-]+ [\w:.-]+=)(?=\s*/?>)")


def read_xml(path: Path, most_bytes: int = MOST_BYTES) -> Element:
    """Returns the root of an XML file, of which no entity is expanded; UsageError if it is unusable."""
    data = read_bytes(path, most_bytes)
    try:
        return parse_xml(data)
    except UsageError as error:
        raise UsageError(f"{path}: {error}") from error


def parse_xml(data: bytes, encoding: str | None = None) -> Element:
    """Returns the root of a document; UsageError if it is too deep, has a DOCTYPE, or is no XML.

    Args:
        data: The document.
        encoding: Of these bytes, whatever they declare; None is as declared, else UTF-8.
    """
    parser, builder, depth, count = expat.ParserCreate(encoding), TreeBuilder(), 0, 0

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal depth, count
        depth, count = depth + 1, count + 1
        if depth > DEEPEST:
            raise UsageError(f"its elements are nested more than {DEEPEST} deep; flatten it")
        if count > MOST_ELEMENTS:
            raise UsageError(f"it has more than {MOST_ELEMENTS:,} elements; take some out")
        builder.start(tag, {name: plain(value) for name, value in attributes.items()})

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


def plain(text: str) -> str:
    """Returns a text in which a space stands for whatever moves a terminal's cursor or begins a line."""
    return text if text.isprintable() else "".join(c if c.isprintable() else " " for c in text)
