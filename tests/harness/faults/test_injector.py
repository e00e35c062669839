import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pytest

from harness.errors import UsageError
from harness.faults.injector import FaultInjector, disturb_time
from harness.faults.kinds import CLOCK, SENSORS, describe_faults, kinds
from harness.faults.readings import measured_as
from harness.faults.spec import Fault, parse_faults
from harness.samples import (
    GroundTruth,
    Imu,
    JointStates,
    LaserScan,
    Odometry,
    Pose,
    Sample,
    Tick,
    TruthState,
    Twist,
)
from rover_metrics.timing.row_times import RosTimer

TICK = 10_000_000
SECOND = 1_000_000_000
UPRIGHT = (0.0, 0.0, 0.0, 1.0)


def tick(number: int) -> Tick:
    """A tick with every sensor; its number can be read from each value."""
    stamp, x = number * TICK, float(number)
    vector = (x, x, x)
    return Tick(
        stamp,
        (
            LaserScan(stamp, np.full(10, x, dtype=np.float32)),
            Imu(stamp, UPRIGHT, vector, vector),
            Pose(stamp, vector, UPRIGHT),
            Odometry(stamp, x, x, 0.5, Twist(x, x)),
            GroundTruth(stamp, x, x, 0.5, vector, vector),
            JointStates(stamp, vector, vector, vector),
        ),
    )


def sent(*specs: str, seconds: float = 4.0, seed: int = 0) -> list[Tick]:
    """What listeners get of an episode with these faults."""
    faults = FaultInjector(parse_faults(specs), seed)
    return [faults.corrupt(tick(number)) for number in range(1, round(seconds * 100) + 1)]


def readings(ticks: Sequence[Tick], kind: type[Sample]) -> list[Sample]:
    return [sample for one in ticks for sample in one.samples if type(sample) is kind]


def scans(*specs: str) -> list[LaserScan]:
    return [s for s in readings(sent(*specs), LaserScan) if isinstance(s, LaserScan)]


def imus(*specs: str, seed: int = 0) -> list[Imu]:
    return [s for s in readings(sent(*specs, seed=seed), Imu) if isinstance(s, Imu)]


def times(some: Sequence[Sample]) -> list[float]:
    return [reading.stamp_ns / SECOND for reading in some]


def test_without_faults_a_tick_passes_as_it_is() -> None:
    one = tick(7)
    assert FaultInjector((), seed=0).corrupt(one) is one


def test_spec_says_sensor_fault_value_start_and_length() -> None:
    assert parse_faults(["imu:nan=0.5@10+2", "scan:latency=0.2", "clock:jump=-3@30"]) == (
        Fault("imu", "nan", 0.5, 10 * SECOND, 12 * SECOND),
        Fault("scan", "latency", 0.2, 0, None),
        Fault("clock", "jump", -3.0, 30 * SECOND, None),
    )


@pytest.mark.parametrize(
    ("spec", "message"),
    [
        ("imu", r"not of the form SENSOR:FAULT\[=VALUE\]\[@START\[\+LENGTH\]\], e\.g\. imu:nan@10\+2"),
        ("", "not of the form"),
        ("imu:nan@", "not of the form"),
        ("sonar:nan", "there is no sensor 'sonar'; available: scan, imu, pose, .*clock"),
        ("imu:jump@3", "imu has no fault 'jump'; available: dropout, .*nan"),
        ("clock:nan", "clock has no fault 'nan'; available: jump, reset"),
        ("scan:latency", "needs =S: seconds above 0"),
        ("scan:freeze=3", "takes no value; leave out '=3'"),
        ("scan:dropout=1.5", "value '1.5' is not valid; give a share above 0 up to 1"),
        ("scan:dropout=nan", "value 'nan' is not valid"),
        ("scan:stuck=soon", "value 'soon' is not valid; give a number"),
        ("scan:beams=2.5", "give a whole number from 0"),
        ("clock:jump=inf@3", "value 'inf' is not valid"),
        ("imu:nan@-1", "START '-1' is not valid; give seconds from 0 up"),
        ("imu:nan@1+nan", "LENGTH 'nan' is not valid"),
        ("imu:nan@1+0", "LENGTH is 0 s"),
        ("clock:jump=3", "happens at one time; give clock:jump@START"),
        ("clock:reset@3+2", "happens at one time; give clock:reset@START"),
    ],
)
def test_invalid_spec_is_one_line_that_says_what_is_valid(spec: str, message: str) -> None:
    with pytest.raises(UsageError, match=message) as caught:
        parse_faults([spec])
    assert "\n" not in str(caught.value)


