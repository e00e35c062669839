"""The documented run resembles the recorded logs, and does so because of what is documented."""

import io
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from rich.console import Console
from scipy.stats import wasserstein_distance

from harness.drivers import DriverContext, Observation
from harness.samples import Imu, LaserScan, Odometry, Tick, Twist
from harness.validation import run_log
from harness.validation.realism import WITHIN, Comparison, Distances, distances, print_comparison
from harness.validation.recorded import COLUMNS, Log, read_log
from harness.validation.run_log import CONFIG, SPEEDS, RecordedAgent, _Logger, drive
from tests.support.once import made_once
from tests.support.rovers import ROVER_ZERO4WD

IMU = ("IMU Acceleration Magnitude", "Vertical Roughness")
LOGS_DIR = Path(__file__).parents[4] / "shared/data/roboterrain/logs"
LOGS = [LOGS_DIR / f"metrics_log_20250116_{time}.csv" for time in (120457, 125842)]
RECORDED = replace(CONFIG, robot=ROVER_ZERO4WD.name)
MINUTES_2 = replace(RECORDED, duration=120.0)


@pytest.fixture(scope="module")
def recorded() -> list[Log]:
    missing = [str(path) for path in LOGS if not path.is_file()]
    if missing:
        pytest.skip(f"RoboTerrain's logs are not part of the project: no {', '.join(missing)}")
    return [read_log(path) for path in LOGS]


@pytest.fixture(scope="module")
def shaken(tmp_path_factory: pytest.TempPathFactory) -> Log:
    return made_once(tmp_path_factory, "shaken", lambda: drive(MINUTES_2))


def test_two_minutes_lie_as_near_to_the_recorded_logs_as_those_to_each_other_times_two(
    shaken: Log, recorded: list[Log]
) -> None:
    ratios = {column: distances(shaken, recorded, column).ratio for column in COLUMNS}
    assert all(ratio <= WITHIN for ratio in ratios.values()), ratios


def test_without_the_noise_the_imu_is_calmer_than_any_recorded(recorded: list[Log]) -> None:
    calm = drive(replace(RECORDED, noise=None, duration=30.0))
    for column in IMU:
        assert distances(calm, recorded, column).ratio > WITHIN
        assert np.percentile(calm[column], 95) < 12.0


def test_the_run_has_a_row_for_every_second_and_repeats_itself(shaken: Log) -> None:
    assert {len(values) for values in shaken.values()} == {120}
    short = drive(replace(RECORDED, duration=10.0))
    for column in COLUMNS:
        assert short[column].tolist() == shaken[column][:10].tolist()


def test_the_agent_drives_as_its_driver_at_speeds_that_it_holds_for_six_to_fourteen_seconds(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    contexts: list[DriverContext] = []

    def driver(context: DriverContext) -> SimpleNamespace:
        contexts.append(context)
        return SimpleNamespace(command=lambda _: Twist(0.5, 0.3))

    monkeypatch.setattr(run_log, "Wander", driver)
    context = DriverContext(ROVER_ZERO4WD, 9.0, np.empty(0), np.random.default_rng(0))
    ours = RecordedAgent(context)
    twists = [ours.command(Observation(n * 100_000_000, 0.0, 0.0, 0.0, None)) for n in range(3000 * 10)]

    speeds = np.array([twist.linear for twist in twists])
    changes = np.flatnonzero(np.diff(speeds)) + 1
    held, chosen = np.diff(changes) / 10, speeds[[0, *changes]] / 0.5
    assert (contexts[0].rover.cruise_speed, contexts[0].rover.cruise_yaw_rate) == (1.0, 2.0)
    assert {twist.angular for twist in twists} == {0.3}
    assert 6.0 <= held.min() < 6.5
    assert 13.5 < held.max() <= 14.1
    # Spread as recorded: the quantiles are those of the table, evenly spaced from 0 to 1.
    assert np.quantile(chosen, np.linspace(0, 1, 9)) == pytest.approx(SPEEDS, abs=0.06)


def test_distances_are_those_of_scipy_and_pass_up_to_twice_the_yardstick() -> None:
    rng = np.random.default_rng(0)
    logs = [{"v": rng.normal(mean, 1.0, size)} for mean, size in ((0.3, 90), (1.0, 70), (2.5, 50))]

    found = distances(logs[0], logs[1:], "v")

    values = [log["v"] for log in logs]
    assert found.ours == pytest.approx(
        (wasserstein_distance(values[0], values[1]), wasserstein_distance(values[0], values[2]))
    )
    assert found.recorded == pytest.approx(wasserstein_distance(values[1], values[2]))
    assert found.ratio == pytest.approx(max(found.ours) / found.recorded)
    close, far = Distances((2.0, 4.0), 2.0), Distances((4.1, 1.0), 2.0)
    assert (close.ratio, close.passed, far.passed) == (2.0, True, False)
    assert Comparison({}, {"close": close, "far": far}).missed == ["far"]


def test_the_comparison_is_printed_with_percentiles_shares_and_verdicts() -> None:
    values = np.linspace(0.0, 20.0, 201)
    logs: dict[str, Log] = {
        title: dict.fromkeys(COLUMNS, values + shift) for shift, title in enumerate(("ours", "a", "b"))
    }
    found = dict.fromkeys(COLUMNS, Distances((2.0, 4.0), 2.0)) | {
        "Current Velocity": Distances((9.0, 1.0), 2.0)
    }
    console = Console(file=io.StringIO(), width=140)

    print_comparison(console, Comparison(logs, found))

    assert isinstance(console.file, io.StringIO)
    lines = [" ".join(line.replace("│", " ").split()) for line in console.file.getvalue().splitlines()]
    assert "IMU Acceleration Magnitude, m/s2 ours 1.00 10.00 19.00 24.9 %" in lines
    assert "Obstacle Clearance, m a 2.00 11.00 20.00" in lines
    assert "Vertical Roughness 2.000 2.000 4.000 2.00 ok" in lines
    assert "Current Velocity 2.000 9.000 1.000 4.50 MISS" in lines
    assert any("recorded: from a (1st) to b (2nd)" in line for line in lines)


def test_a_row_is_written_each_full_second_of_what_came_up_to_it() -> None:
    logger = _Logger()
    imu = Imu(0, (0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0), (3.0, 4.0, 12.0))
    odometry = Odometry(0, 0.0, 0.0, 0.0, Twist(0.7, 9.0))
    scan = LaserScan(0, np.array([np.inf, 2.5], np.float32))

    logger.take(Tick(990_000_000, (imu,)))
    logger.take(Tick(1_000_000_000, (odometry, scan)))
    logger.take(Tick(1_010_000_000, (replace(imu, linear_acceleration=(0.0, 0.0, 1.0)),)))

    assert len(logger.rows) == 1
    assert logger.rows[0] == pytest.approx((13.0, 12.0, 0.7, 2.5))
    where = SimpleNamespace(simulation=SimpleNamespace(position=(1.0, 2.0, 3.0), time_ns=5, yaw=0.5))
    seen = logger.observe(where)  # type: ignore[arg-type]
    assert (seen.time_ns, seen.x, seen.y, seen.yaw) == (5, 1.0, 2.0, 0.5)
    assert seen.ranges is scan.ranges
    assert _Logger().observe(where).ranges is None  # type: ignore[arg-type]
