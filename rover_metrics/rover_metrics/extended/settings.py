"""All parameters of metrics_node as values: its own, the thresholds, those of the extended columns."""

import difflib
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

from rover_metrics.core.parameter import ParameterInfo, parameter, parameters_of, require_ranges
from rover_metrics.core.thresholds import DEFAULT_THRESHOLDS, THRESHOLD_INFO, Thresholds
from rover_metrics.errors import ParameterError
from rover_metrics.extended.footprint import Footprint, LidarPose
from rover_metrics.extended.truth_columns import WHEELS

NEARLY = 0.75  # of 1: so alike, one name is taken for a slip of the other
_WHEEL = re.compile(r"[a-z][a-z0-9_]*|[0-9]+_[a-z]+")
STANDARD_GRAVITY = 9.80665  # m/s^2, ISO 80000-3


@dataclass(frozen=True, kw_only=True)
class ExtendedSettings:
    """Values of the parameters that only the extended columns read; each is described below.

    Without a footprint its columns stay empty. Contacts show as a few centimetres of clearance: lidars
    and poses of lidars are that exact.

    Raises:
        ParameterError: A number is outside its range.
    """

    footprint: Footprint | None = parameter(  # noqa: RUF009 - makes a field
        None,
        "corners of the rover's outline in the base frame, in order: x0, y0, x1, y1, ... "
        "[m]; empty leaves the columns of the footprint empty",
        ros_default=(),
        valid="a list of numbers with decimal points, 3 corners or more of a polygon "
        "that does not cross itself, e.g. [0.2, 0.2, -0.2, 0.2, -0.2, -0.2, 0.2, -0.2]",
    )
    lidar_pose: LidarPose = parameter(  # noqa: RUF009
        LidarPose(),
        "x, y, yaw of the lidar's frame in the base frame",
        ros_default=(0.0, 0.0, 0.0),
        unit="m, m, rad",
        valid="a list of three numbers with decimal points, e.g. [0.174, 0.0, 3.14159]",
    )
    near_returns_as_contact: bool = parameter(
        False, "a return nearer than range_min (-inf, REP-117) is footprint clearance 0"
    )
    footprint_threshold: float = parameter(
        0.05,
        "a scan whose footprint clearance is below this is a footprint collision",
        maximum=100.0,
        unit="m",
        example="0.1, not 1",
    )
    gravity: float = parameter(
        STANDARD_GRAVITY,
        "what the IMU reads at rest, taken out of Roughness RMS; a simulator's may be another",
        maximum=100.0,
        unit="m/s^2",
        example="9.8, not 9",
    )

    wheels: str = parameter(
        ",".join(WHEELS),
        "names of the wheels whose slip /rover/truth/traversal tells; fixed once the node runs, for the "
        "header of a log cannot change",
        valid="names of lower-case letters, digits and _, each once, with commas between them, "
        "e.g. 'left,right'",
        read_only=True,
    )

    energy: bool = parameter(
        False,
        "columns of what /battery/battery_state tells of energy, after all others; fixed once the node "
        "runs, for the header of a log cannot change",
        read_only=True,
    )

    soil: bool = parameter(
        False,
        "columns of what soil does to the wheels, which /rover/truth/traversal tells of a run on soil",
        read_only=True,
    )
    columns: str = parameter(
        "",
        "names of further columns, of plug-ins or as FILE.py:CLASS (docs/extend.md), after the extended "
        "ones; fixed once the node runs",
        valid="names of plug-ins with commas between them",
        read_only=True,
    )

    def __post_init__(self) -> None:
        require_ranges(self)
        names = self.wheel_names
        if not all(map(_WHEEL.fullmatch, names)) or len(set(names)) < len(names):
            valid = parameters_of(ExtendedSettings)["wheels"].constraint
            raise ParameterError(f"parameter wheels must be {valid}; '{self.wheels}' is not")

    @property
    def column_names(self) -> tuple[str, ...]:
        """The further columns, in their order."""
        return tuple(filter(None, self.columns.split(",")))

    @property
    def wheel_names(self) -> tuple[str, ...]:
        """The wheels, in the order of their columns."""
        return tuple(self.wheels.split(","))


EXTENDED_INFO = parameters_of(ExtendedSettings)
DEFAULT_EXTENDED = ExtendedSettings()


