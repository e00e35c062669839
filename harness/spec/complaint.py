"""What is wrong with values, in one line: what pydantic says, with what would be valid."""

from collections.abc import Callable, Iterable, Iterator
from typing import Any, get_args

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from harness.base.errors import unknown
from rover_metrics.errors import shown


def complaint(error: ValidationError, cls: type[BaseModel], name: Callable[[str], str] = str) -> str:
    """Returns what is wrong with values, in one line.

    Args:
        error: What pydantic says of them.
        cls: What was to be made of them.
        name: How a user calls a field.
    """
    first = foremost(error)
    keys = [str(key) for key in first["loc"]]
    field = ".".join([name(keys[0]), *keys[1:]]) if keys else ""
    if first["type"] == "extra_forbidden":
        if len(keys) == 1:
            return unknown_key(field, cls, name)
        return f"{field.rpartition('.')[0]}: {unknown_key(keys[-1], _model_at(cls, keys[:-1]))}"
    if first["type"] == "value_error":
        return str(first["ctx"]["error"])
    if field.startswith("--"):  # whose words nobody counts
        field = name(keys[0])
    fields = _model_at(cls, keys).model_fields
    return not_valid(first, field, next((fields[key] for key in reversed(keys) if key in fields), None))


def unknown_key(key: str, cls: type[BaseModel], name: Callable[[str], str] = str) -> str:
    """Returns that a model has no such key, and which it has."""
    return unknown("key", key, [name(item.alias or own) for own, item in cls.model_fields.items()])


def not_valid(error: ErrorDetails, field: str, info: FieldInfo | None = None) -> str:
    """Returns what is wrong with a value, and what would be valid.

    Args:
        error: What pydantic says of it.
        field: How a user calls it.
        info: Of the field, for the range of its numbers.
    """
    if error["type"] == "missing":
        return f"key '{field}' is missing"
    return f"{field} {shown(repr(error['input']))} is not valid; give {_valid(error, info)}"


KINDS = {
    "int": "a whole number",
    "float": "a number",
    "finite": "a finite number",
    "bool": "true or false",
    "string": "text",
    "tuple": "a list",
    "model": "keys with values",
    "dict": "keys with values",
}


def _valid(error: ErrorDetails, field: FieldInfo | None) -> str:
    """What is valid in place of a wrong value: a range, names, or a kind of value."""
    kind = error["type"]
    if kind.startswith(("greater_than", "less_than")):
        stated = {} if field is None else dict(_bounds(*_part(field, error["loc"])))
        bounds = stated or {name: float(value) for name, value in error["ctx"].items()}
        low, high = bounds.get("ge", bounds.get("gt")), bounds.get("le", bounds.get("lt"))
        if low is None or high is None:
            form = {
                "ge": "{:g} or more",
                "gt": "more than {:g}",
                "le": "{:g} or less",
                "lt": "less than {:g}",
            }
            return " and ".join(form[name].format(value) for name, value in bounds.items())
        return f"{low:g} to {high:g}" + (", the lower end excluded" if "gt" in bounds else "")
    if kind in ("too_long", "too_short"):
        limit = error["ctx"].get("max_length", error["ctx"].get("min_length"))
        return f"at {'most' if kind == 'too_long' else 'least'} {limit}"
    if kind == "literal_error":
        return f"one of {error['ctx']['expected']}"
    return KINDS.get(kind.partition("_")[0]) or error["msg"].replace("Input should be ", "")


def _part(field: FieldInfo, place: tuple[int | str, ...]) -> tuple[Iterable[Any], Any]:
    """The metadata and the annotation of a field, or of an element of a tuple of a fixed length."""
    parts, index = get_args(field.annotation), place[1] if len(place) > 1 else None
    if isinstance(index, int) and index < len(parts) and parts[-1] is not Ellipsis:
        return getattr(parts[index], "__metadata__", ()), parts[index]
    return field.metadata, field.annotation


def _bounds(metadata: Iterable[Any], annotation: Any) -> Iterator[tuple[str, float]]:  # noqa: ANN401
    """Yields the first limits that an annotation holds, its own before those of its parts."""
    for extra in metadata:
        if isinstance(extra, FieldInfo):
            yield from _bounds(extra.metadata, None)
        for name in ("ge", "gt", "le", "lt"):
            if (limit := getattr(extra, name, None)) is not None:
                yield name, float(limit)
    for part in get_args(annotation):
        yield from _bounds(getattr(part, "__metadata__", ()), part)


def foremost(error: ValidationError) -> ErrorDetails:
    """Returns the first mistake; a key that is missing beside one that nobody knows is mistyped."""
    errors = error.errors(include_url=False)
    first = errors[0]
    if first["type"] != "missing":
        return first
    beside = (e for e in errors if e["type"] == "extra_forbidden" and e["loc"][:-1] == first["loc"][:-1])
    return next(beside, first)


def _model_at(cls: type[BaseModel], keys: list[str]) -> type[BaseModel]:
    """The model at a place in another one; items of lists are of the kind that the list holds."""
    for key in keys:
        kind = cls.model_fields[key].annotation if key in cls.model_fields else None
        kinds = (kind, *get_args(kind))
        cls = next((k for k in kinds if isinstance(k, type) and issubclass(k, BaseModel)), cls)
    return cls
