"""Command: the tables of docs/gym.md, made from the environments themselves.

python -m harness.gym.tables [--write docs/gym.md]
"""

import argparse
import inspect
import re
import sys
from collections.abc import Iterable, Sequence
from dataclasses import is_dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from rover_metrics.errors import OneLineParser, begin_program, run_program

if __name__ == "__main__":
    begin_program("harness.gym.tables")

from gymnasium import spaces

from harness.base.errors import UsageError
from harness.gym import ENVIRONMENTS
from harness.gym.options import Options

if TYPE_CHECKING:
    from harness.gym.env import RoverEnv

COMMAND = "python -m harness.gym.tables --write docs/gym.md"
PART = re.compile(r"(<!-- tables of (\S+) -->\n).*?(<!-- end of tables -->)", re.DOTALL)
ATTRIBUTE = re.compile(r"^    (\w+): (.*(?:\n {8}.*)*)", re.MULTILINE)
SHARED = "options"
MOST_SPANS = 9  # limits of single numbers that are told


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = OneLineParser(prog="python -m harness.gym.tables", description="The tables of docs/gym.md.")
    parser.add_argument(
        "--write", type=Path, metavar="FILE", help="put them in their places in this page"
    )
    return run_program("harness.gym.tables", lambda: _run(parser.parse_args(arguments)))


def _run(options: argparse.Namespace) -> int:
    if options.write is None:
        print("\n".join(tables(name) for name in (SHARED, *ENVIRONMENTS)))
    else:
        options.write.write_text(filled(options.write.read_text(encoding="utf-8")), encoding="utf-8")
    return 0


def filled(page: str) -> str:
    """Returns a page with its tables as they are now.

    Raises:
        UsageError: It has a place for tables of what is no environment.
    """
    return PART.sub(lambda found: f"{found[1]}{tables(found[2])}\n{found[3]}", page)


def tables(name: str) -> str:
    """Returns the tables of an environment by its id, or those of the options that all have.

    Raises:
        UsageError: There is no such environment.
    """
    if name == SHARED:
        return _options(Options)
    if name not in ENVIRONMENTS:
        raise UsageError(f"environment '{name}' does not exist; available: {', '.join(ENVIRONMENTS)}")
    env = cast("RoverEnv[Any]", ENVIRONMENTS[name]())
    seen = [
        (f"`{part}`", _shape(box), _span(box), env.parts[part].about)
        for part, box in env.observation_space.items()
    ]
    actions = zip(env.action_space.low, env.action_space.high, env.actions, strict=True)
    return "\n".join(
        table
        for table in (
            _table(("observation", "shape", "from .. to", "what"), seen),
            _table(("action", "from .. to", "what"), _actions(actions)),
            _table(("ending", "what"), [(f"`{end}`", told) for end, told in env.endings.items()]),
            _options(type(env.options)),
        )
        if table
    )


def _actions(actions: Iterable[tuple[float, float, str]]) -> list[tuple[str, ...]]:
    return [
        (str(index), f"{low:.4g} .. {high:.4g}", about)
        for index, (low, high, about) in enumerate(actions)
    ]


def _options(cls: type[Options]) -> str:
    """A table of what a class declares itself, one row for each field of the dataclasses in it."""
    rows: list[tuple[str, ...]] = []
    made, told = cls(), _told(cls)
    for name in inspect.get_annotations(cls):
        value = getattr(made, name)
        rows.append((f"`{name}`", _default(value), told[name]))
        inner = vars(value) if is_dataclass(value) else {}
        rows += [(f"`{name}` `{k}`", _default(v), _told(type(value))[k]) for k, v in inner.items()]
    return _table(("option", "default", "what"), rows) if rows else ""


def _told(cls: type) -> dict[str, str]:
    """What the docstring of a dataclass says of its fields."""
    text = inspect.cleandoc(cls.__doc__ or "")
    return {name: " ".join(about.split()) for name, about in ATTRIBUTE.findall(text)}


def _default(value: object) -> str:
    if is_dataclass(value):
        return "as below"
    return f"`{list(value) if isinstance(value, tuple) else value!r}`"


def _shape(box: spaces.Space[Any]) -> str:
    return f"`{box.shape}`"


def _span(box: Any) -> str:  # noqa: ANN401 - Box is generic
    spans = dict.fromkeys(
        f"{low:.4g} .. {high:.4g}" for low, high in zip(box.low, box.high, strict=True)
    )
    return (
        ", ".join(spans)
        if len(spans) <= box.shape[0] // 2 or box.shape[0] < MOST_SPANS
        else "of each part"
    )


def _table(columns: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> str:
    lines = (f"| {' | '.join(cells)} |" for cells in (columns, ("---",) * len(columns), *rows))
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    sys.exit(main())
