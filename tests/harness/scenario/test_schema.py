"""The published schema is that of the code, and the scenarios that ship keep it."""

import json
import re
from pathlib import Path

import jsonschema
import pytest
from ruamel.yaml import YAML

from harness.robots import find_rover
from harness.robots.content import model_hash
from harness.scenario.case import cases_of
from harness.scenario.names import OF_TOPICS
from harness.scenario.quantities import QUANTITIES, RUN
from harness.scenario.reading import read_scenario
from harness.scenario.schema import schema

ROOT = Path(__file__).parents[3]
SCENARIOS = sorted((ROOT / "scenarios").glob("*.scenario.yaml"))
PUBLISHED = (ROOT / "scenarios/scenario.schema.json").read_text()
PUBLISHED_RULES = jsonschema.Draft202012Validator(json.loads(PUBLISHED))


def test_the_published_schema_is_current() -> None:
    mend = "python -m harness.scenario.schema > scenarios/scenario.schema.json"
    assert schema() == PUBLISHED, mend
    assert len(SCENARIOS) == 14


@pytest.mark.parametrize("path", SCENARIOS, ids=lambda path: path.name)
def test_a_scenario_that_ships_is_valid_and_meant_for_both_rovers(path: Path) -> None:
    PUBLISHED_RULES.validate(YAML(typ="safe").load(path))
    cases = cases_of(path, read_scenario(path))
    assert {case.run.rover.robot for case in cases} == {"leo", "rover_zero4wd"}


def test_the_baselines_that_ship_are_of_todays_models() -> None:
    runs = json.loads((ROOT / "scenarios/gravel.baseline.json").read_text())
    mend = "python -m harness.scenario scenarios/gravel.scenario.yaml --update-baseline"
    for robot in ("leo", "rover_zero4wd"):
        recorded = runs[f"gravel[{robot}-0]"]["of"]["model"]
        assert model_hash(find_rover(robot)).startswith(recorded), mend


@pytest.mark.parametrize(
    "wrong",
    [
        {"expect": {}},
        {"expect": {"truth.sped": {"min": 0}}},
        {"expect": {"truth.speed": {"mix": 0}}},
        {"expect": {"truth.speed": []}},
        {"expect": {"topic./a.latency": {"min": 0, "of": "b"}}},
        {"launch": [{"wait_for": "/a"}]},
        {"launch": [[]]},
        {"seeds": 100_001},
        {"sed": 1},
        {"events": [{"at": 1, "for": 3}]},
    ],
)
def test_the_schema_refuses_what_reading_refuses(wrong: dict[str, object]) -> None:
    valid = {"about": "a", "expect": {"truth.speed": {"min": 0}}}
    PUBLISHED_RULES.validate(valid)
    with pytest.raises(jsonschema.ValidationError):
        PUBLISHED_RULES.validate(valid | wrong)


def test_the_document_has_every_quantity_with_its_meaning() -> None:
    text = (ROOT / "docs/scenarios.md").read_text()
    rows = [
        f"| `{re.sub('(front|rear)_(left|right)', 'WHEEL', name)}` | {q.unit} | {q.meaning} |"
        for name, q in QUANTITIES.items()
    ]
    rows += [f"| `{name}` |  | {meaning} |" for name, meaning in RUN.items()]
    rows += [f"| `topic./NAME.{name}` | {unit} | {told} |" for name, (unit, told) in OF_TOPICS.items()]
    assert [row for row in rows if row not in text] == []
