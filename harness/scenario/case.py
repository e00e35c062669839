"""A scenario's runs: every combination of its matrix with every seed."""

import shlex
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any

from harness.base.errors import UsageError
from harness.config import FILE_OPTIONS, EpisodeConfig
from harness.drivers import takes_goals
from harness.robots import ROVERS
from harness.scenario.events import CommandEvent, FaultEvent, ResetEvent
from harness.scenario.spec import ExpectedFailure, Scenario
from harness.world.actors.spec import beside
from rover_metrics.errors import ParameterError
from rover_metrics.extended.parameter_file import read_values

# Left to EpisodeConfig where they are left out.
_PASSED_ON = (
    *FILE_OPTIONS,
    *("difficulty", "datum", "start", "noise", "lidar_beams", "imu_rate", "sensors", "goal_area"),
)

Cell = tuple[tuple[str, Any], ...]  # values of a matrix by name


@dataclass(frozen=True)
class Case:
    """One run of a scenario.

    Attributes:
        path: The scenario's file.
        scenario: What it says.
        cell: The values of its matrix that this run has, by name.
        config: The run.
        params: Parameters of the metrics that are not the defaults, by name.
    """

    path: Path
    scenario: Scenario
    cell: Cell
    config: EpisodeConfig
    params: dict[str, Any] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """Returns e.g. "kerb[leo-rocky-3]": the scenario, the values of its matrix, the seed."""
        values = [Path(str(value)).name for _, value in self.cell]
        return f"{scenario_name(self.path)}[{'-'.join([*values, str(self.config.seed)])}]"

    @property
    def command(self) -> str:
        """Returns what repeats this run alone."""
        only = [word for name, value in self.cell for word in ("--only", f"{name}={value}")]
        words = [str(self.path), "--seed", str(self.config.seed), *only]
        return f"python -m harness.scenario {shlex.join(words)}"

    @property
    def expected_failure(self) -> ExpectedFailure | None:
        """Returns why this run is known to fail, or None."""
        terrain = Path(self.config.terrain).name
        for known in self.scenario.expected_to_fail:
            if known.robot in (None, self.config.robot) and known.terrain in (None, terrain):
                return known
        return None

    @property
    def folder(self) -> Path:
        """Returns where its evidence goes, below a folder for that of all."""
        inside = [part for part in self.path.parent.parts if part not in ("..", self.path.anchor)]
        return Path(*inside, self.name)


def cell_name(cell: Cell) -> str:
    """Returns what the runs of a cell have in common, e.g. "leo, gravel, 0.5"."""
    return ", ".join(f"no {name}" if value is None else Path(str(value)).name for name, value in cell)


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
    cells = [tuple(zip(lists, values, strict=True)) for values in product(*lists.values())]
    try:
        cases = [
            Case(path, scenario, cell, _config(path, scenario, dict(cell), seed), params)
            for cell in cells
            for params in [_params(path, dict(cell).get("params", scenario.params))]
            for seed in (seeds or scenario.all_seeds)
        ]
        for case in cases:
            case.config.validate()
    except UsageError as error:
        raise UsageError(f"{path}: {error}") from error
    return cases


def _beside(path: Path, name: str) -> Path:
    """A file beside the scenario, if there is such a one, or what is called so otherwise."""
    there = path.parent / name
    return there if there.is_file() else Path(name)


def _robot_beside(path: Path, robot: str) -> str:
    """A rover's folder beside the scenario, if there is such a one, or what is called so otherwise."""
    there = path.parent / robot
    return str(there) if robot not in ROVERS and (there / "rover.yaml").is_file() else robot


def _params(path: Path, name: str | None) -> dict[str, Any]:
    try:
        return {} if name is None else read_values(_beside(path, name))
    except ParameterError as error:
        raise UsageError(f"params: {error}") from error


def _config(path: Path, scenario: Scenario, cell: dict[str, Any], seed: int) -> EpisodeConfig:
    values = {name: getattr(scenario, name) for name in ("robot", "terrain", "driver", "duration")}
    given = {name: getattr(scenario, name) for name in _PASSED_ON}
    values |= {name: value for name, value in given.items() if value is not None} | cell
    values["terrain"] = str(_beside(path, values["terrain"]))
    values["robot"] = _robot_beside(path, values["robot"])
    folders = [(path.parent / name, name) for name in scenario.resource_path]
    values["resource_path"] = tuple(str(there) if there.is_dir() else name for there, name in folders)
    values.pop("params", None)
    events, goal = scenario.events, scenario.goal
    return EpisodeConfig(
        **values,
        seed=seed,
        faults=tuple(event.spec for event in events if isinstance(event, FaultEvent)),
        commands=tuple((e.at, *e.command) for e in events if isinstance(e, CommandEvent)),
        actors=tuple(beside(actor, partial(_beside, path)) for actor in scenario.actors),
        goals=((0.0, *goal.at, goal.yaw),) if goal and takes_goals(values["driver"]) else (),
        resets=tuple(event.at for event in events if isinstance(event, ResetEvent)),
    )
