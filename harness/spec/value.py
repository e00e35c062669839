"""Frozen values, and the one door through which text and the keys of files become them."""

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Self, TypeVar

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, PlainSerializer, ValidationError

from harness.base.errors import UsageError, unknown
from harness.spec.complaint import complaint
from rover_metrics.errors import shown
from rover_metrics.number import NUMBER, number

Finite = Annotated[float, Field(allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]
Seconds = NotNegative
Length = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
Share = Annotated[float, Field(ge=0.0, le=1.0)]
Latitude = Annotated[float, Field(ge=-89.9, le=89.9)]
Longitude = Annotated[float, Field(ge=-180.0, le=180.0)]
Seed = Annotated[int, Field(ge=0)]


class Value(BaseModel):
    """A value that never changes; a key that it does not have is refused.

    `model_construct` makes one of fields as they are, whose schema need not be built for it: for what
    the program states itself at import, and for a value of which parts are still missing.
    """

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
    """

    metavar: str
    flag: str = ""
    also: tuple[str, ...] = ()
    bare: str | None = None
    many: bool = False


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
            raise UsageError(f"{prefix}{name(key)} {shown(repr(text))} is not valid; give a number")
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
