"""What a navigation stack asks of a simulator: /map, /initialpose and /goal_pose.

/map is the world's truth for this rover (harness.world.occupancy), latched; it is made when somebody
listens or records. /initialpose puts the rover there, as Nav2's loopback simulator does, and
/goal_pose is for the driver `goal`; the bridge publishes it where a route is driven over /cmd_vel. Map,
odom and world are one frame here: the rover starts at their origin.
"""

import math
from collections.abc import Callable
from functools import cached_property, partial
from typing import Any

from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped

from harness import samples
from harness.base.sim_time import NANOSECONDS
from harness.drivers import takes_goals
from harness.episode.assembly import graded_world, world_of
from harness.episode.maps import GRADED, MAP, graded_bytes, occupancy_bytes
from harness.episode.stream import RoverOrders
from harness.robots import find_rover
from harness.ros.bridge import Bridge
from harness.ros.channel import Channel, open_channel
from harness.samples import Place
from harness.spec.run import Run
from harness.world.heightfield import EDGE_MARGIN
from harness.world.occupancy import OccupancyMap, occupancy
from rover_metrics.core import rotation
from rover_metrics.errors import shown
from rover_metrics.topics import quaternion

FRAMES = ("map", "odom", "world")


class Navigation:
    """Serves the three topics.

    Args:
        bridge: The node that does.
        run: What is driven.
        number: The rover's place in the run.
        source: Gets what is ordered of the rover.
        truth_map: Whether there is /map/truth too.

    Attributes:
        map: /map.
        graded: /map/truth, if it is asked for.
    """

    def __init__(
        self, bridge: Bridge, run: Run, number: int, source: RoverOrders, *, truth_map: bool = False
    ) -> None:
        self._bridge, self._run, self._source = bridge, run, source
        self._number, self._rover = number, run.rovers[number]
        self.map = open_channel(bridge, MAP, lambda grid: occupancy_bytes(grid, bridge.time_ns))
        graded = partial(open_channel, bridge, GRADED, lambda grid: graded_bytes(grid, bridge.time_ns))
        self.graded = graded() if truth_map else None
        bridge.create_subscription(PoseWithCovarianceStamped, "initialpose", self._put, 1)
        if samples.GoalPose not in bridge.channels_of:  # else it publishes that itself
            bridge.create_subscription(PoseStamped, "goal_pose", self._head_for, 1)

    @cached_property
    def occupancy(self) -> OccupancyMap:
        """Returns the map of this world for this rover."""
        rover = find_rover(self._rover.robot)
        return occupancy(world_of(self._run), rover.slope_limit, rover.step_limit)

    @property
    def maps(self) -> list[Channel]:
        """Returns the topics with maps."""
        return [self.map, *filter(None, [self.graded])]

    def look_around(self) -> None:
        """Publishes each map, once, if somebody listens or records."""
        for channel in self.maps:
            is_wanted = channel.record or channel.listeners()
            if channel.published == 0 and is_wanted:
                is_graded = channel is self.graded
                channel.publish(graded_world(self._run, self._number) if is_graded else self.occupancy)

    def _put(self, message: PoseWithCovarianceStamped) -> None:
        self._take("initialpose", message.header.frame_id, message.pose.pose, self._source.put)

    def _head_for(self, message: PoseStamped) -> None:
        if not takes_goals(self._rover.driver):
            if self._bridge.count_subscribers("goal_pose") == 1:  # else it is for Nav2's bt_navigator
                reason = f"the driver is {self._rover.driver}; start with --driver goal"
                self._refuse("goal_pose", reason)
        else:
            self._take("goal_pose", message.header.frame_id, message.pose, self._source.head_for)

    def _take(
        self,
        topic: str,
        frame: str,
        pose: Any,  # noqa: ANN401
        order: Callable[[Place], int | None],
    ) -> None:
        place = place_of(pose)
        reason = self._objection(frame, place)
        if reason is None and (at_ns := order(place)) is not None:
            where = f"({place.x:.2f}, {place.y:.2f}) m, yaw {place.yaw:.2f} rad"
            taken = f"{topic}: {where}, from t = {at_ns / NANOSECONDS:.2f} s on"
            self._bridge.get_logger().info(taken, throttle_duration_sec=1.0)
        else:
            self._refuse(topic, reason or "the run ends before it would come into effect")

    def _objection(self, frame: str, place: Place) -> str | None:
        where = f"({place.x:.2f}, {place.y:.2f}) m"
        (at_x, at_y), half = self.occupancy.middle, self.occupancy.half_size
        most_x, most_y = (length - EDGE_MARGIN for length in half)
        if frame and frame.rpartition("/")[2] not in FRAMES:
            return f"it is in the frame '{shown(frame)}'; give one of {', '.join(FRAMES)}, or none"
        is_on_map = abs(place.x - at_x) < most_x and abs(place.y - at_y) < most_y  # NaN is not
        if not (is_on_map and math.isfinite(place.yaw)):
            about = "" if (at_x, at_y) == (0.0, 0.0) else f" of the middle, {at_x:g},{at_y:g}"
            return (
                f"{where} is off the map; give |x| below {most_x:g} m and |y| below {most_y:g} m{about}"
            )
        if not self.occupancy.is_free(place.x, place.y, find_rover(self._rover.robot).width / 2):
            return f"{where} is occupied on /map: the rover cannot stand there"
        return None

    def _refuse(self, topic: str, reason: str) -> None:
        self._bridge.get_logger().warning(f"ignored {topic}: {reason}", throttle_duration_sec=1.0)


def place_of(pose: Any) -> Place:  # noqa: ANN401 - rclpy's classes have no types
    """Returns where a geometry_msgs/Pose is, seen from above."""
    return Place(pose.position.x, pose.position.y, rotation.yaw(quaternion(pose.orientation)))
