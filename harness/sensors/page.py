"""Program: the tables of docs/sensors.md, from the sensor table and the options' own descriptions.

    python -m harness.sensors.page docs/sensors.md

Without a page it prints them. What stands outside the two marks of the page is written by hand.
"""

import re
import sys
from collections.abc import Iterator, Sequence
from inspect import cleandoc
from pathlib import Path

from harness.base.errors import UsageError
from harness.base.files import write_whole
from harness.sensors.choice import by_default, kinds
from harness.sensors.optional import SensorOptions
from harness.sensors.table import SensorRow
from rover_metrics.errors import run_program

BEGIN, END = (
    "<!-- python -m harness.sensors.page: begin -->",
    "<!-- python -m harness.sensors.page: end -->",
)


def tables() -> str:
    """Returns the kinds of optional sensors, what all of them and each can be told, and the presets."""
    rows = [(row, row.given) for row in by_default() if row.given is not None]
    lines = ["| kind | what it is | topics, by default | rate [Hz] |", "| --- | --- | --- | ---: |"]
    lines += [f"| `{r.fault}` | {r.summary} | {_topics(r)} | {r.rate} |" for r, _ in rows]
    lines += ["", "Every kind takes:", "", *_options(SensorOptions)]
    for row, given in rows:
        lines += ["", f"`{row.fault}` takes besides:", "", *_options(type(given), SensorOptions)]
        lines += _presets(type(given))
    return "\n".join(lines) + "\n"


def _topics(row: SensorRow) -> str:
    """Those that are always there, and those that an option brings."""
    template = kinds()[str(row.fault)]
    told = [
        f"`/{row.fault}/{topic.name}` {topic.message_type.replace('/msg/', '/')}"
        for topic in template.topics
    ]
    options = [f" (`{topic.option}`)" if topic.option else "" for topic in template.topics]
    return "<br>".join(map("".join, zip(told, options, strict=True)))


def _options(kind: type[SensorOptions], without: type[SensorOptions] | None = None) -> Iterator[str]:
    yield "| option | default | what |"
    yield "| --- | --- | --- |"
    inherited = {name: item.default for name, item in without.model_fields.items()} if without else {}
    known = described(kind)
    for name, item in kind.model_fields.items():
        if name != "name" and (name not in inherited or item.default != inherited[name]):
            yield f"| `{name}` | {_text(item.default)} | {known[name]} |"


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
    if kind.presets:
        yield ""
    usual = kind.model_fields["preset"].default if kind.presets else ""
    for name, values in kind.presets.items():
        told = ", ".join(f"{key} {_text(value)}" for key, value in values.items())
        told = told or ("the defaults" if name == usual else "")
        yield f"- preset `{name}`: {told}" if told else f"- preset `{name}`"


def described(kind: type) -> dict[str, str]:
    """Returns what the docstrings of a class and those above it say of its attributes."""
    found: dict[str, str] = {}
    for cls in reversed(kind.__mro__):
        _, _, told = cleandoc(cls.__doc__ or "").partition("Attributes:\n")
        for name, text in re.findall(r"^    (\w+): ((?:.|\n {8})*)", told, re.MULTILINE):
            found[name] = " ".join(text.split())
    return found


def written(page: str) -> str:
    """Returns a page with the tables between its marks.

    Raises:
        UsageError: It has not got them.
    """
    before, _, rest = page.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not end:
        raise UsageError(f"the page has no place for the tables; give it the lines {BEGIN} and {END}")
    return f"{before}{BEGIN}\n{tables()}{END}{after}"


def main(names: Sequence[str]) -> int:
    """Writes the tables into pages, or prints them if there are none; returns the exit code."""
    for path in map(Path, names):
        write_whole(path, written(path.read_text(encoding="utf-8")), "the page")
    if not names:
        print(tables(), end="")
    return 0


if __name__ == "__main__":
    sys.exit(run_program("harness.sensors.page", lambda: main(sys.argv[1:])))
