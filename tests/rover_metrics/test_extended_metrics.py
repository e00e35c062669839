"""The extended columns, from samples to cells."""

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from rover_metrics.core.columns import COLUMNS
from rover_metrics.core.rotation import Vector3
from rover_metrics.core.thresholds import Thresholds
from rover_metrics.errors import ParameterError
from rover_metrics.extended.footprint import Footprint, LidarPose
from rover_metrics.extended.metrics import EXTENDED_HEADER
from rover_metrics.extended.settings import DEFAULT_EXTENDED, ExtendedSettings
from rover_metrics.extended.traffic_columns import IMU, POSE, SCAN
from rover_metrics.session import MetricsSession, Remark

GRAVITY = 9.80665  # m/s^2, ISO 80000-3
SQUARE = ExtendedSettings(footprint=Footprint.rectangle((-0.2, 0.2, -0.2, 0.2)))
LEVEL = (0.001, 0.0, 0.0, math.sqrt(1 - 1e-6))  # but filled in
WHEELS = ("Front Left", "Rear Left", "Front Right", "Rear Right")

Quaternion = tuple[float, float, float, float]
Cells = dict[str, Any]


class Feed:
    """Gives samples to a session and tells whether they were used."""

    def __init__(
        self, settings: ExtendedSettings = SQUARE, thresholds: Thresholds | None = None
    ) -> None:
        thresholds = thresholds or Thresholds(collision_threshold=0.25)
        self.session = MetricsSession(thresholds, settings)
        self.metrics = self.session.metrics
        assert self.session.extended is not None
        self.extended = self.session.extended

    def scan(self, t: float, *ranges: float, first: float = 0.0, step: float = math.pi / 2) -> bool:
        values, limits = np.array(ranges, dtype=np.float32), (0.15, 10.0)
        return used(self.session.take_scan(ns(t), values, angles=(first, step), limits=limits))

    def imu(self, t: float, a: Vector3, orientation: Quaternion | None = LEVEL) -> bool:
        return used(self.session.take_imu(ns(t), a, (0.1, 0.2, 0.3), orientation))

    def pose(self, t: float, position: Vector3 | None) -> bool:
        return used(self.session.take_pose(ns(t), position))

    def odometry(self, t: float, x: float, y: float = 0.0, z: float = 0.0) -> bool:
        return used(self.session.take_odometry(ns(t), (x, y, z)))

    def contact(self, *, touches: bool) -> bool:
        return used(self.session.take_contact(touches=touches))

    def true_velocity(self, x: float, y: float = 0.0, z: float = 0.0) -> bool:
        return used(self.session.take_true_velocity((x, y, z)))

    def traversal(self, values: Sequence[float], names: str = "") -> bool:
        return used(self.session.take_traversal(values, names.split(",") if names else None))

    def row(self, t: float = 1.0, **kwargs: Any) -> Cells:  # noqa: ANN401
        row = self.session.row(ns(t), **kwargs)
        return dict(zip(row.columns, row.as_fields(), strict=True))


def ns(seconds: float) -> int:
    return round(seconds * 1e9)


def used(remark: Remark | None) -> bool:
    return remark is None or not remark.left_out


def times(rate: float, start: float = 0.0, seconds: float = 1.0) -> Iterator[float]:
    """Stamps at a rate, up to and including the end."""
    return (start + i / rate for i in range(1, round(rate * seconds) + 1))


def test_a_row_is_the_twelve_columns_and_then_the_extended_ones() -> None:
    for settings, columns in ((SQUARE, EXTENDED_HEADER), (None, COLUMNS)):
        session = MetricsSession(Thresholds(), settings)
        session.take_scan(ns(0.5), [1.0], angles=(0.0, math.pi / 2))
        row = session.row(ns(7.9))
        assert row.columns == session.columns == columns
        assert row.as_fields()[:12] == session.metrics.row(7).as_fields()
        assert len(row.as_fields()) == len(columns)


# Any session against the definitions of docs/metrics.md, worked out over the whole history at once


class History:
    """Every message of a session and the row that it was heard before."""

    def __init__(self) -> None:
        self.heard: dict[str, list[tuple[int, float, Any]]] = {}
        self.rows: list[float] = []

    def note(self, topic: str, t: float, value: Any) -> None:  # noqa: ANN401
        self.heard.setdefault(topic, []).append((len(self.rows), t, value))

    def of(self, topic: str, row: int | None = None) -> list[tuple[float, Any]]:
        """Stamps and values of a topic; of those before one row only if it is given."""
        found = self.heard.get(topic, [])
        return [(t, value) for number, t, value in found if row is None or number == row]


