"""The trials' wheel pressed straight down without turning, beside wheels that were pressed so.

A file of such tests has a row for each reading: `run`, `body` (a wheel; plates are left out), `sinkage`
[m] and `force` [N].
"""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from harness.base.errors import UsageError
from harness.soil.rig_kernel import press_wheel
from harness.soil.soils import Soil
from harness.validate.single_wheel import GRAVITY, RADIUS, WHEELS, WIDTH, number_of, read_table

DEPTHS = (0.01, 0.02, 0.03, 0.04)  # [m]
SPEED = 0.005  # [m/s]
COLUMNS = ("run", "body", "sinkage", "force")


def pressed(soil: Soil) -> NDArray[np.float64]:
    """Returns the force [N] that a smooth wheel needs at each of DEPTHS."""
    forces = np.empty(len(DEPTHS))
    press_wheel(soil.numbers(WIDTH, GRAVITY), RADIUS, WIDTH, SPEED, np.array(DEPTHS), forces)
    return forces


def measured(path: Path) -> dict[str, NDArray[np.float64]]:
    """Returns the mean force [N] of each wheel's runs at each of DEPTHS, NaN where none is so deep.

    Raises:
        UsageError: The file cannot be read, lacks a column, or has no wheel.
    """
    table = read_table(path, COLUMNS)
    numbers = ["sinkage", "force"]
    table[numbers] = table[numbers].map(number_of)
    table = table.dropna(subset=numbers)
    means, bodies = {}, table["body"].astype(str).str.strip().str.lower()
    for wheel in WHEELS:
        runs = [rows.sort_values("sinkage") for _, rows in table[bodies == wheel].groupby("run")]
        if runs:
            forces = [np.interp(DEPTHS, run["sinkage"], run["force"], right=np.nan) for run in runs]
            means[wheel] = pd.DataFrame(forces).mean().to_numpy(float)
    if not means:
        raise UsageError(f"{path} has no body of the name {' or '.join(WHEELS)} with numbers")
    return means


def table(
    soils: Mapping[str, Soil], measured_forces: Mapping[str, NDArray[np.float64]]
) -> list[tuple[str, ...]]:
    """Returns rows of a name and the forces [N] at DEPTHS, as text: of soils, then what was measured."""
    rows = {name: pressed(soil) for name, soil in soils.items()}
    rows |= {f"measured, {wheel}": forces for wheel, forces in measured_forces.items()}
    return [(name, *("-" if np.isnan(f) else f"{f:.0f}" for f in row)) for name, row in rows.items()]