def test_help_names_every_sensor_and_fault() -> None:
    told = describe_faults()
    for sensor in (*SENSORS, CLOCK):
        assert sensor in told
        assert all(f"  {name}" in told for name in kinds(sensor))
    forms = {line.split()[0] for line in told.splitlines() if line.startswith("  ")}
    assert {"dropout[=SHARE]", "latency=S", "freeze", "jump[=S]@START", "reset@START"} <= forms
    assert "  beams=N               only the first N ranges" in told


@pytest.mark.parametrize("sensor", [*SENSORS, CLOCK])
def test_every_fault_of_every_sensor_changes_what_is_sent_in_its_time_and_nothing_before(
    sensor: str,
) -> None:
    clean = [repr(one) for one in sent(seconds=0.6)]
    for name, kind in kinds(sensor).items():
        value = "" if kind.value is None or kind.value.default is not None else "=0.5"
        value = "=5" if name in ("beams", "rate") else value
        faulty = [repr(one) for one in sent(f"{sensor}:{name}{value}@0.3", seconds=0.6)]
        assert faulty[:29] == clean[:29], name
        assert faulty[29:] != clean[29:], name


@pytest.mark.parametrize("sensor", SENSORS)
def test_fault_touches_its_sensor_only(sensor: str) -> None:
    clean, faulty = sent(), sent(f"{sensor}:zero@1+1", f"{sensor}:dropout@2+1")
    for kind in set(SENSORS.values()) - {SENSORS[sensor]}:
        assert repr(readings(faulty, kind)) == repr(readings(clean, kind))


@pytest.mark.parametrize(
    ("fault", "is_hit"),
    [
        ("nan", math.isnan),
        ("inf", math.isinf),
        ("zero", lambda x: x == 0.0),
        ("huge", lambda x: x == 1e30),
        ("stuck=-4", lambda x: x == -4.0),
    ],
)
def test_values_are_hit_from_start_to_before_the_end(
    fault: str, is_hit: Callable[[float], bool]
) -> None:
    hit = [
        imu.stamp_ns / SECOND
        for imu in imus(f"imu:{fault}@1+0.5")
        if all(is_hit(x) for x in (*imu.linear_acceleration, *imu.angular_velocity))
    ]
    assert hit == [n / 100 for n in range(100, 150)]


def test_share_of_beams_is_hit_at_random() -> None:
    share = np.mean([np.isnan(scan.ranges).mean() for scan in scans("scan:nan=0.3")])
    assert share == pytest.approx(0.3, abs=0.03)
    assert all(scan.ranges.dtype == np.float32 for scan in scans("scan:nan=0.3"))


def test_spike_throws_one_value_in_ten_off_to_both_sides() -> None:
    off = np.concatenate([s.ranges - round(s.stamp_ns / TICK) for s in scans("scan:spike=3")])
    assert set(np.unique(off).tolist()) == {-3.0, 0.0, 3.0}
    assert np.mean(off != 0.0) == pytest.approx(0.1, abs=0.02)


def test_dropout_silences_and_then_ends() -> None:
    assert times(scans("scan:dropout@1+2.5")) == [n / 100 for n in (*range(1, 100), *range(350, 401))]


def test_dropout_rate_is_the_share_that_is_not_sent() -> None:
    assert len(imus("imu:dropout=0.25")) == pytest.approx(300, abs=30)


