"""A file to a Scenario. A mistake is one line with file, line and column, and what would be valid."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from harness.base.documents import read_yaml
from harness.base.errors import UsageError
from harness.scenario import bound, spec, steps
from harness.scenario.consistency import problems
from harness.scenario.spec import Scenario
from harness.spec.complaint import foremost, not_valid, unknown_key

SUFFIX = ".scenario.yaml"

Location = tuple[str | int, ...]  # keys and indices from the file's top, and pydantic's own words

_KEYS: dict[str, type[BaseModel]] = {  # whose keys are valid in which part of a file
    "": Scenario,
    "matrix": spec.Matrix,
    "goal": spec.Goal,
    "expect": bound.Bound,
    "measure": bound.Measure,
    **steps.EVENTS,
    "launch": steps.Launch,
    "expected_to_fail": spec.ExpectedFailure,
    "pass_rate": spec.PassRate,
}


def read_scenario(path: Path) -> Scenario:
    """Returns the scenario of a file, with names as they are; UsageError if it is not valid."""
    content = read_yaml(path, with_places=True)
    if not isinstance(content, Mapping):
        raise UsageError(f"{path}: it must hold keys with values, beginning with 'about:'")
    try:
        # JSON's rules know no types of Python: a list is a tuple, but "3" and true are no numbers.
        given = {key: value for key, value in content.items() if value is not None}
        scenario = Scenario.model_validate_json(json.dumps(given, default=str), strict=True)
    except ValidationError as error:
        first = foremost(error)
        keys, place = _place_of(content, first["loc"])
        raise UsageError(f"{path}{place}: {_mistake(first, keys)}") from error
    for location, problem in problems(scenario):
        keys, place = _place_of(content, location)
        raise UsageError(f"{path}{place}: {_named(keys, problem)}")
    return scenario


def place_quoted(path: Path, problem: str) -> str:
    """Returns the `:LINE:COLUMN` of the first text in a file that a problem quotes; "" without one."""
    nodes: list[Any] = [read_yaml(path, with_places=True)]  # of ruamel
    places: list[tuple[int, int]] = []
    for node in nodes:  # grows
        is_list = isinstance(node, list)
        keys, at = (range(len(node)), node.lc.item) if is_list else (node, node.lc.value)
        nodes += [node[key] for key in keys if isinstance(node[key], Mapping | list)]
        places += [at(key) for key in keys if isinstance(node[key], str) and f"'{node[key]}'" in problem]
    return "".join(f":{number + 1}" for number in min(places, default=()))


def _place_of(content: Any, location: Location) -> tuple[str, str]:  # noqa: ANN401 - nodes of ruamel
    """The keys of a location that stand in the file, joined, and `:LINE:COLUMN` of the innermost."""
    keys, place = [], ""
    if location[:1] == ("events",):  # after the index pydantic says which kind it is, as keys do too
        location = (*location[:2], *location[3:])
    for step in location:
        if isinstance(content, Mapping) and step in content:
            line, column = content.lc.key(step)  # type: ignore[attr-defined]  # of a CommentedMap
        elif isinstance(content, list) and isinstance(step, int) and step < len(content):
            line, column = content.lc.item(step)  # type: ignore[attr-defined]  # of a CommentedSeq
        else:
            continue  # a word that pydantic adds, or a key that is missing
        keys.append(str(step))
        place = f":{line + 1}:{column + 1}"
        content = content[step]
    return ".".join(keys), place


def _mistake(error: ErrorDetails, keys: str) -> str:
    location = error["loc"]
    part = _KEYS[next((str(step) for step in reversed(location[:-1]) if step in _KEYS), "")]
    match error["type"]:
        case "extra_forbidden":
            return unknown_key(str(location[-1]), part)
        case "missing":
            key = location[-1]
            return not_valid(error, key) if isinstance(key, str) else f"{keys} has too few values"
        case "union_tag_not_found":
            return f"{keys}: an event needs one of the keys {', '.join(steps.EVENTS)}"
        case "value_error":
            return _named(keys, error["ctx"]["error"])
    return not_valid(error, keys, part.model_fields.get(str(location[-1])))


def _named(keys: str, problem: object) -> str:
    return f"{keys}: {problem}" if keys else str(problem)
