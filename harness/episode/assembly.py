"""A run becomes parts: the one place where names are looked up, and where a run's UsageErrors arise.

Each station checks its own part. Light to import: a command line is checked without MuJoCo and compiled
kernels.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache

from harness.base.errors import UsageError, find_named
from harness.base.made_of_files import Files, made_of_files
from harness.drivers import find_driver, goal_takers, takes_goals
from harness.drivers.encounters import StagedEncounter
from harness.faults.actuation import WHEEL, ActuatorFaults
from harness.faults.injector import FaultInjector
from harness.faults.lookup import find_faults
from harness.physics.berths import Member, berth
from harness.robots import RoverSpec, equipped, find_rover
from harness.sensors.choice import chosen
from harness.sensors.noise import PRESETS
from harness.sensors.table import SensorRow
from harness.spec.route import Route
from harness.spec.rover import CMD_VEL, RoverSetup, Start
from harness.spec.run import Run
from harness.spec.target import TargetSpec
from harness.spec.world import WorldSpec
from harness.world.actors.people import Pedestrian, of_terrain, pedestrians
from harness.world.files import check_terrain, file_world, files_beside, is_terrain_file
from harness.world.geodesy import Datum
from harness.world.grading import GradedMap, Limits, graded
from harness.world.route import RouteProgress, check_target, marks
from harness.world.soil_map import check_soil, soil_files, soils_on
from harness.world.targets.placing import target_names
from harness.world.world import RoverNeeds, World, build_world, starting_at, with_actors, with_targets
from rover_metrics.topics import ENERGY

SAME_GRAVITY = 0.1  # [m/s^2] of models for one world: Earth's is 9.78 to 9.83


def rover_of(setup: RoverSetup) -> RoverSpec:
    """Returns a rover of a run, with its motors and tyres there; UsageError if it has none such."""
    return equipped(find_rover(setup.robot), setup.actuators, setup.surface)


def check(run: Run) -> None:
    """Checks everything that can be checked without building the world; a UsageError names what fits."""
    for rover in run.rovers:
        rover_of(rover)
    check_terrain(run.world)
    check_soil(run.world.soil, run.world.terrain)
    people(run.world)
    target_names(run.world.targets)
    for rover in run.rovers:
        _check_rover(rover)
    _check_plan(run)


def check_world(run: Run) -> None:
    """Checks starts, goals, people, targets, what drivers meet in the world, built where it matters."""
    for rover in run.rovers:
        driver = find_driver(rover.driver)
        if issubclass(driver, StagedEncounter):
            world = world_of(run)
            try:
                middle, half_size = world.roaming
                driver.hazards(world.obstacles, half_size, middle)
            except UsageError as error:
                raise UsageError(f"driver '{rover.driver}' on {run.world.terrain}: {error}") from error
        elif rover.start is not None or people(run.world) or run.world.targets:
            world = world_of(run)
            if rover is not run.rover and rover.start is not None:
                starting_at(world, rover.start)
    if run.plan.goals or run.plan.route is not None:
        _check_places(run, world_of(run))


def _check_places(run: Run, world: World) -> None:
    for _, x, y, _ in run.plan.goals:
        world.ground.check_place("goal", x, y, 0.0)
    if run.plan.route is not None:
        for mark in marks(run.plan.route, world.targets, Datum(*run.world.datum)):
            world.ground.check_place("route: way point", *mark.place, margin=0.0)


def world_of(run: Run) -> World:
    """Returns the world, built once and then shared; a UsageError says why there can be none."""
    world = _terrain_world(run)
    if run.world.soil:
        spec = run.world
        world = _of_soil(world, spec.soil, spec.terrain, spec.keep_ruts)
    targets = run.world.targets
    if targets:
        world = _marked(world, run.rover.start, targets, Datum(*run.world.datum))
    return _peopled(world, run.rover.start, people(run.world))


def people(world: WorldSpec) -> tuple[Pedestrian, ...]:
    """Returns who walks, before there is a world: the actors of an SDF world, then those asked for."""
    return pedestrians(
        (*of_terrain(world.terrain, world.resource_path), *world.actors), world.resource_path
    )


def graded_world(run: Run, number: int = 0) -> GradedMap:
    """Returns the world of a run, graded for one of its rovers."""
    from harness.robots.model import tip_limit  # noqa: PLC0415 - loads MuJoCo

    rover = find_rover(run.rovers[number].robot)
    span = max(rover.length, rover.width)
    limits = Limits(rover.slope_limit, rover.step_limit, tip_limit(rover), span)
    return _graded(world_of(run), limits)


def follows_route(driver: str) -> bool:
    """Returns whether a driver takes the way points of a route, or is cmd_vel, whose commander does."""
    return takes_goals(driver) or driver == CMD_VEL


def route_progress(run: Run, world: World | None = None) -> RouteProgress:
    """Returns the progress on a run's route, not begun yet; UsageError if a point names no target."""
    route, world = run.plan.route, world_of(run) if world is None else world
    if route is None:
        return RouteProgress(())
    limit = math.inf if route.limit is None else route.limit
    places = marks(route, world.targets, Datum(*run.world.datum))
    return RouteProgress(places, any_order=route.order == "any", limit=limit)


