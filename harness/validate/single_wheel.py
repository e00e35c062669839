"""A single wheel drawn through flat soil at a constant speed, beside trials that were measured so.

The trials of C. Pavlov (Carnegie Mellon University, 2022, 3d-terramechanics) drag a wheel of 125 mm at
10 mm/s while it turns at its own speed. Their rim speeds were recorded for a radius of 58 mm.
"""

import math
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from harness.base.delimited import read_csv
from harness.base.documents import LARGEST_JSON
from harness.base.errors import UsageError
from harness.base.files import whole_file
from harness.robots import RoverSpec
from harness.robots.model import compiled_alone
from harness.soil.rig_kernel import steady_wheels
from harness.soil.soils import Soil
from rover_metrics.number import number

RADIUS = 0.0625  # [m], to the tips of the grousers
RECORDED_RADIUS = 0.058  # [m], for which the rim speed was recorded
WIDTH = 0.05  # [m]
WHEELS = ("smooth", "grousered")
STEEPEST_DEG = 75.0  # slip angle up to which a wheel rolls; beyond it is ploughed in
MEASURED = ("sinkage", "tractive", "lateral")
GIVEN = ("wheel_speed", "travel_speed", "slip_angle_deg", "load")
LARGEST = 1e6  # in a table of trials, whatever its unit
MOST_LOAD = 1000.0  # [N] that such a wheel bears anywhere
USUAL = {"sinkage": 0.2, "wheel_speed": 5.0, "travel_speed": 5.0}  # [m], [m/s]: more is another unit
GRAVITY = 9.81  # [m/s^2]
SPEED = 0.01  # [m/s] of the carriage

Doubles = NDArray[np.float64]


@dataclass(frozen=True)
class Errors:
    """Root mean square errors of one wheel.

    Attributes:
        wheel: Smooth or grousered.
        trials: Which of its trials.
        n: How many, each with something measured.
        sunk: How many of them the soil does not carry; they count with the wheel sunk to one and a half
            radii and with no force.
        sinkage: [m]; NaN where none was measured, as the forces.
        tractive: [N].
        lateral: [N].
    """

    wheel: str
    trials: str
    n: int
    sunk: int
    sinkage: float
    tractive: float
    lateral: float


def read_table(path: Path, columns: Sequence[str]) -> pd.DataFrame:
    """Returns these columns of a CSV file as they are.

    Raises:
        UsageError: The file cannot be read or lacks a column.
    """
    table = read_csv(path, LARGEST_JSON)
    if missing := [name for name in columns if name not in table]:
        raise UsageError(f"{path} lacks {', '.join(missing)}; needed are {', '.join(columns)}")
    return table[list(columns)].copy()


