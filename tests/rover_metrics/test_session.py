"""What a session makes of each sample: what is used of it, and what it remarks."""

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from rover_metrics.core.columns import COLUMNS
from rover_metrics.core.rotation import Vector3
from rover_metrics.extended.settings import DEFAULT_EXTENDED, ExtendedSettings
from rover_metrics.health import rejections as faults
from rover_metrics.session import MetricsSession, Remark

INF, NAN = math.inf, math.nan
STILL = (0.0, 0.0, 0.0)
NO_INTERVALS = ((0.0, 0.0), (5.0, 5.0), (10.0, 0.15), (NAN, NAN))

Give = Callable[[MetricsSession], Remark | None]


def scan(*ranges: float, limits: tuple[float, float] = (0.15, 10.0)) -> Give:
    return lambda session: session.take_scan(1, ranges, angles=(0.5, 0.25), limits=limits)


def imu(acceleration: Vector3, rate: Vector3 = STILL) -> Give:
    return lambda session: session.take_imu(1, acceleration, rate, None)


def pose(position: Vector3 | None) -> Give:
    return lambda session: session.take_pose(1, position)


def odometry(velocity: Vector3) -> Give:
    return lambda session: session.take_odometry(1, velocity)


@pytest.mark.parametrize("settings", [None, DEFAULT_EXTENDED])
@pytest.mark.parametrize(
    ("give", "used", "left_out", "remark"),
    [
        (scan(2.5, 1.0), True, False, None),
        (scan(0.125, 11.0), True, False, faults.BELOW_LIMIT),
        (scan(0.125, 5.0, limits=(0.125, 5.0)), True, False, None),  # a limit itself can be measured
        *((scan(0.1, 99.0, limits=none), True, False, None) for none in NO_INTERVALS),
        (scan(-1.0, 9.9, limits=(0.0, 0.0)), True, False, faults.ZERO_OR_LESS),
        (scan(5.0, 11.0), True, False, faults.ABOVE_LIMIT),
        (scan(0.0, 5.0), True, False, faults.ZERO_OR_LESS),
        (scan(INF, INF), False, False, None),  # open space: neither used nor a fault
        (scan(INF, NAN), False, False, faults.ALL_NAN),
        (scan(-INF, INF), False, False, faults.ALL_TOO_NEAR),
        (scan(-INF, NAN), False, False, faults.ALL_NAN),
        (scan(), False, False, faults.NO_RANGES),
        (imu((0.0, 0.0, 9.8)), True, False, None),
        (imu((NAN, 0.0, 9.8)), False, True, faults.NOT_FINITE),
        (imu((1e300, 0.0, 0.0), (0.0, NAN, 0.0)), False, True, faults.NOT_FINITE),
        (imu((-6e4, -6e4, -6e4), (0.0, 0.0, 1e5)), False, True, faults.HUGE_ACCELERATION),
        (imu(STILL, (0.0, 0.0, 1e6)), False, True, faults.HUGE_ANGULAR_RATE),
        (pose((1.0, 2.0, 3.0)), True, False, None),
        (pose((0.0, NAN, 0.0)), False, True, faults.NOT_FINITE),
        (pose(None), False, True, faults.NO_POSE),
        (odometry((0.5, 0.0, 0.0)), True, False, None),
        *((odometry(huge), False, True, faults.HUGE_SPEED) for huge in ((-6e3,) * 3, (1e308,) * 3)),
        (odometry((0.0, 0.0, NAN)), False, True, faults.NOT_FINITE),
    ],
)
def test_each_sample_is_used_or_not_and_named_if_odd(
    give: Give, used: bool, left_out: bool, remark: str | None, settings: ExtendedSettings | None
) -> None:
    session = MetricsSession(settings=settings)
    assert give(session) == (None if remark is None else Remark(remark, left_out))
    cells = dict(zip(session.columns, session.row(0).as_fields(), strict=True))
    if settings is not None:
        rejected = [cells[f"{name} Rejected"] for name in ("Scan", "IMU", "Pose", "Odometry")]
        assert rejected.count("") == 3
        assert rejected.count(int(left_out)) == 1
    session.take_pose(1, STILL)  # a pose that was used is where this step begins
    fresh = MetricsSession()
    fresh.take_pose(1, STILL)
    same = session.metrics.row(0) == fresh.metrics.row(0)
    assert (session.metrics.last_step > 0.0 or not same) is used


def test_every_component_reaches_its_metric() -> None:
    session = MetricsSession()
    assert session.take_scan(0, (1e30, 0.125), angles=(0.0, 0.1)) is None  # no limits, nothing odd
    session.take_imu(0, (2.0, 3.0, -6.0), (4.0, 4.0, 2.0))  # 7 and 6
    session.take_odometry(0, (2.0, 1.0, -2.0))
    jumped = Remark(faults.JUMPED, left_out=False)
    path = ((9.0, 8.0, 7.0), (9.02, 8.03, 7.06), (9.02, 8.03, 7.56), (9.02, 8.03, 7.56))
    assert [session.take_pose(0, position) for position in path] == [None, None, jumped, None]
    row = session.row(7_999_999_999)
    assert (session.columns, row.columns, row.stamp_s) == (COLUMNS, COLUMNS, 7)
    assert row.as_fields() == (7, 1, 1, 13.0, 13.0, 0.125, 0.07, 3.0, 7.0, 0, 6.0, "Normal operation")


@pytest.mark.parametrize("settings", [None, DEFAULT_EXTENDED])
def test_truth_that_is_none_is_left_out_where_it_is_asked_for(settings: ExtendedSettings | None) -> None:
    session = MetricsSession(settings=settings)
    remark = None if settings is None else Remark(faults.NOT_FINITE_OR_OTHER)
    assert session.take_true_velocity((NAN, 0.0, 0.0)) == remark
    assert session.take_traversal([0.0], ["speed"]) == remark
    assert session.take_true_velocity((0.3, 0.4, 0.0)) is None
    assert session.take_contact(touches=True) is None


def test_energy_is_power_over_time_but_over_pauses_and_back_in_time() -> None:
    session, watt_hours = MetricsSession(settings=ExtendedSettings(energy=True)), list[object]()
    told = ((0, 1.0), (2, 3.0), (9, 3.0), (8, 4.0), (9, -2.0))  # s, A; a pause, then the clock goes back
    for seconds, amperes in told:
        session.take_battery(seconds * 10**9, 12.0, -amperes)
        cells = dict(zip(session.columns, session.row(0).as_fields(), strict=True))
        watt_hours.append(cells["Energy [Wh]"])
    joules = (48.0, 48.0, 48.0, 60.0)
    assert watt_hours == ["", *(round(each / 3600, 4) for each in joules)]


def test_columns_of_others_go_by_the_settings_that_hold(tmp_path: Path) -> None:
    file = tmp_path / "weight.py"
    file.write_text(
        "from rover_metrics.core.columns import Column\n"
        "from rover_metrics.extended.further import Columns\n"
        "class Weight(Columns):\n"
        "    COLUMNS = (Column(name='Weight', meaning='m', formula='f', source='s'),)\n"
        "    def cells(self):\n"
        "        return (self.settings.gravity,)\n"
    )
    settings = ExtendedSettings(columns=f"{file}:Weight", gravity=1.6)
    session, weights = MetricsSession(settings=settings), list[object]()
    assert session.extended is not None
    for gravity in (1.6, 3.7):
        session.extended.use(replace(settings, gravity=gravity))
        weights.append(dict(zip(session.columns, session.row(0).as_fields(), strict=True))["Weight"])
    assert weights == [1.6, 3.7]
