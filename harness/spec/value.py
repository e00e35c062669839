"""Frozen values, and the one door through which text and the keys of files become them."""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Self, TypeVar, get_args

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    PlainSerializer,
    ValidationError,
)
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from harness.base.errors import UsageError, unknown
from rover_metrics.number import NUMBER, number

Finite = Annotated[float, Field(allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]
Seconds = NotNegative
Length = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
Share = Annotated[float, Field(ge=0.0, le=1.0)]
Seed = Annotated[int, Field(ge=0)]


class Value(BaseModel):
    """A value that never changes; a key that it does not have is refused."""

    model_config = ConfigDict(frozen=True, extra="forbid", validate_default=True, defer_build=True)

    def but(self, **changes: Any) -> Self:  # noqa: ANN401 - as the fields are
        """Returns a copy with other values of some fields; UsageError if one is not valid."""
        return made(type(self), self.__dict__ | changes)


V = TypeVar("V", bound=BaseModel)


@dataclass(frozen=True)
class Option:
    """How a field stands on a command line.

    Attributes:
        metavar: What stands for its value in the help; "" for a switch.
        flag: Without the dashes; the field's own name if empty.
        also: Further names of the flag, with their dashes, from before it was called so.
        bare: The value that the flag has without one; None if it needs one.
        many: Whether several values may stand behind the flag.
        choices: Names that are valid.
    """

    metavar: str
    flag: str = ""
    also: tuple[str, ...] = ()
    bare: str | None = None
    many: bool = False
    choices: tuple[str, ...] = ()


def made(
    cls: type[V], values: Mapping[str, Any], where: str = "", name: Callable[[str], str] = str
) -> V:
    """Returns a value made of words or of what a file holds.

    Args:
        cls: What to make.
        values: Its fields by name; text is converted.
        where: What the values belong to, for the message, e.g. a file.
        name: How a user calls a field, e.g. by a flag.

    Raises:
        UsageError: One is missing, unknown or not valid; the message names what is.
    """
    prefix = f"{where}: " if where else ""
    try:
        value = cls.model_validate(values)
    except ValidationError as error:
        raise UsageError(f"{prefix}{complaint(error, cls, name)}") from error
    for key, text in values.items():  # pydantic reads 1_000 as a number, and true as 1
        if _is_no_number(text, getattr(value, key, None)):
            raise UsageError(f"{prefix}{name(key)} {_shown(text)} is not valid; give a number")
    return value


def _is_no_number(given: object, taken: object) -> bool:
    """Whether a number was taken from what is none: a text of another form, or true or false."""
    if isinstance(given, list | tuple) and isinstance(taken, tuple):
        return any(map(_is_no_number, given, taken))
    if isinstance(given, Mapping) and isinstance(taken, BaseModel):
        return any(_is_no_number(given[key], getattr(taken, key, None)) for key in given)
    if type(taken) not in (int, float):
        return False
    return isinstance(given, bool) or (isinstance(given, str) and not NUMBER.fullmatch(given.strip()))


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
    return f"{field} {_shown(error['input'])} is not valid; give {_valid(error, info)}"


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


def _shown(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 80 else f"{text[:77]}..."


def as_tuple(value: object) -> object:
    """Returns a list as a tuple, which strict types of fields demand, and anything else as it is."""
    return tuple(value) if isinstance(value, list) else value


def parsed(parse: Callable[[str], Any]) -> BeforeValidator:
    """Returns a validator that makes a value of its text, and takes UsageError for a mistake of it."""

    def convert(value: object) -> object:
        if not isinstance(value, str):
            return as_tuple(value)
        try:
            return parse(value)
        except UsageError as error:
            raise ValueError(str(error)) from error

    return BeforeValidator(convert)


def checked(check: Callable[[Any], object]) -> Callable[[Any], Any]:
    """Returns a validator that asks a check which raises UsageError."""

    def validate(value: object) -> object:
        try:
            check(value)
        except UsageError as error:
            raise ValueError(str(error)) from error
        return value

    return validate


def words_of(text: str, known: Collection[str] = (), where: str = "") -> dict[str, str]:
    """Returns the words of KEY=VALUE,KEY=VALUE,... by their keys; UsageError for one that is not known.

    Args:
        text: What a user has written; "" has no words.
        known: Valid keys; all are where there are none.
        where: How a message begins.
    """
    words = {key: value for key, _, value in (pair.partition("=") for pair in text.split(",") if pair)}
    wrong = next((key for key in words if known and key not in known), None)
    if wrong is not None:
        raise UsageError(f"{where}{unknown('key', wrong, known)}")
    return words


AsText = PlainSerializer(str, return_type=str)


def numbers(form: str, count: int, *, rest: float | None = None) -> BeforeValidator:
    """Returns a validator that reads numbers from text.

    Args:
        form: What to write, for the message, e.g. "X,Y[,YAW] in metres and radians".
        count: How many numbers there are.
        rest: The last one, if it is left out; None if it must be given.
    """

    def parse(text: str) -> tuple[float, ...]:
        words = text.split(",")
        if rest is not None and len(words) == count - 1:
            words.append(str(rest))
        try:
            values = tuple(map(number, words))
        except ValueError:
            values = ()
        if len(values) != count:
            raise UsageError(f"'{text}' is not valid; give {form}")
        return values

    return parsed(parse)


def listed(separator: str = "") -> BeforeValidator:
    """Returns a validator that takes one value for a list of one, and splits text at a separator."""

    def convert(value: object) -> object:
        words = (value,) if isinstance(value, str) else as_tuple(value)
        if not (separator and isinstance(words, tuple)):
            return words
        texts = ([w] if not isinstance(w, str) else w.split(separator) for w in words)
        return tuple(w.strip() if isinstance(w, str) else w for text in texts for w in text)

    return BeforeValidator(convert)
