from dataclasses import replace
from itertools import chain

import numpy as np
import pytest

from harness.config import Batch, EpisodeConfig
from harness.episode import Episode
from harness.robots import ROVERS
from harness.samples import TruthState
from harness.sensors.fault_kinds import SENSORS
from harness.sensors.fault_spec import parse_faults
from harness.sensors.faults import FaultInjector
from harness.truth_events import ContactEvent
from harness.truth_recorder import TruthRecorder

PERIOD_NS = 50_000_000


@pytest.fixture(scope="module")
def drive() -> list[Batch]:
    """A drive that meets a hazard, then a rock."""
    config = EpisodeConfig(robot="rover_zero4wd", seed=1, driver="ram", duration=12.5)
    return list(Episode(config).batches())


def states(batches: list[Batch]) -> list[TruthState]:
    samples = chain.from_iterable(tick.samples for batch in batches for tick in batch.ticks)
    return [sample for sample in samples if isinstance(sample, TruthState)]


def events(batches: list[Batch]) -> list[ContactEvent]:
    return [event for batch in batches for event in batch.events]


def test_truth_comes_last_in_its_tick_at_20_hz(drive: list[Batch]) -> None:
    stamps = [state.stamp_ns for state in states(drive)]
    assert stamps == [PERIOD_NS * n for n in range(1, 251)]
    assert all(isinstance(batch.ticks[-1].samples[-1], TruthState) for batch in drive)


def test_states_say_contact_exactly_while_an_event_lasts(drive: list[Batch]) -> None:
    (hazard,) = [event for event in events(drive) if event.kind == "hazard"]
    touching = [s.stamp_ns for s in states(drive) if s.hazard_contact]
    assert touching[0] - PERIOD_NS <= hazard.start_ns < touching[0]
    assert touching[-1] - PERIOD_NS < hazard.end_ns <= touching[-1]
    assert hazard.force == max(s.contact_force for s in states(drive)) > 100.0
    assert all((s.contact_force > 0.0) == s.hazard_contact for s in states(drive))


def test_an_event_says_which_part_met_which_obstacle_and_where_on_the_rover(drive: list[Batch]) -> None:
    (hazard,) = [event for event in events(drive) if event.kind == "hazard"]
    assert (hazard.part, hazard.other) == ("wheel_FR", "hazard_0")
    x, y, z = hazard.point
    _, front, right, _ = ROVERS["rover_zero4wd"].footprint
    assert front - 0.03 < x < front + 0.01
    assert right - 0.01 < y < right + 0.09
    assert 0.0 < z < 0.25


def test_an_event_that_lasts_at_the_end_of_the_drive_is_told_with_the_last_batch(
    drive: list[Batch],
) -> None:
    *before, last = drive
    assert "rock" not in {event.kind for event in events(before)}
    (open_rock,) = before[-1].open_events
    (rock,) = last.events
    assert (rock.kind, rock.start_ns) == (open_rock.kind, open_rock.start_ns)
    assert last.open_events == ()


def test_totals_agree_with_events_and_states(drive: list[Batch]) -> None:
    truth, last = drive[-1].truth, states(drive)[-1]
    kinds = [event.kind for event in events(drive)]
    assert truth.hazard_contacts == kinds.count("hazard") == 1
    assert truth.rock_contacts == kinds.count("rock") == 1
    assert truth.path_length == last.path_length
    moving = np.abs([state.slip for state in states(drive)])
    assert truth.mean_slip == pytest.approx(moving.mean(), abs=0.01)
    assert truth.wheel_slip == pytest.approx(moving.mean(axis=0), abs=0.01)


@pytest.mark.parametrize("robot", ROVERS)
def test_wheels_that_roll_hardly_slip_and_wheels_that_turn_in_place_do(robot: str) -> None:
    config = EpisodeConfig(terrain="flat", robot=robot, duration=3.0, driver="straight")
    straight = states(list(Episode(config).batches()))[-1]
    assert np.abs(straight.slip).max() < 0.05
    assert straight.speed == pytest.approx(0.3, rel=0.06)
    assert straight.roughness == 0.0
    spin = states(list(Episode(replace(config, driver="spin")).batches()))[-1]
    front_left, rear_left, front_right, rear_right = spin.slip
    assert max(front_left, rear_left) < -0.1
    assert min(front_right, rear_right) > 0.1
    assert abs(spin.speed) < 0.05


@pytest.mark.parametrize("robot", ROVERS)
def test_a_rover_on_its_roof_scrapes_the_ground_with_its_body(robot: str) -> None:
    simulation = Episode(EpisodeConfig(terrain="flat", robot=robot, duration=1.0)).simulation
    recorder = TruthRecorder(simulation)
    simulation.data.qpos[2:7] = 0.5, 0.0, 1.0, 0.0, 0.0
    for _ in range(100):
        simulation.tick()
        recorder.observe()
    recorder.events.close()
    kinds = {event.kind for event in recorder.events.take_closed()}
    assert kinds == {"scrape"}
    assert recorder.state().scrape
    assert recorder.truth().scrape_s > 0.3
    assert recorder.truth().tipped_over


def test_no_fault_changes_the_truth() -> None:
    faults = [f"{sensor}:{kind}" for sensor in SENSORS for kind in ("nan", "dropout", "duplicate")]
    config = EpisodeConfig(terrain="flat", duration=0.2)
    injector = FaultInjector(parse_faults([*faults, "clock:jump=10@0.1"]), seed=0)
    for batch in Episode(config).batches():
        for tick in batch.ticks:
            sent = [s for s in injector.corrupt(tick).samples if isinstance(s, TruthState)]
            assert sent == [s for s in tick.samples if isinstance(s, TruthState)]
