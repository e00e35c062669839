"""All sensor faults; the help shows them in this order."""

from harness.faults import clock, readings, streams
from harness.faults.base import Fault

FAULTS: tuple[type[Fault], ...] = (
    readings.Dropout,
    streams.Decimation,
    streams.Latency,
    readings.Duplicate,
    streams.Freeze,
    readings.Stuck,
    readings.Zero,
    readings.Nan,
    readings.Inf,
    readings.Huge,
    readings.Spike,
    readings.StampShift,
    streams.StampFreeze,
    readings.Empty,
    readings.Beams,
    clock.ClockJump,
    clock.ClockReset,
    clock.ClockSpeed,
    clock.ClockFreeze,
    clock.ClockDropout,
)
