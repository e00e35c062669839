"""What determines an episode: values, no physics.

Light to import: the process that only publishes an episode needs neither MuJoCo nor compiled kernels.
"""

import math
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path

import numpy as np

from harness.base.errors import UsageError, find_named
from harness.base.files import modified_ns
from harness.base.sim_time import (
    CONTROL_PERIOD_NS,
    DEFAULT_TIMESTEP_NS,
    NANOSECONDS,
    TICK_NS,
    check_duration,
    parse_timestep,
    period_ticks,
)
from harness.drivers import find_driver, takes_goals
from harness.drivers.goal_course import Area, check_area
from harness.drivers.staged import StagedEncounter
from harness.faults.spec import parse_faults
from harness.frames.options import FrameOptions
from harness.robots import find_rover
from harness.sensors.choice import chosen
from harness.sensors.geodesy import DEFAULT_DATUM, Datum
from harness.sensors.noise import PRESETS
from harness.sensors.table import SensorRow
from harness.world.actors.actor import with_actors
from harness.world.actors.spec import ActorSpec, of_terrain, parse_actors
from harness.world.files import file_world
from harness.world.terrain_file import TerrainFile, is_terrain_file
from harness.world.terrains import TERRAINS
from harness.world.world import (
    DEFAULT_DIFFICULTY,
    Start,
    World,
    build_world,
    check_start,
    starting_at,
)

CMD_VEL_TYPES = ("auto", "twist", "stamped")
LIDAR_BEAMS, IMU_RATE = 640, 20
LISTS = (  # the fields that are tuples
    *("terrain_size", "datum", "start", "sensors", "faults", "commands", "goals", "resets"),
    *("resource_path", "rock", "hazard", "actors", "goal_area"),
)
FLEET_STREAM = 13  # keeps the randomness of several rovers apart
CMD_VEL = "cmd_vel"  # the driver that obeys commands
TICKS_PER_CONTROL = CONTROL_PERIOD_NS // TICK_NS
FILE_OPTIONS = (  # for terrains from files alone
    *("terrain_size", "terrain_height", "terrain_cell", "resource_path", "mesh_unit", "mesh_up"),
    *("rock_height", "rock", "hazard"),
)
FEWEST_BEAMS, MOST_BEAMS = 2, 100_000


_world = lru_cache(maxsize=2)(build_world)  # a run asks for its own up to four times


@lru_cache(maxsize=2)
def _file_world(file: TerrainFile, seed: int, _modified_ns: int) -> World:
    return file_world(file, seed)


@lru_cache(maxsize=2)  # of a long way, each step is looked at
def _peopled(world: World, start: Start | None, people: tuple[ActorSpec, ...]) -> World:
    world = world if start is None else starting_at(world, start)
    return with_actors(world, people) if people else world


