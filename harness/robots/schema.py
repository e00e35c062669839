"""The JSON schema of rover.yaml, for editors; `python -m harness.robot schema` prints it."""

import inspect
import json
import re
from typing import Any

from pydantic import TypeAdapter

from harness.robots.spec import DRIVES, GIVEN, MAY_BE_ZERO, RoverSpec


def schema() -> str:
    """Returns it as JSON text; every key may be left out, unknown ones are mistakes."""
    made: dict[str, Any] = TypeAdapter(RoverSpec).json_schema()
    made["title"] = "rover.yaml"
    made["properties"] = {key: rule for key, rule in made["properties"].items() if key not in GIVEN}
    made.pop("required")
    described = _described()
    made["$defs"]["Drive"]["properties"]["kind"]["enum"] = list(DRIVES)
    for key, rule in made["properties"].items():
        rule.pop("title", None)
        if rule.get("type") in ("number", "integer") and key not in MAY_BE_ZERO:
            rule["exclusiveMinimum"] = 0
        if key in described:
            rule["description"] = described[key]
    for part in (made, *made["$defs"].values()):
        part["additionalProperties"] = False
        part["description"] = part.get("description", "").split("\n\n")[0]
    return json.dumps(made, indent=1, ensure_ascii=False) + "\n"


def _described() -> dict[str, str]:
    """What the docstring says of each field."""
    lines = inspect.cleandoc(RoverSpec.__doc__ or "").partition("Attributes:")[2]
    entries = re.findall(r"^    (\w+): (.*(?:\n {8}.*)*)", lines, re.MULTILINE)
    told = {name: " ".join(text.split()) for name, text in entries}
    siblings = {name: text for text in told.values() for name in re.findall(r"`(\w+)`", text)}
    return siblings | told
