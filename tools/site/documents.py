"""What documents have from the code.

It stands between two lines:

    <!-- generated: NAME -->
    <!-- end -->

The documents keep it, so that they are read on GitHub too. `python -m tools.site write` renews it;
`python -m tools.site check`, a step of `make lint`, holds the documents to it.
"""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path

from harness.gym import ENVIRONMENTS
from harness.robots import ROVERS
from harness.robots.spec import schema as rover_schema
from harness.scenario.schema import schema as scenario_schema
from harness.validate.check import Check
from harness.validate.suite import sheet_of, validate
from rover_metrics.dictionary import dictionary
from rover_metrics.sheet.render import markdown
from tools.site import environments, sensors, tables
from tools.site.pages import ROOT


def validation(results: Mapping[str, Sequence[Check]]) -> str:
    """Returns the tables of what all rovers have driven, each under its name."""
    sheets = (sheet_of(robot, driven) for robot, driven in results.items())
    return "\n".join(f"### {sheet.title}\n\n{markdown(sheet)}" for sheet in sheets)


PART = re.compile(r"(<!-- generated: (\S+) -->\n).*?(<!-- end -->)", re.DOTALL)
PARTS: dict[str, Callable[[], str]] = {
    "topics": tables.topics,
    "parameters": tables.parameters,
    "terrains": tables.terrains,
    "gallery": tables.gallery,
    "sensors": sensors.tables,
    "metrics": dictionary,
    "validation": lambda: validation({rover.name: validate(rover, 0) for rover in ROVERS.values()}),
    "environment-options": environments.shared_options,
    **{name: lambda name=name: environments.tables(name) for name in ENVIRONMENTS},  # type: ignore[misc]
}
MEASURED = ("terrains", "validation")  # by simulations: tests compare them within a tolerance
FILES = {
    "models/rover.schema.json": rover_schema,
    "scenarios/scenario.schema.json": scenario_schema,
}


class UnknownPart(Exception):
    """A document asks for a part that nothing generates."""


@cache
def part(name: str) -> str:
    """Returns a generated part by its name.

    Raises:
        UnknownPart: There is none of that name; the message names those there are.
    """
    if name not in PARTS:
        raise UnknownPart(f"nothing generates '{name}'; available: {', '.join(PARTS)}")
    return PARTS[name]()


def filled(text: str, without: Sequence[str] = ()) -> str:
    """Returns a document with its parts as the code has them now.

    Args:
        text: The document.
        without: Names of parts that stay as they are.

    Raises:
        UnknownPart: The document asks for something that nothing generates.
    """
    return PART.sub(lambda m: m[0] if m[2] in without else f"{m[1]}\n{part(m[2])}\n{m[3]}", text)


def outdated(without: Sequence[str] = ()) -> Iterator[tuple[Path, str]]:
    """Yields each file of the repository that is not what the code gives, and what it gives.

    Args:
        without: Names of parts that are not compared.
    """
    for path in (*sorted((ROOT / "docs").glob("*.md")), ROOT / "models/README.md"):
        if (new := filled(text := path.read_text(encoding="utf-8"), without)) != text:
            yield path, new
    for name, made in FILES.items():
        if (new := made()) != (ROOT / name).read_text(encoding="utf-8"):
            yield ROOT / name, new
