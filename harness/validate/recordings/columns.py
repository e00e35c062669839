"""Columns of CSV files by our names, in SI units, whatever they are called and measured in."""

import math
import re
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from harness.base.delimited import read_csv
from harness.base.errors import UsageError, unknown
from harness.validate.recordings.recording import Series

NAMES: Mapping[str, tuple[str, ...]] = {
    "t": ("t", "time", "timestamp", "stamp", "secs"),
    "v": ("cmd_v", "cmd_linear", "cmd_vel_linear", "cmd_vel_x", "v_cmd", "cmd_speed", "linear_x"),
    "w": ("cmd_w", "cmd_angular", "cmd_vel_angular", "w_cmd", "cmd_yaw_rate", "angular_z"),
    "left": ("left_speed", "left_velocity", "v_left", "speed_left", "left"),
    "right": ("right_speed", "right_velocity", "v_right", "speed_right", "right"),
    "left_turn": ("left_wheel", "left_wheel_speed", "omega_left", "left_wheel_velocity"),
    "right_turn": ("right_wheel", "right_wheel_speed", "omega_right", "right_wheel_velocity"),
    "left_current": ("left_current", "current_left", "left_motor_current", "i_left"),
    "right_current": ("right_current", "current_right", "right_motor_current", "i_right"),
    "left_torque": ("left_torque", "torque_left", "left_effort"),
    "right_torque": ("right_torque", "torque_right", "right_effort"),
    "power": ("power", "battery_power"),
    "wx": ("wx", "gyro_x", "angular_velocity_x"),
    "wy": ("wy", "gyro_y", "angular_velocity_y"),
    "wz": ("wz", "gyro_z", "angular_velocity_z", "yaw_rate"),
    "ax": ("ax", "acc_x", "accel_x", "linear_acceleration_x"),
    "ay": ("ay", "acc_y", "accel_y", "linear_acceleration_y"),
    "az": ("az", "acc_z", "accel_z", "linear_acceleration_z"),
    "x": ("x", "pose_x", "position_x", "px", "pos_x", "pose_position_x"),
    "y": ("y", "pose_y", "position_y", "py", "pos_y", "pose_position_y"),
    "yaw": ("yaw", "heading", "theta"),
    "qx": ("qx", "orientation_x", "pose_orientation_x"),
    "qy": ("qy", "orientation_y", "pose_orientation_y"),
    "qz": ("qz", "orientation_z", "pose_orientation_z"),
    "qw": ("qw", "orientation_w", "pose_orientation_w"),
    "step": ("step", "step_id"),
    "state": ("state", "phase"),
    "ground": ("ground", "terrain", "surface"),
}
KNOWN = {spelling: name for name, spellings in NAMES.items() for spelling in spellings}
UNITS = {
    "s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "m": 1.0, "mm": 1e-3, "cm": 1e-2, "m/s": 1.0,
    "mm/s": 1e-3, "cm/s": 1e-2, "km/h": 1 / 3.6, "rad": 1.0, "rad/s": 1.0, "deg": math.pi / 180,
    "deg/s": math.pi / 180, "rpm": math.tau / 60, "a": 1.0, "ma": 1e-3, "m/s2": 1.0, "m/s^2": 1.0,
    "g": 9.80665, "nm": 1.0, "n m": 1.0, "w": 1.0, "mg": 9.80665e-3, "ft": 0.3048, "ft/s": 0.3048,
    "mph": 0.44704, "dps": math.pi / 180, "°": math.pi / 180, "°/s": math.pi / 180, "m/s²": 1.0,
}  # fmt: skip
SUFFIXES = {  # of names, as in gyro_z_deg_s, where they are not units with _ for /
    **dict.fromkeys(("degs", "deg_per_s", "deg_per_sec"), "deg/s"), "degrees": "deg", "kph": "km/h",
    **dict.fromkeys(("rads", "radps", "rad_per_s", "rad_per_sec"), "rad/s"), "radians": "rad",
    **dict.fromkeys(("mps", "ms", "m_per_s"), "m/s"), "ms2": "m/s2", "mps2": "m/s2", "kmh": "km/h",
    **dict.fromkeys(("sec", "secs", "seconds"), "s"), "msec": "ms", "usec": "us", "nsec": "ns",
    "n_m": "nm", "m_s_2": "m/s2",
}  # fmt: skip
UNIT = re.compile(r"^(?P<name>[^\[(]*?)[\s_]*(?:[\[(](?P<unit>[^\])]+)[\])])?$")
NANOSECONDS = re.compile(r"^(?P<before>.*?)n(?:ano)?(?P<seconds>secs?)$")  # header.stamp.nanosec
OF_TURNING = ("rad/s", "deg/s", "dps", "°/s", "rpm")  # a speed in these is that of a wheel's turning
OF_SPEED = ("m/s", "mm/s", "cm/s", "km/h", "ft/s", "mph")
MEASURED_IN: Mapping[str, tuple[str, ...]] = {
    "t": ("s", "ms", "us", "ns"), "v": OF_SPEED, "yaw": ("rad", "deg", "°"), "power": ("w",),
    **dict.fromkeys(("left", "right", "left_turn", "right_turn"), OF_SPEED + OF_TURNING),
    **dict.fromkeys(("w", "wx", "wy", "wz"), OF_TURNING),
    **dict.fromkeys(("ax", "ay", "az"), ("m/s2", "m/s^2", "m/s²", "g", "mg")),
    **dict.fromkeys(("x", "y"), ("m", "mm", "cm", "ft")),
    **dict.fromkeys(("left_current", "right_current"), ("a", "ma")),
    **dict.fromkeys(("left_torque", "right_torque"), ("nm", "n m")),
}  # fmt: skip
# [s]: times without a unit that are farther apart are in milli-, micro- or nanoseconds.
LONGEST_PERIOD = 0.5
# [s]: with such periods they are seconds all the same where as milliseconds they would be over so soon.
SLOWEST_PERIOD, SHORTEST = 5.0, 1.5


