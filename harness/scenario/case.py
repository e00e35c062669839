"""Files and folders of scenarios to runs: every combination of a matrix with every seed."""

import math
import re
import shlex
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import product
from pathlib import Path
from typing import Any

from harness.base.errors import UsageError
from harness.drivers import takes_goals
from harness.drivers.base import OF_POLICY
from harness.episode.assembly import check, tells_energy
from harness.robots import ROVERS
from harness.scenario.quantities import LOG
from harness.scenario.reading import SUFFIX, place_quoted, read_scenario
from harness.scenario.spec import MOST_RUNS, ExpectedFailure, Scenario
from harness.scenario.steps import (
    AbortEvent,
    CommandEvent,
    FaultEvent,
    LinkLossEvent,
    ResetEvent,
    ResumeEvent,
)
from harness.spec.rover import RoverSetup
from harness.spec.run import Run
from rover_metrics.errors import ParameterError, sibling
from rover_metrics.extended.energy_columns import EnergyColumns
from rover_metrics.extended.parameter_file import read_values
from rover_metrics.plugins import FILE

Cell = tuple[tuple[str, Any], ...]  # values of a matrix by name
Selected = tuple[tuple[str, str], ...]  # names and values of the matrix, as text
UNSAFE = re.compile(r"[^\w.,+=@-]")  # in the name of a folder, to shells or to Windows
NULL = "null"  # of a matrix, as files say it
SCRATCH = "rover-scenario-"  # how folders begin for the logs of runs


@dataclass(frozen=True)
class Case:
    """One run of a scenario.

    `cell` are the values of the matrix that it has, `params` the parameters of the metrics that are not
    the defaults.
    """

    path: Path
    scenario: Scenario
    cell: Cell
    run: Run
    params: dict[str, Any] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """Returns e.g. "kerb[leo-rocky-3]": the scenario, the values of its matrix, the seed."""
        values = [_called(value) for _, value in self.cell]
        return f"{scenario_name(self.path)}[{'-'.join([*values, str(self.run.seed)])}]"

    @property
    def command(self) -> str:
        """Returns what repeats this run alone."""
        only = [word for name, value in self.cell for word in ("--only", f"{name}={_said(value)}")]
        words = [str(self.path), "--seed", str(self.run.seed), *only]
        return f"{sibling('harness.scenario')} {shlex.join(words)}"

    @property
    def expected_failure(self) -> ExpectedFailure | None:
        """Returns why this run is known to fail, or None."""
        robot, terrain = self.run.rover.robot, _called(self.run.world.terrain)
        for known in self.scenario.expected_to_fail:
            if known.robot in (None, robot, _called(robot)) and known.terrain in (None, terrain):
                return known
        return None

    @property
    def folder(self) -> Path:
        """Returns where its evidence goes, below a folder for that of all, e.g. kerb@leo-rocky-3."""
        inside = [part for part in self.path.parent.parts if part not in ("..", self.path.anchor)]
        return Path(*inside, UNSAFE.sub("_", self.name.replace("[", "@").removesuffix("]")))


def cell_name(cell: Cell) -> str:
    """Returns what the runs of a cell have in common, e.g. "leo, gravel, 0.5"."""
    return ", ".join(f"no {name}" if value is None else _called(value) for name, value in cell)


def _called(value: object) -> str:
    """What a value of a matrix is called: a path by its last part."""
    return Path(_said(value)).name


def _said(value: object) -> str:
    """A value of a matrix as the file says it."""
    return NULL if value is None else str(value)


def scenario_name(path: Path) -> str:
    """Returns the name of a file without `.scenario.yaml`."""
    return path.name.removesuffix(".yaml").removesuffix(".scenario")


def cases_of(path: Path, scenario: Scenario, seeds: Sequence[int] | None = None) -> list[Case]:
    """Returns the runs of a scenario, checked.

    Args:
        path: Its file; a terrain's file stands relative to its folder.
        scenario: What it says.
        seeds: Instead of its own.

    Raises:
        UsageError: A name or a value in it is not valid.
    """
    lists = {name: values for name, values in scenario.matrix if values}
    _check_number(len(seeds or scenario.all_seeds) * math.prod(map(len, lists.values())), f"{path}: ")
    for name, values in lists.items():
        called = [_called(value) for value in values]
        if twice := [one for one in called if called.count(one) > 1]:
            raise UsageError(
                f"{path}: {name}: two are called '{twice[0]}', and so is their evidence; rename one"
            )
    cells = [tuple(zip(lists, values, strict=True)) for values in product(*lists.values())]
    try:
        cases = [
            Case(path, scenario, cell, _run(path, scenario, dict(cell), seed), params)
            for cell in cells
            for params in [_params(path, dict(cell).get("params", scenario.params))]
            for seed in (seeds or scenario.all_seeds)
        ]
        for case in cases:
            check(case.run)
            _check_energy(case)
    except UsageError as error:
        raise UsageError(f"{path}{place_quoted(path, str(error))}: {error}") from error
    return cases


def _check_energy(case: Case) -> None:
    columns = [f"{LOG}{column.header}" for column in EnergyColumns.COLUMNS]
    asked = [name for name in case.scenario.quantities if name in columns]
    if asked and not tells_energy(case.run.rover):
        raise UsageError(
            f"'{asked[0]}' is of a rover with a battery; give sensors: [battery] and actuators: real"
        )


