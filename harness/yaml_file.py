"""YAML files as frozen dataclasses: the annotations of the fields say what is valid.

A mistake is told in one line with the file, the key, the value and what would be valid.
"""

import math
from collections.abc import Mapping
from dataclasses import MISSING, fields, is_dataclass
from types import MappingProxyType, UnionType
from typing import Any, TypeVar, get_args, get_origin, get_type_hints

from harness.base.errors import UsageError

T = TypeVar("T")
NAMES = {
    bool: "true or false",
    str: "text",
    int: "a whole number",
    float: "a number",
    dict: "keys with values",
}


def fill(
    cls: type[T],
    values: Mapping[str, object],
    where: str,
    *,
    otherwise: Mapping[str, object] = MappingProxyType({}),
    **given: object,
) -> T:
    """Returns a dataclass made of values from a file.

    Args:
        cls: A dataclass with fields of str, int, float, dict, tuples of them, or further dataclasses.
        values: Its fields by name, as YAML gives them; those with a default may be left out.
        where: The file, and the section in it, for the message.
        otherwise: What fields are that the file leaves out, in place of their defaults.
        given: Fields that come from elsewhere and must not be in the file.

    Raises:
        UsageError: A key is missing or unknown, or a value is of another type.
    """
    hints = get_type_hints(cls)
    # A dataclass, which no type variable can say.
    known = {f.name: f for f in fields(cls) if f.name not in given}  # type: ignore[arg-type]
    for key in values:
        if key not in known:
            raise UsageError(f"{where}: key '{key}' does not exist; valid: {', '.join(known)}")
    for key, item in known.items():
        if (
            key not in values
            and key not in otherwise
            and item.default is MISSING
            and item.default_factory is MISSING
        ):
            raise UsageError(f"{where}: key '{key}' is missing; give {_valid(hints[key])}")
    made = {key: _convert(value, hints[key], f"{where}: {key}") for key, value in values.items()}
    left_out = {key: value for key, value in otherwise.items() if key in known and key not in values}
    return cls(**given, **left_out, **made)


def _convert(value: object, wanted: Any, where: str) -> object:  # noqa: ANN401 - a type or an alias
    plain, parts = _parts_of(wanted)
    if isinstance(plain, type) and is_dataclass(plain) and isinstance(value, dict):
        return fill(plain, value, where)
    if plain is tuple and isinstance(value, list):
        kinds = parts[:1] * len(value) if Ellipsis in parts else parts
        if len(kinds) == len(value):
            numbered = enumerate(zip(value, kinds, strict=True), 1)
            return tuple(_convert(item, kind, f"{where} [{n}]") for n, (item, kind) in numbered)
    if plain is float and type(value) is int:
        return float(value)
    if plain in NAMES and type(value) is plain and not (isinstance(value, float) and math.isnan(value)):
        return value
    raise UsageError(f"{where} = {value!r} is not valid; give {_valid(wanted)}")


def _parts_of(wanted: Any) -> tuple[Any, tuple[Any, ...]]:  # noqa: ANN401 - a type or an alias
    """A type without its parameters, and those; of `T | None` those of T."""
    if isinstance(wanted, UnionType):
        wanted = get_args(wanted)[0]
    plain = get_origin(wanted) or wanted
    return dict if plain is Mapping else plain, get_args(wanted)


def _valid(wanted: Any) -> str:  # noqa: ANN401 - a type or an alias
    """What a field takes, in words."""
    plain, parts = _parts_of(wanted)
    if plain is tuple:
        count = "a list" if Ellipsis in parts else f"a list of {len(parts)}"
        return f"{count}, each {_valid(parts[0])}"
    return NAMES.get(plain) or f"the keys {', '.join(f.name for f in fields(plain))}"
