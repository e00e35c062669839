"""An environment on the page of `--live`: its steps wait for real time, or while it is paused."""

import numpy as np

from harness.base.interrupt import StopRequest
from harness.base.sim_time import CONTROL_PERIOD_NS
from harness.episode.helm import Helm
from harness.gym.course import Course
from harness.gym.driven_rover import DrivenRover
from harness.samples import LaserScan, Place, Truth
from harness.spec.live import LiveOptions
from harness.view.live.page import LivePage
from harness.view.live.watch import Sight


class LiveView:
    """Shows the episodes of one environment; a page per world, at the same address where that is free.

    Raises:
        UsageError: viser is missing.
    """

    def __init__(self) -> None:
        self._helm = Helm(1.0, StopRequest())
        self._course: Course | None = None
        self._goal: tuple[float, float] | None = None  # that is marked
        self._page: LivePage | None = None

    def draw(self, course: Course, driven: DrivenRover, goal: tuple[float, float], steps: int) -> None:
        """Shows a state, and waits as long as the page's speed says.

        Args:
            course: The world.
            driven: The rover.
            goal: In the world [m].
            steps: Control periods since the episode began.
        """
        if course is not self._course or self._page is None:
            self.close()
            self._page = LivePage(course.run, self._helm, LiveOptions().served(), steered=False)
            self._course, self._goal = course, None
            print(f"live: {self._page.address}", flush=True)
        (watch,), simulation = self._page.observers, driven.simulation
        if not steps:
            watch.path = []
            self._helm.begin()
        if goal != self._goal:  # one that is reached may be followed by another
            self._goal = goal
            self._page.mark(Place(*goal, 0.0))
        scan = driven.readings.get(LaserScan)
        x, y, z, w = simulation.orientation
        joints = tuple(simulation.data.qpos[self._joints(driven)].tolist())
        sight = Sight(simulation.position, (w, x, y, z), joints)
        ranges = scan.ranges if isinstance(scan, LaserScan) else None
        if (crowd := simulation.crowd) is not None:
            people = zip(crowd.positions(), crowd.places, strict=True)
            watch.people = np.array([(*middle, place.yaw) for middle, place in people])
        watch.see(sight, Truth(steps * CONTROL_PERIOD_NS), ranges)
        self._helm.go_on(steps * CONTROL_PERIOD_NS)

    def close(self) -> None:
        """Takes the page away."""
        if self._page is not None:
            self._page.close()
        self._page = None

    @staticmethod
    def _joints(driven: DrivenRover) -> list[int]:
        scene = driven.simulation.scene
        return [int(scene.model.joint(n).qposadr[0]) for n in scene.all_own(scene.rover.joints)]
