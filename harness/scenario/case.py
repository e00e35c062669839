"""A scenario's runs: every combination of its matrix with every seed."""

import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

from harness.config import EpisodeConfig
from harness.drivers import takes_goals
from harness.errors import UsageError
from harness.scenario.events import CommandEvent, FaultEvent, ResetEvent
from harness.scenario.spec import ExpectedFailure, Scenario

# Left to EpisodeConfig where they are left out.
_PASSED_ON = (
    *("terrain_size", "terrain_height", "difficulty", "start"),
    *("noise", "lidar_beams", "imu_rate"),
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
    """

    path: Path
    scenario: Scenario
    cell: Cell
    config: EpisodeConfig

    @property
    def name(self) -> str:
        """Returns e.g. "kerb[leo-rocky-3]": the scenario, the values of its matrix, the seed."""
        values = [*_texts(self.cell), str(self.config.seed)]
        return f"{scenario_name(self.path)}[{'-'.join(values)}]"

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
    return ", ".join(_texts(cell))


def _texts(cell: Cell) -> list[str]:
    return [Path(str(value)).name for _, value in cell]


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
            Case(path, scenario, cell, _config(path, scenario, dict(cell), seed))
            for cell in cells
            for seed in (seeds or scenario.all_seeds)
        ]
        for case in cases:
            case.config.validate()
    except UsageError as error:
        raise UsageError(f"{path}: {error}") from error
    return cases


def _config(path: Path, scenario: Scenario, cell: dict[str, Any], seed: int) -> EpisodeConfig:
    values = {name: getattr(scenario, name) for name in ("robot", "terrain", "driver", "duration")}
    given = {name: getattr(scenario, name) for name in _PASSED_ON}
    values |= {name: value for name, value in given.items() if value is not None} | cell
    beside = path.parent / values["terrain"]
    if beside.is_file():
        values["terrain"] = str(beside)
    events, goal = scenario.events, scenario.goal
    return EpisodeConfig(
        **values,
        seed=seed,
        faults=tuple(event.spec for event in events if isinstance(event, FaultEvent)),
        commands=tuple((e.at, *e.command) for e in events if isinstance(e, CommandEvent)),
        goals=((0.0, *goal.at, goal.yaw),) if goal and takes_goals(values["driver"]) else (),
        resets=tuple(event.at for event in events if isinstance(event, ResetEvent)),
    )
