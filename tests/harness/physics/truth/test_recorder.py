"""The truth of a drive: its totals, its states and its contact events say the same."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from harness.base.sim_time import TICK_NS
from harness.physics.contacts import Touch
from harness.physics.simulation import Simulation
from harness.physics.truth.contact_events import ContactEvents
from harness.physics.truth.recorder import TruthRecorder
from harness.physics.truth.wheels import Wheels
from harness.samples import ContactEvent, Truth, TruthState
from harness.world.obstacles import Obstacle, ObstacleKind
from rover_metrics.timing import EVENT_GAP_NS

Vector = NDArray[np.float64]

STATE_TICKS = 5
WALL = Obstacle(ObstacleKind.HAZARD, "box", (0.05, 0.6, 0.3), (0.75, 0.1, 0.3))
STONE = Obstacle(ObstacleKind.ROCK, "ellipsoid", (0.06, 0.09, 0.04), (0.5, -0.18, 0.0))


@dataclass
class Drive:
    """A drive as the recorder tells it, and where the rover was after each tick."""

    poses: list[Vector]
    states: list[TruthState] = field(default_factory=list)
    events: tuple[ContactEvent, ...] = ()
    moves: list[list[bool]] = field(default_factory=list)
    truth: Truth = field(default_factory=Truth)


@pytest.fixture
def simulation(make_simulation: Callable[..., Simulation]) -> Simulation:
    return make_simulation(obstacles=(WALL,))


@pytest.mark.parametrize("degrees", [0.0, 74.9, 75.1, 180.0])
def test_a_rover_has_tipped_over_beyond_75_degrees(degrees: float, simulation: Simulation) -> None:
    recorder = TruthRecorder(simulation)
    assert recorder.truth() == Truth(position=simulation.position, wheel_slip=(0.0,) * 4)
    for tilt in (degrees, 0.0):
        x, y, z, w = Rotation.from_euler("ZYX", [30.0, 0.0, tilt], degrees=True).as_quat()
        simulation.data.qpos[3:7] = w, x, y, z
        recorder.observe()
    truth = recorder.truth()
    assert math.degrees(truth.largest_tilt) == pytest.approx(degrees, abs=1e-5)
    assert truth.tipped_over == (degrees > 75.0)
    x, y = math.sin(math.radians(8.0)), math.cos(math.radians(8.0))
    assert x * x + y * y > 1.0, "rounding says more than upside down"
    simulation.data.qpos[3:7] = 0.0, x, y, 0.0
    recorder.observe()
    assert recorder.truth().largest_tilt == math.pi


def test_the_way_back_to_the_start_is_no_path_and_ends_every_contact(simulation: Simulation) -> None:
    recorder, data = TruthRecorder(simulation), simulation.data
    start = np.array(simulation.position)
    data.qpos[:3] = start + np.array([3.0, 4.0, 12.0])
    simulation.contacts.note("hazard", Touch(5.0, 1, 2, [0.0] * 3, [0.0] * 3 + [1.0] + [0.0] * 3))
    recorder.observe()
    simulation.return_to_start()
    recorder.carried_away()
    assert recorder.events.open == ()
    assert len(recorder.events.take_closed()) == 1
    data.qpos[0] += 1.0
    recorder.observe()
    truth = recorder.truth()
    assert truth.path_length == pytest.approx(13.0 + 1.0)
    assert (truth.resets, truth.hazard_contacts) == (1, 1)
    assert (truth.hazard_contact_s, truth.rock_contact_s, truth.scrape_s) == (0.01, 0.0, 0.0)


@pytest.fixture(scope="module")
def drive(make_simulation: Callable[..., Simulation]) -> Drive:
    """Over a stone against a wall, back, against it again; then on its side, and upright."""
    heights = np.random.default_rng(3).uniform(0.0, 0.01, (41, 41))
    simulation = make_simulation(heights=heights, obstacles=(WALL, STONE))
    recorder = TruthRecorder(simulation)
    told = Drive([simulation.pose.copy()])
    for ticks, speed, pose in (
        (10, 0.0, None),
        (90, 7.0, None),
        (60, -7.0, None),
        (60, 7.0, None),
        (20, 0.0, (-0.8, 0.5, 0.40, *quaternion(roll=2.8))),
        (15, 2.0, (-0.8, 0.5, 0.05, *quaternion(yaw=1.0))),
    ):
        if pose is not None:
            simulation.data.qpos[:7], simulation.data.qvel[:] = pose, 0.0
        simulation.command_wheels(np.full(4, speed))
        for _ in range(ticks):
            simulation.tick()
            recorder.observe()
            told.poses.append(simulation.pose.copy())
            if (len(told.poses) - 1) % STATE_TICKS == 0:
                told.states.append(recorder.state())
                told.moves.append([wheel.moves for wheel in Wheels(simulation).motion()])
    recorder.events.close()
    told.events, told.truth = recorder.events.take_closed(), recorder.truth()
    return told


def quaternion(*, roll: float = 0.0, yaw: float = 0.0) -> tuple[float, ...]:
    x, y, z, w = Rotation.from_euler("ZYX", [yaw, 0.0, roll]).as_quat()
    return w, x, y, z


def test_the_totals_are_those_of_the_whole_drive(drive: Drive) -> None:
    truth, poses = drive.truth, np.array(drive.poses)
    steps = np.linalg.norm(np.diff(poses[:, :3], axis=0), axis=1)
    assert truth.time_ns == drive.states[-1].stamp_ns == len(steps) * TICK_NS
    told = [state.path_length for state in drive.states]
    assert told == pytest.approx(np.cumsum(steps)[STATE_TICKS - 1 :: STATE_TICKS])
    assert truth.path_length == told[-1]
    assert truth.position == pytest.approx(poses[-1, :3])
    up = Rotation.from_quat(poses[:, [4, 5, 6, 3]]).apply([0.0, 0.0, 1.0])[:, 2]
    assert truth.largest_tilt == pytest.approx(np.arccos(up.min()), abs=1e-6)
    assert truth.tipped_over


@pytest.mark.parametrize("kind", ["hazard", "rock", "scrape"])
def test_events_are_when_the_states_tell_of_contacts(kind: str, drive: Drive) -> None:
    events = [event for event in drive.events if event.kind == kind]
    truth = drive.truth
    begun = {"hazard": truth.hazard_contacts, "rock": truth.rock_contacts, "scrape": truth.scrapes}
    lasted = {"hazard": truth.hazard_contact_s, "rock": truth.rock_contact_s, "scrape": truth.scrape_s}
    assert len(events) == begun[kind] == {"hazard": 2}.get(kind, begun[kind]) > 0
    assert 0.05 < lasted[kind] <= sum(event.end_ns - event.start_ns for event in events) * 1e-9 + 1e-9
    for state in drive.states:
        touched = {"hazard": state.hazard_contact, "rock": state.rock_contact, "scrape": state.scrape}
        begin, end = state.stamp_ns - STATE_TICKS * TICK_NS, state.stamp_ns
        during = [event for event in events if event.start_ns < end and event.end_ns > begin]
        assert bool(during) >= touched[kind]
        if kind == "hazard":
            assert state.contact_force <= max((event.force for event in during), default=0.0)
            assert (state.contact_force > 0.0) == state.hazard_contact
    names = {"hazard": "hazard_0", "rock": "rock_1", "scrape": "ground"}
    assert {event.other for event in events} == {names[kind]}
    if kind == "hazard":
        strongest = [max(s.contact_force for s in drive.states if at(s, event)) for event in events]
        assert [event.force for event in events] == strongest
        assert min(event.point[0] for event in events) > 0.1  # the wall is ahead
    if kind == "rock":
        assert {event.part for event in events} <= {"wheel_FR", "wheel_RR"}  # right of the middle


def at(state: TruthState, event: ContactEvent) -> bool:
    return event.start_ns < state.stamp_ns < event.end_ns + STATE_TICKS * TICK_NS


def test_slip_is_averaged_over_the_states_in_which_a_wheel_moves(drive: Drive) -> None:
    slips, moves = np.abs([state.slip for state in drive.states]), np.array(drive.moves)
    assert 0 < moves.sum() < moves.size
    assert (slips[~moves] == 0.0).all()
    assert drive.truth.wheel_slip == pytest.approx(slips.sum(axis=0) / moves.sum(axis=0))
    assert drive.truth.mean_slip == pytest.approx(slips.sum() / moves.sum())


TOUCH = Touch(1.0, 1, 7, [1.0, 2.0, 0.5], [1.0, 2.0, 0.1, 1.0, 0.0, 0.0, 0.0])


def test_contacts_up_to_the_gap_apart_are_one_event_and_farther_ones_are_two() -> None:
    events, gap = ContactEvents({1: "wheel_FL", 7: "hazard_0"}.__getitem__), EVENT_GAP_NS // TICK_NS
    for tick, touches in ((10, 1), (10 + gap, 1), (10 + 2 * gap, 0)):
        events.observe(tick * TICK_NS, {"hazard": TOUCH} if touches else {})
    assert events.take_closed() == ()
    assert len(events.open) == 1
    events.observe((11 + 2 * gap) * TICK_NS, {"hazard": TOUCH})
    (event,) = events.take_closed()
    assert (event.start_ns, event.end_ns) == (9 * TICK_NS, (10 + gap) * TICK_NS)
    assert events.begun == {"hazard": 2, "rock": 0, "scrape": 0}
    assert events.take_closed() == ()
    events.observe((12 + 3 * gap) * TICK_NS, {})
    assert len(events.take_closed()) == 1, "although nothing is touched any more"


def test_the_place_of_a_contact_is_told_on_the_rover_however_it_stands_then() -> None:
    events, stood = ContactEvents(str), Rotation.from_euler("ZYX", [2.0, 0.3, -0.5])
    x, y, z, w = stood.as_quat()
    on_rover, rover = np.array([0.2, -0.3, 0.1]), np.array([4.0, -7.0, 0.5])
    touched = (stood.apply(on_rover) + rover).tolist()
    events.observe(TICK_NS, {"rock": Touch(5.0, 1, 2, touched, [*rover, w, x, y, z])})
    (event,) = events.open
    assert event.point == pytest.approx(on_rover)
