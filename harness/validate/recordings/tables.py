"""CSV files -> recordings; files whose names differ in what they are of are one."""

import re
from collections.abc import Iterable
from itertools import chain
from pathlib import Path

import numpy as np
import pandas as pd

from harness.base.errors import UsageError, how_many
from harness.validate.recordings.columns import UNITS, read_columns, steps_of
from harness.validate.recordings.recording import Recording, Series, changes, empty, in_order

STILL_G = (0.9, 1.1)  # median magnitude of acceleration without a unit that is in g
FASTEST_TURN = 10.0  # [rad/s] that a rover may turn with where no unit says that it does
BACK = 1.0  # [s] by which times may be out of order
PART = re.compile(r"[_\-.]?(wheels?|imu|odom(etry)?|currents?|poses?)$", re.IGNORECASE)
PAUSE = 0.5  # [s]
REPEATED = 0.2  # of a log's times, from which on that is told
RUNNING = ("calib", "step", "drive", "run", "running")


def recordings_of(folder: Path, radius: float) -> list[Recording]:
    """Returns the recordings of a folder: files whose names differ in `wheels` or `imu` are one.

    Args:
        folder: With CSV files, plain or compressed; `runs.csv` may tell the ground of each.
        radius: Of the wheels, by which turning becomes speed [m].

    Raises:
        UsageError: It cannot be read, or none of its files holds a series.
    """
    if not folder.is_dir():
        raise UsageError(f"{folder} is no folder of recordings; give one with CSV files")
    parts: dict[str, list[Path]] = {}
    for path in sorted([*folder.glob("*.csv"), *folder.glob("*.csv.gz")]):
        if path.name != "runs.csv":
            parts.setdefault(PART.sub("", path.name.split(".csv")[0]), []).append(path)
    grounds = _grounds(folder / "runs.csv")
    read = [recording_of(paths, key, radius, grounds.get(key, "")) for key, paths in parts.items()]
    if not any(one.series for one in read):
        raise UsageError(
            f"{folder} holds no recording{_held(parts.values())}; give CSV files with a column t and "
            "some of left_speed, right_speed, cmd_v, cmd_w, wz, az, x, y (docs/real_rovers.md)"
        )
    return [one for one in read if one.series]


def _held(several: Iterable[list[Path]]) -> str:
    """What the first of some files holds instead of a recording; "" without files."""
    for path in chain.from_iterable(several):
        table = read_columns(path)
        return f": {path.name} has {how_many(len(table), 'row')} of {', '.join(table.columns)}"
    return ""


def recording_of(paths: Iterable[Path], name: str, radius: float, ground: str = "") -> Recording:
    """Returns what some CSV files say together.

    Args:
        paths: Of the files.
        name: Of the recording.
        radius: Of the wheels, by which turning becomes speed [m].
        ground: What it drove on; "" for what a column or else the name says.

    Raises:
        UsageError: One cannot be read, has an unknown unit, goes back in time, or repeats another.
    """
    series: dict[str, Series] = {}
    problems: tuple[str, ...] = ()
    for path in paths:
        table = read_columns(path)
        problems += _repeated(table, path)
        if "ground" in table and len(table) and not ground:
            ground = str(table["ground"].iloc[0])
        read = _series(table, radius, path)
        if twice := sorted(read.keys() & series.keys()):
            raise UsageError(f"{path}: the {twice[0]} of {name} stand in another file too; give one")
        series |= read
    ground = ground or re.sub(r"[_\-]?\d+$", "", name)
    return Recording(name, ground, problems=problems, **series)  # type: ignore[arg-type]  # of series alone


def _repeated(table: pd.DataFrame, path: Path) -> tuple[str, ...]:
    """A line if many times of the wheels repeat with other speeds, as where seconds were rounded."""
    names = [name for name in ("left", "right", "left_turn", "right_turn") if name in table]
    if not names or "t" not in table:
        return ()
    steps = steps_of(table[["t", *names]].dropna().drop_duplicates()["t"])
    if not len(steps) or (share := float((steps == 0.0).mean())) < REPEATED:
        return ()
    step = float(np.median(steps[steps > 0.0])) if steps.any() else 0.0
    told = f"{share:.0%} of the wheels' times repeat, and of each the first row counts"
    return (f"{path}: {told}; steps of {step:.3g} s tell delay and lag no better, whatever is said",)


def _grounds(path: Path) -> dict[str, str]:
    if not path.is_file():
        return {}
    table = read_columns(path, dtype=str)
    if not {"run", "ground"} <= set(table.columns):
        return {}
    return dict(zip(table["run"], table["ground"], strict=True))


