"""The truth of a drive, summed up beside it from MuJoCo's raw state of every step."""

import copy
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from harness.base.sim_time import TICK_NS
from harness.physics.contacts import Touch
from harness.physics.simulation import Simulation
from harness.robots import ROVERS
from harness.samples import TruthState
from harness.truth.contact_events import ContactEvents
from harness.truth.recorder import TruthRecorder
from harness.truth.traversal import ContactEvent, Truth
from harness.truth.wheels import Wheels
from harness.world.obstacles import Obstacle, ObstacleKind
from harness.world.statistics import RoughnessMap
from rover_metrics.timing import EVENT_GAP_NS

Vector = NDArray[np.float64]

STATE_TICKS = 5
WHEELS = ROVERS["rover_zero4wd"].wheel_joints
KINDS = ("hazard", "rock", "scrape")
WALL = Obstacle(ObstacleKind.HAZARD, "box", (0.05, 0.6, 0.3), (0.75, 0.1, 0.3))
STONE = Obstacle(ObstacleKind.ROCK, "ellipsoid", (0.06, 0.09, 0.04), (0.5, -0.18, 0.0))


@dataclass
class Contact:
    """One contact point in one step, and the pose of the rover then."""

    force: float
    part: str
    other: str
    place: Vector
    pose: Vector

    @property
    def point(self) -> Vector:
        """Where it is in the model frame."""
        w, x, y, z = self.pose[3:]
        inverse = Rotation.from_quat([x, y, z, w]).inv()
        return np.asarray(inverse.apply(self.place - self.pose[:3]))


@dataclass
class Tick:
    """What MuJoCo's state says of one clock tick."""

    end_ns: int
    position: Vector
    tilt: float
    speed: float
    touches: dict[str, list[Contact]]
    wheels: list[Vector]


@dataclass
class Drive:
    """A drive twice: as the recorder tells it, and as it was."""

    start: Vector
    simulation: Simulation
    ticks: list[Tick] = field(default_factory=list)
    states: list[TruthState] = field(default_factory=list)
    events: list[ContactEvent] = field(default_factory=list)
    moves: list[list[bool]] = field(default_factory=list)
    truth: Truth = field(default_factory=Truth)


class Contacts:
    """Every contact of a step that is not a wheel's with the ground, by kind."""

    def __init__(self, model: mujoco.MjModel) -> None:
        self._model = model
        geoms = [model.geom(index) for index in range(model.ngeom)]
        bodies = [model.body(int(geom.bodyid[0])).name for geom in geoms]
        kinds = {"world": "scrape", "rocks": "rock", "hazards": "hazard"}
        self._kinds = {geom: kinds[name] for geom, name in enumerate(bodies) if name in kinds}
        self._names = [geom.name.removeprefix("body_") for geom in geoms]
        self._names[model.geom("terrain").id] = "ground"
        wheels = {int(model.joint(name).bodyid[0]) for name in WHEELS}
        self._wheels = {geom.id for geom in geoms if int(geom.bodyid[0]) in wheels}

    def of(self, data: mujoco.MjData) -> Iterator[tuple[str, Contact]]:
        for index, geoms in enumerate(data.contact.geom.tolist()):
            part, other = sorted(geoms, key=lambda geom: geom in self._kinds)
            kind = self._kinds[other]
            if kind == "scrape" and part in self._wheels:
                continue
            wrench = np.zeros(6)
            mujoco.mj_contactForce(self._model, data, index, wrench)
            place, pose = data.contact.pos[index].copy(), data.qpos[:7].copy()
            yield kind, Contact(wrench[0], self._names[part], self._names[other], place, pose)


def tick_by_hand(simulation: Simulation, contacts: Contacts) -> Tick:
    """The next tick, on a copy of the state."""
    model, data = simulation.model, copy.copy(simulation.data)
    touches: dict[str, list[Contact]] = {kind: [] for kind in KINDS}
    for _ in range(4):
        mujoco.mj_step(model, data)
        for kind, touch in contacts.of(data):
            touches[kind].append(touch)
    mujoco.mj_forward(model, data)
    w, x, y, z = data.qpos[3:7]
    attitude = Rotation.from_quat([x, y, z, w])
    return Tick(
        end_ns=simulation.time_ns + TICK_NS,
        position=data.qpos[:3].copy(),
        tilt=math.acos(min(1.0, attitude.apply([0.0, 0.0, 1.0])[2])),
        speed=attitude.inv().apply(data.qvel[:3])[0],
        touches=touches,
        wheels=[data.body(int(model.joint(n).bodyid[0])).xpos.copy() for n in WHEELS],
    )


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
    """Over a stone against a wall, back, against it again; then on its side, upright, on its nose."""
    heights = np.random.default_rng(3).uniform(0.0, 0.01, (41, 41))
    simulation = make_simulation(heights=heights, obstacles=(WALL, STONE))
    recorder = TruthRecorder(simulation)
    told, contacts = Drive(np.array(simulation.position), simulation), Contacts(simulation.model)
    for ticks, speed, pose in (
        (10, 0.0, None),
        (90, 7.0, None),
        (60, -7.0, None),
        (60, 7.0, None),
        (20, 0.0, (-0.8, 0.5, 0.40, *quaternion(roll=2.8))),
        (15, 2.0, (-0.8, 0.5, 0.05, *quaternion(yaw=1.0))),
        (5, 0.0, (-0.8, 0.5, 0.50, *quaternion(pitch=1.2))),
    ):
        if pose is not None:
            simulation.data.qpos[:7], simulation.data.qvel[:] = pose, 0.0
        simulation.command_wheels(np.full(4, speed))
        for _ in range(ticks):
            told.ticks.append(tick_by_hand(simulation, contacts))
            simulation.tick()
            recorder.observe()
            if len(told.ticks) % STATE_TICKS == 0:
                told.states.append(recorder.state())
                told.moves.append([wheel.moves for wheel in Wheels(simulation).motion()])
    recorder.events.close()
    told.events += recorder.events.take_closed()
    told.truth = recorder.truth()
    return told