def read_columns(path: Path, **how: Any) -> pd.DataFrame:  # noqa: ANN401 - as of pandas
    """Returns a file's columns by our names, in SI units; those that are not known stay as they are.

    Its `attrs` tell by "stated" which columns had a unit.
    """
    table = _with_whole_stamps(read_csv(path, **how))
    columns, stated = dict[str, pd.Series](), set[str]()
    for column in table.columns:
        name, unit = _named(str(column))
        if unit and unit not in MEASURED_IN.get(name, UNITS):
            if name in NAMES:
                raise UsageError(
                    f"{path}: {column}: {unknown('unit', unit, MEASURED_IN.get(name, UNITS))}"
                )
            unit = None
        if unit and (side := name.removesuffix("_turn")) in ("left", "right"):
            name = f"{side}_turn" if unit in OF_TURNING else side
        if name in columns:
            continue
        columns[name] = (
            pd.to_numeric(table[column], errors="coerce") * UNITS[unit] if unit else table[column]
        )
        stated |= {name} if unit else set()
    read = pd.DataFrame(columns)
    read.attrs["stated"] = stated
    if "t" in read:
        times = pd.to_numeric(read["t"], errors="coerce")
        if "t" not in stated:
            times = _seconds(times) if times.notna().any() else _dates(read["t"])
        read["t"] = times
    return read


def _named(column: str) -> tuple[str, str | None]:
    """Our name of a column, its own if we have none, and its unit, which may be the end of its name."""
    match = UNIT.match(column.strip().casefold())
    spelled, unit = (match["name"].strip(), match["unit"]) if match else (column, None)
    words = re.sub(r"[ ./]+", "_", spelled.removeprefix("field.")).strip("_").split("_")
    if (name := KNOWN.get("_".join(words))) is not None:
        return name, unit
    for end in range(len(words) - 1, 0, -1) if unit is None else ():
        name, suffix = KNOWN.get("_".join(words[:end]), ""), "_".join(words[end:])
        for told in (SUFFIXES.get(suffix), suffix.replace("_", "/")):
            if told in MEASURED_IN.get(name, ()):
                return name, told
    return spelled, unit


def _with_whole_stamps(table: pd.DataFrame) -> pd.DataFrame:
    """The table with one time of seconds and nanoseconds, which stamps of ROS have apart."""
    named = {str(column).strip().casefold(): column for column in table.columns}
    for name, rest in named.items():
        match = NANOSECONDS.match(name)
        if match and (whole := named.get(match["before"] + match["seconds"])) is not None:
            seconds, nanoseconds = (pd.to_numeric(table[one], errors="coerce") for one in (whole, rest))
            times = (seconds + 1e-9 * nanoseconds).rename("t [s]")
            return pd.concat([table.drop(columns=[whole, rest]), times], axis=1)
    return table


def _dates(times: pd.Series) -> pd.Series:
    """Dates with times of the day in seconds; NaN of what is none."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # of a form that is no standard's
        try:
            # Python leaves out fractions of 0, so that not all have the form of the first.
            forms = (
                pd.to_datetime(times, errors="coerce", utc=True, format=f) for f in (None, "ISO8601")
            )
            dates = max(forms, key=pd.Series.count)
        except (OverflowError, ValueError):  # of what is no date at all
            return pd.Series(math.nan, times.index)
    return (dates - pd.Timestamp(0, tz="UTC")).dt.total_seconds()


def _seconds(times: pd.Series) -> pd.Series:
    """Times without a unit in seconds."""
    apart = np.abs(steps_of(times))
    period = float(np.median(apart[apart > 0.0])) if apart.any() else 0.0
    if LONGEST_PERIOD < period <= SLOWEST_PERIOD and np.ptp(times.dropna()) * 1e-3 < SHORTEST:
        return times
    factors = (1.0, 1e-3, 1e-6, 1e-9)
    return times * next((f for f in factors if period * f <= LONGEST_PERIOD), 1.0)


def steps_of(times: pd.Series) -> Series:
    """Returns the steps from each time to the next, where there are both."""
    steps: Series = np.diff(times[np.isfinite(times)])
    return steps
