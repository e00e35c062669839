"""What the callbacks make of each message; messages are of the same shape as ROS's, without it."""

import array
import math
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest
from rover_metrics.extended.messages import MessageIntake
from rover_metrics.ros.sensor_callbacks import SensorCallbacks

from rover_metrics.core.metrics import TraversalMetrics, Vector3
from rover_metrics.health import rejections as faults
from rover_metrics.health.reception import Reception

INF, NAN = math.inf, math.nan
STILL = (0.0, 0.0, 0.0)

Message = Any  # messages have no types
TOPICS = ("scan", "imu", "pose", "odometry", "ground_truth", "contact", "traversal")


def vector(values: Vector3) -> Message:
    return SimpleNamespace(**dict(zip("xyz", values, strict=True)))


def stamped(**fields: object) -> Message:
    stamp = SimpleNamespace(sec=3, nanosec=5)
    return SimpleNamespace(header=SimpleNamespace(stamp=stamp), **fields)


def scan(*ranges: float) -> Message:
    return stamped(ranges=array.array("f", ranges), range_min=0.15, range_max=10.0)


def imu(acceleration: Vector3, rate: Vector3 = STILL) -> Message:
    return stamped(linear_acceleration=vector(acceleration), angular_velocity=vector(rate))


def poses(*positions: Vector3) -> Message:
    return stamped(poses=[SimpleNamespace(position=vector(position)) for position in positions])


def odometry(velocity: Vector3) -> Message:
    return stamped(twist=SimpleNamespace(twist=SimpleNamespace(linear=vector(velocity))))


class Intake:
    """Stands where MessageIntake does: remembers what it is given, and the smoothness at that time."""

    def __init__(self, metrics: TraversalMetrics) -> None:
        self.metrics = metrics
        self.taken: list[tuple[str, Any, bool | None]] = []
        self.answer = True

    def __getattr__(self, kind: str) -> Callable[..., bool]:
        def take(message: Message, used: bool | None = None) -> bool:
            self.taken.append((kind, message, used))
            self.smoothness = self.metrics.smoothness_metric
            return self.answer

        return take


class Bench:
    """The callbacks with all that stands around them."""

    def __init__(self, *, extended: bool = True) -> None:
        self.told: list[str] = []
        self.debugged: list[tuple[str, str]] = []
        self.metrics, self.reception = TraversalMetrics(), Reception(self.told.append)
        self.intake = Intake(self.metrics)
        self.sensors = SensorCallbacks(
            self.metrics,
            self.reception,
            lambda topic, report: self.debugged.append((topic, report())),
            self.intake if extended else None,  # type: ignore[arg-type]
        )
        for topic in TOPICS:
            self.reception.listen(f"/{topic}")
            setattr(self.sensors, topic, f"/{topic}")

    def counts(self, what: dict[str, int]) -> dict[str, int]:
        return {topic: count for topic, count in what.items() if count}

    def remarks(self) -> dict[str, dict[str, int]]:
        return {topic: dict(odd) for topic, odd in self.reception.remarks.items() if odd}


@pytest.mark.parametrize("extended", [True, False])
@pytest.mark.parametrize(
    ("kind", "message", "rejected", "remark"),
    [
        ("scan", scan(2.5, 1.0), False, None),
        ("scan", scan(0.125, 11.0), False, faults.BELOW_LIMIT),
        ("scan", scan(5.0, 11.0), False, faults.ABOVE_LIMIT),
        ("scan", scan(0.0, 5.0), False, faults.ZERO_OR_LESS),
        ("scan", scan(INF, INF), None, None),  # open space: neither used nor a fault
        ("scan", scan(INF, NAN), None, faults.ALL_NAN),
        ("scan", scan(), None, faults.NO_RANGES),
        ("imu", imu((0.0, 0.0, 9.8)), False, None),
        ("imu", imu((NAN, 0.0, 9.8)), True, faults.NOT_FINITE),
        ("imu", imu((0.0, 1e6, 0.0)), True, faults.HUGE_ACCELERATION),
        ("imu", imu(STILL, (0.0, 0.0, 1e6)), True, faults.HUGE_ANGULAR_RATE),
        ("pose", poses((1.0, 2.0, 3.0)), False, None),
        ("pose", poses((0.0, NAN, 0.0)), True, faults.NOT_FINITE),
        ("pose", poses(), True, faults.NO_POSE),
        ("odometry", odometry((0.5, 0.0, 0.0)), False, None),
        ("odometry", odometry((0.0, 1e6, 0.0)), True, faults.HUGE_SPEED),
        ("odometry", odometry((0.0, 0.0, NAN)), True, faults.NOT_FINITE),
    ],
)
def test_each_message_is_counted_once_handed_on_and_named_if_something_is_odd(
    kind: str,
    message: Message,
    rejected: bool | None,
    remark: str | None,
    extended: bool,
) -> None:
    bench = Bench(extended=extended)
    callbacks = {"scan": "lidar_callback", "pose": "pose_array_callback"}
    getattr(bench.sensors, callbacks.get(kind, f"{kind}_callback"))(message)
    assert bench.counts(bench.reception.received) == {f"/{kind}": 1}
    assert bench.counts(bench.reception.rejected) == ({f"/{kind}": 1} if rejected else {})
    assert bench.remarks() == ({f"/{kind}": {remark: 1}} if remark else {})
    used = rejected is False
    assert bench.intake.taken == ([(kind, message, used)] if extended else [])
    states = {state.topic: state for state in bench.reception.states()}
    assert states[f"/{kind}"].stamp_ns == 3_000_000_005


