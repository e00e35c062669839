"""One seeded drive in one world: world + rover + driver + sensors -> a stream of ticks and truth.

No ROS and no wall clock: the same configuration gives the same stream, bit for bit. Consumers take it
in batches of one control period, either in this process or through harness.episode.stream. Rovers that
share a world have an episode each, and are driven together; one alone is a fleet of one.
"""

import math
from collections import deque
from collections.abc import Callable, Collection, Iterator
from dataclasses import replace
from functools import partial
from operator import itemgetter
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from harness.base.sim_time import NANOSECONDS, TICK_NS
from harness.base.streams import EPISODE, GOALS, OPTIONAL_SENSORS, VIBRATION, generator, seeded
from harness.drivers import (
    Driver,
    DriverContext,
    Observation,
    TakesGoals,
    find_driver,
    takes_goals,
)
from harness.drivers.base import drivable
from harness.drivers.goal_course import GoalCourse
from harness.drivers.policy import PolicyDriver
from harness.drivers.route_course import RouteCourse
from harness.drivers.scripted import CmdVel
from harness.episode.assembly import (
    actuator_faults,
    check,
    check_world,
    follows_route,
    route_progress,
    scenery,
    sensor_rows,
)
from harness.episode.batch import Batch, EpisodeInfo
from harness.episode.together import together
from harness.frames.rover_frames import RoverFrames, rover_frames
from harness.frames.transforms import describe
from harness.physics.base_controller import base_controller
from harness.physics.scene import HAZARD_CONTACT, Scene, build_scenes
from harness.physics.simulation import Simulation, simulations
from harness.physics.start import check_room, check_start
from harness.robots import find_rover
from harness.robots.reading import model_hash
from harness.robots.sections import Shake
from harness.samples import ActorPoses, GoalPose, Imu, LaserScan, Place, Sample, Tick, Twist
from harness.sensors.base import EpisodeParts
from harness.sensors.lidar import Lidar
from harness.sensors.lidar_spec import LidarSpec
from harness.sensors.noise import EXACT, PRESETS, SensorNoise
from harness.sensors.optional import Installation, SensorOptions
from harness.sensors.rays.bundle import Surroundings
from harness.sensors.state import PeopleSensor
from harness.sensors.suite import SensorSuite
from harness.spec.ros import FrameOptions
from harness.spec.run import Run
from harness.truth.recorder import TruthRecorder
from harness.world.actors.free_space import FreeSpace
from harness.world.berths import berth, overlaps
from harness.world.geodesy import Datum
from harness.world.world import World, terrain_hash

if TYPE_CHECKING:
    from harness.sensors.vibration import Vibration

Given = TypeVar("Given", bound=SensorOptions)