@pytest.mark.parametrize("seed", [0, 3])
def test_each_fault_has_a_random_stream_of_its_own(seed: int) -> None:
    """The streams are part of what a seed means: numpy's for the key (11, place of the fault)."""
    told = sent("imu:dropout=0.5", "scan:dropout=0.5", "clock:dropout=0.25", seed=seed)
    sent_at = (
        [any(type(s) is Imu for s in one.samples) for one in told],
        [any(type(s) is LaserScan for s in one.samples) for one in told],
        [one.tells_time for one in told],
    )
    for place, (share, told_at) in enumerate(zip((0.5, 0.5, 0.25), sent_at, strict=True)):
        rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(11, place)))
        assert told_at == (rng.random(len(told)) >= share).tolist()


def test_frozen_sensor_repeats_its_last_reading_with_new_stamps() -> None:
    frozen = scans("scan:freeze@1+1")
    assert times(frozen) == [n / 100 for n in range(1, 401)]
    assert {scan.ranges[0] for scan in frozen[98:199]} == {99.0}
    assert frozen[199].ranges[0] == 200.0


def test_sensor_that_is_frozen_from_the_start_repeats_its_first_reading() -> None:
    assert {scan.ranges[0] for scan in scans("scan:freeze")} == {1.0}


def test_late_readings_come_in_order_with_their_own_stamps() -> None:
    late = sent("scan:latency=0.2@1+1")
    arrivals = [
        (one.stamp_ns, s.stamp_ns) for one in late for s in one.samples if isinstance(s, LaserScan)
    ]
    assert len(arrivals) == 400
    assert [stamp for _, stamp in arrivals] == sorted(stamp for _, stamp in arrivals)
    delays = {(then - stamp) / SECOND for then, stamp in arrivals if 1.0 <= stamp / SECOND < 2.0}
    assert delays == {0.2}
    assert {then - stamp for then, stamp in arrivals if not 1.0 <= stamp / SECOND < 2.2} == {0}


def test_lower_rate_leaves_readings_evenly_out_from_the_start_of_the_fault() -> None:
    assert times(scans("scan:rate=5@1+1"))[98:106] == [0.99, 1.0, 1.2, 1.4, 1.6, 1.8, 2.0, 2.01]
    assert times(scans("scan:rate=2@1.3+1.2"))[128:134] == [1.29, 1.3, 1.8, 2.3, 2.5, 2.51]


@pytest.mark.parametrize(
    "fault", ["zero", "freeze", "stamp-freeze", "stamp-shift=-0.05", "duplicate", "dropout", "spike"]
)
def test_a_lasting_fault_touches_every_tick_from_its_start_to_before_its_end(fault: str) -> None:
    clean, faulty = sent(seconds=2.0), sent(f"imu:{fault}@1+0.5", seconds=2.0)
    changed = [n for n, (a, b) in enumerate(zip(clean, faulty, strict=True), 1) if repr(a) != repr(b)]
    if fault == "spike":  # hits one value in ten
        assert changed
        assert set(changed) <= set(range(100, 150))
    else:
        assert changed == list(range(100, 150))


@pytest.mark.parametrize(
    ("sensor", "expected"),
    [
        ("imu", Imu(TICK, UPRIGHT, (7.0,) * 3, (7.0,) * 3)),
        ("pose", Pose(TICK, (7.0,) * 3, UPRIGHT)),
        ("odometry", Odometry(TICK, 7.0, 7.0, 0.5, Twist(7.0, 7.0))),
        ("ground_truth", GroundTruth(TICK, 7.0, 7.0, 0.5, (7.0,) * 3, (7.0,) * 3)),
        ("joint_states", JointStates(TICK, (7.0,) * 3, (7.0,) * 3, (7.0,) * 3)),
    ],
)
def test_everything_measured_is_hit_and_no_attitude(sensor: str, expected: Sample) -> None:
    (found,) = readings(sent(f"{sensor}:stuck=7", seconds=0.01), type(expected))
    assert found == expected


