"""The rovers: a folder each, with a model and what the model cannot say in rover.yaml.

NAME.xml has geometry and masses, joints, wheels, limits of the drive and gravity; models/README.md
gives its conventions and the source of every number. rover.yaml has the controller, rates, frames,
measures and what the manoeuvres of harness.validate are to show. Nothing is compiled, without MuJoCo.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

from harness.errors import UsageError, find_named
from harness.yaml_file import fill, read_mapping

MODELS_DIR = next(
    folder
    for folder in (Path(__file__).parent / "models", Path(__file__).parents[1] / "models")
    if folder.is_dir()
)
MAY_BE_ZERO = ("rest_height", "lidar_x")  # or negative


@dataclass(frozen=True, kw_only=True)
class FrameRow:
    """One frame of rover.yaml: where `child` is, in what is named.

    Attributes:
        body: The model's body that it belongs to, whose mass and shapes its link gets in the URDF, or
            `site`: a site of the model; with neither it is fixed to `parent`.
        xyz: Its origin [m] and `rpy` its roll, pitch, yaw [rad] there, else in the parent.
    """

    parent: str
    child: str
    body: str = ""
    site: str = ""
    xyz: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rpy: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True, kw_only=True)
class RoverSpec:
    """One rover; lengths in metres, angles in radians, rates in hertz of simulation time.

    The root body of the model is the model frame, whose pose /rover/pose_array tells.

    Attributes:
        wheel_joints: Front left, rear left, front right, rear right; from the model, as are
            `passive_joints` (published in /joint_states but not driven), `wheel_radius`,
            `wheel_width`, `wheel_speed_limit`, `lidar_x` and `gravity` [m/s^2].
        rest_height: Height of the model frame above flat ground when the rover stands on it.
        track: Lateral wheel distance; `wheelbase` is that along x.
        controller_radius: The wheels' radius as the DiffDrive controller believes it;
            `controller_separation` is the track that it believes.
        footprint: x_min, x_max, y_min, y_max over the wheels, in the model frame.
        linear_acceleration: DiffDrive's limit on commands, as is `angular_acceleration`.
        cruise_speed: What the scripted drivers command; `cruise_yaw_rate` likewise.
        encoder_ticks: Encoder resolution per wheel revolution.
        lidar_height: Above flat ground, as is `clearance`, that of the underside.
        frames: Of /tf and the URDF; harness.frames adds those of the model that are not named here.
        slope_limit: Steepest slope that it climbs; `step_limit` is the highest step.
        expected: What harness.validation.check reads.
        sensors: Those that it carries beside the usual ones, each as rover.yaml has it.
    """

    name: str
    wheel_joints: tuple[str, str, str, str]
    passive_joints: tuple[str, ...]
    wheel_radius: float
    wheel_width: float
    wheel_speed_limit: float
    lidar_x: float
    gravity: float
    summary: str
    odometry_child_frame: str
    imu_frame: str
    rest_height: float
    wheelbase: float
    track: float
    controller_radius: float
    controller_separation: float
    footprint: tuple[float, float, float, float]
    linear_acceleration: float
    angular_acceleration: float
    cruise_speed: float
    cruise_yaw_rate: float
    encoder_ticks: float
    odometry_rate: int
    lidar_height: float
    clearance: float
    frames: tuple[FrameRow, ...] = ()
    slope_limit: float = math.radians(40.0)
    step_limit: float = 0.07
    expected: dict[str, Any] = field(default_factory=dict, compare=False, repr=False)
    sensors: tuple[Mapping[str, Any], ...] = field(default=(), hash=False)

    @property
    def folder(self) -> Path:
        """The rover's files."""
        return MODELS_DIR / self.name

    @property
    def model_path(self) -> Path:
        """The rover's MJCF file."""
        return self.folder / f"{self.name}.xml"

    @property
    def length(self) -> float:
        """Length of the footprint [m]."""
        return self.footprint[1] - self.footprint[0]

    @property
    def width(self) -> float:
        """Width of the footprint [m]."""
        return self.footprint[3] - self.footprint[2]

    @property
    def top_speed(self) -> float:
        """Speed at which the wheels turn as fast as they can [m/s]."""
        return self.wheel_speed_limit * self.wheel_radius

    @property
    def joints(self) -> tuple[str, ...]:
        """Every joint of /joint_states, in its order."""
        return self.wheel_joints + self.passive_joints


