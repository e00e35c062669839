"""SDF's <actor> as it is told: who it is, and the way points that it walks along."""

from dataclasses import dataclass
from xml.etree.ElementTree import Element

from harness.world.sdf.poses import Transform, read_pose
from harness.world.sdf.reader import is_true, numbers, text_of


@dataclass(frozen=True, eq=False)
class WayPoint:
    """When an actor is where: time since its start [s], and x, y, z [m], roll, pitch, yaw [rad]."""

    time: float
    pose: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class ToldActor:
    """An actor of a world.

    Attributes:
        pose: T_world_actor, where it stands without a trajectory; else that of its trajectory.
        loop: Whether it begins anew at the end of its way points.
        delay: Before it starts [s].
        way_points: In the order of the file; those of all its trajectories.
    """

    name: str
    pose: Transform
    loop: bool
    delay: float
    way_points: tuple[WayPoint, ...]


def read_actor(actor: Element) -> ToldActor:
    """Returns what an <actor> says.

    Raises:
        UsageError: A number is not valid.
    """
    name = actor.get("name", "actor")
    script = actor.find("script")
    points = (
        ()
        if script is None
        else tuple(
            WayPoint(
                numbers(text_of(point, "time"), 1, f"time of a way point of {name}")[0],
                numbers(text_of(point, "pose"), 6, f"way point of {name}"),
            )
            for point in script.iterfind("trajectory/waypoint")
        )
    )
    pose, _ = read_pose(actor, name)
    (delay,) = numbers(text_of(script, "delay_start", "0"), 1, f"delay_start of {name}")
    return ToldActor(name, pose, is_true(text_of(script, "loop", "true")), delay, points)