def test_a_twist_keeps_its_axes() -> None:
    """Values that differ: forward must not become yaw."""
    reading = Odometry(TICK, 1.0, 2.0, 3.0, Twist(4.0, 5.0))
    assert measured_as(reading, lambda values: values + 10.0) == Odometry(
        TICK, 11.0, 12.0, 3.0, Twist(14.0, 15.0)
    )


def test_no_fault_changes_the_truth() -> None:
    state = TruthState(TICK, True, False, True, 5.0, 0.1, 0.2, (0.0, 0.1, 0.2, 0.3), 0.01)
    faults = [f"{sensor}:{kind}" for sensor in SENSORS for kind in ("nan", "dropout", "freeze")]
    injector = FaultInjector(parse_faults([*faults, "clock:jump=10@0.01"]), seed=0)
    clean = tick(1)
    assert injector.corrupt(replace(clean, samples=(*clean.samples, state))).samples[-1] is state


@pytest.mark.parametrize(
    ("fault", "value"),
    [
        *((f"imu:{kind}", 1.0) for kind in ("dropout", "zero", "nan", "inf", "huge")),
        *(("imu:spike", 10.0), ("imu:duplicate", 2.0), ("clock:jump@1", 10.0)),
        *(("clock:dropout", 1.0), ("scan:freeze", 0.0)),
    ],
)
def test_a_value_that_is_left_out_has_a_default(fault: str, value: float) -> None:
    assert parse_faults([fault])[0].value == value


@pytest.mark.parametrize(
    ("form", "valid", "invalid"),
    [
        ("imu:dropout={}", (1e-9, 1.0), (0.0, 1.0001)),
        ("imu:spike={}", (1e-9, 1e300), (0.0, math.inf)),
        ("imu:duplicate={}", (2, 10), (1, 11, 2.5)),
        ("scan:beams={}", (0, 100_000), (-1, 100_001)),
        ("imu:latency={}", (1e-9, 60.0), (0.0, 60.001)),
        ("imu:rate={}", (1e-9, 100.0), (0.0, 100.001)),
        ("imu:stamp-shift={}", (-1e8, 1e8), (-1.001e8, 1.001e8)),
        ("clock:jump={}@1", (-1e8, 1e8), (-1.001e8, 1.001e8)),
        ("clock:speed={}", (1e-9, 100.0), (0.0, 100.001)),
        ("imu:nan@{}", (0.0, 1e8), (-0.001, 1.001e8)),
        ("imu:nan@1+{}", (1e-9, 1e8), (0.0, 1.001e8)),
        ("imu:stuck={}", (-1e300, "nan", "-inf"), ("x",)),
    ],
)
def test_limits_belong_to_what_is_valid(
    form: str, valid: tuple[object, ...], invalid: tuple[object, ...]
) -> None:
    parse_faults([form.format(value) for value in valid])
    for value in invalid:
        with pytest.raises(UsageError):
            parse_faults([form.format(value)])


def test_duplicates_follow_each_other() -> None:
    assert times(imus("imu:duplicate=3@3.99")) == [
        *(n / 100 for n in range(1, 399)),
        *[3.99] * 3,
        *[4.0] * 3,
    ]


def test_stamps_shift_but_never_below_zero_or_stand_still() -> None:
    assert times(imus("imu:stamp-shift=-0.5@0.2+0.4"))[18:61:20] == [0.19, 0.0, 0.09]
    assert times(imus("imu:stamp-freeze@1+1"))[98:201:50] == [0.99, 0.99, 0.99]


def test_empty_messages_hold_no_readings() -> None:
    one = sent("scan:empty", "pose:empty", "joint_states:empty")[0]
    scan, _, pose, _, _, joints = one.samples
    assert isinstance(scan, LaserScan)
    assert scan.ranges.size == 0
    assert isinstance(pose, Pose)
    assert pose.empty
    assert np.isnan(pose.position).all()
    assert isinstance(joints, JointStates)
    assert (joints.position, joints.velocity, joints.effort) == ((), (), ())


