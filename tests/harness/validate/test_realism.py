"""The documented run resembles the recorded logs, and does so because of what is documented."""

import csv
import io
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from harness.base.errors import UsageError
from harness.base.interrupt import StopRequest
from harness.drivers.base import DriverContext, Observation
from harness.drivers.wander import Wander
from harness.episode.direct import run_direct
from harness.episode.result import Outputs
from harness.samples import Twist
from harness.spec.ros import RosOptions
from harness.validate.realism import (
    WITHIN,
    Comparison,
    Distances,
    compare,
    distances,
    print_comparison,
    sheets_of,
)
from harness.validate.run_log import COLUMNS, RUN, SPEEDS, Log, RecordedAgent, drive, read_log
from tests.support.once import made_once
from tests.support.rovers import ROVER_ZERO4WD

LOGS_DIR = Path(__file__).parents[4] / "shared/data/roboterrain/logs"
LOGS = [LOGS_DIR / f"metrics_log_20250116_{time}.csv" for time in (120457, 125842)]
RECORDED = RUN.alone(robot=ROVER_ZERO4WD.name)
HEADER = ",".join(["Timestamp", *COLUMNS])


@pytest.fixture(scope="module")
def recorded() -> list[Log]:
    missing = [str(path) for path in LOGS if not path.is_file()]
    if missing:
        pytest.skip(f"RoboTerrain's logs are not part of the project: no {', '.join(missing)}")
    return [read_log(path) for path in LOGS]


@pytest.fixture(scope="module")
def shaken(tmp_path_factory: pytest.TempPathFactory) -> Log:
    return made_once(tmp_path_factory, "shaken", lambda: drive(RECORDED.alone(duration=90.0)))


def test_a_run_lies_at_most_twice_as_far_from_the_recorded_logs_as_those_from_each_other(
    shaken: Log, recorded: list[Log]
) -> None:
    ratios = {column: distances(shaken, recorded, column).ratio for column in COLUMNS}
    assert all(ratio <= WITHIN for ratio in ratios.values()), ratios


def test_an_agent_keeps_off_posts_also_with_a_lidar_that_looks_ahead() -> None:
    assert drive(RUN.alone(robot="jackal", duration=30.0))["Obstacle Clearance"].min() > 0.5