@dataclass(frozen=True, kw_only=True)
class Settings:
    """The values of the node's parameters, all valid; each is described below."""

    debug_mode: bool = parameter(False, "report clearance, collisions and distance while running")
    debug_interval: int = parameter(
        100, "callbacks of a topic from one debug report to the next", minimum=1, maximum=1_000_000
    )
    pose_queue: int = parameter(
        1,
        "poses that may wait for the node: only the newest, as RoboTerrain has it, but more "
        "while a simulator waits for the node; fixed once the node runs",
        minimum=1,
        maximum=100,
        read_only=True,
    )
    log_dir: str = parameter(
        "metrics_analyzer/data/metric_logs/",
        "folder for the log of this session; fixed once the node runs",
        valid="the path of a folder, as text",
        read_only=True,
    )
    fsync: bool = parameter(
        False,
        "force each row onto the disk, so that it survives a power cut too; "
        "rows survive the death of the node either way",
    )
    stale_after: float = parameter(
        5.0,
        "report a topic, or /clock, that has been silent for so long; 0 is never",
        maximum=86400.0,
        unit="s",
        example="5.0, not 5",
    )
    publish_metrics: bool = parameter(
        True,
        "publish each row, and the state of each topic, on rover/metrics "
        "(diagnostic_msgs/DiagnosticArray)",
    )
    extended_columns: bool = parameter(
        False,
        "write the extended columns of docs/metrics.md after the twelve; fixed once the "
        "node runs, for the header of a log cannot change",
    )
    thresholds: Thresholds = DEFAULT_THRESHOLDS
    extended: ExtendedSettings = DEFAULT_EXTENDED

    @property
    def parameters(self) -> dict[str, Any]:
        """The value of every parameter as ROS has it, by name; `updated` is the way back."""
        extended, outline, lidar = self.extended, self.extended.footprint, self.extended.lidar_pose
        own = {**vars(self), **vars(self.thresholds), **vars(extended)}
        own["footprint"] = [] if outline is None else [x for corner in outline.corners for x in corner]
        own["lidar_pose"] = [lidar.x, lidar.y, lidar.yaw]
        # A parameter has the type of its declared default, so 1 must be 1.0 where that is a float.
        return {
            name: float(own[name]) if isinstance(info.default, float) else own[name]
            for name, info in PARAMETERS.items()
        }

    def updated(self, values: Mapping[str, Any]) -> "Settings":
        """Returns these settings with some parameters changed, by name; other names are ignored."""
        if values.get("log_dir") == "":
            raise ParameterError("parameter log_dir must be the path of a folder, not empty text")
        extended = _known(values, EXTENDED_INFO)
        if "footprint" in extended:
            corners = extended["footprint"]
            extended["footprint"] = Footprint.from_flat(corners) if len(corners or ()) else None
        if "lidar_pose" in extended:
            extended["lidar_pose"] = LidarPose.from_flat(extended["lidar_pose"])
        return replace(
            self,
            thresholds=replace(self.thresholds, **_known(values, THRESHOLD_INFO)),
            extended=replace(self.extended, **extended),
            **_known(values, parameters_of(Settings)),
        )


def _known(values: Mapping[str, Any], infos: Mapping[str, ParameterInfo]) -> dict[str, Any]:
    return {name: value for name, value in values.items() if name in infos}


PARAMETERS: Mapping[str, ParameterInfo] = MappingProxyType(
    {**parameters_of(Settings), **THRESHOLD_INFO, **EXTENDED_INFO}
)
OF_EVERY_NODE = ("use_sim_time", "start_type_description_service")
QOS_OVERRIDES = "qos_overrides."  # what their names begin with


def check_name(name: str, *, may_be_others: bool) -> bool:
    """Returns whether a parameter is one of PARAMETERS; False for those that every node has.

    For any other name a ParameterError names the nearest. A name that may be another node's is only a
    mistake where it nearly is one of PARAMETERS.
    """
    if name in PARAMETERS:
        return True
    if name in OF_EVERY_NODE or name.startswith(QOS_OVERRIDES):
        return False
    cutoff = NEARLY if may_be_others else 0.0
    nearest = difflib.get_close_matches(name, (*PARAMETERS, *OF_EVERY_NODE), n=1, cutoff=cutoff)
    if nearest:
        raise ParameterError(f"there is no parameter {name}; did you mean {nearest[0]}?")
    return False
