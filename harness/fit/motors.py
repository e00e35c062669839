"""Constants of the motors: torque over current, and what is lost in their windings."""

import numpy as np

from harness.fit.estimate import CERTAIN, Estimate, deviations, of, slope
from harness.fit.steady import SKEW, SLOWEST
from harness.robots import RoverSpec
from harness.validate.recordings.recording import Recording, Series, at

SPAN = 0.5  # [s] over which torques, currents and power are means
PARTS, STEADY = 10, 0.05  # of a span; sd of currents over the larger one's mean
ERROR = 0.015  # of each power, at least: few spans may fit by chance
FORCES = "torques, or the battery's power, are missing"


def motors(rover: RoverSpec, recording: Recording) -> list[Estimate]:
    """Returns the motor constant and the resistance.

    The motor constant is torque over current, where both are recorded; the battery gives
    P = K sum(i w) + R sum(i^2) + standby, which tells both, and the resistance by K.
    """
    keys = "actuators.motor_constant", "actuators.resistance"
    constant = Estimate("motor constant", "N m/A", keys[0], of(rover, keys[0]))
    resistance = Estimate("resistance", "Ohm", keys[1], of(rover, keys[1]))
    there = recording.series
    if "currents" not in there:
        return [one.unknown("currents are missing") for one in (constant, resistance)]
    if "torques" in there:
        (currents, torques) = (_means(recording, name) for name in ("currents", "torques"))
        value, half = slope(currents.ravel(), torques.ravel())
        constant = constant.judged(value, half, "driving under load is missing")
    if "power" not in there:
        return [constant if constant.is_known and "torques" in there else constant.unknown(FORCES),
                resistance.unknown("the battery's power is missing")]  # fmt: skip
    return _by_power(rover, recording, constant, resistance)


def _by_power(
    rover: RoverSpec, recording: Recording, constant: Estimate, resistance: Estimate
) -> list[Estimate]:
    assert rover.actuators is not None  # noqa: S101 - the command checks it
    power, currents, rims = (_means(recording, name) for name in ("power", "currents", "wheels"))
    each = 1 if rover.actuators.one_motor_a_side else len(rover.drive.driven) // 2  # motors of a side
    spinning = np.abs(rims) / rover.controller_radius
    work, lost = (currents * spinning).sum(axis=1), (currents**2).sum(axis=1) / each
    columns, wanted = np.column_stack([lost, np.ones(len(lost)), work]), power[:, 0]
    if np.isfinite(constant.after):
        columns, wanted = columns[:, :2], wanted - constant.after * work
    if each > 1:  # in turns the motors of a side share its current unequally, and lose more
        straight = np.ptp(rims, axis=1) <= SKEW * np.abs(rims).max(axis=1, initial=SLOWEST)
        columns, wanted, power = columns[straight], wanted[straight], power[straight]
    values, _, rank, _ = np.linalg.lstsq(columns, wanted, rcond=None)
    halves = np.full(len(values), np.inf)
    if rank == len(values):
        by_chance = np.linalg.norm(np.linalg.pinv(columns) * ERROR * power[:, 0], axis=1)
        halves = CERTAIN * np.hypot(deviations(columns, wanted - columns @ values), by_chance)
    if not np.isfinite(constant.after):
        constant = constant.judged(float(values[2]), float(halves[2]), "driving under load is missing")
    return [
        constant,
        resistance.judged(float(values[0]), float(halves[0]), "large currents are missing"),
    ]


def _means(recording: Recording, name: str) -> Series:
    """Means over each SPAN that currents, torques, power and wheels have in common, if it is steady."""
    names = "currents", "torques", "power", "wheels"
    there = {one: series for one, series in recording.series.items() if one in names}
    begin, end = max(v[0, 0] for v in there.values()), min(v[-1, 0] for v in there.values())
    times = np.arange(begin, end, SPAN / PARTS)
    times = times[: times.size // PARTS * PARTS]
    currents, values = (
        at(there[one], times).reshape(-1, PARTS, there[one].shape[1] - 1) for one in ("currents", name)
    )
    most = currents.mean(axis=1).max(axis=1, keepdims=True)
    is_steady = (currents.std(axis=1) <= STEADY * most).all(axis=1)
    has_settled = is_steady & np.append(True, is_steady[:-1])  # the rover has no more speed to gain
    means: Series = values.mean(axis=1)[has_settled]
    return means
