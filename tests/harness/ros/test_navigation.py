"""/map, /initialpose and /goal_pose: what goes to the episode, and what is refused and why."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped
from scipy.spatial.transform import Rotation

from harness.episode.assembly import world_of
from harness.robots import find_rover
from harness.ros.navigation import Navigation, place_of
from harness.samples import Place
from harness.spec.run import Run
from harness.world.obstacles import ObstacleKind
from harness.world.occupancy import occupancy

CONFIG = Run.of(terrain="posts", driver="goal")


class Rig:
    """A node and an episode that only remember."""

    def __init__(self, config: Run = CONFIG, goal_takers: int = 1) -> None:
        self.said: list[str] = []
        self.ordered: list[tuple[str, Place]] = []
        self.answer: int | None = 1_250_000_000
        self.listeners = 0
        self.sent: list[Any] = []
        self.callbacks: dict[str, Any] = {}
        publisher = SimpleNamespace(
            topic_name="/map", publish=self.sent.append, get_subscription_count=lambda: self.listeners
        )
        bridge: Any = SimpleNamespace(
            time_ns=2_300_000_000,
            create_publisher=lambda *_: publisher,
            count_subscribers={"goal_pose": goal_takers}.__getitem__,
            create_subscription=lambda _, name, callback, __: self.callbacks.update({name: callback}),
            get_logger=lambda: SimpleNamespace(info=self.said.append, warning=self.said.append),
        )
        source: Any = SimpleNamespace(put=self._order("put"), head_for=self._order("head for"))
        self.navigation = Navigation(bridge, config, 0, source)

    def _order(self, what: str) -> Any:  # noqa: ANN401
        def order(place: Place) -> int | None:
            self.ordered.append((what, place))
            return self.answer

        return order

    def send(self, topic: str, x: float, y: float, frame: str = "map", yaw: float = 0.0) -> None:
        message = PoseStamped() if topic == "goal_pose" else PoseWithCovarianceStamped()
        pose = message.pose if topic == "goal_pose" else message.pose.pose
        message.header.frame_id = frame
        pose.position.x, pose.position.y = x, y
        pose.orientation.z, pose.orientation.w = math.sin(yaw / 2), math.cos(yaw / 2)
        self.callbacks[topic](message)


@pytest.mark.parametrize("frame", ["map", "odom", "", "rover1/map"])
@pytest.mark.parametrize(("topic", "what"), [("initialpose", "put"), ("goal_pose", "head for")])
def test_a_pose_on_the_map_goes_to_the_episode_and_the_line_says_when(
    topic: str, what: str, frame: str
) -> None:
    rig = Rig()
    rig.send(topic, 1.0, -2.0, frame, yaw=0.5)
    ((ordered, place),) = rig.ordered
    assert (ordered, place.x, place.y, round(place.yaw, 9)) == (what, 1.0, -2.0, 0.5)
    assert rig.said == [f"{topic}: (1.00, -2.00) m, yaw 0.50 rad, from t = 1.25 s on"]


@pytest.mark.parametrize("topic", ["initialpose", "goal_pose"])
def test_what_the_rover_cannot_do_is_refused_in_one_line_with_the_mend(topic: str) -> None:
    rig = Rig()
    post = next(o for o in world_of(CONFIG).obstacles if o.kind is ObstacleKind.HAZARD)
    px, py, _ = post.position
    off = "m is off the map; give |x| below 19.5 m and |y| below 19.5 m"
    for x, y, frame, reason in (
        (19.5, 0.0, "map", f"(19.50, 0.00) {off}"),
        (0.0, math.nan, "map", f"(0.00, nan) {off}"),
        (px, py, "map", f"({px:.2f}, {py:.2f}) m is occupied on /map: the rover cannot stand there"),
        (
            px + 0.2,
            py,
            "map",
            f"({px + 0.2:.2f}, {py:.2f}) m is occupied on /map: the rover cannot stand there",
        ),
        (1.0, 0.0, "base_link", "it is in the frame 'base_link'; give one of map, odom, world, or none"),
    ):
        rig.send(topic, x, y, frame)
        assert rig.said.pop() == f"ignored {topic}: {reason}"
    assert rig.ordered == []
    rig.answer = None
    rig.send(topic, 1.0, -2.0)
    assert rig.said == [f"ignored {topic}: the run ends before it would come into effect"]


@pytest.mark.parametrize("takers", [1, 2])
def test_a_goal_without_the_driver_for_it_is_refused_with_the_mend_unless_another_takes_it(
    takers: int,
) -> None:
    rig = Rig(Run.of(driver="wander"), takers)
    rig.send("goal_pose", 1.0, 0.0)
    told = ["ignored goal_pose: the driver is wander; start with --driver goal"]
    assert rig.said == (told if takers == 1 else [])
    assert rig.ordered == []


@pytest.mark.parametrize("records", [True, False])
def test_the_map_goes_out_once_when_somebody_listens_or_records(records: bool) -> None:
    rig = Rig()
    rig.navigation.look_around()
    assert rig.sent == []
    if records:
        rig.navigation.map.record = lambda message: message
    else:
        rig.listeners = 1
    for _ in range(3):
        rig.navigation.look_around()
    (message,) = rig.sent
    rover, info = find_rover("leo"), message.info
    cells = occupancy(world_of(CONFIG), rover.slope_limit, rover.step_limit).cells
    assert (np.array(message.data).reshape(info.height, info.width) == cells).all()
    assert (info.resolution, info.origin.position.x, info.origin.position.y) == (0.05, -20.0, -20.0)
    assert (info.origin.orientation.w, message.header.frame_id) == (1.0, "map")
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (2, 300_000_000)


def test_a_place_is_a_pose_from_above() -> None:
    for angles in ((0.0, 0.0, 3.0), (0.2, -0.3, -2.5), (-0.4, 0.1, 1.2)):
        x, y, z, w = Rotation.from_euler("xyz", angles).as_quat()
        orientation = SimpleNamespace(x=x, y=y, z=z, w=w)
        place = place_of(
            SimpleNamespace(position=SimpleNamespace(x=4.0, y=5.0), orientation=orientation)
        )
        assert (place.x, place.y) == (4.0, 5.0)
        assert place.yaw == pytest.approx(angles[2])
