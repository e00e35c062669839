"""The documented run resembles the recorded logs, and does so because of what is documented."""

import io
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console
from scipy.stats import wasserstein_distance

from harness.validate.realism import WITHIN, Comparison, Distances, distances, print_comparison
from harness.validate.run_log import COLUMNS, RUN, Log, drive, read_log
from tests.support.once import made_once
from tests.support.rovers import ROVER_ZERO4WD

IMU = ("IMU Acceleration Magnitude", "Vertical Roughness")
LOGS_DIR = Path(__file__).parents[4] / "shared/data/roboterrain/logs"
LOGS = [LOGS_DIR / f"metrics_log_20250116_{time}.csv" for time in (120457, 125842)]
RECORDED = RUN.alone(robot=ROVER_ZERO4WD.name)
LONG = RECORDED.alone(duration=90.0)


@pytest.fixture(scope="module")
def recorded() -> list[Log]:
    missing = [str(path) for path in LOGS if not path.is_file()]
    if missing:
        pytest.skip(f"RoboTerrain's logs are not part of the project: no {', '.join(missing)}")
    return [read_log(path) for path in LOGS]


@pytest.fixture(scope="module")
def shaken(tmp_path_factory: pytest.TempPathFactory) -> Log:
    return made_once(tmp_path_factory, "shaken", lambda: drive(LONG))


def test_a_minute_and_a_half_lies_as_near_to_the_recorded_logs_as_those_to_each_other_times_two(
    shaken: Log, recorded: list[Log]
) -> None:
    ratios = {column: distances(shaken, recorded, column).ratio for column in COLUMNS}
    assert all(ratio <= WITHIN for ratio in ratios.values()), ratios


def test_without_the_noise_the_imu_is_calmer_than_any_recorded(recorded: list[Log]) -> None:
    calm = drive(RECORDED.alone(noise=None, duration=15.0))
    for column in IMU:
        assert distances(calm, recorded, column).ratio > WITHIN
        assert np.percentile(calm[column], 95) < 12.0


def test_the_run_has_a_row_for_every_second_and_repeats_itself(shaken: Log) -> None:
    assert {len(values) for values in shaken.values()} == {90}
    short = drive(RECORDED.alone(duration=5.0))
    for column in COLUMNS:
        assert short[column].tolist() == shaken[column][:5].tolist()


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