PAUSES = (0.0, 0.02, 0.05, 0.5, 1.01, -0.3)  # s
READINGS = (0.1, 0.25, 0.3, 0.6, 2.0, math.inf, -math.inf, math.nan)  # m


def drive(seed: int, feed: Feed) -> Iterator[tuple[History, Cells]]:
    """Half a minute of every kind of message in any order, with a row now and then."""
    rng, history, t = np.random.default_rng(seed), History(), 5.0
    position = np.zeros(3)
    for _ in range(8):
        for _ in range(rng.integers(4, 60)):
            t = round(t + float(rng.choice(PAUSES, p=[0.1, 0.4, 0.4, 0.04, 0.03, 0.03])), 6)
            kind = rng.choice(["scan", "imu", "pose", "odometry", "contact", "speed"])
            if kind == "scan":
                ranges = rng.choice(READINGS, 4)
                first, step = (0.0, math.pi / 2) if rng.random() < 0.8 else (0.3, -0.8)
                feed.scan(t, *ranges, first=first, step=step)
                angles = first + step * np.arange(4)
                history.note("Scan", t, (ranges.astype(np.float32), angles))
            elif kind == "imu":
                at_threshold = rng.random() < 0.1
                a = np.array((9.0, 12.0, 0.0)) if at_threshold else rng.normal((0.0, 0.0, 10.0), 5.0)
                a[0] = math.nan if rng.random() < 0.05 else a[0]
                q = rng.normal((0.0, 0.0, 0.0, 3.0))
                known = rng.random() < 0.8
                feed.imu(t, tuple(a), tuple(q / np.linalg.norm(q)) if known else None)
                history.note("IMU", t, (a, Rotation.from_quat(q) if known else None))
            elif kind == "pose":
                jump = 0.4 if rng.random() < 0.1 else 0.0
                position = position + rng.normal((0.1, 0.05, 0.02), 0.05) + jump
                shown = position * (math.nan if rng.random() < 0.05 else 1.0)
                feed.pose(t, tuple(shown))
                history.note("Pose", t, shown)
            elif kind == "odometry":
                v = rng.normal(0.0, 0.4, 3) * (math.inf if rng.random() < 0.05 else 1.0)
                feed.odometry(t, *v)
                history.note("Odometry", t, v)
            elif kind == "contact":
                touches = bool(rng.random() < 0.2)
                feed.contact(touches=touches)
                history.note(kind, t, touches)
            else:
                v = rng.normal(0.0, 0.4, 3)
                feed.true_velocity(*v)
                history.note(kind, t, v)
        history.rows.append(t)
        yield history, feed.row(t)


def expected(history: History) -> Cells:
    """The extended columns of the newest row."""
    row = len(history.rows) - 1
    cells: Cells = {}
    for columns in (travel, lidar, ride, truth):
        cells |= columns(history, row)
    now, before = history.rows[row], history.rows[row - 1] if row else math.inf
    for topic in ("Scan", "IMU", "Pose", "Odometry"):
        messages = history.of(topic)
        came = len(history.of(topic, row))
        bad = sum(topic != "Scan" and not usable(value) for _, value in messages)
        cells[f"{topic} Rate [Hz]"] = came / (now - before) if messages and now > before else ""
        cells[f"{topic} Age [s]"] = now - messages[-1][0] if messages else ""
        cells[f"{topic} Rejected"] = bad if messages else ""
    return cells


def usable(value: Any) -> bool:  # noqa: ANN401
    return bool(np.isfinite(value[0] if isinstance(value, tuple) else value).all())


def steps(samples: Sequence[tuple[float, Any]]) -> NDArray[np.float64]:
    """Time since the sample before [s]; NaN where it is not told: over a second, or not forward."""
    dt = np.diff([t for t, _ in samples], prepend=math.nan)
    return np.where((dt > 0) & (dt <= 1.0), dt, math.nan)


