"""Pages made from the code: commands, keys of scenarios and the Python reference."""

import importlib
import io
import json
import os
import sys
from contextlib import redirect_stdout, suppress
from typing import Any
from unittest import mock

import tomllib

import harness
import rover_metrics
from rover_metrics.sheet.render import markdown
from rover_metrics.sheet.sheet import Sheet
from tools.site.links import REPOSITORY
from tools.site.pages import ROOT

SCHEMA = "scenarios/scenario.schema.json"
WIDTH = "100"  # columns of a help text


def generated() -> dict[str, str]:
    """Returns the text of each page that is made from the code."""
    texts = {"commands": commands(), "scenario_file": scenario_file(), "python": python()}
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
    printed = io.StringIO()
    environment = mock.patch.dict(os.environ, COLUMNS=WIDTH)
    called = mock.patch.object(sys, "argv", [script])
    with environment, called, redirect_stdout(printed), suppress(SystemExit):
        importlib.import_module(module).main(["--help"])
    return module.removesuffix(".__main__"), printed.getvalue()


def scenario_file() -> str:
    """Returns the page of the keys of a scenario's file, from its JSON schema."""
    schema = json.loads((ROOT / SCHEMA).read_text())
    parts = [
        "# Keys of a scenario file\n",
        f"From [its JSON schema]({REPOSITORY}/blob/main/{SCHEMA}).",
        "What they mean, and the quantities of `expect`: [Scenarios](../scenarios.md).\n",
    ]
    for name, rules in (("The file", schema), *schema["$defs"].items()):
        required = rules.get("required", ())
        rows = tuple(
            (f"`{key}`", _type(rule), "required" if key in required else _default(rule))
            for key, rule in rules["properties"].items()
        )
        about = rules["description"].partition("\n")[0]
        parts.append(f"## {name}\n\n{about}\n\n{markdown(Sheet(('key', 'type', 'default'), rows))}")
    return "\n".join(parts)


def _type(rule: dict[str, Any]) -> str:
    """What a key may hold, in a few words."""
    if "$ref" in rule:
        name = rule["$ref"].rpartition("/")[2]
        return f"[{name}](#{name.lower()})"
    if either := rule.get("anyOf") or rule.get("oneOf"):
        return " or ".join(_type(one) for one in either if one.get("type") != "null")
    if "enum" in rule:
        return ", ".join(f"`{value}`" for value in rule["enum"])
    if rule["type"] == "array":
        items = rule.get("prefixItems", [rule.get("items", {})])
        count = f"{len(items)} " if "prefixItems" in rule else ""
        return f"list of {count}{_type(items[0])}".replace("string", "strings").replace(
            "number", "numbers"
        )
    if rule["type"] == "object" and "additionalProperties" in rule:
        return f"quantity: {_type(rule['additionalProperties'])}"
    return str(rule["type"])


def _default(rule: dict[str, Any]) -> str:
    default = rule.get("default")
    return (
        f"`{json.dumps(default)}`"
        if default not in (None, [], {}) and not isinstance(default, dict)
        else ""
    )


def python() -> str:
    """Returns the page of the Python API, for mkdocstrings to fill."""
    parts = ["# Python reference\n\nWhat is stable, and how it is used: [Python API](../api.md).\n"]
    for package in (harness, rover_metrics):
        parts.append(f"## {package.__name__}\n")
        parts += [f"::: {package._PLACES[name]}.{name}\n" for name in package.__all__]  # noqa: SLF001
    return "\n".join(parts)
