"""Optional sensors: exact rays a second against mj_multiRay, and the speed of a run with each."""

import resource
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, cast

import mujoco
import numpy as np
from numpy.typing import NDArray

from benchmarks import ros_runs
from benchmarks.lidar import EVERYTHING_BUT_THE_ROVER, NOBODY
from benchmarks.measuring import Effort, Rounds, Table
from harness.episode.assembly import sensor_rows
from harness.episode.episode import Episode
from harness.robots.frames.rover_frames import rover_frames
from harness.sensors.rays.bundle import RayBundle, Surroundings
from harness.spec.run import Run

if TYPE_CHECKING:
    from harness.sensors.ranging import RangeOptions

TARGETS = {  # rays a second in millions, times real time
    "lidar2d": ("-", "-"),
    "lidar3d=vlp16": (">= 3", ">= 8"),
    "lidar3d=os1_64": (">= 3", "-"),
    "lidar3d=livox": (">= 3", "-"),
    "depth": (">= 3", ">= 5"),
}
SAMPLE = 200  # rays that MuJoCo is asked for: it takes its time

Array = NDArray[np.float64]


def measure(effort: Effort) -> Table:
    """Rays and runs, on the default terrain."""
    usual, usual_cpu = _run((), effort)
    rows: list[tuple[str, ...]] = []
    rows.append(
        ("the usual sensors", *("-",) * 5, f"{usual:.1f}", f"{1 / usual_cpu:.1f}", "**1.00**", "-")
    )
    for word, (rays, speed) in TARGETS.items():
        factor, cpu = _run((word,), effort)
        told = f"{factor:.1f}", f"{1 / cpu:.1f}", f"**{usual_cpu / cpu:.2f}**", speed
        rows.append((word, *_rays(word, effort), rays, *told))
    return Table(
        title=f"Optional sensors of leo on rocky, runs of {effort.seconds:g} simulated seconds",
        columns=(
            "sensor",
            "rays a reading",
            "million rays a second of a core",
            "speed of a ray against mj_multiRay",
            "largest difference",
            "target, million rays a second",
            "run, times real time",
            "as far as the busier core goes",
            "that against the usual sensors",
            "target, times real time",
        ),
        rows=tuple(rows),
    )


def _run(sensors: tuple[str, ...], effort: Effort) -> tuple[float, float]:
    """A run's simulated seconds a second, and its busier process's time on a core for each of them."""
    spent: list[NDArray[np.float64]] = []
    for seconds in (effort.seconds / 5, effort.seconds):  # the difference has no start-up in it
        before = _cpu()
        result = ros_runs.run(Run.of(duration=seconds, sensors=sensors or ("none",)))
        assert not result.lost
        spent.append(_cpu() - before)
    per_second = (spent[1] - spent[0]) / (0.8 * effort.seconds)
    return result.real_time_factor, float(per_second.max())


def _cpu() -> Array:
    """Time on a core of this process, and of its children that have ended [s]."""
    usages = map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return np.array([usage.ru_utime + usage.ru_stime for usage in usages])


def _rays(word: str, effort: Effort) -> tuple[str, ...]:
    """How many rays, how many a second, MuJoCo's time over ours for each, largest difference."""
    run = Run.of(sensors=(word,), duration=1.0)
    options = cast("RangeOptions", sensor_rows(run.rover)[-1].given)
    simulation = Episode(run).simulation
    model, data, rover = simulation.model, simulation.data, simulation.scene.rover
    mujoco.mj_kinematics(model, data)
    frames = rover_frames(rover, options.frames(rover))
    pose = frames.mount(options.frame_id, model).pose(data)
    directions = options.directions()
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    bundle = RayBundle(Surroundings(model), directions, options.range_max)
    some = np.linspace(0, len(directions) - 1, SAMPLE).astype(int)
    vectors = np.ascontiguousarray(directions[some] @ pose[1:].T)
    theirs = np.empty(SAMPLE)

    def multi_ray() -> None:
        ids, groups = np.empty(SAMPLE, np.int32), EVERYTHING_BUT_THE_ROVER
        limit = options.range_max
        mujoco.mj_multiRay(
            model, data, pose[0], vectors.ravel(), groups, 1, NOBODY, ids, theirs, None, SAMPLE, limit
        )
        theirs[(ids < 0) | (theirs > limit)] = np.inf

    ours = _on_a_core(lambda: bundle.cast(data, pose))
    rounds = Rounds({"ours": ours, "theirs": _on_a_core(multi_ray)}, effort.rounds)
    found = bundle.cast(data, pose)[some]
    assert np.array_equal(np.isfinite(found), np.isfinite(theirs))
    hit = np.isfinite(theirs)
    apart = np.abs(found[hit] - theirs[hit]).max(initial=0.0)
    ratio = rounds.ratio("theirs", "ours") * len(directions) / SAMPLE
    return (
        f"{len(directions):,}",
        f"**{len(directions) / rounds.median('ours') / 1e6:.1f}**",
        f"**{ratio:,.0f}**",
        f"{apart:.1e} m",
    )


def _on_a_core(work: Callable[[], object]) -> Callable[[], float]:
    """A contestant whose time is that of its core: nobody else's counts."""

    def run() -> float:
        start = time.process_time()
        work()
        return time.process_time() - start

    return run
