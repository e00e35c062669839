"""The topics of a rover's samples, in publishing order, each with what makes its messages."""

from collections.abc import Iterable, Sequence

from harness import samples
from harness.messages import fillers
from harness.messages.blank import blank
from harness.messages.optional import Draw
from harness.messages.refilled import Fill
from harness.robots import RoverSpec
from harness.robots.lidar import LidarSpec
from harness.samples import Sample, Source
from harness.sensors.table import SensorRow, Topic

PERSON = "geometry_msgs/msg/Pose"  # RoboTerrain's plugin gives no stamp
# Latched for late subscribers; one of Nav2's, which is volatile, hears it too.
GOAL = Topic("goal_pose", "geometry_msgs/msg/PoseStamped", depth=1, latched=True)
CLOCK = Topic("/clock", "rosgraph_msgs/msg/Clock")
Outlets = dict[Source, list[tuple[Topic, Fill]]]  # of each sample its topics, and what fills messages


def outlets(
    rover: RoverSpec,
    lidar: LidarSpec,
    rows: Iterable[SensorRow],
    *,
    draw: Draw | None = None,
    actors: Sequence[str] = (),
    goals: bool = False,
) -> Outlets:
    """Returns what is published of each sample; of transforms only their place in the order.

    Args:
        rover: Gives the frames.
        lidar: Gives the geometry of scans.
        rows: The sensors.
        draw: Gives the images of cameras; without it there are none.
        actors: Names of the people, as NAME_actor.
        goals: Whether the way points of a route are published for who commands the rover.
    """
    made: Outlets = {
        row.source: [(topic, fillers.filler(row, topic, rover, lidar, draw)) for topic in row.topics]
        for row in rows
        if row.sample is not samples.Transforms
    } | {samples.Transforms: []}
    if actors:
        made[samples.ActorPoses] = [
            (Topic(f"{name}/pose", PERSON), fillers.person(index)) for index, name in enumerate(actors)
        ]
    if goals:
        made[samples.GoalPose] = [(GOAL, fillers.goal())]
    return made


def clock() -> Fill:
    """Returns what makes messages of /clock of ticks."""
    return fillers.by_names(blank(CLOCK.message_type), samples.Tick)


def bursts(sent: Iterable[Sample]) -> list[dict[Source, Sample]]:
    """Returns parts with a sample of each sensor at most: a listener's queue may hold but the latest."""
    bursts: list[dict[Source, Sample]] = []
    for sample in sent:
        sensor = samples.source(sample)
        for burst in bursts:
            if sensor not in burst:
                burst[sensor] = sample
                break
        else:
            bursts.append({sensor: sample})
    return bursts