def actor_names(world: WorldSpec) -> tuple[str, ...]:
    """Returns the names of the people as their topics and columns have them: NAME_actor."""
    return tuple(person.full_name for person in people(world))


def sensor_rows(rover: RoverSetup) -> tuple[SensorRow, ...]:
    """Returns the sensors that a rover carries, in publishing order."""
    rows, noise = chosen(find_rover(rover.robot), rover.sensors), PRESETS.get(rover.noise or "")
    return tuple(replace(row, noise=noise) for row in rows)


def tells_energy(rover: RoverSetup) -> bool:
    """Returns whether a rover carries the battery that the columns of energy are made of."""
    topics = (f"/{topic.name}" for row in sensor_rows(rover) for topic in row.topics)
    return any(topic == source.name for topic in topics for source in ENERGY)


def gravity(run: Run) -> float:
    """Returns what IMUs read at rest [m/s^2]: of a world that says so, else of its first rover."""
    of_world = _terrain_world(run).gravity if is_terrain_file(run.world.terrain) else None
    of_models = {rover.robot: find_rover(rover.robot).gravity for rover in run.rovers}
    if of_world is None and max(of_models.values()) - min(of_models.values()) > SAME_GRAVITY:
        each = ", ".join(f"{robot} {value:g}" for robot, value in of_models.items())
        raise UsageError(f"rovers of one world have one gravity, not {each} m/s2; mend their models")
    return next(iter(of_models.values())) if of_world is None else of_world


def injector(run: Run, number: int = 0) -> FaultInjector:
    """Returns the faults of a rover."""
    rover = run.rovers[number]
    rows = sensor_rows(rover)
    return FaultInjector(find_faults(rover.faults, rows), run.own_seed(number), rows, run.seed)


def actuator_faults(run: Run, number: int) -> ActuatorFaults:
    """Returns what goes wrong between the commands and the wheels of a rover."""
    rover = run.rovers[number]
    return ActuatorFaults(find_faults(rover.faults, sensor_rows(rover)), run.own_seed(number))


def scenery(run: Run) -> tuple[World, tuple[Member, ...]]:
    """Returns the world of a run, and who starts where in it."""
    world = world_of(run)
    starts = [world.start if r.start is None else starting_at(world, r.start).start for r in run.rovers]
    return world, tuple(
        Member(rover.name, rover_of(rover), start)
        for rover, start in zip(run.rovers, starts, strict=True)
    )


def fleet(run: Run, rovers: tuple[RoverSetup, ...]) -> Run:
    """Returns a run with these rovers, checked and placed; a goal area is for those who take goals."""
    for rover in rovers:
        find_rover(rover.robot)
    if any(takes_goals(rover.driver) for rover in rovers):
        rovers = tuple(r if takes_goals(r.driver) else r.but(goal_area=None) for r in rovers)
    several = run.but(rovers=rovers)
    check(several)
    gravity(several)
    return placed(several)


def placed(run: Run) -> Run:
    """Returns the run with a start for each further rover: beside the first where none is given."""
    if all(rover.start is not None for rover in run.rovers[1:]):
        return run
    world = world_of(run)
    models = [find_rover(rover.robot) for rover in run.rovers]
    starts: list[Start | None] = [world.start, *(rover.start for rover in run.rovers[1:])]
    for number, model in enumerate(models):
        if starts[number] is None:
            starts[number] = berth(world.start, model, _taken(starts, models), world)
        if starts[number] is None:
            name = run.rovers[number].name
            raise UsageError(
                f"there is no room for {name} near the start of {run.rover.name}; "
                f"give it one: --rover ROBOT:{name},x=X,y=Y"
            )
    others = (rover.but(start=start) for rover, start in zip(run.rovers[1:], starts[1:], strict=True))
    return run.but(rovers=(run.rover, *others))


