"""Who commands a rover of an episode: its driver, what is planned, goals, the link, faults of motors."""

import math
from bisect import insort
from collections import deque
from collections.abc import Callable, Mapping
from functools import partial
from operator import itemgetter
from weakref import WeakMethod

from harness.base.sim_time import NANOSECONDS, TICK, TICK_NS
from harness.base.streams import GOALS, generator
from harness.drivers import find_driver, takes_goals
from harness.drivers.base import Driver, DriverContext, Observation, TakesGoals, commanded, drivable
from harness.drivers.goal_course import GoalCourse
from harness.drivers.policy import PolicyDriver
from harness.drivers.route_course import RouteCourse
from harness.drivers.scripted import CmdVel
from harness.episode.assembly import actuator_faults, follows_route, route_progress
from harness.episode.helm import Order
from harness.episode.sensing import generators
from harness.physics.base_controller import base_controller
from harness.physics.scene import HAZARD_CONTACT
from harness.physics.simulation import Simulation
from harness.robots import find_rover
from harness.robots.lidar import LidarSpec
from harness.samples import GoalPose, LaserScan, Place, Sample, Twist
from harness.spec.run import Run
from harness.world.actors.free_space import FreeSpace
from harness.world.world import World

Latest = Mapping[type[Sample], Sample]
Act = Callable[["Pilot"], None]
Due = tuple[float, int, Act]  # when [s], its kind, what is done
RESET, LINK, ABORT, RESUME, DRIVER, COMMAND, GOAL = range(7)  # of one time in this order
IN_TIME = itemgetter(0, 1)