def _series(table: pd.DataFrame, radius: float, path: Path) -> dict[str, Series]:
    if "t" not in table:
        return {}
    back = -float(steps_of(table["t"]).min(initial=0.0))
    if back > BACK:
        raise UsageError(f"{path}: time goes back by {back:.1f} s; give each drive a file of its own")
    series = {
        "commands": _columns(table, "v", "w"),
        "wheels": _columns(table, "left", "right"),
        "currents": _columns(table, "left_current", "right_current"),
        "torques": _columns(table, "left_torque", "right_torque"),
        "power": _columns(table, "power"),
        "imu": _imu(table, path),
        "poses": _poses(table, path),
        "steps": _steps(table),
    }
    if not len(series["wheels"]):
        series["wheels"] = _columns(table, "left_turn", "right_turn") * [1.0, radius, radius]
    return {name: values for name, values in series.items() if len(values)}


def _columns(table: pd.DataFrame, *names: str) -> Series:
    """Times and columns of whole rows in order; empty if one of them is missing."""
    if not set(names) <= set(table.columns):
        return empty(1 + len(names))
    numbers = table[["t", *names]].apply(pd.to_numeric, errors="coerce").to_numpy(float)
    return in_order(numbers[np.isfinite(numbers).all(axis=1)])


def _imu(table: pd.DataFrame, path: Path) -> Series:
    """Angular velocity and acceleration; NaN where an axis was not recorded."""
    names = ("wx", "wy", "wz", "ax", "ay", "az")
    if not {"wz", "az"} & set(table.columns):
        return empty(7)
    there = [name in table for name in names]
    felt = _columns(table, *(name for name in names if name in table))
    series = np.full((len(felt), 7), np.nan)
    series[:, [True, *there]] = felt
    if not table.attrs["stated"] & set(names[3:]):
        series = in_metres(series)
    if "wz" in table and not table.attrs["stated"] & set(names[:3]):
        check_turning(series[:, 3], "name the unit, as in wz [deg/s]", path)
    return series


def in_metres(imu: Series) -> Series:
    """Returns an IMU's series in m/s2, where what it feels most of the time is 1 g or 1000 mg."""
    felt = np.sqrt(np.nansum(imu[:, 4:] ** 2, axis=1))
    level = float(np.median(felt)) if len(felt) else 0.0
    units = (UNITS[u] for u, of in (("g", level), ("mg", 1e-3 * level)) if STILL_G[0] < of < STILL_G[1])
    return imu * ([1.0] * 4 + [next(units, 1.0)] * 3)


def check_turning(rates: Series, mend: str, path: Path) -> None:
    """UsageError if no rover turns like that [rad/s], so that what has no unit is in degrees."""
    if len(rates) and (fastest := float(np.percentile(np.abs(rates), 99))) > FASTEST_TURN:
        raise UsageError(f"{path}: it turns by {fastest:.3g} rad/s; {mend}")


def _poses(table: pd.DataFrame, path: Path) -> Series:
    """Places and headings; rows that repeat the last pose are left out."""
    if {"qx", "qy", "qz", "qw"} <= set(table.columns):
        x, y, z, w = (pd.to_numeric(table[name], errors="coerce") for name in ("qx", "qy", "qz", "qw"))
        table = table.assign(yaw=np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)))
    series = _columns(table, "x", "y", "yaw")
    if len(series):
        series = series[changes(series[:, 1:])]
        if "yaw" not in table.attrs["stated"] and "qw" not in table:
            check_turning(
                np.diff(series[:, 3]) / np.diff(series[:, 0]), "name the unit, as in yaw [deg]", path
            )
        series[:, 3] = np.unwrap(series[:, 3])
    return series


def _steps(table: pd.DataFrame) -> Series:
    """Begin and end of each step that runs."""
    if not {"step", "state"} <= set(table.columns):
        return empty(2)
    runs = table[table["state"].astype(str).str.casefold().isin(RUNNING)]
    whole: list[tuple[float, float]] = []
    for _, rows in runs.groupby("step"):
        times = rows["t"].to_numpy(float)
        parts = np.split(times, np.flatnonzero(np.diff(times) > PAUSE) + 1)
        # Of a step that was paused, the longest part.
        whole.append(max(((part[0], part[-1]) for part in parts), key=lambda ends: ends[1] - ends[0]))
    return np.array(whole).reshape(-1, 2)
