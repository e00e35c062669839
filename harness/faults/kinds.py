"""The faults that there are: of which sensor, what they take, what they do to its messages.

What each does to a reading stands in harness.faults.injector, to the clock in fault_clock.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

from harness.samples import GroundTruth, Imu, JointStates, LaserScan, Odometry, Pose, Sample

CLOCK = "clock"
LONGEST = 1e8  # [s]: stamps have 31 bits of seconds

# In publishing order.
SENSORS: dict[str, type[Sample]] = {
    "scan": LaserScan,
    "imu": Imu,
    "pose": Pose,
    "odometry": Odometry,
    "ground_truth": GroundTruth,
    "joint_states": JointStates,
}


@dataclass(frozen=True)
class Value:
    """What may stand behind the '='.

    Attributes:
        name: Placeholder in the help.
        meaning: Which numbers are valid, as an error message says it.
        valid: Whether a number is.
        default: Taken if none is given; None if one must be.
    """

    name: str
    meaning: str
    valid: Callable[[float], bool]
    default: float | None = None


@dataclass(frozen=True)
class Kind:
    """One kind of fault.

    Attributes:
        summary: What it does, for the help.
        value: What it takes; None if it takes no value.
        momentary: Whether it happens at one time, instead of lasting.
    """

    summary: str
    value: Value | None = None
    momentary: bool = False


_SHARE = Value("SHARE", "a share above 0 up to 1", lambda x: 0.0 < x <= 1.0, default=1.0)
_NUMBER = Value("X", "a number, inf or nan", lambda _: True)
_SIZE = Value("SIZE", "a size above 0", lambda x: 0.0 < x < math.inf, default=10.0)
_COPIES = Value("N", "a whole number from 2 to 10", lambda x: x in range(2, 11), default=2.0)
_BEAMS = Value("N", "a whole number from 0 to 100000", lambda x: x in range(100_001))
_DELAY = Value("S", "seconds above 0 up to 60", lambda x: 0.0 < x <= 60.0)
_RATE = Value("HZ", "a rate above 0 up to 100 Hz", lambda x: 0.0 < x <= 100.0)
_SHIFT = Value("S", "seconds, negative for back in time", lambda x: abs(x) <= LONGEST)
_JUMP = Value(_SHIFT.name, _SHIFT.meaning, _SHIFT.valid, default=10.0)
_FACTOR = Value("FACTOR", "a factor above 0 up to 100", lambda x: 0.0 < x <= 100.0)

ANY_SENSOR = {
    "dropout": Kind("messages are not sent", _SHARE),
    "rate": Kind("at most so many messages a second", _RATE),
    "latency": Kind("messages come late, in order, with the stamp of the reading", _DELAY),
    "duplicate": Kind("each message is sent N times", _COPIES),
    "freeze": Kind("the last reading again and again, with new stamps"),
    "stuck": Kind("every value is X", _NUMBER),
    "zero": Kind("values are 0", _SHARE),
    "nan": Kind("values are NaN", _SHARE),
    "inf": Kind("values are infinite", _SHARE),
    "huge": Kind("values are 1e30", _SHARE),
    "spike": Kind("one value in ten, at random, is off by SIZE", _SIZE),
    "stamp-shift": Kind("stamps are off by S", _SHIFT),
    "stamp-freeze": Kind("stamps stand still"),
}
_EMPTY = Kind("a message without readings")
OWN: dict[str, dict[str, Kind]] = {
    "scan": {"empty": _EMPTY, "beams": Kind("only the first N ranges, or more that miss", _BEAMS)},
    "pose": {"empty": _EMPTY},
    "joint_states": {"empty": _EMPTY},
    CLOCK: {
        "jump": Kind("time goes S ahead or back, not below 0, and on from there", _JUMP, momentary=True),
        "reset": Kind("time starts again from 0", momentary=True),
        "speed": Kind("time runs FACTOR as fast, for stamps too", _FACTOR),
        "freeze": Kind("/clock repeats its last time, then catches up"),
        "dropout": Kind("/clock is not sent", _SHARE),
    },
}


def kinds(sensor: str) -> dict[str, Kind]:
    """The faults that a sensor or the clock can have, by name."""
    return OWN[CLOCK] if sensor == CLOCK else ANY_SENSOR | OWN.get(sensor, {})


def describe_faults() -> str:
    """Sensors and faults for a command's help."""
    lines = [f"sensors: {', '.join((*SENSORS, CLOCK))}"]
    lines += _described("each sensor", ANY_SENSOR)
    for sensor, own in OWN.items():
        lines += _described(sensor, own)
    return "\n".join(lines)


def _described(whose: str, some: dict[str, Kind]) -> list[str]:
    forms = {_form(name, kind): kind.summary for name, kind in some.items()}
    return [f"{whose}:", *(f"  {form:22}{summary}" for form, summary in forms.items())]


def _form(name: str, kind: Kind) -> str:
    at = "@START" if kind.momentary else ""
    if kind.value is None:
        return name + at
    value = f"={kind.value.name}"
    return name + (value if kind.value.default is None else f"[{value}]") + at
