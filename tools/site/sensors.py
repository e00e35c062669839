"""The tables of docs/sensors.md, from the sensor table and what the options say of themselves."""

import re
from collections.abc import Iterator
from inspect import cleandoc

from harness.sensors.choice import by_default
from harness.sensors.optional import SensorOptions
from harness.sensors.table import OPTIONAL, SensorRow
from rover_metrics.sheet.render import markdown
from rover_metrics.sheet.sheet import Sheet


def tables() -> str:
    """Returns the kinds of optional sensors, the options of all and of each, and the presets."""
    rows = [(row, row.given) for row in by_default() if row.given is not None]
    titles = ("kind", "what it is", "topics, by default", "rate [Hz]")
    cells = ((f"`{row.fault}`", row.summary, _topics(row), str(row.rate)) for row, _ in rows)
    parts = [markdown(Sheet(titles, tuple(cells))), "Every kind takes:\n", _options(SensorOptions)]
    for row, given in rows:
        parts += [f"`{row.fault}` takes besides:\n", _options(type(given), SensorOptions)]
        if given.presets:
            parts.append("\n".join(_presets(type(given))) + "\n")
    return "\n".join(parts)


def _topics(row: SensorRow) -> str:
    """Those that are always there, and those that an option brings."""
    template = OPTIONAL.shipped[str(row.fault)]
    topics = [
        f"`/{row.fault}/{topic.name}` {topic.message_type.replace('/msg/', '/')}"
        for topic in template.topics
    ]
    options = [f" (`{topic.option}`)" if topic.option else "" for topic in template.topics]
    return "<br>".join(map("".join, zip(topics, options, strict=True)))


def _options(kind: type[SensorOptions], without: type[SensorOptions] | None = None) -> str:
    """The options of a kind; those that it has from another class only where their default differs."""
    inherited = {name: item.default for name, item in without.model_fields.items()} if without else {}
    known = described(kind)
    defaults = {name: item.default for name, item in kind.model_fields.items() if name != "name"}
    rows = (
        (f"`{name}`", _text(default), known[name])
        for name, default in defaults.items()
        if name not in inherited or default != inherited[name]
    )
    return markdown(Sheet(("option", "default", "meaning"), tuple(rows)))


def _text(value: object) -> str:
    """A default as YAML has it."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, tuple):
        return f"[{', '.join(map(_text, value))}]"
    if isinstance(value, float):
        return f"{value:.6g}"
    return str(value) if isinstance(value, str | int) else "none"


def _presets(kind: type[SensorOptions]) -> Iterator[str]:
    usual = kind.model_fields["preset"].default if kind.presets else ""
    for name, values in kind.presets.items():
        meaning = ", ".join(f"{key} {_text(value)}" for key, value in values.items())
        meaning = meaning or ("the defaults" if name == usual else "")
        yield f"- preset `{name}`: {meaning}" if meaning else f"- preset `{name}`"


def described(kind: type) -> dict[str, str]:
    """Returns what the docstrings of a class and those above it say of its attributes."""
    texts: dict[str, str] = {}
    for cls in reversed(kind.__mro__):
        _, _, attributes = cleandoc(cls.__doc__ or "").partition("Attributes:\n")
        for name, text in re.findall(r"^    (\w+): ((?:.|\n {8})*)", attributes, re.MULTILINE):
            texts[name] = " ".join(text.split())
    return texts
