"""The node's ROS parameters: what exists, what is valid, and what the current values are."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.exceptions import ParameterException
from rclpy.node import Node
from rclpy.parameter import Parameter

from rover_metrics.core.thresholds import DEFAULT_THRESHOLDS, THRESHOLD_INFO, Thresholds
from rover_metrics.errors import ParameterError, ThresholdError
from rover_metrics.extended.settings import DEFAULT_EXTENDED, ExtendedSettings
from rover_metrics.ros import extended_parameters

DEFAULT_LOG_DIR = "metrics_analyzer/data/metric_logs/"
LONGEST_DEBUG_INTERVAL = 1_000_000  # callbacks
LONGEST_SILENCE = 86400.0  # s
RELIABLE, BEST_EFFORT = "reliable", "best_effort"


@dataclass(frozen=True)
class Settings:
    """The values of the node's parameters, all valid.

    Attributes:
        debug_mode: Whether the lidar and pose callbacks report.
        debug_interval: How many callbacks of a topic share one report.
        log_dir: Folder for the log, relative to the working directory unless absolute.
        fsync: Whether each row is forced onto the disk itself.
        stale_after: From which silence on a topic is reported [s]; 0 is never.
        publish_metrics: Whether rover/metrics is published.
        extended_columns: Whether the log has the extended columns; fixed once the node runs.
        thresholds: The thresholds, each a parameter of its own name.
        extended: What only the extended columns read, likewise.
    """

    debug_mode: bool = False
    debug_interval: int = 100
    log_dir: str = DEFAULT_LOG_DIR
    fsync: bool = False
    stale_after: float = 5.0
    publish_metrics: bool = True
    extended_columns: bool = False
    thresholds: Thresholds = DEFAULT_THRESHOLDS
    extended: ExtendedSettings = DEFAULT_EXTENDED

    def updated(self, parameters: Iterable[Parameter]) -> "Settings":
        """Give these settings with some parameters changed; names of others are ignored.

        Raises:
            ParameterError: A value is not valid; then no value is to be used.
        """
        values = {parameter.name: parameter.value for parameter in parameters}
        thresholds = {name: values[name] for name in values if name in THRESHOLD_INFO}
        own = {name: values[name] for name in values if name in _OWN_NAMES}
        if own.get("log_dir") == "":
            message = "parameter log_dir must be the path of a folder, not empty text"
            raise ParameterError(message)
        try:
            return replace(
                self,
                thresholds=replace(self.thresholds, **thresholds),
                extended=extended_parameters.updated(self.extended, values),
                **own,
            )
        except ThresholdError as error:
            raise ParameterError(str(error)) from error


_OWN_NAMES = (
    "debug_mode",
    "debug_interval",
    "log_dir",
    "fsync",
    "stale_after",
    "publish_metrics",
    extended_parameters.SWITCH,
)


def declare_settings(node: Node) -> Settings:
    """Declare all parameters and read what the launch set them to.

    Args:
        node: The node that shall have them.

    Raises:
        ParameterError: The launch gave a value of the wrong type or outside its range.
    """
    defaults = Settings()
    declared = [
        _declare(node, "debug_mode", defaults.debug_mode, _debug_mode()),
        _declare(node, "debug_interval", defaults.debug_interval, _debug_interval()),
        _declare(node, "log_dir", defaults.log_dir, _log_dir()),
        _declare(node, "fsync", defaults.fsync, _fsync()),
        _declare(node, "stale_after", defaults.stale_after, _stale_after()),
        _declare(node, "publish_metrics", defaults.publish_metrics, _publish_metrics()),
    ]
    for name, info in THRESHOLD_INFO.items():
        declared.append(_declare(node, name, info.default, _threshold(name)))
    for name, (default, descriptor) in extended_parameters.descriptors().items():
        declared.append(_declare(node, name, default, descriptor))
    extended_parameters.fill_empty(node)
    return defaults.updated(declared)


def declare_reliability(node: Node, topic: str, default: str) -> tuple[str, str]:
    """Declare the standard ROS parameter for the reliability of a subscription.

    Args:
        node: The subscribing node.
        topic: The topic's resolved name.
        default: RELIABLE or BEST_EFFORT.

    Returns:
        The parameter's name and its value.

    Raises:
        ParameterError: The launch gave another value than these two.
    """
    name = f"qos_overrides.{topic}.subscription.reliability"
    descriptor = ParameterDescriptor(
        description=f"reliability that this node asks of publishers on {topic}",
        additional_constraints=f"{RELIABLE} or {BEST_EFFORT}, as text",
        read_only=True,
    )
    value = str(_declare(node, name, default, descriptor).value)
    if value not in (RELIABLE, BEST_EFFORT):
        raise ParameterError(_must_be(name, descriptor))
    return name, value


def wrong_type(node: Node, parameters: Iterable[Parameter]) -> str | None:
    """Say what is valid for the first parameter of a wrong type; None if all types fit.

    rclpy rejects these too, but names the types by number: "expected '3' got '2'".
    """
    for parameter in parameters:
        name = parameter.name
        declared = node.has_parameter(name) and node.describe_parameter(name)
        if declared and declared.additional_constraints and declared.type != parameter.type_.value:
            return _must_be(name, declared)
    return None


def _declare(node: Node, name: str, default: object, descriptor: ParameterDescriptor) -> Parameter:
    try:
        return node.declare_parameter(name, default, descriptor)
    except ParameterException as error:
        raise ParameterError(_must_be(name, descriptor)) from error


def _must_be(name: str, descriptor: ParameterDescriptor) -> str:
    return f"parameter {name} must be {descriptor.additional_constraints}"


def _debug_mode() -> ParameterDescriptor:
    return ParameterDescriptor(
        description="report clearance, collisions and distance while running",
        additional_constraints="true or false, not 0 or 1",
    )


def _debug_interval() -> ParameterDescriptor:
    valid = IntegerRange(from_value=1, to_value=LONGEST_DEBUG_INTERVAL, step=1)
    return ParameterDescriptor(
        description="callbacks of a topic from one debug report to the next",
        additional_constraints=f"an integer from {valid.from_value} to {valid.to_value}",
        integer_range=[valid],
    )


def _log_dir() -> ParameterDescriptor:
    return ParameterDescriptor(
        description="folder for the log of this session; fixed once the node runs",
        additional_constraints="the path of a folder, as text",
        read_only=True,
    )


def _fsync() -> ParameterDescriptor:
    return ParameterDescriptor(
        description="force each row onto the disk, so that it survives a power cut too; "
        "rows survive the death of the node either way",
        additional_constraints="true or false, not 0 or 1",
    )


def _stale_after() -> ParameterDescriptor:
    longest = LONGEST_SILENCE
    return ParameterDescriptor(
        description="report a topic, or /clock, that has been silent for so long; 0 is never [s]",
        additional_constraints=f"a number with a decimal point (5.0, not 5) from 0.0 to {longest} s",
        floating_point_range=[FloatingPointRange(from_value=0.0, to_value=longest, step=0.0)],
    )


def _publish_metrics() -> ParameterDescriptor:
    return ParameterDescriptor(
        description="publish each row, and the state of each topic, on rover/metrics "
        "(diagnostic_msgs/DiagnosticArray)",
        additional_constraints="true or false, not 0 or 1",
    )


def _threshold(name: str) -> ParameterDescriptor:
    info = THRESHOLD_INFO[name]
    return ParameterDescriptor(
        description=f"{info.description} [{info.unit}]",
        additional_constraints=f"a number with a decimal point (1.0, not 1) {info.valid_range}",
        floating_point_range=[
            FloatingPointRange(from_value=info.minimum, to_value=info.maximum, step=0.0)
        ],
    )
