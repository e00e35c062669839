"""/map, /initialpose and /goal_pose over DDS: what goes to the episode, and what is refused and why."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped
from nav_msgs.msg import OccupancyGrid

from harness.base.message_types import GRID_MAP, read_message
from harness.episode.assembly import graded_world, world_of
from harness.robots import find_rover
from harness.ros.navigation import Navigation
from harness.samples import Place
from harness.spec.rover import RoverSetup
from harness.spec.run import Run
from harness.spec.world import WorldSpec
from harness.world.obstacles import ObstacleKind
from harness.world.occupancy import occupancy
from rover_metrics.ros.subscriptions import keep_last
from tests.support.ros import Ros

GOAL = RoverSetup(name="b", robot="husky", driver="goal", start=(3.0, 3.0, 0.0))
RUN = Run(world=WorldSpec(terrain="posts"), rovers=(RoverSetup(name="a"), GOAL))  # it is the second
KINDS = {"initialpose": PoseWithCovarianceStamped, "goal_pose": PoseStamped}


class Scene:
    """A bridge that serves a navigation stack, and who asks; the orders are only kept."""

    def __init__(self, ros: Ros, run: Run = RUN, *, truth_map: bool = False) -> None:
        self.ros, self.ordered, self.at_ns = ros, list[tuple[str, Place]](), 1_250_000_000
        self.bridge, self.stack = ros.bridge(), ros.node("stack")
        number = len(run.rovers) - 1
        self.navigation = Navigation(self.bridge, run, number, self, truth_map=truth_map)  # type: ignore[arg-type]  # two of its orders
        self._publishers = {
            topic: self.stack.create_publisher(KINDS[topic], topic, 1) for topic in KINDS
        }
        self.ros.until(lambda: all(p.get_subscription_count() for p in self._publishers.values()))

    def put(self, place: Place) -> int | None:
        self.ordered.append(("initialpose", place))
        return self.at_ns or None

    def head_for(self, place: Place) -> int | None:
        self.ordered.append(("goal_pose", place))
        return self.at_ns or None

    def send(self, topic: str, x: float, y: float, frame: str = "map", yaw: float = 0.0) -> None:
        message = KINDS[topic]()
        pose = message.pose if topic == "goal_pose" else message.pose.pose
        message.header.frame_id = frame
        pose.position.x, pose.position.y = x, y
        pose.orientation.z, pose.orientation.w = math.sin(yaw / 2), math.cos(yaw / 2)
        self._publishers[topic].publish(message)

    def said(self, capfd: pytest.CaptureFixture[str], topic: str) -> str:
        """The line that the bridge says of a topic."""
        lines = list[str]()

        def look() -> bool:
            lines.extend(line for line in capfd.readouterr().err.splitlines() if topic in line)
            return bool(lines)

        self.ros.until(look)
        (line,) = lines
        return line


@pytest.mark.parametrize(("topic", "frame"), [("initialpose", "map"), ("goal_pose", "rover1/odom")])
def test_a_pose_on_the_map_goes_to_the_episode_and_the_line_says_when(
    ros: Ros, topic: str, frame: str, capfd: pytest.CaptureFixture[str]
) -> None:
    scene = Scene(ros)
    scene.send(topic, 1.0, -2.0, frame, yaw=0.5)
    assert f"{topic}: (1.00, -2.00) m, yaw 0.50 rad, from t = 1.25 s on" in scene.said(capfd, topic)
    ((ordered, place),) = scene.ordered
    assert (ordered, place.x, place.y) == (topic, 1.0, -2.0)
    assert place.yaw == pytest.approx(0.5)
    scene.at_ns = 0
    scene.send(topic, 1.0, -2.0, "")
    assert "the run ends before" in scene.said(capfd, f"ignored {topic}")
    free = scene.navigation.occupancy
    scene.navigation.occupancy = replace(free, middle=(100.0, -50.0))  # as that of a file may be
    scene.send(topic, 101.0, -52.0)
    ros.until(lambda: len(scene.ordered) == 3)
    scene.navigation.occupancy = free
    scene.send(topic, POST[0] + 0.52, POST[1])  # beside it, where it could not turn
    ros.until(lambda: len(scene.ordered) == 4)


POST = next(o.position for o in world_of(RUN).obstacles if o.kind is ObstacleKind.HAZARD)


@pytest.mark.parametrize(
    ("x", "y", "yaw", "frame", "mend"),
    [
        (19.5, 0.0, 0.0, "map", "give |x| below 19.5 m and |y| below 19.5 m"),
        (0.0, math.nan, 0.0, "map", "(0.00, nan) m is off the map"),
        (1.0, -2.0, math.nan, "map", "(1.00, -2.00) m is off the map"),
        (POST[0], POST[1], 0.0, "map", "is occupied on /map"),
        (POST[0] + 0.2, POST[1], 0.0, "map", "is occupied on /map"),
        (1.0, 0.0, 0.0, "base_link", "'base_link'; give one of map, odom, world, or none"),
    ],
)
def test_where_the_rover_cannot_be_is_refused_with_the_mend(
    ros: Ros, x: float, y: float, yaw: float, frame: str, mend: str, capfd: pytest.CaptureFixture[str]
) -> None:
    scene = Scene(ros)
    scene.send("initialpose", x, y, frame, yaw)
    assert mend in scene.said(capfd, "ignored initialpose")
    assert scene.ordered == []


def test_a_goal_without_the_driver_for_it_is_refused_unless_another_takes_it(
    ros: Ros, capfd: pytest.CaptureFixture[str]
) -> None:
    scene = Scene(ros, Run.of(driver="wander"))
    scene.send("goal_pose", 1.0, 0.0)
    assert "the driver is wander; start with --driver goal" in scene.said(capfd, "ignored goal_pose")
    taken: list[object] = []
    scene.stack.create_subscription(PoseStamped, "goal_pose", taken.append, 1)
    ros.until(lambda: scene.bridge.count_subscribers("goal_pose") == 2)

    def is_taken() -> bool:
        scene.send("goal_pose", 1.0, 0.0)
        return bool(taken)

    ros.until(is_taken)
    assert (scene.ordered, capfd.readouterr().err) == ([], "")


def test_the_map_goes_out_once_when_somebody_listens(ros: Ros) -> None:
    scene, heard = Scene(ros, Run.of(terrain="posts")), list[Any]()
    scene.bridge.time_ns = 2_300_000_000
    grid = replace(scene.navigation.occupancy, middle=(3.0, -1.0))  # as that of a file may be
    scene.navigation.occupancy = grid
    scene.navigation.look_around()
    assert scene.navigation.map.published == 0
    scene.stack.create_subscription(OccupancyGrid, "map", heard.append, keep_last(1, latched=True))

    def is_heard() -> bool:
        scene.navigation.look_around()
        return bool(heard)

    ros.until(is_heard)
    scene.navigation.look_around()
    assert scene.navigation.map.published == 1
    (message,) = heard
    rover, info = find_rover("leo"), message.info
    cells = occupancy(world_of(RUN), rover.slope_limit, rover.step_limit).cells
    assert (np.array(message.data).reshape(info.height, info.width) == cells).all()
    assert (info.resolution, info.origin.position.x, info.origin.position.y) == (
        *(pytest.approx(0.05), -17.0, -21.0),
    )
    assert (info.origin.orientation.w, message.header.frame_id) == (1.0, "map")
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (2, 300_000_000)


def test_the_graded_map_is_that_of_the_rover_whose_topic_it_is(ros: Ros) -> None:
    navigation, kept = Scene(ros, truth_map=True).navigation, list[bytes]()
    assert navigation.graded is not None

    def record(data: bytes) -> bytes:
        kept.append(bytes(data))
        return data

    navigation.graded.record = record
    navigation.look_around()
    navigation.look_around()
    (data,) = kept
    message = read_message(data, GRID_MAP)
    margins = np.sort(message.data[message.layers.index("tip_margin")].data)
    expected = np.sort(graded_world(RUN, 1).layers["tip_margin"], axis=None)
    np.testing.assert_allclose(margins, expected, atol=1e-6)
