"""Episodes as tables, without driving: a rover that closes in on a hazard, second by second."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np
import pytest

from harness.tune.episodes.plan import Planned, plan
from harness.tune.episodes.record import EVENT, SCAN, WINDOW, Ending, EpisodeRecord, Sight, Zone
from harness.tune.output import parameter_file
from harness.tune.page.page import render
from harness.tune.scoring.study import RobotStudy, study
from tests.support.once import made_once

SCANS_PER_S = 20
COMMAND = "python -m harness.tune --out '<b>tuning</b>'"

MakeRecord = Callable[..., EpisodeRecord]
Sweep = tuple[Sequence[RobotStudy], Mapping[Planned, EpisodeRecord]]


def make(
    nearest: Sequence[float],
    *,
    contacts: Sequence[tuple[float, float]] = (),
    sight: Sight = Sight.SEEN,
    zone: Zone = Zone.FRONT,
    windows: Sequence[dict[str, float]] = (),
    driver: str = "ram",
    terrain: str = "posts",
) -> EpisodeRecord:
    """An episode with these nearest ranges [m] at 20 Hz and contacts (start, end) [s], at 1 m/s."""
    scans = np.zeros(len(nearest), SCAN)
    scans["stamp_ms"] = (np.arange(len(nearest)) + 1) * 1000 // SCANS_PER_S
    scans["nearest"] = scans["footprint"] = nearest
    scans["speed"] = 1.0
    events = np.zeros(len(contacts), EVENT)
    for event, (start, end) in zip(events, contacts, strict=True):
        event["start_s"], event["end_s"] = start, end
        event["zone"], event["sight"], event["speed"] = zone, sight, 1.0
        times = scans["stamp_ms"] / 1000.0
        scans["contact"] |= (times > start) & (times <= end + 1.0 / SCANS_PER_S)
    table = np.zeros(len(windows), WINDOW)
    for number, (row, values) in enumerate(zip(table, windows, strict=True)):
        row["time_s"], row["speed"] = number + 1, 0.5
        for name, value in values.items():
            row[name] = value
    length = len(nearest) / SCANS_PER_S
    return EpisodeRecord(scans, table, events, Ending.COMPLETE, length, driver, terrain)


@pytest.fixture
def make_record() -> MakeRecord:
    """Makes an episode from its nearest ranges; see `make`."""
    return make


@pytest.fixture(scope="session")
def small_sweep(tmp_path_factory: pytest.TempPathFactory) -> Sweep:
    """Studies of a Leo that touches what it comes near to, and of a rover_zero4wd on a smooth floor."""
    return made_once(tmp_path_factory, "small_sweep", _small_sweep)


@pytest.fixture(scope="session")
def small_page(small_sweep: Sweep, tmp_path_factory: pytest.TempPathFactory) -> str:
    """The report of the small sweep."""
    return made_once(tmp_path_factory, "small_page", lambda: rendered(small_sweep))


def rendered(sweep: Sweep) -> str:
    """The report of a sweep."""
    files = {study.name: parameter_file(study, COMMAND) for study in sweep[0]}
    return render(*sweep, COMMAND, files)


def _small_sweep() -> Sweep:
    rng = np.random.default_rng(0)
    robots = ("leo", "rover_zero4wd")
    records = {
        planned: _approach(rng, planned) if planned.run.rover.robot == "leo" else _nothing(planned)
        for planned in plan(robots, 44, seed=0, duration=10.0)
    }
    return [study(robot, records, 0) for robot in robots], records


def _approach(rng: np.random.Generator, planned: Planned) -> EpisodeRecord:
    """Drives up to a hazard and back, over ground that is rough in every other second."""
    touches = planned.index % 8 < 4  # in every other pair of worlds, one of which checks
    nearest = rng.uniform(0.205, 0.27) if touches else rng.uniform(0.265, 0.5)
    ranges = np.concatenate([np.linspace(3.0, nearest, 40), np.linspace(nearest, 3.0, 40)])
    windows = [
        {
            "peak_acceleration": 10.0 + rng.exponential(3.0 if rough else 0.3),
            "mean_smoothness": 9.9 + rng.exponential(0.1 if rough else 0.05),
            "roughness": 0.006 * rough,
            "largest_step": rng.uniform(0.0, 0.02),
            "largest_stride": rng.uniform(0.0, 0.07),
            "from_start": rng.uniform(0.0, 9.0),
        }
        for second in range(10)
        for rough in [second >= 5]
    ]
    return make(
        ranges.tolist(),
        contacts=[(2.0, 2.2)] if touches else [],
        windows=windows,
        driver=planned.run.rover.driver,
        terrain=planned.run.world.terrain,
    )


def _nothing(planned: Planned) -> EpisodeRecord:
    windows = [{"peak_acceleration": 9.9, "largest_step": 0.01, "from_start": 3.0}] * 10
    return make([3.0] * 80, windows=windows, driver=planned.run.rover.driver, terrain="flat")