def _taken(
    starts: Sequence[Start | None], models: Sequence[RoverSpec]
) -> list[tuple[float, float, float]]:
    return [
        (start[0], start[1], model.reach)
        for start, model in zip(starts, models, strict=True)
        if start is not None
    ]


_graded = lru_cache(maxsize=1)(graded)
_named_world = lru_cache(maxsize=2)(build_world)  # a run asks for its own up to four times


@made_of_files(2)
def _file_world(spec: WorldSpec, rover: RoverNeeds, seed: int) -> tuple[World, Files]:
    world = file_world(spec, rover, seed)
    return world, (spec.terrain, *files_beside(spec.terrain), *(file for file, _ in world.files))


@made_of_files(2)
def _of_soil(world: World, soil: str, terrain: str, keeps_ruts: bool) -> tuple[World, Files]:
    soils = soils_on(soil, world.ground, terrain)
    return replace(world, soil=replace(soils, keeps_ruts=keeps_ruts)), soil_files(soil)


@lru_cache(maxsize=2)  # of a long way, each step is looked at
def _peopled(world: World, start: Start | None, who: tuple[Pedestrian, ...]) -> World:
    world = world if start is None else starting_at(world, start)
    return with_actors(world, who) if who else world


@made_of_files(2)
def _marked(
    world: World, start: Start | None, targets: tuple[TargetSpec, ...], datum: Datum
) -> tuple[World, Files]:
    world = world if start is None else starting_at(world, start)
    return with_targets(world, targets, datum), [file for target in targets for file in target.files]


def _terrain_world(run: Run) -> World:
    if not is_terrain_file(run.world.terrain):
        return _named_world(run.world.terrain, run.seed, run.world.difficulty)
    rover = find_rover(run.rover.robot)
    sizes = rover.clearance, rover.step_limit, rover.wheel_radius
    needs = RoverNeeds(*sizes, needs_start=run.rover.start is None)
    return _file_world(run.world, needs, run.seed)


def _check_rover(rover: RoverSetup) -> None:
    find_driver(rover.driver)
    if rover.noise is not None:
        find_named("noise preset", rover.noise, PRESETS)
    equipped_rover, rows = rover_of(rover), sensor_rows(rover)
    for row in rows:
        if row.given is not None:
            row.given.check(equipped_rover)
    drive, names = equipped_rover.drive, equipped_rover.wheel_names
    joints = zip(names, equipped_rover.wheel_joints, strict=True)
    wheels = [name for name, joint in joints if joint in drive.driven]
    for fault in find_faults(rover.faults, rows):
        if fault.sensor.startswith(WHEEL) and fault.sensor.removeprefix(WHEEL) not in wheels:
            named = ", ".join(WHEEL + wheel for wheel in wheels)
            raise UsageError(f"there is no '{fault.sensor}'; available: {named}")
    if rover.goal_area is not None and not takes_goals(rover.driver):
        raise UsageError(f"a goal area needs a driver that takes goals; give one of: {goal_takers()}")
    if rover.cmd_vel_timeout is not None and rover.driver != CMD_VEL:
        raise UsageError("--cmd-vel-timeout is for --driver cmd_vel only; other drivers go on")


def _check_plan(run: Run) -> None:
    later = [driver for _, driver in run.plan.drivers if driver]
    drivers = [*(rover.driver for rover in run.rovers), *later]
    commands = run.plan.commands and CMD_VEL not in drivers
    if commands or (run.plan.goals and not any(map(takes_goals, drivers))):
        raise UsageError(
            f"driver '{run.rover.driver}' takes no commands or goals; "
            f"this needs driver '{CMD_VEL if commands else 'goal'}'"
        )
    if run.plan.route is not None:
        _check_route(run, run.plan.route)
    if run.plan.goals and any(rover.goal_area is not None for rover in run.rovers):
        raise UsageError("a goal area gives goals by itself: leave out the goals")


def _check_route(run: Run, route: Route) -> None:
    for point in route.points:
        if point.target:
            check_target(point.target, target_names(run.world.targets))
    if not any(follows_route(rover.driver) for rover in run.rovers):
        raise UsageError(
            f"driver '{run.rover.driver}' follows no route; give one of: {goal_takers()}, or "
            f"{CMD_VEL} with a node that takes /goal_pose"
        )
    if run.plan.goals or any(rover.goal_area is not None for rover in run.rovers):
        raise UsageError("a route gives goals by itself: leave out goals and goal areas")
