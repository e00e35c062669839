"""YAML files become dataclasses, or one line that names file, key, value and what is valid."""

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

from harness.base.errors import UsageError
from harness.yaml_file import fill, read_mapping


@dataclass(frozen=True)
class Span:
    low: float
    high: float = math.inf


@dataclass(frozen=True, kw_only=True)
class Thing:
    name: str
    count: int
    corner: tuple[float, float]
    span: Span
    spans: tuple[Span, ...] = ()
    rest: dict[str, Any] = field(default_factory=dict)


VALID = {"count": 3, "corner": [1, 2.5], "span": {"low": 1}}


def test_a_file_becomes_a_dataclass_with_what_comes_from_elsewhere(tmp_path: Path) -> None:
    path = tmp_path / "thing.yaml"
    path.write_text("count: 3\ncorner: [1, 2.5]\nspan: &s {low: 1}\nspans: [*s, *s]\nrest: {a: [b]}\n")
    thing = fill(Thing, read_mapping(path), str(path), name="it")
    one = Span(1.0)
    assert thing == Thing(
        name="it", count=3, corner=(1.0, 2.5), span=one, spans=(one, one), rest={"a": ["b"]}
    )
    assert isinstance(thing.corner[0], float)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"count": 2.5}, "f.yaml: count = 2.5 is not valid; give a whole number"),
        ({"count": True}, "f.yaml: count = True is not valid; give a whole number"),
        ({"corner": [1.0]}, r"f.yaml: corner = \[1.0\] is not valid; give a list of 2, each a number"),
        ({"corner": [1.0, "x"]}, r"f.yaml: corner \[2\] = 'x' is not valid; give a number"),
        ({"corner": [1.0, math.nan]}, r"f.yaml: corner \[2\] = nan is not valid; give a number"),
        ({"span": 1.0}, "f.yaml: span = 1.0 is not valid; give the keys low, high"),
        ({"span": {"high": 1.0}}, "f.yaml: span: key 'low' is missing; give a number"),
        ({"spans": [{"low": "x"}]}, r"f.yaml: spans \[1\]: low = 'x' is not valid; give a number"),
        ({"spans": None}, "spans = None is not valid; give a list, each the keys low, high"),
        ({"rest": 1}, "f.yaml: rest = 1 is not valid; give keys with values"),
        ({"counts": 3}, "f.yaml: key 'counts' does not exist; valid: count, corner, span, spans, rest"),
        ({"name": "x"}, "f.yaml: key 'name' does not exist"),
    ],
)
def test_a_mistake_names_file_key_value_and_what_is_valid(change: dict[str, Any], said: str) -> None:
    with pytest.raises(UsageError, match=said):
        fill(Thing, VALID | change, "f.yaml", name="it")


@pytest.mark.parametrize(
    ("text", "said"),
    [("a: [1", "is not valid YAML"), ("a: 1\na: 2\n", "duplicate key"), ("- 1\n", "keys with values")],
)
def test_a_file_that_is_no_mapping_is_one_line(text: str, said: str, tmp_path: Path) -> None:
    path = tmp_path / "f.yaml"
    path.write_text(text)
    with pytest.raises(UsageError, match=said) as told:
        read_mapping(path)
    assert "\n" not in str(told.value)


def test_a_file_that_is_not_there_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"cannot read .*none\.yaml: No such file"):
        read_mapping(tmp_path / "none.yaml")