class Episode:
    """Builds the world on construction; `batches` then drives it once from start to end.

    Of several rovers in a world `episodes_of` makes the episodes and `together` drives them.

    Args:
        run: What determines it.
        number: The rover's place in the run.
        frame_options: Which transforms are among its samples; None for none at all.
        samples: Those that anybody wants, whatever drives the rover included; None for all. The drive
            is the same without the others.
        simulation: The rover, in a world with others; None for one that is alone.

    Attributes:
        description: What the transforms are of; None without them.
    """

    def __init__(
        self,
        run: Run,
        number: int = 0,
        *,
        frame_options: FrameOptions | None = None,
        samples: Collection[type[Sample]] | None = None,
        simulation: Simulation | None = None,
    ) -> None:
        self.run, self.number, self.setup = run, number, run.rovers[number]
        if simulation is None:
            run.check_single()
            (simulation,) = _simulated(run)
        self.simulation = simulation
        scene = self.simulation.scene
        rover, world = scene.rover, scene.world
        self.info = EpisodeInfo(
            model_hash=model_hash(rover),
            terrain_hash=terrain_hash(world),
            obstacles=len(world.obstacles),
            map_size=(2 * world.ground.half_size[0], 2 * world.ground.half_size[1]),
            start=world.start,
            notes=world.notes,
            files=world.files,
            targets={target.name: target.position for target in world.targets},
        )
        self._recorder = TruthRecorder(self.simulation)
        self._hazard_contact = self.simulation.summed(HAZARD_CONTACT)
        lidar_spec = LidarSpec(beams=self.setup.lidar_beams)
        lidar = Lidar(scene.model, lidar_spec, scene.own("lidar"), scene.others())
        parts = EpisodeParts(simulation=self.simulation, lidar=lidar, recorder=self._recorder)
        self.description = None
        rows = sensor_rows(self.setup)
        optional = [row.given for row in rows if row.given is not None]
        if frame_options is not None or optional:
            frames = rover_frames(rover, (frame for some in optional for frame in some.frames(rover)))
            install = partial(installed, run, number, frames, scene, lidar.surroundings)
            parts = replace(parts, install=install)
        if frame_options is not None:
            self.description = describe(frames, frame_options)
            parts = replace(parts, frames=frames, frame_options=frame_options)
        noise = sensor_noise(self.setup.noise, run.own_seed(number), lidar_spec, rover.vibration)
        rates: dict[type[Sample], int] = {Imu: self.setup.imu_rate}
        self._sensors = SensorSuite(parts, rover, rates, wanted=samples, noise=noise, rows=rows)
        crowd, told = self.simulation.crowd, samples is None or ActorPoses in samples
        self._people = PeopleSensor(self.simulation, crowd) if crowd is not None and told else None
        self._ticks: list[Tick] = []  # since the last batch
        self._goals: list[Place] = []  # that come with the next batch
        self._told: list[GoalPose] = []  # to who drives over topics, with the first tick of the period
        self._given: tuple[list[Place], list[GoalPose]] = [], []  # for the next control period
        self._bearings = lidar_spec.bearings(rover.lidar_yaw)
        self._takes_goals = takes_goals(self.setup.driver)
        self._course = course_of(run, number, world)
        self._is_linked, self._is_aborted = True, False
        planned: list[tuple[float, Callable[[], None]]] = [(t, self.reset) for t in run.plan.resets]
        for start, length in run.plan.link_losses:
            planned += [
                (start, partial(self._link, up=False)),
                (start + length, partial(self._link, up=True)),
            ]
        planned += [(t, self._abort) for t in run.plan.aborts]
        planned += [(t, self._resume) for t in run.plan.resumes]
        planned += [(t, partial(self.hand_over, driver)) for t, driver in run.plan.drivers]
        planned += [
            (t, partial(self.command, Twist(*twist), held=True)) for t, *twist in run.plan.commands
        ]
        planned += [(t, partial(self.head_for, Place(*place))) for t, *place in run.plan.goals]
        self._planned = deque(sorted(planned, key=itemgetter(0)))  # at the same time in this order
        self._begin()

    def _begin(self) -> None:
        """A driver that has done nothing yet, at a rover that stands."""
        self._began_ns = self.simulation.time_ns
        self._drive = base_controller(self.simulation.scene.rover, TICK_NS / NANOSECONDS)
        self._faults = actuator_faults(self.run, self.number)
        scene, (rng, *_) = self.simulation.scene, generators(self.run.own_seed(self.number), 3)
        middle, half_size = scene.world.roaming
        seconds = self.setup.cmd_vel_timeout
        if seconds is None and scene.rover.real and scene.rover.actuators is not None:
            seconds = scene.rover.actuators.command_timeout
        timeout_ns = None if seconds is None else round(seconds * NANOSECONDS)
        self._context = DriverContext(
            scene.rover,
            half_size,
            self._bearings,
            rng,
            obstacles=scene.world.obstacles,
            command_timeout_ns=timeout_ns,
            middle=middle,
        )
        self.hand_over("")

    def hand_over(self, driver: str) -> None:
        """Lets the driver of that name drive from now on, anew; "" for the run's own."""
        self._driver: Driver = find_driver(driver or self.setup.driver)(self._context)
        self._give_again()

    def command(self, twist: Twist, *, held: bool = False) -> None:
        """Hands a command to the cmd_vel driver, unless the link is lost; others make their own.

        Args:
            twist: The command.
            held: Whether it holds until the next one whatever the rover's own time-out is; one that is
                asked for ends it all the same.
        """
        if isinstance(self._driver, CmdVel) and self._is_linked:
            self._driver.obey(twist, held=held and self.setup.cmd_vel_timeout is None)

    def head_for(self, place: Place) -> None:
        """Gives a driver that takes goals its next one; other drivers choose their own."""
        if isinstance(self._driver, TakesGoals):
            self._given[0].append(place)
            self._driver.head_for(place.x, place.y, place.yaw)

    def reset(self, place: Place | None = None) -> None:
        """Puts the rover back to its start, or elsewhere, between two batches; time and duration go on.

        From then on it drives as it did at first, step for step. The IMU begins a new window. Wheel
        odometry goes on without a jump, as that of Gazebo's DiffDrive after a set_pose, and so do the
        biases of noise. Joints stand as they stood. People begin their walks anew, unless the rover is
        put elsewhere or is one of several: then they walk on.

        Args:
            place: Where to, onto the ground; None for the start. Where another rover stands, beside it.

        Raises:
            Diverged: It cannot stand there.
        """
        self._sensors.before_reset()
        place = self._beside_others(place)
        if place is None:
            self.simulation.return_to_start()
            if self.simulation.crowd is not None and len(self.simulation.physics.rovers) == 1:
                self.simulation.crowd.restart(self.simulation.time_ns)
        else:
            self.simulation.put(place.x, place.y, place.yaw)
        self._sensors.after_reset()
        self._recorder.carried_away()
        self._begin()

    def batches(self) -> Iterator[Batch]:
        """Drives the episode, one control period at a time; RunFailed as `together`."""
        for (batch,) in together((self,)):
            yield batch

    def can_go_ahead(self, tick: int) -> bool:
        """Returns whether what is due at a tick, and the driver, leave the period before it as it is."""
        is_planned = bool(self._planned) and _is_due(self._planned[0][0], tick)
        return not is_planned and self._sensors.can_read_early(self._driver.senses)

    def look_ahead(self, tick: int) -> None:
        """Reads what the driver looks at, at the end of a control period that is yet to be observed."""
        self._sensors.read_early(tick, self._driver.senses)

    def begin_period(self, tick: int) -> None:
        """Does what is planned up to a tick, and takes the driver's command."""
        self._act(tick)
        twist = self._faults.command(self._commanded(), self.simulation.time_ns)
        self._drive.command(twist)

    @property
    def looks_at_each_tick(self) -> bool:
        """Whether a sensor must see the ruts at the end of a tick within a control period."""
        return self.simulation.physics.bed is not None and self._sensors.sees_ground_between

    def begin_observing(self) -> None:
        """Takes over what was given for the control period that is observed next."""
        (self._goals, self._told), self._given = self._given, ([], [])

    def drive_wheels(self, ticks: int) -> None:
        """Commands the wheels for the next ticks."""
        self.simulation.command_ahead(self._drive.ahead(ticks))
        self._faults.act(self.simulation)

    def needs(self, index: int) -> bool:
        """Returns whether anybody looks at the state at the end of a tick, counted from 1."""
        return self._people is not None or self._sensors.needs(index)

    def observe(self, index: int) -> None:
        """Takes a tick that has just been simulated into account, counted from 1."""
        self._recorder.observe(self.simulation.now)
        samples = self._sensors.tick(index)
        if self._people is not None and self._people.due(index):
            samples += (self._people.read(),)
        if self._told:
            samples += (replace(self._told.pop(), stamp_ns=self.simulation.time_ns),)
        self._ticks.append(Tick(self.simulation.time_ns, samples))

    def end_period(self, *, is_last: bool) -> Batch:
        """Returns what has been since the last batch; after the last one no contact goes on."""
        events = self._recorder.events
        if is_last:
            events.close()
        ticks = tuple(self._ticks)
        self._ticks.clear()
        closed = events.take_closed()
        return Batch(ticks, self._recorder.truth(), closed, events.open, tuple(self._goals))

    def _beside_others(self, place: Place | None) -> Place | None:
        """Where there is room for the rover, which is there unless another one is in the way."""
        scene, physics = self.simulation.scene, self.simulation.physics
        x, y, yaw = scene.world.start if place is None else (place.x, place.y, place.yaw)
        others = (rover for rover in physics.rovers if rover.scene is not scene)
        taken = [(*rover.pose[:2].tolist(), rover.scene.rover.reach) for rover in others]
        if not overlaps((x, y, scene.rover.reach), taken):
            return place
        free = berth((x, y, yaw), scene.rover, taken, scene.world)
        return place if free is None else Place(*free)

    def _commanded(self) -> Twist:
        """What the driver wants; commands from elsewhere and of policies are taken as they are."""
        twist = self._driver.command(self._observe())
        if self._is_aborted:
            return Twist()
        if isinstance(self._driver, CmdVel | PolicyDriver):
            return twist
        return drivable(twist, self.simulation.scene.rover)

    def _act(self, tick: int) -> None:
        """Does what is planned up to a tick."""
        while self._planned and _is_due(self._planned[0][0], tick):
            _, act = self._planned.popleft()
            act()
        if self._course is not None:
            simulation, (x, y, _) = self.simulation, self.simulation.position
            time_s = simulation.time_ns / NANOSECONDS
            goal = self._course.next(time_s, (x, y), simulation.orientation)
            if goal is not None:
                self._give(goal)

    def _give(self, goal: Place) -> None:
        """Gives the driver its next goal, or tells it over a topic to who commands the rover."""
        if self._takes_goals:
            self.head_for(goal)
            return
        height, half = self.simulation.scene.world.ground.height_at(goal.x, goal.y), 0.5 * goal.yaw
        turned = (0.0, 0.0, math.sin(half), math.cos(half))
        self._given[1][:] = [GoalPose(0, (goal.x, goal.y, height), turned)]

    def _link(self, *, up: bool) -> None:
        self._is_linked = up

    def _abort(self) -> None:
        self._is_aborted = True

    def _resume(self) -> None:
        self._is_aborted = False
        self._give_again()

    def _give_again(self) -> None:
        """A new driver, or one that was held, is given the goal or way point that is in hand."""
        if self._course is not None:
            self._course.again()

    def _observe(self) -> Observation:
        simulation, (x, y, _) = self.simulation, self.simulation.position
        latest = self._sensors.latest
        scan = latest.get(LaserScan)
        ranges = scan.ranges if isinstance(scan, LaserScan) else None
        touches, time_ns = bool(self._hazard_contact[0]), simulation.time_ns - self._began_ns
        readings = {kind: latest[kind] for kind in self._driver.senses if kind in latest}
        return Observation(time_ns, x, y, simulation.yaw, ranges, touches, readings)


