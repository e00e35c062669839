"""Logs for the tests: synthetic ones whose numbers can be worked out by hand."""

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

import numpy as np
import pytest

from rover_metrics.analysis.logs.log import Log
from rover_metrics.analysis.logs.reading import episode_starts
from rover_metrics.analysis.metric import COUNTERS
from rover_metrics.core.columns import COLUMNS

WriteLog = Callable[..., Path]
MakeLog = Callable[..., Log]


@pytest.fixture
def row() -> Callable[..., str]:
    """Write one line: second i of a drive at 0.5 m/s, or with some columns replaced."""

    def write(i: int, **changed: object) -> str:
        cells: dict[str, object] = {
            "Timestamp": 100 + i,
            "Total Collisions": 2 * i,
            "Current Collision Status": 0,
            "Smoothness Metric": 200.0 * i,
            "Current Smoothness": 10.0,
            "Obstacle Clearance": 1.0 + 0.1 * (i % 5),
            "Distance Traveled": 0.5 * i,
            "Current Velocity": 0.5 + 0.01 * (i % 3),
            "IMU Acceleration Magnitude": 10.0 + i % 7,
            "Is Rough Terrain": int(i % 7 == 6),
            "Vertical Roughness": 9.0 + 0.5 * (i % 4),
            "Notes": "Normal operation",
        }
        cells.update({name.replace("_", " "): value for name, value in changed.items()})
        return ",".join(map(str, cells.values()))

    return write


@pytest.fixture
def write_log(tmp_path: Path, row: Callable[..., str]) -> WriteLog:
    """Write a log of given lines, or of as many good rows as asked for."""

    def write(name: str = "log.csv", lines: Iterable[str] | int = 60, end: str = "\n") -> Path:
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        rows = [row(i) for i in range(lines)] if isinstance(lines, int) else list(lines)
        path.write_text("\n".join([",".join(COLUMNS), *rows]) + end, encoding="utf-8")
        return path

    return write


@pytest.fixture
def make_log() -> MakeLog:
    """Make a log in memory: columns by name, times by default one second apart."""

    def make(columns: Mapping[str, Iterable[float]], stamps: Iterable[float] | None = None) -> Log:
        arrays = {name: np.array(list(column), dtype=np.float64) for name, column in columns.items()}
        rows = len(next(iter(arrays.values())))
        times = np.arange(float(rows)) if stamps is None else np.array(list(stamps), dtype=np.float64)
        counters = [array for name, array in arrays.items() if name in COUNTERS]
        return Log(Path("made.csv"), times, arrays, episode_starts(times, counters))

    return make
