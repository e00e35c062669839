"""What a user may write after --fault, and what he is told."""

import math

import pytest

from harness.base.errors import UsageError
from harness.base.sim_time import NANOSECONDS as SECOND
from harness.faults.base import Fault
from harness.faults.lookup import describe_faults, faults_of, sensors
from harness.sensors import table
from tests.support.words import parse_faults


def test_spec_says_sensor_fault_value_start_and_length() -> None:
    specs = ["imu:nan=0.5@10+2", "scan:latency=0.2", "clock:jump=-3@30", "imu:stuck=-1e+5@2.01+2.03"]
    assert parse_faults(specs) == (  # times are the nearest nanoseconds: 2.01 * 1e9 is below them
        Fault(faults_of("imu")["nan"], "imu", 0.5, 10 * SECOND, 12 * SECOND),
        Fault(faults_of("scan")["latency"], "scan", 0.2, 0, None),
        Fault(faults_of("clock")["jump"], "clock", -3.0, 30 * SECOND, None),
        Fault(faults_of("imu")["stuck"], "imu", -1e5, 2_010_000_000, 4_040_000_000),
    )


@pytest.mark.parametrize(
    ("spec", "message"),
    [
        ("imu", r"not of the form SENSOR:FAULT\[=VALUE\]\[@START\[\+LENGTH\]\], e\.g\. imu:nan@10\+2"),
        ("", "not of the form"),
        ("imu:nan@", "not of the form"),
        ("sonar:nan", "there is no sensor 'sonar'; available: tf, scan, imu, pose, .*clock"),
        ("scan.attitude:nan", "there is no sensor 'scan.attitude'; available: .*imu.attitude"),
        ("imu.attitude:dropout", "imu.attitude has no fault 'dropout'; available: stuck, zero, nan"),
        ("imu:jump@3", "imu has no fault 'jump'; available: dropout, .*nan"),
        ("clock:nan", "clock has no fault 'nan'; available: jump, reset"),
        ("scan:latency", "needs =S: seconds above 0"),
        ("imu:stamp-shift", "needs =S: seconds, negative for back in time"),
        ("imu:rate", "needs =HZ: a rate above 0"),
        ("imu:stuck", "needs =X: a number, inf or nan"),
        ("scan:beams", "needs =N: a whole number from 0"),
        ("clock:speed", "needs =FACTOR: a factor above 0"),
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


def test_a_sensor_that_could_be_carried_is_told_how() -> None:
    rows = [row for row in table.SENSORS if row.options is None]
    told = "there is no sensor 'barometer', but --sensors barometer adds it; available: tf, scan"
    with pytest.raises(UsageError, match=told):
        parse_faults(["barometer:nan"], rows)
    with pytest.raises(UsageError, match="there is no sensor 'sonar'; available"):
        parse_faults(["sonar:nan"], rows)


def test_help_names_every_sensor_and_fault() -> None:
    told = describe_faults()
    for sensor in sensors():
        assert sensor in told
        assert all(f"  {name}" in told for name in faults_of(sensor))
    forms = {line.split()[0] for line in told.splitlines() if line.startswith("  ")}
    assert {"dropout[=SHARE]", "latency=S", "freeze", "jump[=S]@START", "reset@START"} <= forms
    assert "  beams=N               only the first N ranges" in told
    own = {"beams": 1, "empty": 3, "jump": 1, "reset": 1, "dropout": 2, "nan": 1}
    assert {name: told.count(f"\n  {name}") for name in own} == own  # not among all sensors' ones
    names = ", ".join(sensors())
    assert told.splitlines()[0] == f"sensors: {names}; attitudes have those of values"
    headings = [line for line in told.splitlines() if line.endswith(":")]
    assert headings == ["each sensor:", "scan:", "pose:", "joint_states:", "clock:"]


def test_a_fault_is_parsed_once() -> None:
    specs = ["imu:nan@1+1", "clock:jump=3@2"]
    assert all(a is b for a, b in zip(parse_faults(specs), parse_faults(specs), strict=True))


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
