"""What the sources say of each rover's behaviour; what follows from geometry is derived where measured.

Sources: spec page = docs.fictionlab.pl and leorover.tech on Leo 1.8; firmware = leo_robot-ros2
default_firmware_params.yaml; recorded = RoboTerrain's bags and logs; SDF = RoboTerrain's leo_lidar.sdf
and camera_rover_4wd.sdf. models/README.md gives their paths.
"""

from dataclasses import dataclass

from harness.robots import LEO, ROVER_ZERO4WD, RoverSpec
from harness.validation.check import Span, around, at_least


@dataclass(frozen=True, slots=True)
class Passage:
    """A place below the rover where rocks may pass, and the height that just does [m].

    Attributes:
        name: What is above it.
        aside: Of the middle of the place, to the left [m].
        radius: Of the largest upright cylinder that no wheel touches [m].
        height: Above flat ground [m].
    """

    name: str
    aside: float
    radius: float
    height: float
    source: str


@dataclass(frozen=True, kw_only=True)
class Expected:
    """Spans of one rover.

    Attributes:
        speed_ratio: Ground speed over commanded speed, within the wheels' limit.
        at_half: Ground speed at a command of 0.5 m/s.
        at_top: Ground speed at a command of 1.0 m/s, the highest of RoboTerrain's RL agents.
        yaw_ratio: Achieved over commanded yaw rate, in place.
        kerb_one_side: Height climbed with the wheels of one side [m].
    """

    speed_ratio: Span
    at_half: Span
    at_top: Span
    yaw_ratio: Span
    kerb_one_side: Span
    passages: tuple[Passage, ...]


EXPECTED = {
    LEO.name: Expected(
        speed_ratio=Span(0.97, 1.0, "S: true wheel radius; D: less sink, dry friction"),
        at_half=Span(0.49, 0.50, "S: RoboTerrain on flat ground"),
        at_top=Span(0.68, 0.75, "S: recorded p95 0.68; SDF 12 rad/s x 0.0625 m"),
        yaw_ratio=around(1 / 1.76, 0.03, "S: firmware multiplier, 1 / 1.76 = 0.568"),
        kerb_one_side=at_least(0.070, "S: spec page, obstacle 70 mm"),
        passages=(
            Passage("underside", 0.0, 0.03, LEO.clearance, "S: mesh 106 mm, spec page 108 mm"),
            Passage("hubs", 0.128, 0.012, 0.037, "S: lowest point of the rocker mesh"),
        ),
    ),
    ROVER_ZERO4WD.name: Expected(
        speed_ratio=Span(1.02, 1.041, "S: 0.127 m wheels believed 0.122; D: less sink"),
        at_half=Span(0.515, 0.520, "S: recorded cruise"),
        at_top=Span(1.02, 1.041, "S: 0.127 m wheels believed 0.122; D: less sink"),
        yaw_ratio=Span(0.3, 0.24 / 0.36, "S: separation 0.24 believed, track 0.36; E: skid"),
        kerb_one_side=at_least(0.070, "D: a rover that climbs head-on climbs with one side"),
        passages=(
            Passage("belly", 0.0, 0.03, 0.0765, "D: chassis box, z 0.0745 + 0.002"),
            Passage("track guards", 0.10, 0.03, ROVER_ZERO4WD.clearance, "S: flipper_track.dae"),
        ),
    ),
}


def expected_of(rover: RoverSpec) -> Expected:
    """The spans of a rover."""
    return EXPECTED[rover.name]