def read_trials(path: Path) -> tuple[pd.DataFrame, tuple[str, ...]]:
    """Returns trials of single wheels and notes on what of the file was left out.

    The trials have a row each: WHEELS' name, GIVEN and MEASURED in SI units, NaN where something was not
    measured. What lacks a given number, or is of another wheel, is left out.

    Raises:
        UsageError: The file cannot be read, lacks a column, or has no trial that can be used.
    """
    table, numbers = read_table(path, ("wheel", *GIVEN, *MEASURED)), [*GIVEN, *MEASURED]
    wheels = table["wheel"].astype(str).str.strip().str.lower()
    table = table[numbers].map(number_of)
    table.insert(0, "wheel", wheels)
    known, whole = wheels.isin(WHEELS), table[list(GIVEN)].notna().all(axis=1)
    whole &= table["load"].between(0.0, MOST_LOAD, inclusive="right")
    whole &= (table[["wheel_speed", "travel_speed"]] >= 0.0).all(axis=1)
    measured = table[list(MEASURED)].notna().any(axis=1)
    usable = table[known & whole & measured]
    valid = f"speeds are 0 or more, loads above 0 and at most {MOST_LOAD:g} N"
    if usable.empty:
        raise UsageError(
            f"{path} has no trial of {' or '.join(WHEELS)} with {', '.join(GIVEN)} and "
            f"{' or '.join(MEASURED)}; {valid}"
        )
    for name, most in USUAL.items():
        if usable[name].abs().median() > most:
            raise UsageError(
                f"{path}: {name} is above {most:g} in most trials; give m, m/s, N and degrees"
            )
    if 0.0 < (steepest := usable["slip_angle_deg"].abs().max()) <= math.pi / 2:
        raise UsageError(f"{path}: slip_angle_deg is at most {steepest:.3g}: radians; give degrees")
    others = sorted(set(wheels[~known]))
    notes = []
    if others:
        notes.append(
            f"left out: {int((~known).sum())} trials of {others[0]!r} and its like, no known wheel"
        )
    for kept, reason in ((whole, f"whose {', '.join(GIVEN)} are no such numbers ({valid})"),
                       (measured, f"without {', '.join(MEASURED)}")):  # fmt: skip
        if (left_out := known & ~kept).any():
            first = int(np.flatnonzero(left_out)[0]) + 2
            notes.append(f"left out: {left_out.sum()} trials {reason}; the first in line {first}")
    lacking = usable[list(MEASURED)].isna().sum()
    notes += [
        f"{name} was not measured in {count} trials: its RMSE is of fewer"
        for name, count in lacking.items()
        if count
    ]
    return usable.reset_index(drop=True), tuple(notes)


def number_of(cell: object) -> float:
    """The number of a cell; NaN for what is none, or more than any rig measures."""
    with suppress(ValueError):
        value = number(str(cell))
        return value if abs(value) <= LARGEST else math.nan
    return math.nan


def predict(soil: Soil, trials: pd.DataFrame) -> Doubles:
    """Returns sinkage [m], tractive and lateral force [N], shape (n, 3); NaN where the wheel sinks."""
    angle = np.radians(trials["slip_angle_deg"].to_numpy(float))
    travel = trials["travel_speed"].to_numpy(float)
    rim = trials["wheel_speed"].to_numpy(float) * RADIUS / RECORDED_RADIUS
    grousers = np.array(trials["wheel"] == "grousered", np.float64)
    speeds = rim, travel * np.cos(angle), travel * np.sin(angle)
    results = _steady(soil, RADIUS, WIDTH, grousers, *speeds, trials["load"].to_numpy(float))
    return results * (1.0, 1.0, -1.0)


def judge(trials: pd.DataFrame, predicted: Doubles) -> list[Errors]:
    """Returns the errors of each wheel, over all slip angles up to STEEPEST_DEG and straight ahead."""
    off = np.where(np.isnan(predicted), (1.5 * RADIUS, 0.0, 0.0), predicted)
    off = off - trials[list(MEASURED)].to_numpy(float)
    errors = []
    for wheel in WHEELS:
        for title, limit in ((f"to {STEEPEST_DEG:g}°", STEEPEST_DEG), ("at 0°", 0.0)):
            rows = ((trials["wheel"] == wheel) & (trials["slip_angle_deg"].abs() <= limit)).to_numpy()
            if rows.any():
                sunk = int(np.isnan(predicted[rows, 0]).sum())
                rms = [_rms(errors[~np.isnan(errors)]) for errors in off[rows].T]
                errors.append(Errors(wheel, title, int(rows.sum()), sunk, *rms))
    return errors


def _rms(errors: Doubles) -> float:
    return math.sqrt(np.mean(errors**2)) if errors.size else math.nan