@dataclass(frozen=True, kw_only=True)
class EpisodeConfig:
    """Everything that determines an episode; checked by `validate`."""

    terrain: str = "rocky"
    robot: str = "leo"
    seed: int = 0
    duration: float = 60.0
    driver: str = "wander"
    difficulty: float = DEFAULT_DIFFICULTY
    terrain_size: tuple[float, float] | None = None  # [m] along x and y, of a terrain from a file
    terrain_height: float | None = None  # [m] of relief, likewise
    datum: tuple[float, float, float] = DEFAULT_DATUM  # of the origin: lat., lon. [deg], altitude [m]
    terrain_cell: float | None = None  # [m] between the vertices that a mesh becomes
    resource_path: tuple[str, ...] = ()  # folders in which an SDF world's models and meshes are
    mesh_unit: str = ""  # of meshes: m, cm, mm...; as their files say
    mesh_up: str = ""  # their axis that is up, likewise
    rock_height: float | None = None  # [m] up to which an obstacle of a file is a rock; the clearance
    rock: tuple[str, ...] = ()  # patterns of names that are rocks whatever their height
    hazard: tuple[str, ...] = ()  # likewise
    start: Start | None = None  # x, y [m], yaw [rad] in the world; None: where the terrain has it
    timestep: float = DEFAULT_TIMESTEP_NS / NANOSECONDS
    noise: str | None = None  # a preset's name; None for exact sensors
    lidar_beams: int = LIDAR_BEAMS
    imu_rate: int = IMU_RATE
    sensors: tuple[str, ...] | None = None  # optional ones: NAME or NAME=PRESET; None: of rover.yaml
    cmd_vel_timeout: float | None = None  # [s] of simulation time after which a command ends
    faults: tuple[str, ...] = ()  # on the way to listeners; the episode itself does not see them
    commands: tuple[tuple[float, float, float], ...] = ()  # to driver cmd_vel: when [s], m/s, rad/s
    goal_area: Area | None = None  # x from, to, y from, to [m]: one random goal in it after another
    actors: tuple[str, ...] = ()  # people, as harness.world.actors.spec reads them
    goals: tuple[tuple[float, float, float, float], ...] = ()  # to driver goal: when [s], x, y, yaw
    resets: tuple[float, ...] = ()  # when the rover is put back to its start [s]
    name: str = ""  # of the rover among several (harness.episode.fleet)
    number: int = 0  # its place among them
    world_robot: str = ""  # whose clearance sorts the obstacles of a file, if not its own

    def __post_init__(self) -> None:
        """Takes lists for tuples, as JSON gives them back."""
        for name in LISTS:
            if isinstance(value := getattr(self, name), list):
                inner = (tuple(v) if isinstance(v, list) else v for v in value)
                object.__setattr__(self, name, tuple(inner))

    @property
    def total_ticks(self) -> int:
        """Clock ticks from start to end."""
        return round(self.duration * NANOSECONDS) // TICK_NS

    @property
    def total_periods(self) -> int:
        """Control periods from start to end, which is how many batches there are."""
        return math.ceil(self.total_ticks / TICKS_PER_CONTROL)

    @property
    def people(self) -> tuple[str, ...]:
        """Who walks, in words: the actors of an SDF world, then those asked for."""
        return (*of_terrain(self.terrain, self.resource_path), *self.actors)

    def actor_specs(self) -> tuple[ActorSpec, ...]:
        """Returns who walks, before there is a world.

        Raises:
            UsageError: One of them is not valid.
        """
        return parse_actors(self.people, self.resource_path)

    def actor_names(self) -> tuple[str, ...]:
        """Returns the names of the people as their topics and columns have them: NAME_actor.

        Raises:
            UsageError: As `actor_specs`.
        """
        return tuple(spec.full_name for spec in self.actor_specs())

    @property
    def own_seed(self) -> int:
        """The seed of what is random about this rover; of a single one and of the first, `seed`."""
        if self.number == 0:
            return self.seed
        source = np.random.SeedSequence(self.seed, spawn_key=(FLEET_STREAM, self.number))
        return int.from_bytes(source.generate_state(4).tobytes(), "little")

    def sensor_rows(self) -> tuple[SensorRow, ...]:
        """Returns the sensors that the rover carries, in publishing order.

        Raises:
            UsageError: One of the optional ones does not exist or is not valid.
        """
        return chosen(find_rover(self.robot), self.sensors)

    def world(self) -> World:
        """Returns the world, which is built once and then shared: nobody changes one.

        Raises:
            UsageError: The terrain's file is not usable, the start is off the map, or no person can
                walk so.
        """
        return _peopled(self._terrain_world(), self.start, self.actor_specs())

    def gravity(self) -> float:
        """Returns what the IMU reads at rest [m/s^2]: of a world that says so, else of the model.

        Raises:
            UsageError: The terrain's file is not usable.
        """
        told = self._terrain_world().gravity if is_terrain_file(self.terrain) else None
        return find_rover(self.robot).gravity if told is None else told

    def check_world(self) -> None:
        """Checks what depends on the world, which is built only where something does.

        Raises:
            UsageError: The start is off the map, no person can walk so, or there is nothing for the
                driver to meet.
        """
        driver = find_driver(self.driver)
        if issubclass(driver, StagedEncounter):
            world = self.world()
            try:
                middle, half_size = world.roaming
                driver.hazards(world.obstacles, half_size, middle)
            except UsageError as error:
                raise UsageError(f"driver '{self.driver}' on {self.terrain}: {error}") from error
        elif self.start is not None or self.people:
            self.world()

    def _terrain_world(self) -> World:
        if not is_terrain_file(self.terrain):
            return _world(self.terrain, self.seed, self.difficulty)
        file = self._terrain_file()
        return _file_world(file, self.seed, modified_ns(file.path))

    def _terrain_file(self) -> TerrainFile:
        return TerrainFile(
            path=Path(self.terrain),
            size=self.terrain_size,
            relief=self.terrain_height,
            needs_start=self.start is None,
            folders=tuple(map(Path, self.resource_path)),
            cell=self.terrain_cell,
            mesh_unit=self.mesh_unit,
            mesh_up=self.mesh_up,
            rock_height=self.rock_height,
            rocks=self.rock,
            hazards=self.hazard,
            clearance=(rover := find_rover(self.world_robot or self.robot)).clearance,
            step_limit=rover.step_limit,
        )

    def _validate_terrain(self) -> None:
        find_rover(self.robot)
        if is_terrain_file(self.terrain):
            self._terrain_file().check()
            if self.difficulty != DEFAULT_DIFFICULTY:
                raise UsageError("a terrain from a file has no difficulty; leave out --difficulty")
            return
        find_named("terrain", self.terrain, TERRAINS)
        for name in FILE_OPTIONS:
            if getattr(self, name) not in (None, (), ""):
                raise UsageError(
                    f"--{name.replace('_', '-')} applies to terrains from files only; leave it out"
                )

    def _validate_plan(self) -> None:
        told = (*self.commands, *self.goals)
        plans = (
            (self.commands, self.driver == CMD_VEL, CMD_VEL),
            (self.goals, takes_goals(self.driver), "goal"),
        )
        for what, heeds, driver in plans:
            if what and not heeds:
                raise UsageError(f"driver '{self.driver}' is told nothing; this needs driver '{driver}'")
        if self.goal_area is not None:
            check_area(self.goal_area)
            if self.goals or not takes_goals(self.driver):
                needed = "leave out the goals" if self.goals else "it needs driver 'goal' or a policy"
                raise UsageError(f"a goal area gives goals by itself: {needed}")
        if not all(math.isfinite(value) for _, *values in told for value in values):
            raise UsageError("a command or goal is not valid; give finite numbers")
        for time_s in (*(time_s for time_s, *_ in told), *self.resets):
            if not 0.0 <= time_s < self.duration:
                raise UsageError(f"an event at {time_s:g} s is not in the run of {self.duration:g} s")

    def _validate_faults(self) -> None:
        parsed = parse_faults(self.faults, self.sensor_rows())
        for spec, fault in zip(self.faults, parsed, strict=True):
            if fault.start_ns > self.total_ticks * TICK_NS:
                raise UsageError(
                    f"fault '{spec}' begins after the end of the run at {self.duration:g} s; "
                    "begin it earlier, or give a longer --duration"
                )

    def _validate_timeout(self) -> None:
        timeout = self.cmd_vel_timeout
        if timeout is None:
            return
        if not CONTROL_PERIOD_NS / NANOSECONDS <= timeout < math.inf:
            raise UsageError(f"command timeout {timeout:g} s is not valid; give 0.05 or more")
        if self.driver != CMD_VEL:
            raise UsageError("--cmd-vel-timeout is for --driver cmd_vel only; other drivers go on")

    def validate(self) -> None:
        """Checks every value that can be checked without building the world.

        Raises:
            UsageError: A value is not valid; the message names those that are.
        """
        self._validate_terrain()
        Datum(*self.datum).check()
        find_driver(self.driver)
        parse_timestep(self.timestep)
        period_ticks(self.imu_rate)
        if self.noise is not None:
            find_named("noise preset", self.noise, PRESETS)
        check_duration(self.duration)
        self._validate_plan()
        self._validate_faults()
        self.actor_specs()
        self._validate_timeout()
        if self.start is not None:
            check_start(self.start)
        if self.seed < 0:
            raise UsageError(f"seed {self.seed} is not valid; give a whole number from 0 up")
        if not 0.0 <= self.difficulty <= 1.0:
            raise UsageError(f"difficulty {self.difficulty:g} is not valid; give 0 to 1")
        if not FEWEST_BEAMS <= self.lidar_beams <= MOST_BEAMS:
            raise UsageError(
                f"{self.lidar_beams} lidar beams are not valid; give {FEWEST_BEAMS} to {MOST_BEAMS}"
            )


@dataclass(frozen=True, kw_only=True)
class RosOptions:
    """How a run goes through ROS.

    Attributes:
        log_dir: Folder for the metrics CSV.
        host_metrics: Whether to run a MetricsNode in this process.
        wait_for: Names of nodes elsewhere to keep in lock-step.
        rate: Simulated seconds per wall second; None is as fast as possible.
        ros_args: Arguments from `--ros-args` on.
        cmd_vel: How commands come; one of CMD_VEL_TYPES.
        record: MCAP file to record every message into.
        overwrite: Whether that file may exist.
        frames: Which transforms are published.
    """

    log_dir: Path
    host_metrics: bool = True
    wait_for: tuple[str, ...] = ()
    rate: float | None = None
    ros_args: tuple[str, ...] = ()
    cmd_vel: str = "auto"
    record: Path | None = None
    overwrite: bool = False
    frames: FrameOptions = field(default_factory=FrameOptions)