def ride(history: History, row: int) -> Cells:
    samples = [(t, value) for t, value in history.of("IMU") if usable(value)]
    first = sum(usable(value) for n, _, value in history.heard.get("IMU", []) if n < row)
    gravity, shakes, jerks = np.zeros(3), [], []
    for i, (step, (t, (a, rotation))) in enumerate(zip(steps(samples), samples, strict=True)):
        repeats = i > 0 and t == samples[i - 1][0]  # nothing has passed in which it could settle
        settled = a if math.isnan(step) else a + (gravity - a) * math.exp(-step)
        gravity = gravity if repeats else settled
        up = gravity if rotation is None else rotation.inv().apply((0.0, 0.0, GRAVITY))
        if i >= first:
            shakes.append(((a - up) ** 2).sum())
            jerks.append(np.linalg.norm(a - samples[i - 1][1][0]) / step)
    return {
        "Roughness RMS [m/s^2]": math.sqrt(np.mean(shakes)) if shakes else "",
        "Peak Jerk [m/s^3]": np.nanmax(jerks) if np.isfinite(jerks).any() else "",
    }


def travel(history: History, row: int) -> Cells:
    def verdicts(of_row: int) -> list[tuple[float, bool]]:
        imu = [(t, a) for t, (a, _) in history.of("IMU", of_row) if usable(a)]
        return sorted((t, bool(np.linalg.norm(a) > 15.0)) for t, a in imu)

    earlier = next((v[-1][1] for r in range(row - 1, -1, -1) if (v := verdicts(r))), False)
    speeds = [(t, np.linalg.norm(v)) for t, v in history.of("Odometry", row) if usable(v)]
    heard = verdicts(row)
    rough = [s for t, s in speeds if [earlier, *(is_rough for at, is_rough in heard if at <= t)][-1]]
    samples = [(n, t, p) for n, t, p in history.heard.get("Pose", []) if usable(p)]
    places = np.array([p for _, _, p in samples]).reshape(-1, 3)
    moves = np.diff(places, axis=0, prepend=np.full((1, 3), math.nan))[: len(samples)]
    lengths, times = np.linalg.norm(moves, axis=1), steps([(t, None) for _, t, _ in samples])
    travelled = lengths < 0.5
    path = lengths[travelled].sum()
    now = travelled & np.isfinite(times) & np.array([n == row for n, _, _ in samples], dtype=bool)
    slip: Any = ""
    if speeds and now.any():
        wheels, pose = np.mean([s for _, s in speeds]), lengths[now].sum() / times[now].sum()
        slip = (wheels - pose) / max(wheels, pose) if wheels >= 0.05 else ""
    return {
        "VORT [m/s]": np.mean(rough) if rough else "",
        "Slip": slip,
        "Path Efficiency": np.linalg.norm(moves[travelled].sum(axis=0)) / path if path >= 0.1 else "",
    }


def lidar(history: History, row: int) -> Cells:
    scans = history.of("Scan")
    near = [t for t, (ranges, _) in scans if (ranges[np.isfinite(ranges)] < 0.25).any()]
    distances = []
    for _, (ranges, angles) in scans:
        returns = [(r, b) for r, b in zip(ranges, angles, strict=True) if math.isfinite(r)]
        places = [(r * math.cos(b), r * math.sin(b)) for r, b in returns]
        distances.append(min((to_square(*place) for place in places), default=math.inf))
    now = distances[len(scans) - len(history.of("Scan", row)) :]
    counts = {
        "Collision Events": bool(near) + int((np.abs(np.diff(near)) >= 0.5).sum()),
        "Near Return Scans": sum((ranges == -math.inf).any() for _, (ranges, _) in scans),
        "Footprint Collisions": sum(d < 0.05 for d in distances),
    }
    told = counts if scans else dict.fromkeys(counts, "")
    return {**told, "Footprint Clearance [m]": min(now, default="")}


def to_square(x: float, y: float) -> float:
    """Distance to SQUARE."""
    return math.hypot(max(abs(x) - 0.2, 0.0), max(abs(y) - 0.2, 0.0))


def truth(history: History, row: int) -> Cells:
    touches = [touch for _, touch in history.of("contact")]
    events = sum(touch and not any(touches[max(0, i - 10) : i]) for i, touch in enumerate(touches))
    now = [touch for _, touch in history.of("contact", row)]
    speeds = [np.linalg.norm(v) for _, v in history.of("speed", row)]
    return {
        "True Contact Events": events if touches else "",
        "True Contact Share": np.mean(now) if now else "",
        "True Speed [m/s]": np.mean(speeds) if speeds else "",
    }


