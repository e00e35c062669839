"""A second core that simulates ahead: the same drive, whatever happens between two control periods."""

import math
import shutil
import threading
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from typing import Any
from unittest.mock import patch

import pytest

from harness.base.errors import RunFailed
from harness.episode.assembly import fleet
from harness.episode.episode import Episode, episodes_of
from harness.episode.together import Together
from harness.physics import ahead, physics
from harness.physics.ahead import Ahead
from harness.physics.base_controller import DiffDrive
from harness.physics.physics import Physics
from harness.robots import ROVERS
from harness.samples import Place
from harness.sensors.lidar import Lidar
from harness.spec.fleet import parse_rovers
from harness.spec.run import Run
from tests.support.exact import as_bytes

LIGHT = {"duration": 2.2, "lidar_beams": 40, "imu_rate": 100}
AREA = ((-6.0, 6.0), (-6.0, 6.0))
SHARED = Run.of(terrain="posts", robot="leo", **LIGHT)
RUNS = {
    "a post in the way": Run.of(
        terrain="posts", driver="straight", robot="husky", start=(2.74, -0.09, 0.0), **LIGHT
    ),
    "every sensor that looks": Run.of(
        terrain="rocky", robot="leo", sensors=("lidar3d=vlp16", "height_scan"), **LIGHT
    ),
    "goals and resets": Run.of(
        terrain="rocky",
        driver="goal",
        robot="rover_zero4wd",
        resets=(0.52, 1.4),
        goals=((0.3, 2.0, 1.0, 0.0),),
        **LIGHT,
    ),
    "people, who see where it is": Run.of(terrain="rocky", actors=("walker=1,1/2,2",), **LIGHT),
    "a soil": Run.of(terrain="flat", soil="dry_sand", **LIGHT),
    "grass that drags": Run.of(robot="husky", surface="wet_grass", **LIGHT),
    "stop and go with wheels that stick": Run.of(
        driver="cmd_vel",
        robot="jackal",
        faults=("wheel.front_left:stuck@0.7+0.6", "motor.right:weak=0.5@0.5"),
        commands=((0.5, 0.6, 0.3), (1.02, 0.0, 0.0), (2.0, -0.4, 0.0)),
        **LIGHT,
    ),
    "two": fleet(SHARED, parse_rovers(("leo:a,driver=wander", "husky:b,x=2,y=2"), SHARED.rover)),
    "the edge": Run.of(terrain="flat", start=(18.7, 0.0, 0.0), driver="straight", **LIGHT),
}


def driven(
    run: Run,
    *,
    ahead: bool,
    act: Callable[[Episode], None] | None = None,
    haste: int = 0,
) -> list[bytes]:
    """All batches, and at the end what it failed of; something is ordered for the 20th.

    While the consumer has a batch it hastens the next ones, more and less often.
    """
    episodes, told = episodes_of(run), list[bytes]()
    asked = iter(range(1_000_000))

    def ordered() -> Callable[[], None] | None:
        return partial(act, episodes[-1]) if next(asked) == 20 and act is not None else None

    drive = Together(episodes, ordered, ahead=ahead, awake=ahead)
    try:
        for number, period in enumerate(drive.batches()):
            for _ in range(haste * number % 5):
                drive.hasten()
            told.append(as_bytes(period))
    except (RunFailed, ZeroDivisionError) as error:
        told.append(as_bytes(str(error)))
    data = episodes[0].simulation.data
    return [*told, as_bytes([data.qpos.tolist(), data.qacc_warmstart.tolist()])]


