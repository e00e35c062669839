"""A scenario's runs: every combination of its matrix with every seed."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

from harness.config import EpisodeConfig
from harness.errors import UsageError
from harness.scenario.quantities import check_names
from harness.scenario.spec import CommandEvent, ExpectedFailure, FaultEvent, ResetEvent, Scenario

_PASSED_ON = ("difficulty", "noise", "lidar_beams", "imu_rate")  # left to EpisodeConfig if left out


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
    cell: tuple[tuple[str, Any], ...]
    config: EpisodeConfig

    @property
    def name(self) -> str:
        """Returns e.g. "kerb[leo-rocky-3]": the scenario, the values of its matrix, the seed."""
        values = [Path(str(value)).name for _, value in self.cell]
        return f"{scenario_name(self.path)}[{'-'.join([*values, str(self.config.seed)])}]"

    @property
    def command(self) -> str:
        """Returns what repeats this run alone."""
        only = "".join(f" --only {name}={value}" for name, value in self.cell)
        return f"python -m harness.scenario {self.path} --seed {self.config.seed}{only}"

    @property
    def expected_failure(self) -> ExpectedFailure | None:
        """Returns why this run is known to fail, or None."""
        for known in self.scenario.expected_to_fail:
            if known.robot in (None, self.config.robot) and known.terrain in (None, self.config.terrain):
                return known
        return None


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
        check_names(scenario.expect)
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
    events = scenario.events
    return EpisodeConfig(
        **values,
        seed=seed,
        faults=tuple(event.spec for event in events if isinstance(event, FaultEvent)),
        commands=tuple((e.at, *e.command) for e in events if isinstance(e, CommandEvent)),
        resets=tuple(event.at for event in events if isinstance(event, ResetEvent)),
    )