@pytest.mark.parametrize("seed", range(12))
def test_every_column_of_any_session_is_that_of_its_definition(seed: int) -> None:
    for history, cells in drive(seed, Feed()):
        for name, value in expected(history).items():
            told = f"{name} in row {len(history.rows)}"
            assert (cells[name] == "") == (value == ""), told
            if value != "":
                assert cells[name] == pytest.approx(value, abs=6e-5), told


@pytest.mark.parametrize(
    ("pause", "events"), [(0.499999999, 1), (0.5, 2), (-0.499999999, 1), (-0.5, 2), (-100.0, 2)]
)
def test_collisions_half_a_second_apart_are_two_events(pause: float, events: int) -> None:
    feed = Feed()
    for t in (200.0, 200.3, 200.3 + pause):  # a lasting one counts from its last scan
        feed.scan(t, 0.16)
    feed.scan(300.0, math.inf)  # open space, whatever the clearance was before
    assert feed.row()["Collision Events"] == events


@pytest.mark.parametrize(("step", "told"), [(1.0, True), (1.000001, False), (0.0, False), (-0.5, False)])
def test_steps_of_up_to_a_second_forward_tell_jerk_and_speed(step: float, told: bool) -> None:
    feed = Feed()
    for t, x in ((3.0, 0.0), (3.0 + step, 0.3)):
        feed.imu(t, (0.0, x, 9.8))
        feed.pose(t, (x, 0.0, 0.0))
    feed.odometry(4.0, 0.3)
    row = feed.row(5.0)
    assert row["Peak Jerk [m/s^3]"] == (0.3 if told else "")
    assert row["Slip"] == (0.0 if told else "")
    assert row["Path Efficiency"] == 1.0  # whatever the time


def test_slip_is_defined_from_five_centimetres_a_second_of_the_wheels() -> None:
    for wheels, pose, slip in (
        (0.05, 0.0, 1.0),  # spins
        (0.05, 0.1, -0.5),  # is outrun
        (0.0499999, 0.0, ""),  # hardly turns
        (0.04, 0.4, ""),  # slides down
    ):
        feed = Feed()
        for t in (0.5, 1.0):
            feed.pose(t, (pose * t, 0.0, 0.0))
            feed.odometry(t, wheels)
        assert feed.row()["Slip"] == slip


def test_a_path_has_an_efficiency_from_a_decimetre_and_never_more_than_one() -> None:
    for length, efficiency in ((0.1, 1.0), (0.0999999, "")):
        feed = Feed()
        for t, x in ((0.5, 0.0), (1.0, length)):
            feed.pose(t, (x, 0.0, 0.0))
        assert feed.row()["Path Efficiency"] == efficiency
    feed = Feed()
    for t in range(50):
        feed.pose(float(t), (0.1 * t, 0.3 * t, 0.07 * t))
    told = feed.session.row(ns(50.0)).extended["Path Efficiency"]
    assert told is not None
    assert 0.999999 < told <= 1.0


def test_without_a_footprint_its_columns_are_empty() -> None:
    feed = Feed(DEFAULT_EXTENDED)
    feed.scan(0.1, 0.16)
    row = feed.row()
    assert (row["Footprint Clearance [m]"], row["Footprint Collisions"]) == ("", "")
    assert (row["Collision Events"], row["Near Return Scans"]) == (1, 0)


def test_the_settings_of_the_footprint_are_used_as_they_are_set() -> None:
    backwards = LidarPose(0.1, 0.0, math.pi)
    settings = {"footprint": SQUARE.footprint, "lidar_pose": backwards, "footprint_threshold": 0.25}
    feed = Feed()
    feed.scan(0.1, 0.5, 3.0)
    feed.extended.use(ExtendedSettings(**settings, near_returns_as_contact=True))  # type: ignore[arg-type]
    feed.scan(0.1, 0.6, 3.0)
    feed.row()
    feed.scan(0.1, 0.5, 3.0)
    assert feed.row()["Footprint Clearance [m]"] == 0.2
    feed.scan(0.1, 0.55, 3.0)  # at the threshold
    assert feed.row()["Footprint Collisions"] == 1
    feed.scan(1.1, -math.inf, 3.0)
    assert feed.row()["Footprint Clearance [m]"] == 0.0
    feed.scan(1.2, 3.0, 3.0, first=math.inf)  # no lidar's angles, no crash
    assert feed.row()["Footprint Clearance [m]"] >= 0.0


