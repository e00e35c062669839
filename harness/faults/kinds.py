"""All faults there are; the help shows them in this order."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from harness.faults.actuation import CMD_VEL, MOTOR, WHEEL, frozen_commands, late_commands, lost_commands
from harness.faults.base import Kind, SensorAct, Value
from harness.faults.clock import ClockAct, drift, freeze, jump, reset, silence
from harness.faults.readings import becomes, each, empty, measured, resize, shift, spike
from harness.faults.streams import decimated, frozen, late, repeat
from harness.spec.fault import LONGEST
from rover_metrics.plugins import Table, takes

SHARE = Value("SHARE", "a share above 0 up to 1", lambda x: 0.0 < x <= 1.0, default=1.0)
WEAK = Value("SHARE", "a share of the torque from 0 up, below 1", lambda x: 0.0 <= x < 1.0, default=0.0)
SIZE = Value("SIZE", "a size above 0", lambda x: 0.0 < x < math.inf, default=10.0)
ANY = Value("X", "a number, inf or nan", lambda _: True)
RATE = Value("HZ", "a rate above 0 up to 100 Hz", lambda x: 0.0 < x <= 100.0)
DELAY = Value("S", "seconds above 0 up to 60", lambda x: 0.0 < x <= 60.0)
COPIES = Value("N", "a whole number from 2 to 10", lambda x: x in range(2, 11), default=2.0)
BEAMS = Value("N", "a whole number from 0 to 100000", lambda x: x in range(100_001))
FACTOR = Value("FACTOR", "a factor above 0 up to 100", lambda x: 0.0 < x <= 100.0)
_SECONDS = ("S", "seconds, negative for back in time", lambda x: abs(x) <= LONGEST)
SHIFT, JUMP = Value(*_SECONDS), Value(*_SECONDS, default=10.0)

DUPLICATE = "duplicate"
EMPTY = ("scan", "pose", "joint_states")  # the sensors whose messages can be

OF_SENSORS: tuple[Kind[SensorAct], ...] = (
    Kind("dropout", "messages are not sent", each(lambda r, p, rng: (r,) * (rng.random() >= p)), SHARE),
    Kind("rate", "at most so many messages a second", decimated, RATE),
    Kind("latency", "messages come late, in order, with the stamp of the reading", late, DELAY),
    Kind(DUPLICATE, "each message is sent N times", each(lambda r, n, _: (r,) * int(n)), COPIES),
    Kind("freeze", "the last reading again and again, with new stamps", frozen(repeat)),
    Kind("stuck", "every value is X", measured(lambda v, x, _: np.full_like(v, x)), ANY, of_values=True),
    Kind("zero", "values are 0", becomes(0.0), SHARE, of_values=True),
    Kind("nan", "values are NaN", becomes(math.nan), SHARE, of_values=True),
    Kind("inf", "values are infinite", becomes(math.inf), SHARE, of_values=True),
    # 1e30 fits float32; its square fits float64.
    Kind("huge", "values are 1e30", becomes(1e30), SHARE, of_values=True),
    Kind("spike", "one value in ten, at random, is off by SIZE", measured(spike), SIZE, of_values=True),
    Kind("stamp-shift", "stamps are off by S", each(shift), SHIFT),
    Kind("stamp-freeze", "stamps stand still", frozen(lambda last, now: repeat(now, last))),
    Kind("empty", "a message without readings", each(empty), own=EMPTY),
    Kind("beams", "only the first N ranges, or more that miss", each(resize), BEAMS, own=("scan",)),
)
FAULTS = Table[Kind[SensorAct]](
    "faults",
    {kind.name: kind for kind in OF_SENSORS},
    lambda value: isinstance(value, Kind) and takes(value.act, 2),
    "a harness.faults.base.Kind with an `act` (fault, rng)",
)
OF_THE_CLOCK: tuple[Kind[ClockAct], ...] = (
    Kind(
        "jump", "time goes S ahead or back, not below 0, and on from there", jump, JUMP, momentary=True
    ),
    Kind("reset", "time starts again from 0", reset, momentary=True),
    Kind("speed", "time runs FACTOR as fast, for stamps too", drift, FACTOR),
    Kind("freeze", "/clock repeats its last time, then catches up", freeze),
    Kind("dropout", "/clock is not sent", silence, SHARE),
)
# Between commands and wheels: they change the drive itself (harness.faults.actuation), after a command
# that is too old has become a stop.
OF_COMMANDS: tuple[Kind[Any], ...] = (
    Kind("latency", "commands take effect S later", late_commands, DELAY),
    Kind(
        "dropout",
        "what is commanded in a period of 50 ms is lost; the last one stays in force",
        lost_commands,
        SHARE,
    ),
    Kind("freeze", "no command is heard; the last one stays in force", frozen_commands),
)
OF_MOTORS = (Kind[Any]("weak", "the motors of a side give a SHARE of their torque", None, WEAK),)
OF_WHEELS = (Kind[Any]("stuck", "the wheel does not turn", None),)
OF_ACTUATION: Mapping[str, tuple[Kind[Any], ...]] = {
    CMD_VEL: OF_COMMANDS,
    f"{MOTOR}left": OF_MOTORS,
    f"{MOTOR}right": OF_MOTORS,
    f"{WHEEL}front_left": OF_WHEELS,  # and other wheels
}