def quaternion(*, roll: float = 0.0, pitch: float = 0.0, yaw: float = 0.0) -> tuple[float, ...]:
    x, y, z, w = Rotation.from_euler("ZYX", [yaw, pitch, roll]).as_quat()
    return w, x, y, z


def path_lengths(drive: Drive) -> list[float]:
    """Of the path up to the end of each tick [m]."""
    positions = np.array([drive.start, *(tick.position for tick in drive.ticks)])
    lengths: list[float] = np.cumsum(np.linalg.norm(np.diff(positions, axis=0), axis=1)).tolist()
    return lengths


def test_the_totals_are_those_of_the_whole_drive(drive: Drive) -> None:
    truth, tilts = drive.truth, [tick.tilt for tick in drive.ticks]
    assert truth.time_ns == drive.ticks[-1].end_ns == 260 * TICK_NS
    assert truth.path_length == pytest.approx(path_lengths(drive)[-1])
    assert truth.position == pytest.approx(drive.ticks[-1].position)
    assert max(tilts) > max(tilts[-20:]) + 0.1
    assert truth.largest_tilt == pytest.approx(max(tilts), abs=1e-6)
    assert truth.tipped_over
    told = (truth.hazard_contact_s, truth.rock_contact_s, truth.scrape_s)
    counted = [sum(bool(tick.touches[kind]) for tick in drive.ticks) for kind in KINDS]
    assert min(counted) > 5
    assert len(set(counted)) == 3
    assert told == pytest.approx([0.01 * count for count in counted])


@pytest.mark.parametrize("kind", KINDS)
def test_an_event_lasts_from_its_first_contact_to_its_last_and_names_the_strongest(
    kind: str, drive: Drive
) -> None:
    touching = [tick for tick in drive.ticks if tick.touches[kind]]
    expected: list[list[Tick]] = []
    for tick in touching:
        if expected and tick.end_ns - expected[-1][-1].end_ns <= 500_000_000:
            expected[-1].append(tick)
        else:
            expected.append([tick])
    told = sorted((e for e in drive.events if e.kind == kind), key=lambda event: event.start_ns)
    assert len(told) == len(expected) == {"hazard": 2}.get(kind, len(expected)) > 0
    truth = drive.truth
    begun = dict(zip(KINDS, (truth.hazard_contacts, truth.rock_contacts, truth.scrapes), strict=True))
    assert begun[kind] == len(expected)
    for event, ticks in zip(told, expected, strict=True):
        assert (event.start_ns, event.end_ns) == (ticks[0].end_ns - TICK_NS, ticks[-1].end_ns)
        strongest = max((t for tick in ticks for t in tick.touches[kind]), key=lambda touch: touch.force)
        assert event.force == pytest.approx(strongest.force)
        assert (event.part, event.other) == (strongest.part, strongest.other)
        assert event.point == pytest.approx(strongest.point, abs=1e-9)


def test_slip_is_averaged_over_the_states_in_which_a_wheel_moves(drive: Drive) -> None:
    slips, moves = np.abs([state.slip for state in drive.states]), np.array(drive.moves)
    assert 0 < moves.sum() < moves.size
    assert (slips[~moves] == 0.0).all()
    assert drive.truth.wheel_slip == pytest.approx(slips.sum(axis=0) / moves.sum(axis=0))
    assert drive.truth.mean_slip == pytest.approx(slips.sum() / moves.sum())


def test_each_state_tells_of_its_own_fifty_milliseconds(drive: Drive) -> None:
    paths, roughness = path_lengths(drive), RoughnessMap(drive.simulation.scene.world.ground)
    for index, state in enumerate(drive.states, start=1):
        ticks = drive.ticks[(index - 1) * STATE_TICKS : index * STATE_TICKS]
        now = ticks[-1]
        touched = {kind: [t for tick in ticks for t in tick.touches[kind]] for kind in KINDS}
        assert state.stamp_ns == now.end_ns
        told = (state.hazard_contact, state.rock_contact, state.scrape)
        assert told == tuple(bool(touched[kind]) for kind in KINDS)
        force = max((touch.force for touch in touched["hazard"]), default=0.0)
        assert state.contact_force == pytest.approx(force)
        assert state.speed == pytest.approx(now.speed, abs=1e-9)
        assert state.path_length == pytest.approx(paths[index * STATE_TICKS - 1])
        squares = [roughness.mean_square(x, y) for x, y, _ in now.wheels]
        assert state.roughness == pytest.approx(math.sqrt(np.mean(squares)))


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
