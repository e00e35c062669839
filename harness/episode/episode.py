"""One seeded drive in one world: world + rover + driver + sensors -> a stream of ticks and truth.

No ROS and no wall clock: the same configuration gives the same stream, bit for bit. Consumers take it
in batches of one control period, by `Together` or, if rovers are ordered to do something meanwhile, from
harness.episode.stream. Rovers that share a world have an episode each, and are driven together; one
alone is a fleet of one.
"""

from collections.abc import Collection, Iterator
from dataclasses import replace
from functools import partial
from weakref import WeakMethod

from harness.episode.assembly import check, check_world, scenery, sensor_rows
from harness.episode.batch import Batch, EpisodeInfo
from harness.episode.pilot import Pilot
from harness.episode.sensing import installed, sensor_noise
from harness.episode.together import Together
from harness.physics.aside import Errand
from harness.physics.berths import berth, overlaps
from harness.physics.scene import build_scenes
from harness.physics.simulation import Simulation, simulations
from harness.physics.start import check_room, check_start
from harness.physics.truth.recorder import TruthRecorder
from harness.robots.content import model_hash
from harness.robots.frames.rover_frames import rover_frames
from harness.robots.lidar import LidarSpec
from harness.samples import ActorPoses, GoalPose, Imu, Place, Sample, Tick, Twist
from harness.sensors.base import EpisodeParts
from harness.sensors.lidar import Lidar
from harness.sensors.state import PeopleSensor
from harness.sensors.suite import SensorSuite
from harness.sensors.transforms import describe
from harness.spec.ros import FrameOptions
from harness.spec.run import Run
from harness.world.world import terrain_hash


class Episode:
    """Builds the world on construction; `batches` then drives it once from start to end.

    For several rovers in a world, `episodes_of` makes the episodes and `Together` drives them.

    Args:
        run: What determines it.
        number: The rover's place in the run.
        frame_options: Which transforms are among its samples; None for none at all.
        samples: Those that anybody wants, whatever drives the rover included; None for all. The drive
            is the same without the others.
        simulation: The rover, in a world with others; None for one that is alone.

    Attributes:
        description: What the transforms are of; None without them.
        pilot: Commands the rover.
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
        lidar_spec = LidarSpec(beams=self.setup.lidar_beams)
        lidar = Lidar(scene.model, lidar_spec, scene.own("lidar"), scene.others())
        parts = EpisodeParts(simulation=self.simulation, lidar=lidar, recorder=self._recorder)
        self.description = install = None
        rows = sensor_rows(self.setup)
        optional = [row.given for row in rows if row.given is not None]
        if frame_options is not None or optional:
            frames = rover_frames(rover, (frame for some in optional for frame in some.frames(rover)))
            install = partial(installed, run, number, frames, scene, lidar.surroundings)
        if frame_options is not None:
            self.description = describe(frames, frame_options)
            parts = replace(parts, frames=frames, frame_options=frame_options)
        noise = sensor_noise(self.setup.noise, run.own_seed(number), lidar_spec, rover.vibration)
        rates: dict[type[Sample], int] = {Imu: self.setup.imu_rate}
        self._sensors = SensorSuite(
            parts, rover, rates, wanted=samples, noise=noise, rows=rows, install=install
        )
        crowd, are_sampled = self.simulation.crowd, samples is None or ActorPoses in samples
        self._people = (
            PeopleSensor(self.simulation, crowd) if crowd is not None and are_sampled else None
        )
        self._ticks: list[Tick] = []  # since the last batch
        self._goals, self._goal_poses = list[Place](), list[GoalPose]()  # that come with this batch
        self.pilot = Pilot(run, number, self.simulation, lidar_spec, WeakMethod(self.reset))

    def command(self, twist: Twist, *, held: bool = False) -> None:
        """Hands a command to the cmd_vel driver, as `Pilot.command`."""
        self.pilot.command(twist, held=held)

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
        self.pilot.begin()

    def batches(self) -> Iterator[Batch]:
        """Drives the episode, one control period at a time; RunFailed as `Together`."""
        for (batch,) in Together((self,)).batches():
            yield batch

    def can_go_ahead(self, tick: int) -> bool:
        """Returns whether what is due at a tick, and the driver, leave the period before it as it is."""
        return not self.pilot.has_plans(tick) and self._sensors.can_read_early(self.pilot.senses)

    def look_ahead(self, tick: int) -> None:
        """Reads what the driver looks at, at the end of a control period that is yet to be observed."""
        self._sensors.read_early(tick, self.pilot.senses)

    def errands(self, tick: int) -> list[Errand]:
        """Returns what the driver looks at, at a later tick, that another thread can read by then."""
        return self._sensors.errands(tick, self.pilot.senses)

    def begin_period(self, tick: int) -> None:
        """Has the rover commanded for the control period that begins at a tick."""
        self.pilot.begin_period(tick, self._sensors.latest)

    @property
    def looks_at_each_tick(self) -> bool:
        """Whether a sensor must see the ruts at the end of a tick within a control period."""
        return self.simulation.physics.bed is not None and self._sensors.sees_ground_between

    def begin_observing(self) -> None:
        """Takes over what was given for the control period that is observed next."""
        self._goals, self._goal_poses = self.pilot.take_given()

    def needs(self, index: int) -> bool:
        """Returns whether anybody looks at the state at the end of a tick, counted from 1."""
        return self._people is not None or self._sensors.needs(index)

    def observe(self, index: int) -> None:
        """Takes a tick that has just been simulated into account, counted from 1."""
        self._recorder.observe(self.simulation.now)
        samples = self._sensors.tick(index)
        if self._people is not None and self._people.due(index):
            samples += (self._people.read(),)
        if self._goal_poses:
            samples += (replace(self._goal_poses.pop(), stamp_ns=self.simulation.time_ns),)
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


def episodes_of(run: Run, frame_options: FrameOptions | None = None) -> tuple[Episode, ...]:
    """Returns the episodes of a run's rovers, which `Together` drives.

    Args:
        run: All rovers but the first have a start.
        frame_options: As of an Episode.

    Raises:
        UsageError: A value is not valid, or two rovers would touch at the start.
    """
    made = enumerate(_simulated(run))
    return tuple(
        Episode(run, number, frame_options=frame_options, simulation=simulation)
        for number, simulation in made
    )


def _simulated(run: Run) -> tuple[Simulation, ...]:
    """The rovers of a run in its world, settled at their starts."""
    check(run)
    check_world(run)
    scenes = build_scenes(*scenery(run), run.timestep)
    chosen = [scene for scene, rover in zip(scenes, run.rovers, strict=True) if rover.start is not None]
    for scene in chosen:
        check_room(scene, scenes)
    made = simulations(scenes, run.timestep_ns)
    for scene in chosen:
        check_start(scene, made[0].data)
    return made
