"""Pages made from the code: commands, topics and the Python reference."""

import importlib
import io
import os
import sys
from contextlib import redirect_stdout, suppress
from unittest import mock

import tomllib

import harness
import rover_metrics
from harness.robots import ROVERS
from harness.sensors.table import SENSORS, Topic
from rover_metrics.topics import SENSORS as HEARD
from rover_metrics.topics import TRUTH
from tools.site.pages import ROOT

WIDTH = "100"  # columns of a help text


def generated() -> dict[str, str]:
    """Returns the text of each page that is made from the code."""
    texts = {"commands": commands(), "topics": topics(), "python": python()}
    return {f"reference/{name}.md": text for name, text in texts.items()}


def commands() -> str:
    """Returns the page of the commands: what each says when it is asked for --help."""
    scripts = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["scripts"]
    about = (
        "Each is installed as a script; `python -m MODULE` is the same. "
        "Exit codes: 0 it is as it should be, 1 it is not, 2 it was asked for in a wrong way."
    )
    parts = [f"# Commands\n\n{about}\n"]
    for script in sorted(scripts):
        if script.startswith("rover-"):
            module, text = _help(script, scripts[script])
            parts.append(f"## {script}\n\n`python -m {module}`\n\n```text\n{text.strip()}\n```\n")
    return "\n".join(parts)


def _help(script: str, entry_point: str) -> tuple[str, str]:
    """The module of an installed command, and its help."""
    place, _, name = entry_point.partition(":")
    (module,) = getattr(importlib.import_module(place), name).args
    told = io.StringIO()
    environment = mock.patch.dict(os.environ, COLUMNS=WIDTH)
    called = mock.patch.object(sys, "argv", [script])
    with environment, called, redirect_stdout(told), suppress(SystemExit):
        importlib.import_module(module).main(["--help"])
    return module.removesuffix(".__main__"), told.getvalue()


def topics() -> str:
    """Returns the page of the topics that sensors publish, and of those that the metrics hear."""
    lines = [
        "# Topics of the sensors\n",
        "In publishing order; rates in simulation time. Others can be [asked for](../sensors.md).\n",
        "| topic | type | QoS | rate [Hz] | frame | `--fault` | heard by `metrics_node` |",
        "|---|---|---|---|---|---|---|",
    ]
    heard = {source.name.lstrip("/") for source in (*HEARD, *TRUTH)}
    for row in SENSORS:
        if row.rate == 0:  # only where it is asked for
            continue
        rates = _by_robot({name: str(row.rate_on(rover)) for name, rover in ROVERS.items()})
        frames = _by_robot({name: row.frame_on(rover) for name, rover in ROVERS.items()})
        for topic in row.topics:
            cells = (f"`/{topic.name}`", topic.message_type.replace("/msg/", "/"), _qos(topic), rates)
            more = (frames, row.fault or "", "yes" if topic.name in heard else "")
            lines.append(f"| {' | '.join((*cells, *more))} |")
    return "\n".join(lines) + "\n"


def _by_robot(values: dict[str, str]) -> str:
    """One value if all robots have the same, else each with its robot."""
    if len(set(values.values())) == 1:
        return next(iter(values.values()))
    return ", ".join(f"{robot} {value}" for robot, value in values.items())


def _qos(topic: Topic) -> str:
    latched = ", latched" if topic.latched else ""
    return f"{'best effort' if topic.best_effort else 'reliable'}{latched}, {topic.depth}"


def python() -> str:
    """Returns the page of the Python API, for mkdocstrings to fill."""
    parts = ["# Python reference\n\nWhat is stable, and how it is used: [Python API](../api.md).\n"]
    for package in (harness, rover_metrics):
        parts.append(f"## {package.__name__}\n")
        parts += [f"::: {package._PLACES[name]}.{name}\n" for name in package.__all__]  # noqa: SLF001
    return "\n".join(parts)
