"""Recorded logs, and the columns of them that tell how a run went."""

import csv
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from harness.errors import UsageError

COLUMNS = {
    "IMU Acceleration Magnitude": "m/s2",
    "Vertical Roughness": "m/s2",
    "Current Velocity": "m/s",
    "Obstacle Clearance": "m",
}

Values = NDArray[np.float64]
Log = Mapping[str, Values]  # by column


def read_log(path: Path) -> Log:
    """Reads those columns of a log; rows whose clearance is still infinite are left out.

    Raises:
        UsageError: It cannot be read, or lacks a column or a row.
    """
    try:
        with path.open(encoding="utf-8", newline="") as file:
            rows = [[float(row[column]) for column in COLUMNS] for row in csv.DictReader(file)]
    except OSError as error:
        raise UsageError(f"cannot read {path}: {error.strerror}; --realism takes two logs") from error
    except (KeyError, TypeError, ValueError) as error:
        message = f"{path} is no metrics log; it needs numbers in {', '.join(COLUMNS)}"
        raise UsageError(message) from error
    return as_log(np.array(rows).reshape(-1, len(COLUMNS)), str(path))


def as_log(rows: Values, name: str) -> Log:
    """Rows in the order of COLUMNS, shape (n, 4), as a log.

    Raises:
        UsageError: No row is finite.
    """
    finite = rows[np.isfinite(rows).all(axis=1)]
    if not len(finite):
        raise UsageError(f"{name} holds no complete row")
    return dict(zip(COLUMNS, finite.T, strict=True))
