"""How a run goes through ROS: nodes, names, pace, transforms, recording."""

from functools import partial
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from harness.base.errors import UsageError
from harness.base.ros_names import namespace_of
from harness.spec.live import FOXGLOVE_PORT, HERE, address_of
from harness.spec.value import AsText, Option, Value, checked, listed, made, parsed

GROUND_TRUTH, WHEELS, NONE = "ground_truth", "wheels", "none"
SLOWEST_RATE = 0.01
foxglove_address = partial(address_of, flag="--foxglove", default=FOXGLOVE_PORT)
FOXGLOVE_ADDRESS = f"{HERE}:{FOXGLOVE_PORT}"


EFFECT_FORM = "TOPIC[,newer-than=INPUT][,timeout=SECONDS]"


class Effect(Value):
    """An output of the user's nodes, which must come before simulation time goes on.

    Attributes:
        topic: The output; below the rover's namespace unless it begins with "/".
        newer_than: The input: a topic of the run, each message of which must be answered by one.
        timeout: Wall time after which the answer counts as missing, and the run as failed [s].
    """

    topic: Annotated[str, Field(min_length=1)]
    newer_than: Annotated[str, Field(min_length=1)] = "scan"
    timeout: Annotated[float, Field(gt=0.0, le=3600.0)] = 30.0

    def __str__(self) -> str:
        """Returns it as a user writes it."""
        return f"{self.topic},newer-than={self.newer_than},timeout={self.timeout:g}"


def parse_effect(text: str) -> Effect:
    """Returns the output that a text names; UsageError if it has another form."""
    topic, *options = (word.strip() for word in text.split(","))
    pairs = [option.partition("=") for option in options]
    if not all(equals for _, equals, _ in pairs):
        raise UsageError(f"'{text}' is not valid; give {EFFECT_FORM}")
    values: dict[str, Any] = {key.replace("-", "_"): value for key, _, value in pairs}
    return made(Effect, {"topic": topic} | values, f"'{text}'", lambda name: name.replace("_", "-"))


EffectText = Annotated[Effect, parsed(parse_effect), AsText]


class FrameOptions(Value):
    """What a user chooses of the tree of frames."""

    odom_tf: Annotated[Literal["ground_truth", "wheels", "none"], Option("SOURCE")] = Field(
        default="ground_truth", description="who owns odom -> base on /tf; none where an EKF does"
    )
    odom_tf_3d: Annotated[bool, Option("")] = Field(
        default=False, description="with the true height, roll and pitch; else the pose from above"
    )
    map_tf: Annotated[bool, Option("")] = Field(
        default=False, description="publish map -> odom too, as the identity"
    )

    @model_validator(mode="after")
    def _agrees(self) -> Self:
        if self.odom_tf_3d and self.odom_tf != GROUND_TRUTH:
            raise ValueError(
                f"--odom-tf-3d is the true pose: leave out --odom-tf {self.odom_tf}, or --odom-tf-3d"
            )
        return self


def _rate(value: object) -> object:
    return None if value == "max" else value


def _check_nodes(names: tuple[str, ...]) -> None:
    if not all(namespace_of(name, "--wait-for") for name in names):
        raise UsageError("--wait-for needs the name of a node, e.g. /metrics_node")


class RosOptions(Value):
    """How a run goes through ROS; `log_dir` and `rate` hold for a run without it too.

    Attributes:
        host_metrics: Whether to run a MetricsNode in this process.
        ros_args: Arguments from `--ros-args` on.
        frames: Which transforms are published.
    """

    log_dir: Annotated[Path, Option("DIR")] = Field(
        description="folder for the log and its manifest; with --actor, for social/social_log_....csv "
        "too"
    )
    rate: Annotated[
        Annotated[float, Field(ge=SLOWEST_RATE, allow_inf_nan=False)] | None,
        BeforeValidator(_rate),
        Option("R|max"),
    ] = Field(default=None, description="times real time; default: max")
    host_metrics: bool = True
    wait_for: Annotated[
        tuple[str, ...], listed(), AfterValidator(checked(_check_nodes)), Option("NODE")
    ] = Field(default=(), description="keep lock-step with a node in another process; repeatable")
    wait_for_topic: Annotated[tuple[EffectText, ...], listed(), Option("TOPIC[,...]")] = Field(
        default=(),
        description="let time go on only when this output has come for each /scan; of another input, or "
        f"within other than 30 s: {EFFECT_FORM}; repeatable; default: none",
    )
    ros_args: tuple[str, ...] = ()
    cmd_vel: Annotated[Literal["auto", "twist", "stamped"], Option("TYPE")] = Field(
        default="auto",
        description="type of /cmd_vel; auto: as it is sent, TwistStamped from Kilted on until "
        "something is",
    )
    record: Annotated[Path | None, Option("FILE.mcap")] = Field(
        default=None,
        description="record every topic, /cmd_vel and /rover/metrics too; a killed run's file is "
        "read by rover_metrics.replay as it is, and mended by: mcap recover FILE.mcap -o MENDED.mcap",
    )
    foxglove: Annotated[
        Annotated[str, AfterValidator(checked(foxglove_address))] | None,
        Option("[HOST:]PORT", bare=FOXGLOVE_ADDRESS),
    ] = Field(
        default=None,
        description="serve every topic to Foxglove, without ROS too, at --rate 1 unless another is "
        f"given (extra [foxglove]); bare: at {FOXGLOVE_ADDRESS}; whoever reaches the host can read it; "
        "default: none",
    )
    overwrite: Annotated[bool, Option("")] = Field(
        default=False, description="let --record and --social-log replace a file"
    )
    truth_map: Annotated[bool, Option("")] = Field(
        default=False,
        description="publish /map/truth (grid_map_msgs/GridMap): slope, step, roughness, tip margin and "
        "danger for this rover (docs/scenarios.md)",
    )
    frames: FrameOptions = FrameOptions.model_construct()