@pytest.mark.parametrize(
    "unknown",
    [None, (0.0, 0.0, 0.0, 1.0), *((0.6 * norm, 0.0, 0.0, 0.8 * norm) for norm in (0.0, 0.98, 1.02))],
)
def test_without_an_orientation_gravity_is_what_lasts(unknown: Quaternion | None) -> None:
    """No orientation: said so, the message's default, and no unit quaternion."""
    feed = Feed()
    for t in times(20):
        feed.imu(t, (1.0, 2.0, 9.0), unknown)
    assert feed.row()["Roughness RMS [m/s^2]"] == 0.0


def test_roughness_at_rest_is_0_where_the_gravity_is_another_one() -> None:
    feed = Feed()
    for t, gravity in enumerate((9.8, 3.7)):
        feed.extended.use(ExtendedSettings(gravity=gravity))
        feed.imu(float(t), (0.0, 0.0, gravity), (0.0, 0.0, 0.6, 0.8))  # turned, level
        assert feed.row()["Roughness RMS [m/s^2]"] == 0.0


def test_a_clock_that_stands_still_for_hours_costs_no_memory() -> None:
    feed = Feed()
    for i in range(10_500):
        feed.extended.add_odometry(0, (float(i < 600),), used=True)  # type: ignore[arg-type]
        feed.extended.add_imu(i < 600, (0.0, 0.0, 20.0), None, used=True)
    assert feed.row()["VORT [m/s]"] == 0.01  # of the last 10 000 alone


def test_lost_messages_are_counted_for_each_topic() -> None:
    feed = Feed()
    for t in (*times(20), 1.05, 1.10, 1.30, 1.35, 1.55, 1.60):  # two gaps, of three
        feed.scan(t, 1.0)
        if t < 1.5:
            feed.imu(t, (0.0, 0.0, 9.8))
        if t <= 1.0:
            feed.odometry(t, 1.0)
            feed.pose(t, (0.0, 0.0, 0.0))
        if t == 1.0:
            feed.row()
    for t in (1.05, 1.05, 1.0, 50.0):  # stands still, goes back, jumps: nothing is lost
        feed.odometry(t, 1.0)
    row = feed.row(2.0, reported_lost={SCAN: 2, IMU: 5, POSE: 4})
    assert [row[f"{topic} Lost"] for topic in ("Scan", "IMU", "Pose", "Odometry")] == [6, 5, 4, 0]


def test_true_speed_is_empty_while_nobody_fills_the_twist_in() -> None:
    feed = Feed()
    assert feed.true_velocity(0.0, 0.0, 0.0)
    assert feed.row()["True Speed [m/s]"] == ""
    assert feed.true_velocity(0.3, 0.4, 1.2)
    assert feed.true_velocity(0.0, 0.0, 0.0)
    assert not feed.true_velocity(math.nan, 0.0, 0.0)
    assert feed.row()["True Speed [m/s]"] == 0.65


def test_another_truth_is_refused() -> None:
    feed = Feed()
    assert not feed.traversal([0.0] * 10, "roughness,b,c,d,e,f,g,h,i,j")  # lacks the slips
    for values in ([], [1.0] * 9, [1.0] * 11, [1.0] * 9 + [math.nan]):
        assert not feed.traversal(values)
    assert feed.row()["True Roughness [m]"] == ""


def test_a_rover_of_other_wheels_has_other_columns_of_slip() -> None:
    session = MetricsSession(settings=ExtendedSettings(wheels="front_left,front_right,1_left"))
    assert session.take_traversal([9.0, 9.0, 9.0, 9.0, 9.0, 0.1, 0.2, 0.3, 5.0]) is None
    assert session.take_traversal([0.0] * 10) is not None  # of four wheels
    row = session.row(ns(1.0))
    told = dict(zip(row.columns, row.as_fields(), strict=True))
    slips = {name: told[name] for name in told if name.startswith("True Slip")}
    assert slips == {"True Slip Front Left": 0.1, "True Slip Front Right": 0.2, "True Slip 1 Left": 0.3}


@pytest.mark.parametrize(
    "wheels",
    ["", "left,left", "Left,right", "left, right", "left,,right", "_left", "7", "7left", "7_8", "7_"],
)
def test_names_of_wheels_that_are_not_valid_are_refused(wheels: str) -> None:
    with pytest.raises(ParameterError, match="parameter wheels must be names of lower-case letters"):
        ExtendedSettings(wheels=wheels)
