"""The tables of docs/gym.md, from the environments themselves."""

import inspect
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, cast

from gymnasium import spaces

from harness.gym import ENVIRONMENTS
from harness.gym.options import Options, RunOptions
from harness.spec.value import Value
from rover_metrics.sheet.render import markdown
from rover_metrics.sheet.sheet import Sheet
from tools.site.sensors import described

if TYPE_CHECKING:
    from harness.gym.env import RoverEnv

MOST_SPANS = 9  # limits of single numbers that are listed


def shared_options() -> str:
    """Returns the table of the options that all environments have."""
    return _options(Options)


def tables(name: str) -> str:
    """Returns the tables of an environment by its id: observations, actions, endings, own options."""
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
            _table(("ending", "what"), [(f"`{end}`", about) for end, about in env.endings.items()]),
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
    made, meanings = cls(), described(cls)
    of_runs = RunOptions.model_fields if cls is Options else {}
    for name in (*of_runs, *inspect.get_annotations(cls)):
        value = getattr(made, name)
        rows.append(
            (f"`{name}`", _default(value), meanings.get(name) or of_runs[name].description or "")
        )
        inner = vars(value) if isinstance(value, Value) else {}
        rows += [(f"`{name}` `{k}`", _default(v), described(type(value))[k]) for k, v in inner.items()]
    return _table(("option", "default", "what"), rows) if rows else ""


def _default(value: object) -> str:
    if isinstance(value, Value):
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
    return markdown(Sheet(columns, tuple(rows)))