def stall_slope_deg(soil: Soil, rover: RoverSpec) -> float:
    """Returns the slope at which a rover no longer gains height with its best slip, 0 if on none.

    Each wheel bears the same share of its weight, and the soil is flat across; a slope at which no slip
    pulls as much as the rover's weight holds back is too steep.
    """
    model, _ = compiled_alone(rover)
    mass = float(model.body_subtreemass[0])
    share = mass * GRAVITY / len(rover.wheel_joints)
    slips = np.linspace(0.02, 0.95, 32)
    low, high = 0.0, math.radians(60.0)
    for _ in range(24):
        slope = 0.5 * (low + high)
        loads = np.full(len(slips), share * math.cos(slope))
        speeds = SPEED / (1.0 - slips), np.full(len(slips), SPEED), np.zeros(len(slips))
        grousers = np.full(len(slips), rover.grousers)
        pull = _steady(soil, rover.wheel_radius, rover.wheel_width, grousers, *speeds, loads)[:, 1]
        if np.nanmax(pull, initial=0.0) > share * math.sin(slope):
            low = slope
        else:
            high = slope
    return math.degrees(low)


def plot(path: Path, soil: Soil, trials: pd.DataFrame) -> None:
    """Draws sinkage, pull and side force of both wheels over slip: curves computed, points measured.

    Args:
        path: Of the PNG.
        soil: Under the wheel.
        trials: A row per trial, as `read_trials` gives them.
    """
    from matplotlib.figure import Figure  # noqa: PLC0415 - half a second that only plots pay

    figure = Figure(figsize=(11, 10), layout="constrained")
    axes = figure.subplots(3, 2, sharex=True, sharey="row")
    angles = sorted(angle for angle in set(trials["slip_angle_deg"]) if abs(angle) <= STEEPEST_DEG)
    labels = "sinkage [mm]", "tractive force [N]", "lateral force [N]"
    for column, wheel in enumerate(WHEELS):
        for place, angle in enumerate(angles):
            rows = trials[(trials["wheel"] == wheel) & (trials["slip_angle_deg"] == angle)].copy()
            if rows.empty:
                continue
            rim, travel = rows["wheel_speed"] * RADIUS / RECORDED_RADIUS, rows["travel_speed"]
            slip = (rim - travel) / np.maximum(rim, travel)
            rows["slip"] = (20.0 * slip).round() / 20.0
            means = rows.groupby("slip", as_index=False).mean(numeric_only=True).assign(wheel=wheel)
            curve = predict(soil, means)
            for row, (name, scale) in enumerate(zip(MEASURED, (1e3, 1.0, 1.0), strict=True)):
                colour, axis = f"C{place}", axes[row, column]
                axis.plot(means["slip"], scale * curve[:, row], color=colour, label=f"{angle:g}°")
                axis.plot(rows["slip"], scale * rows[name], ".", color=colour)
                axes[row, 0].set_ylabel(labels[row])
        axes[0, column].set_title(f"{wheel} wheel")
        axes[2, column].set_xlabel("slip (rim - travel) / the larger of both")
    for each in axes.flat:
        each.grid(alpha=0.3)
    axes[0, 1].legend(title="slip angle", ncols=2)
    figure.suptitle("A wheel of 125 mm in soil: points measured, lines computed at their loads")
    with whole_file(path) as part:
        figure.savefig(part, dpi=90, format="png")


def stall_table(soils: Mapping[str, Soil], rovers: Sequence[RoverSpec]) -> list[tuple[str, ...]]:
    """Returns a row for each soil: its name and the slope [deg] at which each rover stalls, as text."""
    return [
        (name, *(f"{stall_slope_deg(soil, rover):.1f}" for rover in rovers))
        for name, soil in soils.items()
    ]


def _steady(soil: Soil, radius: float, width: float, grousers: Doubles, *given: Doubles) -> Doubles:
    """Sinkage, forces ahead and left of wheels; `given` is rim, ahead, left [m/s] and load [N]."""
    wheels = np.ascontiguousarray(np.stack([np.full(len(grousers), radius), grousers, *given], axis=1))
    results = np.empty((len(wheels), 5))
    steady_wheels(soil.numbers(width, GRAVITY), wheels, width, results)
    return results[:, :3]
