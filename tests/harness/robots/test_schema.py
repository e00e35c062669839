"""The published schema of rover.yaml is that of the code, and takes what reading takes."""

import json
from collections.abc import Callable

import jsonschema
import pytest
from ruamel.yaml import YAML

from harness.robots import MODELS_DIR, ROVERS, RoverSpec
from harness.robots.spec import schema

PUBLISHED = (MODELS_DIR / "rover.schema.json").read_text()
RULES = jsonschema.Draft202012Validator(json.loads(PUBLISHED))


def test_the_published_schema_is_current() -> None:
    assert schema() == PUBLISHED, "python -m harness.robot schema > models/rover.schema.json"


def test_rovers_that_ship_and_rovers_that_are_made_keep_it(
    foreign: Callable[[str], RoverSpec],
) -> None:
    for rover in (*ROVERS.values(), foreign("buggy")):
        text = (rover.folder / "rover.yaml").read_text()
        RULES.validate(json.loads(json.dumps(YAML(typ="safe").load(text))))


@pytest.mark.parametrize(
    "wrong",
    [
        {"wheel_radius": 0.1},
        {"clearance": -1},
        {"clearance": "high"},
        {"drive": {"kind": "hover"}},
        {"drive": {"lef": []}},
        {"footprint": [1, 2, 3]},
        {"sensors": [1]},
    ],
)
def test_it_refuses_what_reading_refuses(wrong: object) -> None:
    with pytest.raises(jsonschema.ValidationError):
        RULES.validate(wrong)


def test_every_key_is_described() -> None:
    rules = json.loads(PUBLISHED)["properties"]
    assert [key for key, rule in rules.items() if not rule.get("description")] == []
