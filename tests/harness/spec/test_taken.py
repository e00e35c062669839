"""What each field of each value takes, and each option of the command lines, of the same probes."""

import argparse
import math
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, TypeAdapter
from pydantic.fields import FieldInfo

from harness.base.errors import UsageError
from harness.cli.options import parse_run
from harness.sensors.choice import by_default
from harness.spec.value import Value, made
from tests.support.programs import PARSERS
from tests.support.snapshots import check_snapshot

NUMBERS = (-2.5, -1, 0, 1e-3, 0.3, 1, 2, 2.5, 7, 20, 45, 64, 95, 200, 1e3, 2026, 3e4, 1e5, 1e7, math.inf)
TEXTS = ("x", "", "_x", "1", "2,1", "1,2,3", "1,2,3,4", "2,1,3,4", "1,2,4,3", "x:y", "imu:nan", "1,2/x")
LISTS = ((), (1.0, 2.0), (2.0, 1.0), (0.1, 0.2, 0.3), (0.1, 0.2, 7.0), (1, 2, 3, 4), (1, 2, 4, 3))
PROBES: tuple[object, ...] = (*NUMBERS, *TEXTS, *LISTS, ("x", "x"), (1.0, 2.0, "x"), True, None, {})
REFUSED = (UsageError, NotImplementedError, ValueError, TypeError, argparse.ArgumentTypeError)
WITH_VALUES = ["course.entry", "course.receipt", "gym.point_nav", "gym.robo_terrain", "scenario.spec"]
WITH_VALUES += ["scenario.baseline", "world.soil_map"]
TOGETHER: dict[str, dict[str, Any]] = {  # what stands beside a field that is probed
    "Bound": {"min": 0},
    "EntryFile": {"lock": "x", "driver": "x"},
    "RangeOptions": {"name": "x", "range_min": 1, "range_max": 2},
    "Route": {"points": "x"},
    "Scenario": {"about": "x", "expect": {"truth.path_length": [{"over": "end", "min": 1}]}},
    "WayPoint": {"at": (1, 2)},
}

LINES = Path(__file__).with_name("lines.txt")  # of every form of a text that an option takes


def taken(take: Callable[[Any], object], probes: tuple[object, ...]) -> str:
    """The probes that are taken, and what becomes of them if they do not stay what they are."""
    found = dict[object, str]()
    for probe in probes:
        with suppress(*REFUSED):
            value = take(probe)
            is_kept = value == probe or (isinstance(value, float) and value == float(str(probe)))
            found[repr(probe)] = f"{probe!r}" if is_kept else f"{probe!r} as {value}"
    if found.keys() >= {*map(repr, TEXTS)}:
        for text in TEXTS:
            del found[repr(text)]
        found["any"] = "any text"
    return "; ".join(found.values())


def kinds(cls: type[Value] = Value) -> Iterator[type[Value]]:
    for kind in cls.__subclasses__():
        if kind.__module__.startswith("harness."):
            yield from (kind, *kinds(kind))


def first_taken(field: FieldInfo) -> object:
    adapter: TypeAdapter[object] = TypeAdapter(Annotated[field.annotation, field])  # type: ignore[arg-type]  # made at run time
    for probe in (1, 0.3, *PROBES):
        with suppress(ValueError):
            return (adapter.validate_python(probe), probe)[1]
    return None


def actions(parser: argparse.ArgumentParser, name: str) -> Iterator[tuple[str, Callable[[Any], object]]]:
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for verb, own in action.choices.items():
                yield from actions(own, f"{name} {verb}")
        elif callable(action.type) and action.type not in (Path, int, float, str):
            yield f"{name} {(*action.option_strings, action.dest)[0]}", action.type


def made_of(cls: type[Value], beside: dict[str, Any], name: str, probe: object) -> object:
    return getattr(made(cls, {**beside, name: probe}), name)


def fields() -> Iterator[tuple[str, Callable[[Any], object]]]:
    """Each field of each value, with what makes the value of it and of what else is needed."""
    by_default()  # loads the sensors
    for module in WITH_VALUES:
        import_module(f"harness.{module}")
    for cls in sorted(set(kinds()), key=lambda cls: cls.__name__):
        needed = {n: first_taken(f) for n, f in cls.model_fields.items() if f.is_required()}
        beside = TOGETHER.get(cls.__name__, needed)
        for name in filter(cls.model_fields.__contains__, cls.__annotations__):
            yield f"{cls.__name__}.{name}", partial(made_of, cls, beside, name)


def test_each_field_and_each_option_takes_what_it_took() -> None:
    lines = [f"{name}: {taken(take, PROBES)}\n" for name, take in fields()]
    words = (*map(str, NUMBERS), *TEXTS)
    for program, parser in PARSERS.items():
        lines += [f"{name}: {taken(take, words)}\n" for name, take in actions(parser(), program)]
    check_snapshot("taken.txt", "".join(lines))


def said(value: object) -> object:
    """What a value has that is not by default."""
    if isinstance(value, tuple):
        return [said(item) for item in value]
    if not isinstance(value, BaseModel):
        return repr(value)
    fields = ((name, getattr(value, name), field) for name, field in type(value).model_fields.items())
    return {name: said(own) for name, own, field in fields if own != field.get_default()}


def test_a_command_line_is_understood_as_it_was() -> None:
    lines, plain = list[str](), parse_run([])
    for line in LINES.read_text().splitlines():
        options = parse_run(line.split())
        assert options is not None
        more = [
            own
            for own, usual in zip(vars(options).values(), vars(plain).values(), strict=True)
            if own != usual
        ]
        lines.append("\n".join([line, *(str(said(own)) for own in more)]))
    check_snapshot("understood.txt", "\n".join(lines) + "\n")