def test_a_run_repeats_itself_and_another_seed_has_other_speeds(
    shaken: Log, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert {len(values) for values in shaken.values()} == {90}
    short = drive(RECORDED.alone(duration=5.0))
    for column in COLUMNS:
        assert short[column].tolist() == shaken[column][:5].tolist()
    monkeypatch.setattr(Wander, "command", lambda *_: Twist(0.5, 0.0))
    runs = [drive(RECORDED.alone(duration=3.0, seed=seed, noise=None)) for seed in (0, 1)]
    one, other = (run["Current Velocity"] for run in runs)
    assert np.abs(one - other).max() > 0.01


def test_a_run_has_the_rows_of_a_direct_run_with_the_commands_of_its_agent(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The agent's commands act from the next control period on, as those of a plan do."""
    commands: list[tuple[float, float, float]] = []
    decide = RecordedAgent.command

    def noted(agent: RecordedAgent, seen: Observation) -> Twist:
        twist = decide(agent, seen)
        commands.append((seen.time_ns / 1e9, twist.linear, twist.angular))
        return twist

    with monkeypatch.context() as patch:
        patch.setattr(RecordedAgent, "command", noted)
        ours = drive(RECORDED.alone(duration=6.0))
    planned = RECORDED.alone(duration=6.0, commands=commands[:-1])
    (result,) = run_direct(
        planned, (Outputs(log_dir=tmp_path),), RosOptions(log_dir=tmp_path), StopRequest()
    )
    assert result.log_path is not None
    rows = list(csv.DictReader(result.log_path.read_text().splitlines()))
    assert len(commands) == 120
    for column in COLUMNS:
        assert ours[column] == pytest.approx([float(row[column]) for row in rows], abs=6e-5), column


def test_the_agent_drives_as_its_driver_at_speeds_that_are_spread_as_recorded(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(Wander, "command", lambda *_: Twist(0.5, 0.3))
    context = DriverContext(ROVER_ZERO4WD, (9.0, 9.0), np.empty(0), np.random.default_rng(0))
    agent = RecordedAgent(context)
    twists = [agent.command(Observation(n * 100_000_000, 0.0, 0.0, 0.0, None)) for n in range(30_000)]
    speeds = np.array([twist.linear for twist in twists])
    changes = np.flatnonzero(np.diff(speeds)) + 1
    held, chosen = np.diff(changes) / 10, speeds[[0, *changes]] / 0.5
    assert {twist.angular for twist in twists} == {0.3}
    assert 6.0 <= held.min() < 6.5
    assert 13.5 < held.max() <= 14.1
    # The quantiles are those of the table, evenly spaced from 0 to 1.
    assert np.quantile(chosen, np.linspace(0, 1, 9)) == pytest.approx(SPEEDS, abs=0.06)


def test_a_log_is_read_by_column_without_the_rows_before_the_first_scan(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text(f"{HEADER}\n1,9.8,9.7,0.1,inf\n2,10.5, 9.1,0.3,2.5\n3,427.1234\n")
    values = {column: values.tolist() for column, values in read_log(path).items()}
    assert values == dict(zip(COLUMNS, ([10.5], [9.1], [0.3], [2.5]), strict=True))


@pytest.mark.parametrize(
    ("content", "named"),
    [
        (b"", "empty"),
        (b"Timestamp,Current Velocity\n1,2\n", "IMU Acceleration Magnitude, Vertical"),
        (f"{HEADER}\n1,9.8,9.7,0.1,inf\n".encode(), "no complete row"),
        (b"\xff\xfe\x00\x80", "no text in UTF-8, perhaps UTF-16"),
        (None, "--realism takes two logs"),
    ],
)
def test_a_file_that_is_no_log_is_one_line(content: bytes | None, named: str, tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(UsageError, match=named) as error:
        read_log(path)
    assert str(path) in str(error.value)
    assert "\n" not in str(error.value)


def test_logs_of_one_name_are_told_apart_alike_or_not_and_one_log_is_not_two(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("harness.validate.realism.drive", lambda run: drive(run.alone(duration=3.0)))
    paths = [tmp_path / folder / "ours.csv" for folder in "ab"]
    for path in paths:
        path.parent.mkdir()
        path.write_text(f"{HEADER}\n2,10.5,9.1,0.3,2.5\n")
    comparison = compare(paths, "leo", 0)
    assert comparison.missed == [*COLUMNS]
    assert all(str(path) in sheets_of(comparison)[1].caption for path in paths)
    with pytest.raises(UsageError, match="given twice"):
        compare([paths[0], paths[0]], "leo", 0)


def test_the_comparison_is_printed_with_percentiles_shares_and_verdicts() -> None:
    values = np.linspace(0.0, 20.0, 201)
    logs: dict[str, Log] = {
        title: dict.fromkeys(COLUMNS, values + shift) for shift, title in enumerate(("ours", "a", "b"))
    }
    measured = {column: distances(logs["ours"], (logs["a"], logs["b"]), column) for column in COLUMNS}
    assert measured["Vertical Roughness"].ours == pytest.approx((1.0, 2.0))
    measured["Current Velocity"] = Distances((1.0, 4.1), 2.0)
    comparison, text = Comparison(logs, measured), io.StringIO()
    print_comparison(Console(file=text, width=140), comparison)
    lines = [" ".join(line.replace("│", " ").split()) for line in text.getvalue().splitlines()]
    assert comparison.missed == ["Current Velocity"]
    assert "IMU Acceleration Magnitude, m/s2 ours 1.00 10.00 19.00 24.9 %" in lines
    assert "Vertical Roughness 1.000 1.000 2.000 2.00 ok" in lines
    assert "Current Velocity 2.000 1.000 4.100 2.05 MISS" in lines