@pytest.fixture(autouse=True)
def _has_two_cores(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(physics, "has_second_core", lambda: True)
    # Who hastens waits for the second core: it depends on no clock which periods are hastened.
    monkeypatch.setattr(Ahead, "has_landed", property(lambda _: True))


@pytest.mark.parametrize("name", RUNS)
def test_a_drive_is_the_same_with_a_second_core(name: str) -> None:
    with patch.object(Physics, "launch", autospec=True, side_effect=Physics.launch) as launched:
        ahead = driven(RUNS[name], ahead=True)
    assert ahead == driven(RUNS[name], ahead=False) == driven(RUNS[name], ahead=True, haste=7)
    seen = name in ("people, who see where it is", "a soil")
    assert launched.call_count == 0 if seen else launched.call_count > 20


@pytest.mark.parametrize("is_raised", [True, False])
def test_a_drive_ends_after_the_same_batches_however_it_is_hastened(is_raised: bool) -> None:
    """A controller raises what is nobody's, or it commands no number, which MuJoCo warns of."""

    def told(**how: Any) -> list[bytes]:  # noqa: ANN401 - of `driven`
        calls = iter(range(1_000_000))

        def commands(_: object) -> list[float]:
            if next(calls) != 152:
                return [3.0] * 4
            return [1 / 0 if is_raised else math.nan] * 4

        with patch.object(DiffDrive, "commands", commands):
            return driven(Run.of(driver="straight", robot="husky", **LIGHT), **how)

    ended = told(ahead=True)
    assert len(ended) < 35
    assert ended == told(ahead=True, haste=3) == told(ahead=True, haste=4) == told(ahead=False)
    assert is_raised or b"diverged at t = 1.53 s" in ended[-2]


def test_what_drivers_look_at_is_scanned_on_the_second_core_once_it_simulates() -> None:
    with patch.object(Lidar, "scan", autospec=True, side_effect=Lidar.scan) as scanned:
        driven(RUNS["two"], ahead=True)
    assert 0 < scanned.call_count < 10  # of 120


def test_a_rover_whose_model_asks_for_rk4_is_not_stepped_by_halves(tmp_path: Path) -> None:
    folder = Path(shutil.copytree(ROVERS["husky"].folder, tmp_path / "husky"))
    model = folder / "husky.xml"
    model.write_text(model.read_text().replace('integrator="implicitfast"', 'integrator="RK4"'))
    run = Run.of(robot=str(folder), **LIGHT)
    assert (
        driven(run, ahead=True)
        == driven(run, ahead=False)
        != driven(run.alone(robot="husky"), ahead=True)
    )


@cache
def undisturbed() -> list[bytes]:
    return driven(RUNS["two"], ahead=True)


@pytest.mark.parametrize(
    "act",
    [
        Episode.reset,
        lambda episode: episode.reset(Place(1.0, 1.0, 0.5)),
        lambda episode: episode.pilot.hand_over("spin"),
    ],
)
def test_what_is_ordered_between_two_periods_comes_into_effect_there(
    act: Callable[[Episode], None],
) -> None:
    run = RUNS["two"]
    ahead, plain = driven(run, ahead=True, act=act), undisturbed()
    assert ahead == driven(run, ahead=False, act=act) == driven(run, ahead=True, act=act, haste=3)
    assert ahead[:20] == plain[:20]
    assert ahead != plain


@pytest.mark.parametrize(
    ("limit", "may"),
    [("max 100000", True), ("200000 100000", True), ("150000 100000", False), ("", True)],
)
def test_a_container_may_use_a_second_core_if_its_limit_allows_both(
    limit: str, may: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "cpu.max").write_text(limit)
    monkeypatch.setattr(ahead, "CPU_MAX", tmp_path / "cpu.max")
    monkeypatch.setattr("os.sched_getaffinity", lambda _: {0, 1}, raising=False)
    assert ahead.has_second_core() is may


def test_nothing_goes_on_when_a_drive_is_left_early() -> None:
    threads, batches = (
        threading.active_count(),
        Together(episodes_of(RUNS["a post in the way"]), ahead=True).batches(),
    )
    for _ in range(9):
        next(batches)
    assert threading.active_count() == threads + 1
    del batches
    assert threading.active_count() == threads