def test_beams_are_cut_or_added() -> None:
    assert scans("scan:beams=3")[6].ranges.tolist() == [7.0] * 3
    assert scans("scan:beams=12")[6].ranges.tolist() == [7.0] * 10 + [math.inf] * 2


def test_faults_of_one_sensor_act_in_the_order_given() -> None:
    assert imus("imu:stuck=2", "imu:nan@0")[0].linear_acceleration == pytest.approx(
        (math.nan,) * 3, nan_ok=True
    )
    assert imus("imu:nan@0", "imu:stuck=2")[0].linear_acceleration == (2.0, 2.0, 2.0)


def clock_times(*specs: str) -> list[float]:
    return [one.stamp_ns / SECOND for one in sent(*specs) if one.tells_time]


@pytest.mark.parametrize(
    ("spec", "expected"),
    [
        ("clock:jump=5@2", [1.99, 7.0, 7.01]),
        ("clock:jump=-1.5@2", [1.99, 0.5, 0.51]),
        ("clock:jump=-30@2", [1.99, 0.01, 0.02]),
        ("clock:reset@2", [1.99, 0.01, 0.02]),
        ("clock:speed=0.5@2", [1.99, 1.995, 2.0]),
        ("clock:freeze@2+1", [1.99, 1.99, 1.99]),
    ],
)
def test_time_goes_another_way_at_the_start_of_a_clock_fault(spec: str, expected: list[float]) -> None:
    assert clock_times(spec)[198:201] == pytest.approx(expected)


def test_stamps_follow_the_simulators_time() -> None:
    for one in sent("clock:jump=5@1", "clock:speed=3@2+1", "clock:reset@3"):
        assert {sample.stamp_ns for sample in one.samples} == {one.stamp_ns}


def test_stamps_go_on_while_the_clock_alone_fails_and_it_then_catches_up() -> None:
    for spec in ("clock:freeze@1+1", "clock:dropout@1+1"):
        assert times(imus(spec)) == [n / 100 for n in range(1, 401)]
        assert clock_times(spec)[-200:] == [n / 100 for n in range(201, 401)]
    assert len(clock_times("clock:dropout@1+1")) == 300


def test_time_never_leaves_what_a_stamp_can_hold() -> None:
    jumps = [f"clock:jump=1e8@{n / 10}" for n in range(30)]
    assert max(one.stamp_ns for one in sent(*jumps)) == (2**31 - 1) * SECOND


def test_time_runs_faster_for_as_long_as_the_fault_lasts() -> None:
    assert clock_times("clock:speed=3@1+1")[-1] == 4.0 + 2 * 1.0
    assert clock_times("clock:speed=3@1+1", "clock:speed=2@1+1")[-1] == 4.0 + 5 * 1.0
    assert clock_times("clock:speed=3@1+1")[97:101] == [0.98, 0.99, 1.02, 1.05]


def test_only_clock_faults_disturb_time() -> None:
    assert disturb_time(parse_faults(["imu:nan", "clock:freeze@1"]))
    assert not disturb_time(parse_faults(["imu:nan", "scan:latency=1"]))


def fired(*stamps: float) -> list[float]:
    timer = RosTimer(SECOND)
    return [stamp for stamp in stamps if timer.fires_at(round(stamp * SECOND))]


def test_ros_timer_fires_on_the_grid_skips_what_it_missed_and_starts_again_after_going_back() -> None:
    assert fired(0.5, 1.0, 1.5, 2.0) == [1.0, 2.0]
    assert fired(0.5, 5.7, 5.9, 6.0, 6.1) == [5.7, 6.0]
    assert fired(1.0, 2.0, 2.5, 0.3, 1.0, 1.3, 2.3) == [1.0, 2.0, 1.3, 2.3]
    assert fired(1.0, 1.8, 1.2, 2.0) == [1.0, 2.0]