def _is_due(time_s: float, tick: int) -> bool:
    return round(time_s * NANOSECONDS) <= tick * TICK_NS


def episodes_of(
    run: Run, frame_options: FrameOptions | None = None, world: World | None = None
) -> tuple[Episode, ...]:
    """Returns the episodes of a run's rovers, which `together` drives.

    Args:
        run: All rovers but the first have a start.
        frame_options: As of an Episode.
        world: From a process that has built it; None to build it here.

    Raises:
        UsageError: A value is not valid, or two rovers would touch at the start.
    """
    made = enumerate(_simulated(run, world))
    return tuple(
        Episode(run, number, frame_options=frame_options, simulation=simulation)
        for number, simulation in made
    )


def _simulated(run: Run, world: World | None = None) -> tuple[Simulation, ...]:
    """The rovers of a run in its world, settled at their starts."""
    if world is None:
        check(run)
        check_world(run)
    scenes = build_scenes(*scenery(run, world), run.timestep)
    chosen = [scene for scene, rover in zip(scenes, run.rovers, strict=True) if rover.start is not None]
    for scene in chosen:
        check_room(scene, scenes)
    made = simulations(scenes, run.timestep_ns)
    for scene in chosen:
        check_start(scene, made[0].data)
    return made


def course_of(run: Run, number: int, world: World) -> RouteCourse | GoalCourse | None:
    """Returns what gives the goals of a rover: its route, or an area; None without either.

    Raises:
        UsageError: There is no free place in the area.
    """
    rover = run.rovers[number]
    if run.plan.route is not None and follows_route(rover.driver):
        return RouteCourse(route_progress(run, world))
    if rover.goal_area is None:
        return None
    reach = find_rover(rover.robot).reach
    space, rng = FreeSpace(world.ground, world.obstacles), generator(run.own_seed(number), GOALS)
    course = GoalCourse(rover.goal_area, space, reach, rng)
    course.draw()
    return course


