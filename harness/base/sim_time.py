"""Simulation time: whole nanoseconds, the clock tick, and the physics steps that divide it.

Free of MuJoCo: code that only counts ticks need not load it.
"""

import math

from harness.base.errors import UsageError

NANOSECONDS = 1_000_000_000
TICK_NS = 10_000_000  # /clock at 100 Hz
TICK = TICK_NS / NANOSECONDS  # [s]
LOOK_PERIOD_NS = NANOSECONDS // 10  # from one look for nodes and topics that have turned up to the next
HIGHEST_RATE = NANOSECONDS // TICK_NS  # [Hz]
CONTROL_PERIOD_NS = 50_000_000  # 20 Hz, the lidar's rate: every command can use a fresh scan
CONTROL_PERIOD = CONTROL_PERIOD_NS / NANOSECONDS
TICKS_PER_CONTROL = CONTROL_PERIOD_NS // TICK_NS
SMALLEST_TIMESTEP_NS, LARGEST_TIMESTEP_NS = 100_000, 5_000_000
DEFAULT_TIMESTEP_NS = 2_500_000


def check_duration(seconds: float, name: str = "duration") -> None:
    """Checks that an episode can last that long; UsageError, which names what is valid, if not."""
    if not (math.isfinite(seconds) and round(seconds * NANOSECONDS) >= TICK_NS):
        raise UsageError(f"{name} {seconds:g} s is not valid; give {TICK:g} s or more")
    below, rest_ns = divmod(round(seconds * NANOSECONDS), TICK_NS)
    if rest_ns:
        raise UsageError(
            f"{name} {seconds:.9g} s is refused: it must be whole clock ticks of 10 ms; "
            f"nearest valid: {below * TICK:.9g} or {(below + 1) * TICK:.9g}"
        )


def parse_timestep(seconds: float) -> int:
    """Converts a timestep to nanoseconds; UsageError, which names the nearest valid ones."""
    nanoseconds = round(seconds * NANOSECONDS) if math.isfinite(seconds) else 0
    in_limits = SMALLEST_TIMESTEP_NS <= nanoseconds <= LARGEST_TIMESTEP_NS
    if in_limits and TICK_NS % nanoseconds == 0:
        return nanoseconds
    nearest = sorted(timesteps(), key=lambda v: abs(v - nanoseconds / NANOSECONDS))[:2]
    raise UsageError(
        f"timestep {seconds:g} s is refused: {_why_not(nanoseconds)}; "
        f"nearest valid: {' or '.join(f'{v:g}' for v in nearest)}"
    )


def _why_not(timestep_ns: int) -> str:
    if timestep_ns > LARGEST_TIMESTEP_NS:
        return (
            "above 5 ms the wheels' contacts (time constant 20 ms) are sampled too coarsely: "
            "they chatter and shake the IMU"
        )
    if timestep_ns < SMALLEST_TIMESTEP_NS:
        return "give 0.0001 or more"
    return "it must divide the 10 ms clock tick"


def timesteps() -> list[float]:
    """Returns the valid timesteps, from the largest down [s]."""
    parts = range(TICK_NS // LARGEST_TIMESTEP_NS, TICK_NS // SMALLEST_TIMESTEP_NS + 1)
    return [TICK_NS // n / NANOSECONDS for n in parts if TICK_NS % n == 0]


def period_ticks(rate: int) -> int:
    """Returns the clock ticks between samples at a rate [Hz]; UsageError if they are not whole."""
    if rate > 0 and HIGHEST_RATE % rate == 0:
        return HIGHEST_RATE // rate
    valid = [r for r in range(1, HIGHEST_RATE + 1) if HIGHEST_RATE % r == 0]
    nearest = sorted(sorted(valid, key=lambda r: abs(r - rate))[:2])
    raise UsageError(
        f"rate {rate} Hz does not divide the {HIGHEST_RATE} Hz clock; "
        f"nearest valid: {' or '.join(str(r) for r in nearest)}"
    )