class Pilot:
    """Commands the wheels of a rover, one control period after the other.

    Args:
        run: What determines the episode.
        number: The rover's place in the run.
        simulation: The rover in its world.
        lidar: Whose scans the driver looks at.
        reset: Puts the rover back to its start, or to a place, where that is planned or ordered; weak,
            or the episode, which has the pilot, would outlive its run until garbage is collected.

    Attributes:
        senses: The samples that the driver looks at.
    """

    def __init__(
        self,
        run: Run,
        number: int,
        simulation: Simulation,
        lidar: LidarSpec,
        reset: WeakMethod[Callable[[Place | None], None]],
    ) -> None:
        self._run, self._number, self._simulation = run, number, simulation
        self._setup, rover = run.rovers[number], simulation.scene.rover
        self._bearings = lidar.bearings(rover.lidar_yaw)
        self._hazard_contact = simulation.summed(HAZARD_CONTACT)
        self._takes_goals = takes_goals(self._setup.driver)
        self._course = _course_of(run, number, simulation.scene.world)
        self._is_linked, self._is_aborted = True, False
        # For the next control period: the driver's goals, and those that are published.
        self._goals, self._goal_poses = list[Place](), list[GoalPose]()
        self._reset = reset
        self._planned = self._plan()
        self.begin()

    def _plan(self) -> deque[Due]:
        """What is planned, and when [s]; at the same time in this order."""
        plan = self._run.plan
        planned: list[Due] = [(t, RESET, partial(Pilot._put, place=None)) for t in plan.resets]
        for start, length in plan.link_losses:
            planned += [
                (start, LINK, partial(Pilot._link, up=False)),
                (start + length, LINK, partial(Pilot._link, up=True)),
            ]
        planned += [(t, ABORT, Pilot._abort) for t in plan.aborts]
        planned += [(t, RESUME, Pilot._resume) for t in plan.resumes]
        planned += [(t, DRIVER, partial(Pilot.hand_over, driver=driver)) for t, driver in plan.drivers]
        planned += [
            (t, COMMAND, partial(Pilot.command, twist=Twist(*twist), held=True))
            for t, *twist in plan.commands
        ]
        planned += [(t, GOAL, partial(Pilot.head_for, place=Place(*place))) for t, *place in plan.goals]
        return deque(sorted(planned, key=IN_TIME))

    def follow(self, order: Order) -> None:
        """Takes an order for the control period that begins now, as if planned last of its kind."""
        now = self._simulation.time_ns / NANOSECONDS
        acts: list[tuple[int, Act]] = []
        if order.reset:
            acts.append((RESET, partial(Pilot._put, place=order.place)))
        if order.driver is not None:
            acts.append((DRIVER, partial(Pilot.hand_over, driver=order.driver)))
        if order.command is not None:
            acts.append((COMMAND, partial(Pilot.command, twist=order.command, held=order.held)))
        if order.goal is not None:
            acts.append((GOAL, partial(Pilot.head_for, place=order.goal)))
        for kind, act in acts:
            insort(self._planned, (now, kind, act), key=IN_TIME)

    def begin(self) -> None:
        """Has a driver that has done nothing yet, at a rover that stands."""
        scene, (rng, *_) = self._simulation.scene, generators(self._run.own_seed(self._number))
        self._began_ns = self._simulation.time_ns
        self._base = base_controller(scene.rover, TICK)
        self._faults = actuator_faults(self._run, self._number)
        middle, half_size = scene.world.roaming
        seconds = self._setup.cmd_vel_timeout
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
            reach=math.inf if self._course is None else self._course.reach,
        )
        self.hand_over("")

    def hand_over(self, driver: str) -> None:
        """Lets the driver of that name drive from now on, anew; "" for the run's own."""
        self._driver: Driver = find_driver(driver or self._setup.driver)(self._context)
        self.senses = self._driver.senses
        self._give_again()

    def command(self, twist: Twist, *, held: bool = False) -> None:
        """Hands a command to the cmd_vel driver, unless the link is lost; others make their own.

        Args:
            twist: The command.
            held: Whether it holds until the next one whatever the rover's own time-out is; one that is
                asked for ends it all the same.
        """
        if isinstance(self._driver, CmdVel) and self._is_linked:
            self._driver.obey(twist, held=held and self._setup.cmd_vel_timeout is None)

    def head_for(self, place: Place) -> None:
        """Gives a driver that takes goals its next one; other drivers choose their own."""
        if isinstance(self._driver, TakesGoals):
            self._goals.append(place)
            self._driver.head_for(place.x, place.y, place.yaw)

    def has_plans(self, tick: int) -> bool:
        """Returns whether anything planned is due at a tick."""
        return bool(self._planned) and _is_due(self._planned[0][0], tick)

    def begin_period(self, tick: int, latest: Latest) -> None:
        """Does what is planned up to a tick, and takes the driver's command.

        Args:
            tick: At which the control period begins, counted from 0.
            latest: The last sample of each kind.
        """
        while self.has_plans(tick):
            *_, act = self._planned.popleft()
            act(self)
        if self._course is not None:
            simulation, (x, y, _) = self._simulation, self._simulation.position
            time_s = simulation.time_ns / NANOSECONDS
            goal = self._course.next(time_s, (x, y), simulation.orientation)
            if goal is not None:
                self._give(goal)
        self._base.command(self._faults.command(self._commanded(latest), self._simulation.time_ns))

    def take_given(self) -> tuple[list[Place], list[GoalPose]]:
        """Returns the goals given to the driver, and those to be published, since the last call."""
        given = self._goals, self._goal_poses
        self._goals, self._goal_poses = [], []
        return given

    def drive_wheels(self, ticks: int) -> None:
        """Commands the wheels for the next ticks."""
        self._simulation.command_ahead(self._base.ahead(ticks))
        self._faults.act(self._simulation)

    def _commanded(self, latest: Latest) -> Twist:
        """What the driver wants; commands from elsewhere and of policies are taken as they are."""
        twist = commanded(self._driver, self._observe(latest))
        if self._is_aborted:
            return Twist()
        if isinstance(self._driver, CmdVel | PolicyDriver):
            return twist
        return drivable(twist, self._simulation.scene.rover)

    def _observe(self, latest: Latest) -> Observation:
        simulation, (x, y, _) = self._simulation, self._simulation.position
        scan = latest.get(LaserScan)
        ranges = scan.ranges if isinstance(scan, LaserScan) else None
        touches, time_ns = bool(self._hazard_contact[0]), simulation.time_ns - self._began_ns
        readings = {kind: latest[kind] for kind in self.senses if kind in latest}
        return Observation(time_ns, x, y, simulation.yaw, ranges, touches, readings)

    def _give(self, goal: Place) -> None:
        """Gives the driver its next goal, or tells it over a topic to who commands the rover."""
        if self._takes_goals:
            self.head_for(goal)
            return
        ground, half = self._simulation.scene.world.ground, 0.5 * goal.yaw
        turned = (0.0, 0.0, math.sin(half), math.cos(half))
        self._goal_poses = [GoalPose(0, (goal.x, goal.y, ground.height_at(goal.x, goal.y)), turned)]

    def _put(self, place: Place | None) -> None:
        reset = self._reset()
        if reset is not None:
            reset(place)

    def _link(self, *, up: bool) -> None:
        self._is_linked = up

    def _abort(self) -> None:
        self._is_aborted = True

    def _resume(self) -> None:
        self._is_aborted = False
        self._give_again()

    def _give_again(self) -> None:
        """Gives the present goal or way point to a new driver, or to one that was held."""
        if self._course is not None:
            self._course.again()


def _is_due(time_s: float, tick: int) -> bool:
    return round(time_s * NANOSECONDS) <= tick * TICK_NS


def _course_of(run: Run, number: int, world: World) -> RouteCourse | GoalCourse | None:
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
