"""What a user may write after --fault, and what is said of the rest."""

import re

import pytest

from harness.base.errors import UsageError
from harness.base.sim_time import NANOSECONDS as SECOND
from harness.faults.base import Fault
from harness.faults.kinds import OF_SENSORS, OF_THE_CLOCK
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
    assert all(a is b for a, b in zip(parse_faults(specs), parse_faults(specs), strict=True)), "once"


@pytest.mark.parametrize(
    ("spec", "valid"),
    [
        ("imu", "SENSOR:FAULT[=VALUE][@START[+LENGTH]], e.g. imu:nan@10+2"),
        ("sonar:nan", "no sensor 'sonar'; available: tf, scan, imu"),
        ("imu.attitude:dropout", "no fault 'dropout'; available: stuck, zero, nan"),
        ("scan:latency", "needs =S: seconds above 0"),
        ("scan:freeze=3", "takes no value"),
        ("imu:nan@-1", "seconds from 0 up"),
        ("clock:jump=3", "give clock:jump@START"),
        ("clock:reset@3+2", "give clock:reset@START"),
    ],
)
def test_invalid_spec_is_one_line_that_says_what_is_valid(spec: str, valid: str) -> None:
    with pytest.raises(UsageError) as refusal:
        parse_faults([spec])
    assert valid in str(refusal.value)
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize("number", ["1_0", "\uff10.5", "\u0663"])
def test_a_number_has_ascii_digits_and_no_underscores(number: str) -> None:
    for spec in (f"imu:stuck={number}", f"imu:nan@{number}", f"imu:nan@1+{number}"):
        with pytest.raises(UsageError, match=f"'{number}' is not valid; give (a number|seconds)"):
            parse_faults([spec])


def test_help_names_every_sensor_and_fault() -> None:
    first, *rest = describe_faults().splitlines()
    assert first == f"sensors: {', '.join(sensors())}; attitudes have those of values"
    named = {re.split(r"[=@\[\s]", line.strip())[0] for line in rest}
    assert named >= {kind.name for kind in OF_SENSORS} | {kind.name for kind in OF_THE_CLOCK}
    assert {"  jump[=S]@START", "  beams=N", "  freeze"} <= {line[:24].rstrip() for line in rest}


def test_duplicates_of_duplicates_have_a_bound() -> None:
    parse_faults(["scan:duplicate=10"] * 3 + ["imu:duplicate=10"])
    mend = (
        r"faults of scan send each message 10,000,000 times; give duplicates that come to 1,000 at most"
    )
    with pytest.raises(UsageError, match=mend):
        parse_faults([f"scan:duplicate=10@{start}+1" for start in range(7)])


def test_a_sensor_that_could_be_carried_is_told_how() -> None:
    rows = [row for row in table.SENSORS if row.options is None]
    message = "there is no sensor 'barometer', but --sensors barometer adds it; available: tf, scan"
    with pytest.raises(UsageError, match=message):
        parse_faults(["barometer:nan"], rows)


@pytest.mark.parametrize(
    ("form", "default", "valid", "invalid"),
    [
        ("imu:dropout{}", 1.0, (1e-9, 1.0), (0.0, 1.0001)),
        ("imu:zero{}", 1.0, (1e-9, 1.0), (0.0, 1.0001)),
        ("imu:spike{}", 10.0, (1e-9, 1e300), (0.0, "inf")),
        ("imu:duplicate{}", 2.0, (2, 10), (1, 11, 2.5)),
        ("scan:beams{}", None, (0, 100_000), (-1, 100_001)),
        ("imu:latency{}", None, (1e-9, 60.0), (0.0, 60.001)),
        ("imu:rate{}", None, (1e-9, 100.0), (0.0, 100.001)),
        ("imu:stamp-shift{}", None, (-1e8, 1e8), (-1.001e8, 1.001e8)),
        ("clock:jump{}@1", 10.0, (-1e8, 1e8), (-1.001e8, 1.001e8, "inf")),
        ("clock:speed{}", None, (1e-9, 100.0), (0.0, 100.001)),
        ("clock:dropout{}", 1.0, (1e-9, 1.0), (0.0, 1.0001)),
        ("imu:stuck{}", None, (-1e300, "nan", "-inf"), ("x",)),
    ],
)
def test_a_value_has_limits_and_a_default_unless_it_must_be_given(
    form: str, default: float | None, valid: tuple[object, ...], invalid: tuple[object, ...]
) -> None:
    parse_faults([form.format(f"={value}") for value in valid])
    wrong = [form.format(f"={value}") for value in invalid]
    if default is None:
        wrong.append(form.format(""))
    else:
        assert parse_faults([form.format("")])[0].value == default
    for spec in wrong:
        with pytest.raises(UsageError):
            parse_faults([spec])
