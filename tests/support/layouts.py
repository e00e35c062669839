"""The topics and fields that the layouts of Foxglove and PlotJuggler in examples/ name."""

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

EXAMPLES = Path(__file__).parents[2] / "examples"
FOXGLOVE, PLOTJUGGLER = EXAMPLES / "foxglove_layout.json", EXAMPLES / "plotjuggler_layout.xml"


def foxglove_panels() -> dict[str, Any]:
    """Returns the settings of each panel."""
    panels: dict[str, Any] = json.loads(FOXGLOVE.read_text())["configById"]
    return panels


def foxglove_paths() -> Iterator[str]:
    """Yields what panels show: /topic or /topic.field.field[0]."""
    for panel in foxglove_panels().values():
        yield from panel.get("topics", ())
        yield from (path["value"] for path in panel.get("paths", ()))
        if "topicToRender" in panel:
            yield panel["topicToRender"]


def plotjuggler_paths() -> Iterator[str]:
    """Yields what is drawn: /topic/field/field[0]."""
    for curve in ET.parse(PLOTJUGGLER).iter("curve"):  # noqa: S314 - our own file
        given = curve.attrib
        yield from (given["curve_x"], given["curve_y"]) if "curve_x" in given else (given["name"],)


def look_up(path: str, recorded: dict[str, Any]) -> Any:  # noqa: ANN401 - rosbags makes its classes
    """Returns what a path leads to in the messages of a recording, one by topic."""
    topic = max((name for name in recorded if re.match(rf"{re.escape(name)}([./]|$)", path)), key=len)
    found = recorded[topic]
    for name, index in re.findall(r"(\w+)(?:\[(\d+)\])?", path.removeprefix(topic)):
        found = getattr(found, name)
        found = found[int(index)] if index else found
    return found
