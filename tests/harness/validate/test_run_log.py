"""Logs as they are read, and what our side of the comparison drives and logs."""

from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from harness.base.errors import UsageError
from harness.drivers import DriverContext, Observation, wander
from harness.samples import Imu, LaserScan, Odometry, Tick, Twist
from harness.spec.run import Run
from harness.validate import run_log
from harness.validate.run_log import COLUMNS, RUN, SPEEDS, RecordedAgent, drive, read_log
from tests.support.rovers import ROVER_ZERO4WD

HEADER = ",".join(["Timestamp", *COLUMNS])


def test_a_log_is_read_by_column_without_the_rows_before_the_first_scan(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text(f"{HEADER}\n1,9.8,9.7,0.1,inf\n2,10.5, 9.1,0.3,2.5\n3,427.1234\n")
    log = read_log(path)
    assert {column: values.tolist() for column, values in log.items()} == dict(
        zip(COLUMNS, ([10.5], [9.1], [0.3], [2.5]), strict=True)
    )


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "the file is empty; --realism takes two logs"),
        (f"{HEADER}\n", "there is a header but no row"),
        ("Timestamp,Current Velocity\n1,2\n", "has no column IMU Acceleration Magnitude, Vertical"),
        (f"{HEADER}\n1,9.8,9.7,0.1,inf\n", "holds no complete row"),
        ("Timestamp,Notes\n1,fine\n", "the header lacks any of"),
        (f"{HEADER}\n1,rough,9.7,0.1,2\n", "holds no complete row"),
        (f"{HEADER}\n1,9.8\n", "none of its 1 rows is usable"),
    ],
)
def test_a_file_that_is_no_log_is_one_line(text: str, said: str, tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text(text)
    with pytest.raises(UsageError, match=said):
        read_log(path)


def test_a_log_that_is_not_there_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="--realism takes two logs"):
        read_log(tmp_path / "none.csv")


def test_a_log_that_is_not_text_is_one_line(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_bytes(b"\xff\xfe\x00\x80")
    with pytest.raises(UsageError, match="not the header of a metrics log"):
        read_log(path)


def test_the_agent_drives_as_its_driver_at_speeds_that_it_holds_for_six_to_fourteen_seconds(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    contexts: list[DriverContext] = []

    def driver(context: DriverContext) -> SimpleNamespace:
        contexts.append(context)
        return SimpleNamespace(command=lambda _: Twist(0.5, 0.3))

    monkeypatch.setattr(wander, "Wander", driver)
    context = DriverContext(ROVER_ZERO4WD, (9.0, 9.0), np.empty(0), np.random.default_rng(0))
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


class ToldEpisode:
    """Two batches up to 1.01 s, the first without a scan; keeps what it is commanded."""

    commands: list[Twist]
    scan = LaserScan(0, np.array([np.inf, 2.5], np.float32))

    def __init__(self, _: Run) -> None:
        self.info = SimpleNamespace(map_size=(40.0, 30.0))
        self.simulation = SimpleNamespace(position=(1.0, 2.0, 3.0), time_ns=5, yaw=0.5)
        self.commands = ToldEpisode.commands = []

    def command(self, twist: Twist) -> None:
        self.commands.append(twist)

    def batches(self) -> Iterator[SimpleNamespace]:
        imu = Imu(0, (0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0), (3.0, 4.0, 12.0))
        later = Imu(0, (0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
        odometry = Odometry(0, 0.0, 0.0, 0.0, Twist(0.7, 9.0))
        yield SimpleNamespace(ticks=(Tick(990_000_000, (imu,)),))
        full, over = Tick(1_000_000_000, (odometry, self.scan)), Tick(1_010_000_000, (later,))
        yield SimpleNamespace(ticks=(full, over))


def test_a_row_is_written_each_full_second_and_the_agent_sees_the_latest_scan(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    seen: list[Observation] = []

    def see(_: RecordedAgent, observation: Observation) -> Twist:
        seen.append(observation)
        return Twist(0.1 * len(seen))

    monkeypatch.setattr(run_log, "Episode", ToldEpisode)
    monkeypatch.setattr(RecordedAgent, "command", see)

    log = drive(RUN)

    assert {name: values.tolist() for name, values in log.items()} == {
        "IMU Acceleration Magnitude": [pytest.approx(13.0)],
        "Vertical Roughness": [12.0],
        "Current Velocity": [pytest.approx(0.7)],
        "Obstacle Clearance": [2.5],
    }
    assert ToldEpisode.commands == [Twist(0.1), Twist(0.2)]
    assert {(one.time_ns, one.x, one.y, one.yaw) for one in seen} == {(5, 1.0, 2.0, 0.5)}
    assert seen[0].ranges is None
    assert seen[1].ranges is ToldEpisode.scan.ranges
