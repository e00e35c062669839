"""The transforms of an episode, against MuJoCo's raw state at their tick."""

import math
from pathlib import Path
from types import SimpleNamespace

import pytest

from harness.robots import ROVERS
from harness.robots.frames.rover_frames import rover_frames
from harness.robots.frames.tree import Edge
from harness.sensors.transforms import TransformSensor, describe
from harness.spec.ros import FrameOptions
from tests.harness.robots.frames.made_rover import made_rover
from tests.support.rovers import LEO

WHEELS, NONE = FrameOptions(odom_tf="wheels"), FrameOptions(odom_tf="none")


def test_a_slide_moves_its_frame_along_its_axis_in_the_parent(tmp_path: Path) -> None:
    body = (
        '<body name="lift" pos="0.1 0 0.2" euler="90 0 0"><joint name="lift" type="slide" axis="0 0 1"/>'
        '<geom size="0.1"/></body>'
    )
    frames = rover_frames(made_rover(tmp_path, body))
    frames.data.joint("lift").qpos[0] = 0.3
    simulation: object = SimpleNamespace(
        model=frames.model, data=frames.data, time_ns=50_000_000, scene=SimpleNamespace(own=str)
    )
    sample = TransformSensor(simulation, frames, NONE, {}, 1).read()  # type: ignore[arg-type]
    assert sample.translation == pytest.approx((0.1, -0.3, 0.2))
    assert sample.rotation == pytest.approx((math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)))


@pytest.mark.parametrize("map_tf", [False, True])
@pytest.mark.parametrize("odom_tf", ["ground_truth", "wheels", "none"])
def test_the_description_names_what_moves_and_holds_what_does_not(odom_tf: str, map_tf: bool) -> None:
    frames, owns = rover_frames(LEO), odom_tf != "none"
    told = describe(frames, FrameOptions.model_validate({"odom_tf": odom_tf, "map_tf": map_tf}))
    assert (told.moving[0] == ("odom", "base_footprint"), told.owns_odom) == (owns, owns)
    to_odom = Edge("map", "odom", (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))
    assert [edge for edge in told.fixed if "odom" in (edge.parent, edge.child)] == [to_odom] * map_tf
    children = {child for _, child in told.moving} | {edge.child for edge in told.fixed} - {"odom"}
    assert children == {link.name for link in frames.links[1 - owns :]}


def test_the_frame_of_the_true_odometry_is_there_on_every_rover_and_hangs_on_the_base() -> None:
    """Its pose in odom is what /odom_ground_truth says: that of the model frame, from above."""
    for rover in ROVERS.values():
        frames = rover_frames(rover)
        description = describe(frames, FrameOptions())
        parents = {edge.child: edge for edge in description.fixed} | dict.fromkeys(
            child for _, child in description.moving
        )
        edge = parents["base_footprint"]
        assert edge == (None if frames.base == "base_footprint" else Edge(frames.base, "base_footprint"))