class _Rovers(Mapping[str, RoverSpec]):
    """The folders of models/ by name; each is read when it is first asked for."""

    def __getitem__(self, name: str) -> RoverSpec:
        if name not in iter(self):
            raise KeyError(name)
        return read_rover(MODELS_DIR / name)

    def __iter__(self) -> Iterator[str]:
        return iter(sorted(path.parent.name for path in MODELS_DIR.glob("*/rover.yaml")))

    def __len__(self) -> int:
        return sum(1 for _ in self)


ROVERS: Mapping[str, RoverSpec] = _Rovers()


def find_rover(name: str) -> RoverSpec:
    """Returns the rover of that name.

    Raises:
        UsageError: No such rover; the message names those there are.
    """
    return find_named("robot", name, ROVERS)


@cache
def read_rover(folder: Path) -> RoverSpec:
    """Returns the rover of a folder.

    Raises:
        UsageError: One of its two files is not valid; the message names file, key and what is.
    """
    path, model = folder / "rover.yaml", folder / f"{folder.name}.xml"
    try:
        told = _told_by_model(ET.parse(model).getroot())  # noqa: S314 - no stranger's: MuJoCo loads it
    except (OSError, ET.ParseError, AttributeError, KeyError, ValueError, IndexError) as error:
        raise UsageError(f"{model} is not as models/README.md says: {error!r}") from error
    rover = fill(RoverSpec, read_mapping(path), str(path), name=folder.name, **told)
    for key, value in vars(rover).items():
        if isinstance(value, int | float) and value <= 0 and key not in MAY_BE_ZERO:
            raise UsageError(f"{path}: {key} = {value:g} is not valid; give a number above 0")
    if min(rover.length, rover.width) <= 0:
        raise UsageError(
            f"{path}: footprint = {rover.footprint} is empty; give x_min, x_max, y_min, y_max"
        )
    return rover


def _told_by_model(root: ET.Element) -> dict[str, object]:
    """What a model says of a rover, by the field's name."""
    defaults: dict[str, dict[str, dict[str, str]]] = {}
    for top in root.findall("default"):
        _gather(top, {}, defaults)

    def numbers(found: ET.Element | None, attribute: str) -> list[float]:
        """An attribute of the element, or else of its class."""
        element: ET.Element = found  # type: ignore[assignment]  # None fails, and is told of, as it should
        of_class = defaults.get(element.get("class", "main"), {}).get(element.tag, {})
        return [float(word) for word in (of_class | element.attrib)[attribute].split()]

    drives = root.findall("actuator/*")
    wheel = root.find(".//geom[@name='wheel_FL']")
    driven = tuple(drive.attrib["joint"] for drive in drives)
    joints = (joint.attrib["name"] for joint in root.findall("worldbody//joint"))
    return {
        "wheel_joints": driven,
        "passive_joints": tuple(name for name in joints if name not in driven),
        "wheel_radius": numbers(wheel, "size")[0],
        "wheel_width": 2 * numbers(wheel, "size")[1],
        "wheel_speed_limit": numbers(drives[0], "ctrlrange")[1],
        "lidar_x": numbers(root.find(".//site[@name='lidar']"), "pos")[0],
        "gravity": -numbers(root.find("option"), "gravity")[2],
    }


def _gather(
    node: ET.Element,
    inherited: dict[str, dict[str, str]],
    defaults: dict[str, dict[str, dict[str, str]]],
) -> None:
    """Takes down the attributes of a default class and of those in it, by element."""
    own = {item.tag: inherited.get(item.tag, {}) | item.attrib for item in node}
    defaults[node.get("class", "main")] = of_class = inherited | own
    for nested in node.findall("default"):
        _gather(nested, of_class, defaults)
