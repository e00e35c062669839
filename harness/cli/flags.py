"""Options of a command line, made from the fields of values."""

import argparse
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path
from typing import Any, Literal, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from harness.spec.value import Option, V, made

Group = argparse._ArgumentGroup  # noqa: SLF001 - what add_argument_group returns has no public name
DEFAULT = "; default: "


def add_flags(
    group: Group,
    cls: type[BaseModel],
    names: Collection[str] = (),
    texts: Mapping[str, str] | None = None,
) -> None:
    """Adds an option for each field that has one; what is not given stays out of the namespace.

    Args:
        group: Gets the options.
        cls: Whose fields they are.
        names: Of the fields; all if empty.
        texts: Help in place of the fields' descriptions, by the names of fields.
    """
    for name, field, option in options_of(cls):
        if names and name not in names:
            continue
        text = (texts or {}).get(name) or field.description or ""
        flag = flag_of(name, option)
        if not option.metavar:
            group.add_argument(
                flag, *option.also, dest=name, action="store_true", default=argparse.SUPPRESS, help=text
            )
            continue
        is_named = get_origin(field.annotation) is Literal
        is_list = isinstance(field.default, tuple) and not option.many and field.default == ()
        group.add_argument(
            flag,
            *option.also,
            dest=name,
            action="append" if is_list else "store",
            nargs="+" if option.many else "?" if option.bare is not None else None,
            const=option.bare,
            type=Path if field.annotation in (Path, Path | None) else str,
            choices=[*filter(None, get_args(field.annotation))] if is_named else None,
            default=argparse.SUPPRESS,
            metavar=option.metavar,
            help=f"{text}{_default(field, text)}".replace("%", "%%"),
        )


def options_of(cls: type[BaseModel]) -> Iterator[tuple[str, FieldInfo, Option]]:
    """Yields the name, the field and the option of each field that stands on a command line."""
    for name, field in cls.model_fields.items():
        for extra in field.metadata:
            if isinstance(extra, Option):
                yield name, field, extra


def flag_of(name: str, option: Option | None = None) -> str:
    """Returns the flag of a field, e.g. --terrain-size."""
    own = option.flag if option is not None else ""
    return f"--{(own or name).replace('_', '-')}"


def flags_of(*classes: type[BaseModel]) -> dict[str, str]:
    """Returns the flags of all fields of values, by their names."""
    return {name: flag_of(name, option) for cls in classes for name, _, option in options_of(cls)}


def from_flags(cls: type[V], given: argparse.Namespace, **others: object) -> V:
    """Returns a value of given options and other fields; UsageError names the flag of a wrong one."""
    flags = flags_of(cls)
    values = {name: value for name, value in vars(given).items() if name in flags}
    return made(cls, values | others, name=lambda name: flags.get(name, name))


def _default(field: FieldInfo, text: str) -> str:
    default: Any = field.get_default()
    if "default" in text or default in (None, "", ()) or field.is_required():
        return ""
    words = default if isinstance(default, tuple) else (default,)
    return DEFAULT + ",".join(f"{word:g}" if isinstance(word, float) else str(word) for word in words)