def _check_number(runs: int, where: str = "") -> None:
    if runs > MOST_RUNS:
        raise UsageError(f"{where}{runs:,} runs are more than {MOST_RUNS:,}; give fewer seeds or values")


def _beside(path: Path, name: str) -> str:
    """A file, also that of FILE.py:NAME, beside the scenario if it is there, else the name as it is."""
    file, is_part, part = name.partition(FILE)
    there = path.parent / (f"{file}.py" if is_part else name)
    return f"{there}:{part}" if is_part and there.is_file() else str(there if there.is_file() else name)


def _robot_beside(path: Path, robot: str) -> str:
    """A rover's folder beside the scenario if it is there, else the name as it is."""
    there = path.parent / robot
    return str(there) if robot not in ROVERS and (there / "rover.yaml").is_file() else robot


def _part_beside(path: Path, part: str) -> str:
    """A driver or a sensor; the file of a policy or of FILE.py:NAME is the one beside the scenario."""
    if part.startswith(OF_POLICY):
        return f"{OF_POLICY}{_beside(path, part.removeprefix(OF_POLICY))}"
    return _beside(path, part) if FILE in part else part


def _params(path: Path, name: str | None) -> dict[str, Any]:
    try:
        return {} if name is None else read_values(Path(_beside(path, name)), None)
    except ParameterError as error:
        raise UsageError(f"params: {error}") from error


def _run(path: Path, scenario: Scenario, cell: dict[str, Any], seed: int) -> Run:
    values = scenario.run_values() | {name: value for name, value in cell.items() if name != "params"}
    values |= {name: "" for name in ("soil", "surface") if name in cell and cell[name] is None}
    places = {"terrain": _beside, "soil": _beside, "robot": _robot_beside, "driver": _part_beside}
    for name, place in places.items():
        if values.get(name):
            values[name] = place(path, values[name])
    if values.get("sensors"):
        values["sensors"] = tuple(_part_beside(path, str(choice)) for choice in values["sensors"])
    folders = [(path.parent / name, name) for name in values.get("resource_path", ())]
    values["resource_path"] = tuple(str(there) if there.is_dir() else name for there, name in folders)
    values["actors"] = tuple(
        actor.in_file(_beside(path, actor.file)) if actor.file else actor
        for actor in values.get("actors", ())
    )
    values["targets"] = tuple(
        target.in_file(*(_beside(path, file) if file else "" for file in target.files))
        for target in values.get("targets", ())
    )
    events, goal = scenario.events, scenario.goal
    is_sent = goal is not None and takes_goals(values.get("driver", RoverSetup().driver))
    return Run.of(
        **values,
        seed=seed,
        faults=tuple(event.spec for event in events if isinstance(event, FaultEvent)),
        commands=tuple((e.at, *e.command) for e in events if isinstance(e, CommandEvent)),
        goals=((0.0, *goal.at, goal.yaw),) if goal is not None and is_sent else (),
        resets=tuple(event.at for event in events if isinstance(event, ResetEvent)),
        aborts=tuple(event.at for event in events if isinstance(event, AbortEvent)),
        resumes=tuple(event.at for event in events if isinstance(event, ResumeEvent)),
        link_losses=tuple((e.at, e.link_loss) for e in events if isinstance(e, LinkLossEvent)),
    )


def find_files(paths: Iterable[Path]) -> list[Path]:
    """Returns the files that are named and those below folders, in order; UsageError if one is not."""
    files: dict[Path, None] = {}
    for path in paths:
        if path.is_dir():
            below = sorted(path.rglob(f"*{SUFFIX}"))
            if not below:
                raise UsageError(f"there is no *{SUFFIX} below {path}")
            files |= dict.fromkeys(below)
        elif path.is_file():
            files[path] = None
        else:
            raise UsageError(f"there is no scenario {path}; name a *{SUFFIX}, or a folder of them")
    return list(files)


def _has(cell: Cell, name: str, text: str) -> bool:
    """Whether a name of a matrix has a value as a file would say it: 1 is 1.0, null is none."""
    if name not in (values := dict(cell)):
        return False
    value = values[name]
    if isinstance(value, float):
        with suppress(ValueError):
            return float(text) == value
    return text in (str(value), _said(value))


def plan(files: Iterable[Path], seeds: Sequence[int] | None = None, only: Selected = ()) -> list[Case]:
    """Returns all runs of some files, checked.

    Args:
        files: The scenarios.
        seeds: Instead of theirs.
        only: Values of the matrix; other runs are left out.

    Raises:
        UsageError: A file is not valid, or nothing is left.
    """
    cases: list[Case] = []
    for path in files:
        cases += cases_of(path, read_scenario(path), seeds)
        _check_number(len(cases))
    left = [case for case in cases if all(_has(case.cell, name, text) for name, text in only)]
    if not left:
        there = ", ".join(
            dict.fromkeys(f"{n}={_said(value)}" for case in cases for n, value in case.cell)
        )
        asked = ", ".join("=".join(pair) for pair in only)
        raise UsageError(f"no run has {asked}; available: {there or 'no matrix'}")
    return left