def test_every_component_reaches_its_metric_and_the_extended_ones_come_after() -> None:
    bench = Bench()
    sensors, metrics = bench.sensors, bench.metrics
    sensors.lidar_callback(scan(3.0, 0.125))
    sensors.imu_callback(imu((2.0, 3.0, -6.0), (4.0, 4.0, 2.0)))  # 7 and 6
    assert bench.intake.smoothness == 13.0
    sensors.odometry_callback(odometry((2.0, 1.0, -2.0)))
    for position in ((9.0, 8.0, 7.0), (9.02, 8.03, 7.06)):
        sensors.pose_array_callback(poses(position, STILL))  # the first is the rover's
    row = metrics.row(0)
    assert (row.total_collisions, row.obstacle_clearance) == (1, 0.125)
    assert (row.smoothness_metric, row.vertical_roughness) == (13.0, 6.0)
    assert row.imu_acceleration_magnitude == 7.0
    assert row.current_velocity == 3.0
    assert row.distance_traveled == pytest.approx(0.07)


@pytest.mark.parametrize(("step", "jumps"), [(0.4999, 0), (0.5, 1), (5.0, 1)])
def test_a_step_of_the_distance_threshold_or_more_is_remarked_upon(step: float, jumps: int) -> None:
    bench = Bench()
    for x in (0.0, step, step):
        bench.sensors.pose_array_callback(poses((x, 0.0, 0.0)))
    odd = bench.remarks()["/pose"]
    assert odd.get("step of distance_threshold or more, no travel", 0) == jumps
    assert bench.counts(bench.reception.rejected) == {}


@pytest.mark.parametrize(
    ("kind", "message", "is_stamped"),
    [
        ("ground_truth", odometry((0.3, 0.4, 0.0)), True),
        ("contact", SimpleNamespace(data=True), False),
        ("traversal", SimpleNamespace(data=[0.0]), False),
    ],
)
def test_truth_is_counted_and_left_out_if_it_is_no_truth(
    kind: str,
    message: Message,
    is_stamped: bool,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def take(intake: Intake, taken: object) -> bool:
        return intake.__getattr__(kind)(taken)

    monkeypatch.setattr(MessageIntake, kind, take)
    bench = Bench()
    for answer in (True, False):
        bench.intake.answer = answer
        getattr(bench.sensors, f"{kind}_callback")(message)
        assert bench.reception.rejected[f"/{kind}"] == (not answer)
    assert bench.counts(bench.reception.received) == {f"/{kind}": 2}
    assert bench.counts(bench.reception.rejected) == {f"/{kind}": 1}
    assert bench.intake.taken == [(kind, message, None)] * 2
    assert bench.remarks()[f"/{kind}"] == {
        faults.NOT_FINITE_OR_OTHER: 1,
        **({"stamp stands still": 1} if is_stamped else {}),
    }
    without = Bench(extended=False)
    getattr(without.sensors, f"{kind}_callback")(message)
    assert without.counts(without.reception.rejected) == {}


def test_scans_and_poses_are_reported_with_what_they_came_to() -> None:
    bench = Bench()
    for x in (0.0, 0.25, 0.5):
        bench.sensors.lidar_callback(scan(0.125, 3.0))
        bench.sensors.pose_array_callback(poses((x, 0.0, 0.0)))
    bench.sensors.lidar_callback(scan(INF))
    bench.sensors.imu_callback(imu(STILL))
    bench.sensors.odometry_callback(odometry(STILL))
    bench.sensors.pose_array_callback(poses())
    assert bench.debugged[-3:] == [
        ("/scan", "LIDAR: clearance 0.1250 m, total collisions 3"),
        ("/pose", "Position update: distance 0.2500 m, total 0.5000 m"),
        ("/scan", "LIDAR: clearance 0.1250 m, total collisions 3"),
    ]
    assert len(bench.debugged) == 7
