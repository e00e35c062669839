"""A log of RoboTerrain's social collector: where the rover was each second, and how far each person.

Two forms of header occur in its data; both are read by the names of their columns:

    step,time_s,robot_x,robot_y,speed_mps,NAME_actor_dist...,dmin,goals_count
    step,time_s,rx,ry,speed_mps,d1_NAME...,dmin,goals
"""

import csv
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rover_metrics.analysis.logs.header import (
    UnreadableLog,
    as_logged,
    comma_in_cells,
    first_line,
    separator_of,
    shown,
)
from rover_metrics.analysis.logs.log import Floats, Integers
from rover_metrics.errors import counted, reason_of

TIME, NEAREST = "time_s", "dmin"
GOALS = ("goals_count", "goals")
PLACES = (("robot_x", "rx"), ("robot_y", "ry"))
DISTANCE = re.compile(r"(?:d\d+_(?P<old>.+)|(?P<new>.+?)(?:_actor)?_dist)")
MOST_LISTED = 3  # lines left out that are listed one by one
PERIOD, MOST_OFF = 1.0, 0.25  # [s] from row to row, and how much it may be off
LARGEST = 1e12  # of a number in a log: no time, place or count is beyond


@dataclass(frozen=True, eq=False)
class SocialLog:
    """One run, a row per second; what is not known is NaN."""

    path: Path
    actors: tuple[str, ...]  # names of the people, in the order of the columns
    time_s: Floats  # simulation or Unix time [s]
    position: Floats  # x and y of the rover in the world [m], shape (rows, 2)
    distance: Floats  # from the rover to each person [m], shape (rows, people)
    nearest: Floats  # to the nearest person [m]
    goals: Integers  # reached so far
    findings: tuple[str, ...] = ()  # what was odd about the file

    def __len__(self) -> int:
        return len(self.time_s)


def read_social_log(path: Path) -> SocialLog:
    """Returns a log of either form.

    Raises:
        UnreadableLog: It is none; the message says why, without the path.
    """
    header = first_line(path)[0]
    separator = separator_of(header)
    names = [name.strip() for name in next(csv.reader([header], delimiter=separator), [])]
    _check_header(names)
    findings: list[str] = []
    try:
        with path.open("rb") as content:
            content.readline()
            comma = comma_in_cells(content, separator)
        with path.open(encoding="utf-8", errors="replace", newline="") as file:
            file.readline()
            lines = csv.reader(as_logged(line, separator, comma) for line in file)
            rows = list(_rows(lines, len(names), findings))
    except (OSError, csv.Error) as error:
        raise UnreadableLog(f"cannot be read: {reason_of(error)}") from error
    if not rows:
        raise UnreadableLog("there is a header but no whole row")
    table = np.array(rows)
    column = {name: table[:, index] for index, name in enumerate(names)}
    steps = np.diff(column[TIME])
    known = steps[np.isfinite(steps)] if steps.size else np.array([PERIOD])
    period = float(np.median(known)) if known.size else np.nan
    if not abs(period - PERIOD) < MOST_OFF:
        findings.append(f"its rows are {period:.3g} s apart, not {PERIOD:g} s; each counts as a second")
    people = {name: match for name in names if (match := DISTANCE.fullmatch(name))}
    distance = np.column_stack([column[name] for name in people])
    nearest, unknown = column.get(NEAREST), np.full(len(rows), np.nan)
    goals = np.nan_to_num(next(column[name] for name in GOALS if name in column))
    return SocialLog(
        path=path,
        actors=tuple(match["old"] or match["new"] for match in people.values()),
        time_s=column[TIME],
        position=np.column_stack([column.get(x, column.get(old, unknown)) for x, old in PLACES]),
        distance=distance,
        nearest=np.fmin.reduce(distance, axis=1) if nearest is None else nearest,
        goals=goals.astype(np.int64),
        findings=tuple(findings),
    )


def _check_header(names: Sequence[str]) -> None:
    missing = [] if TIME in names else [TIME]
    missing += [] if set(GOALS) & set(names) else [" or ".join(GOALS)]
    missing += [] if any(map(DISTANCE.fullmatch, names)) else ["the distances (NAME_dist or d1_NAME)"]
    if missing:
        raise UnreadableLog(
            f"the first line is not the header of a social log but {shown(','.join(names))}; "
            f"it lacks {', '.join(missing)}"
        )
    if twice := sorted({name for name in names if names.count(name) > 1}):
        raise UnreadableLog(f"the header names {', '.join(twice)} more than once")


def _rows(lines: Iterator[list[str]], width: int, findings: list[str]) -> Iterator[list[float]]:
    """Yields the whole rows, and adds a line to the findings for each of the first others."""
    left_out = 0
    for number, cells in enumerate(lines, 2):
        if not cells:
            continue
        try:
            values = [float(cell or "nan") for cell in cells]
        except ValueError:
            values = []
        if len(values) == width and not any(abs(value) > LARGEST for value in values):
            yield values
            continue
        left_out += 1
        if left_out <= MOST_LISTED:
            findings.append(f"line {number} is not {width} numbers and is left out")
    if left_out > MOST_LISTED:
        findings.append(f"{counted(left_out - MOST_LISTED, 'more line')} left out")