def installed(
    run: Run,
    number: int,
    frames: RoverFrames,
    scene: Scene,
    surroundings: Surroundings,
    options: Given,
) -> Installation[Given]:
    """Returns what an optional sensor is made with; its randomness depends on seed and name alone.

    Args:
        run: Whose seed, noise and datum it has.
        number: The rover's place in the run.
        frames: The rover's, the sensor's own among them.
        scene: The rover in its world.
        surroundings: What the sensor's rays can meet.
        options: The sensor's.
    """
    preset = run.rovers[number].noise
    return Installation(
        options,
        mount=frames.mount(options.frame_id, scene.model, scene.prefix),
        rng=generator(run.own_seed(number), OPTIONAL_SENSORS, options.name),
        datum=Datum(*run.world.datum),
        surroundings=surroundings,
        noise=None if preset is None else PRESETS[preset],
    )


def sensor_noise(
    preset: str | None, seed: int, lidar: LidarSpec, shakes: tuple[Shake, ...] = ()
) -> SensorNoise | None:
    """Returns the noise of an episode, from its own generators; None without.

    Args:
        preset: Its name; None for sensors without errors.
        seed: Of the rover.
        lidar: Whose limits ranges have.
        shakes: What the surface that it drives on adds.
    """
    if preset is None and not shakes:
        return None
    _, scan_rng, imu_rng = generators(seed, 3)
    vibration = vibration_of(shakes, seed)
    limits = lidar.range_min, lidar.range_max
    chosen = EXACT if preset is None else PRESETS[preset]
    return SensorNoise(chosen, limits, scan_rng, imu_rng, vibration)


def vibration_of(shakes: tuple[Shake, ...], seed: int) -> "Vibration | None":
    """Returns what shakes an IMU, from its own generator; None where nothing does."""
    if not shakes:
        return None
    from harness.sensors.vibration import Vibration  # noqa: PLC0415 - it loads scipy's filters

    return Vibration(shakes, generator(seed, VIBRATION))


def generators(seed: int, count: int) -> list[np.random.Generator]:
    """Returns an episode's generators: of its driver, of its scans' noise, of its IMU's."""
    return [np.random.default_rng(child) for child in seeded(seed, EPISODE).spawn(count)]
