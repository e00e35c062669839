"""Recorded runs to compare with, in NAME.baseline.json beside NAME.scenario.yaml."""

import json
from collections.abc import Iterable
from dataclasses import replace
from itertools import zip_longest
from pathlib import Path
from typing import Any

import mujoco
from pydantic import Field

from harness.base.documents import read_json
from harness.base.errors import UsageError
from harness.base.files import write_whole
from harness.base.version import __version__
from harness.drivers.base import OF_POLICY
from harness.episode.result import RunResult
from harness.scenario.bound import Bound
from harness.scenario.case import Case, scenario_name
from harness.scenario.judge import value_of
from harness.scenario.series import Series
from harness.spec.run import Run
from harness.spec.value import Value, made

HASH_DIGITS = 12
MEND = "if that is meant, record it anew with --update-baseline"


class Recorded(Value):
    """A run as its baseline knows it.

    Attributes:
        of: Versions, hashes, and arguments that are not the defaults, by name. Runs that differ in one
            cannot be compared.
        values: Of the quantities that have a tolerance, by `key_of`; None where there was no value.
        log: The lines of its log, if they are to be the same.
    """

    of: dict[str, Any]
    values: dict[str, Any] = Field(default_factory=dict)
    log: tuple[str, ...] = ()


def key_of(name: str, bound: Bound) -> str:
    """Returns what a baseline calls the value of a bound, e.g. "truth.speed mean 5-10 s"."""
    window = "" if bound.window is None else f" {bound.window[0]:g}-{bound.window[1]:g} s"
    return f"{bound.label(name)} {bound.over}{window}"


def record(case: Case, result: RunResult, series: dict[str, Series]) -> Recorded:
    """Returns a run as a baseline keeps it.

    Args:
        case: What was driven, with the scenario's bounds.
        result: What it came to.
        series: Every quantity that is bounded, by its label.
    """
    # Only what is not the default: an argument that a later version adds changes nothing.
    defaults, fields = Run().fields(), _without_places(case.run).fields()
    arguments = {k: value for k, value in fields.items() if value != defaults[k]}
    if case.params:
        arguments["params"] = case.params
    versions = {"rover-harness": __version__, "mujoco": mujoco.__version__}
    info = result.info
    hashes = {"model": info.model_hash, "terrain's hash": info.terrain_hash} if info else {}
    hashes = {name: value[:HASH_DIGITS] for name, value in hashes.items()}
    log = result.log_path if case.scenario.same_bytes else None
    return Recorded(
        of=json.loads(json.dumps(versions | hashes | arguments)),  # as it is read again
        values={
            key_of(name, bound): value_of(bound, series[bound.label(name)])
            for name, bound in case.scenario.bounds
            if bound.has_baseline
        },
        log=tuple(log.read_bytes().decode().split("\r\n")) if log else (),
    )


def _without_places(run: Run) -> Run:
    """The run with the names of its files alone, whose places may change."""

    def named(file: str) -> str:
        before = OF_POLICY if file.startswith(OF_POLICY) else ""
        return before + Path(file.removeprefix(before)).name

    changes: dict[str, Any] = {
        name: named(run.fields()[name]) for name in ("terrain", "soil", "robot", "driver")
    }
    sensors = run.rover.sensors
    changes["sensors"] = sensors and tuple(replace(one, name=named(one.name)) for one in sensors)
    changes["resource_path"] = tuple(map(named, run.world.resource_path))
    changes["actors"] = tuple(
        one.in_file(named(one.file)) if one.file else one for one in run.world.actors
    )
    changes["targets"] = tuple(one.in_file(*map(named, one.files)) for one in run.world.targets)
    return run.alone(**changes)


def path_of(scenario: Path) -> Path:
    """Returns where the baseline of a scenario's file is."""
    return scenario.with_name(f"{scenario_name(scenario)}.baseline.json")


def read_baseline(case: Case) -> Recorded:
    """Returns the baseline of a run; UsageError if there is none or it cannot be read."""
    path = path_of(case.path)
    runs = _read(path)
    if case.name not in runs:
        raise UsageError(f"there is no baseline of it in {path}; record it with --update-baseline")
    return made(Recorded, runs[case.name], f"{path}: {case.name}")


def check_comparable(now: Recorded, baseline: Recorded) -> None:
    """Raises UsageError if a run and its baseline differ in an argument, a version, model or terrain."""
    for name in {**baseline.of, **now.of}:
        was, is_now = (run.of.get(name, "the default") for run in (baseline, now))
        if was != is_now:
            raise UsageError(f"the baseline is of {name} {was}, this run of {is_now}; {MEND}")


def first_difference(now: Recorded, baseline: Recorded) -> str | None:
    """Returns where the log leaves that of the baseline, e.g. "same_bytes: row 3: ..."."""
    header = baseline.log[0].split(",") if baseline.log else []
    for row, (is_now, was) in enumerate(zip_longest(now.log, baseline.log, fillvalue="")):
        if is_now != was:
            cells = zip_longest(header, is_now.split(","), was.split(","), fillvalue="")
            name, left, right = next(cell for cell in cells if cell[1] != cell[2])
            return f"same_bytes: row {row}: {name} is {left or 'nothing'}, baseline {right or 'nothing'}"
    return None


def write_baselines(records: Iterable[tuple[Case, Recorded]]) -> list[Path]:
    """Writes runs into the baselines of their scenarios, beside other runs there; returns the files."""
    files: dict[Path, dict[str, Any]] = {}
    for case, recorded in records:
        path = path_of(case.path)
        if path not in files:
            files[path] = _read(path)
        files[path][case.name] = recorded.model_dump()
    for path, runs in files.items():
        write_whole(path, json.dumps(runs, indent=1, allow_nan=False) + "\n", "the baseline", UsageError)
    return list(files)


def _read(path: Path) -> dict[str, Any]:
    if not path.exists():
        return {}
    runs = read_json(path)
    if not isinstance(runs, dict):
        raise UsageError(f"the baseline {path} must hold runs by name; {MEND}")
    return runs
