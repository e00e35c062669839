"""The documented run resembles the recorded logs, and does so because of what is documented."""

from dataclasses import replace

import numpy as np
import pytest

from harness.drivers import DriverContext, Observation
from harness.robots import ROVER_ZERO4WD
from harness.validation.agent import SPEEDS, RecordedAgent
from harness.validation.realism import WITHIN, distances
from harness.validation.recorded import COLUMNS, DEFAULT_LOGS, Log, read_log
from harness.validation.run_log import CONFIG, drive

IMU = ("IMU Acceleration Magnitude", "Vertical Roughness")
MINUTES_2 = replace(CONFIG, duration=120.0)


@pytest.fixture(scope="module")
def recorded() -> list[Log]:
    missing = [str(path) for path in DEFAULT_LOGS if not path.is_file()]
    if missing:
        pytest.skip(f"RoboTerrain's logs are not part of the project: no {', '.join(missing)}")
    return [read_log(path) for path in DEFAULT_LOGS]


@pytest.fixture(scope="module")
def shaken() -> Log:
    return drive(MINUTES_2)


def test_two_minutes_lie_as_near_to_the_recorded_logs_as_those_to_each_other_times_two(
    shaken: Log, recorded: list[Log]
) -> None:
    ratios = {column: distances(shaken, recorded, column).ratio for column in COLUMNS}
    assert all(ratio <= WITHIN for ratio in ratios.values()), ratios


def test_without_the_noise_the_imu_is_calmer_than_any_recorded(recorded: list[Log]) -> None:
    calm = drive(replace(CONFIG, noise=False, duration=30.0))
    for column in IMU:
        assert distances(calm, recorded, column).ratio > WITHIN
        assert np.percentile(calm[column], 95) < 12.0


def test_the_run_has_a_row_for_every_second_and_repeats_itself(shaken: Log) -> None:
    assert {len(values) for values in shaken.values()} == {120}
    short = drive(replace(CONFIG, duration=10.0))
    for column in COLUMNS:
        assert short[column].tolist() == shaken[column][:10].tolist()


def test_the_agent_holds_a_recorded_speed_for_seconds_on_free_ground() -> None:
    context = DriverContext(
        ROVER_ZERO4WD, 500.0, np.linspace(-np.pi, np.pi, 16), np.random.default_rng(0)
    )
    agent = RecordedAgent(context)
    speeds = []
    for second in range(200):
        moving = Observation(second * 1_000_000_000, 0.5 * second, 0.0, 0.0, None)
        speeds.append(agent.command(moving).linear)
    assert max(speeds) <= SPEEDS[-1]
    assert len({round(speed, 3) for speed in speeds}) > 10
