"""What a session makes of each sample: what its metrics get, in which order, and what it remarks."""

import array
import math
from collections.abc import Callable
from typing import Any

import pytest

from rover_metrics.core.columns import COLUMNS
from rover_metrics.core.rotation import Vector3
from rover_metrics.health import rejections as faults
from rover_metrics.session import MetricsSession, Remark

INF, NAN = math.inf, math.nan
STILL = (0.0, 0.0, 0.0)
LEVEL = (0.0, 0.0, 0.0, 1.0)
STAMP_NS = 3_000_000_005

Give = Callable[[MetricsSession], Remark | None]
Taken = tuple[str, tuple[Any, ...], dict[str, Any]]


class Extended:
    """Stands where ExtendedMetrics and its truth do: remembers what it is given, and when."""

    def __init__(self) -> None:
        self.taken: list[Taken] = []
        self.truth = self
        self.answer = True
        self.smoothness = NAN

    def __getattr__(self, kind: str) -> Callable[..., bool]:
        def take(*values: object, **named: object) -> bool:
            self.taken.append((kind, values, named))
            self.smoothness = self.session.metrics.smoothness_metric
            return self.answer

        return take

    def stand_in(self, session: MetricsSession) -> MetricsSession:
        self.session = session
        session.extended = self  # type: ignore[assignment]  # a stand-in
        return session


def scan(*ranges: float) -> tuple[Give, Taken]:
    values = array.array("f", ranges)
    return (
        lambda session: session.take_scan(STAMP_NS, values, angles=(0.5, 0.25), limits=(0.15, 10.0)),
        ("add_scan", (STAMP_NS, values, (0.5, 0.25)), {}),
    )


def imu(acceleration: Vector3, rate: Vector3 = STILL) -> tuple[Give, Taken]:
    return (
        lambda session: session.take_imu(STAMP_NS, acceleration, rate, LEVEL),
        ("add_imu", (STAMP_NS, acceleration, LEVEL), {}),
    )


def pose(position: Vector3 | None) -> tuple[Give, Taken]:
    return (
        lambda session: session.take_pose(STAMP_NS, position),
        ("add_pose", (STAMP_NS, position), {}),
    )


def odometry(velocity: Vector3) -> tuple[Give, Taken]:
    return (
        lambda session: session.take_odometry(STAMP_NS, velocity),
        ("add_odometry", (STAMP_NS, velocity), {}),
    )


@pytest.mark.parametrize("extended", [True, False])
@pytest.mark.parametrize(
    ("sample", "used", "left_out", "remark"),
    [
        (scan(2.5, 1.0), True, False, None),
        (scan(0.125, 11.0), True, False, faults.BELOW_LIMIT),
        (scan(5.0, 11.0), True, False, faults.ABOVE_LIMIT),
        (scan(0.0, 5.0), True, False, faults.ZERO_OR_LESS),
        (scan(INF, INF), False, False, None),  # open space: neither used nor a fault
        (scan(INF, NAN), False, False, faults.ALL_NAN),
        (scan(), False, False, faults.NO_RANGES),
        (imu((0.0, 0.0, 9.8)), True, False, None),
        (imu((NAN, 0.0, 9.8)), False, True, faults.NOT_FINITE),
        (imu((0.0, 1e6, 0.0)), False, True, faults.HUGE_ACCELERATION),
        (imu(STILL, (0.0, 0.0, 1e6)), False, True, faults.HUGE_ANGULAR_RATE),
        (pose((1.0, 2.0, 3.0)), True, False, None),
        (pose((0.0, NAN, 0.0)), False, True, faults.NOT_FINITE),
        (pose(None), False, True, faults.NO_POSE),
        (odometry((0.5, 0.0, 0.0)), True, False, None),
        (odometry((0.0, 1e6, 0.0)), False, True, faults.HUGE_SPEED),
        (odometry((0.0, 0.0, NAN)), False, True, faults.NOT_FINITE),
    ],
)
def test_each_sample_is_handed_on_once_and_named_if_something_is_odd(
    sample: tuple[Give, Taken], used: bool, left_out: bool, remark: str | None, extended: bool
) -> None:
    give, (kind, values, named) = sample
    session, spy = MetricsSession(), Extended()
    told = give(spy.stand_in(session) if extended else session)
    assert told == (None if remark is None else Remark(remark, left_out))
    assert spy.taken == ([(kind, values, {**named, "used": used})] if extended else [])


def test_every_component_reaches_its_metric_and_the_extended_ones_come_after() -> None:
    spy = Extended()
    session = spy.stand_in(MetricsSession())
    assert session.take_scan(0, (1e30, 0.125), angles=(0.0, 0.1)) is None  # no limits, nothing odd
    session.take_imu(0, (2.0, 3.0, -6.0), (4.0, 4.0, 2.0))  # 7 and 6
    assert spy.smoothness == 13.0
    session.take_odometry(0, (2.0, 1.0, -2.0))
    jumped = Remark("step of distance_threshold or more, no travel", left_out=False)
    path = ((9.0, 8.0, 7.0), (9.02, 8.03, 7.06), (9.02, 8.03, 7.56), (9.02, 8.03, 7.56))
    assert [session.take_pose(0, position) for position in path] == [None, None, jumped, None]
    twelve = MetricsSession()
    assert (twelve.columns, twelve.row(7_999_999_999).stamp_s) == (COLUMNS, 7)
    row = session.metrics.row(0)
    assert (row.total_collisions, row.obstacle_clearance) == (1, 0.125)
    assert (row.smoothness_metric, row.vertical_roughness) == (13.0, 6.0)
    assert row.imu_acceleration_magnitude == 7.0
    assert row.current_velocity == 3.0
    assert row.distance_traveled == pytest.approx(0.07)


@pytest.mark.parametrize(
    ("give", "taken", "may_be_left_out"),
    [
        (
            lambda session: session.take_true_velocity((0.3, 0.4, 0.0)),
            ("add_velocity", ((0.3, 0.4, 0.0),), {}),
            True,
        ),
        (
            lambda session: session.take_contact(touches=True),
            ("add_contact", (), {"touches": True}),
            False,
        ),
        (
            lambda session: session.take_traversal([0.0], ["speed"]),
            ("add_traversal", ([0.0], ["speed"]), {}),
            True,
        ),
    ],
)
def test_truth_goes_to_the_extended_columns_and_is_left_out_if_it_is_no_truth(
    give: Give, taken: Taken, may_be_left_out: bool
) -> None:
    spy = Extended()
    session = spy.stand_in(MetricsSession())
    assert give(session) is None
    spy.answer = False
    assert give(session) == (Remark(faults.NOT_FINITE_OR_OTHER) if may_be_left_out else None)
    assert spy.taken == [taken, taken]
    assert give(MetricsSession()) is None
