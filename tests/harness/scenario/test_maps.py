"""Maps against the graded truth: closed forms of simple worlds, maps with known mistakes, a node's."""

import math
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from harness.base.errors import UsageError
from harness.base.message_types import GRID_MAP, read_message
from harness.episode.assembly import graded_world
from harness.messages.optional import grid_map
from harness.robots import ROVERS, find_rover
from harness.robots.model import tip_limit
from harness.scenario.case import plan
from harness.scenario.maps import Grid, grids_of, share
from harness.spec.run import Run
from harness.validate.grounds import floor
from harness.validate.rig import Rig
from harness.validate.stability import balance, tip_angle
from harness.world.grading import GradedMap, Limits, graded
from harness.world.heightfield import Heightfield
from harness.world.obstacles import Obstacle, ObstacleKind
from harness.world.occupancy import OCCUPIED, occupancy
from harness.world.world import World

Where = tuple[float, float]
LIMITS = Limits(slope=0.5, step=0.1, tip=0.8, span=0.5)


def ramp(angle: float, *obstacles: Obstacle, middle: Where = (0.0, 0.0)) -> World:
    x = np.linspace(-5.0, 5.0, 101)
    heights = np.broadcast_to(x * math.tan(angle), (71, 101)).copy()
    return World("ramp", Heightfield(heights, 0.1, middle), obstacles, 0, None)


def box(kind: ObstacleKind, height: float, middle: Where = (0.0, 0.0)) -> Obstacle:
    return Obstacle(kind, "box", (0.5, 0.5, height / 2), (*middle, height / 2))


def near(grades: GradedMap, layer: str, x: float, y: float) -> float:
    column, row = (int((at - corner) / 0.05) for at, corner in zip((x, y), grades.corner, strict=True))
    return float(grades.layers[layer][row, column])


@pytest.mark.parametrize("angle", [0.0, 0.3, 0.6])
def test_a_ramp_has_its_slope_no_step_no_roughness_and_its_share_of_the_limit(angle: float) -> None:
    grades = graded(ramp(angle), LIMITS)
    assert near(grades, "slope", 1.0, 1.0) == pytest.approx(angle, abs=1e-9)
    assert near(grades, "step", 1.0, 1.0) == pytest.approx(
        max(0.0, 0.1 * (math.tan(angle) - math.tan(0.5)))
    )
    assert near(grades, "roughness", 1.0, 1.0) == pytest.approx(0.0, abs=1e-9)
    assert near(grades, "tip_margin", 1.0, 1.0) == pytest.approx(0.8 - angle)
    assert (near(grades, "danger", 1.0, 1.0) >= 1.0) == (angle > 0.5)


@pytest.mark.parametrize(
    ("kind", "height", "danger"),
    [("ROCK", 0.05, 0.5), ("ROCK", 0.2, 2.0), ("HAZARD", 0.05, 1.0), ("DECK", 0.2, 0.0)],
)
def test_a_rock_takes_a_share_of_the_step_a_hazard_all_of_it_and_a_deck_none(
    kind: str, height: float, danger: float
) -> None:
    grades = graded(ramp(0.0, box(ObstacleKind[kind], height)), LIMITS)
    assert near(grades, "danger", 0.0, 0.0) == pytest.approx(danger)
    assert near(grades, "elevation", 0.2, 0.2) == pytest.approx(height)
    assert near(grades, "danger", 0.0, 1.0) == 0.0


@pytest.mark.parametrize("robot", ROVERS)
def test_a_rover_tips_where_its_weight_stands_over_its_wheels(robot: str) -> None:
    stand = balance(Rig(ROVERS[robot], floor(0)))
    expected = min(tip_angle(arm, stand.height) for arm in stand.arms.values())
    assert tip_limit(ROVERS[robot]) == pytest.approx(expected, rel=0.05)


def test_what_navigation_cannot_pass_is_dangerous() -> None:
    run = Run.of(terrain="rocky", seed=2)
    rover, truth = find_rover("leo"), graded_world(run)
    from harness.episode.assembly import world_of  # noqa: PLC0415 - beside its use

    cells = occupancy(world_of(run), rover.slope_limit, rover.step_limit).cells[12:-12, 12:-12]
    dangerous = truth.layers["danger"][12:-12, 12:-12] >= 1.0
    assert (dangerous[cells == OCCUPIED]).mean() > 0.97
    assert dangerous.mean() < 1.2 * (cells == OCCUPIED).mean() + 0.01


def heard(truth: GradedMap, turn: float = 0.0, middle: Where = (0.0, 0.0)) -> Grid:
    """A map of 4 m around the middle that says the truth, in a frame that is turned."""
    grid = Grid(0, np.zeros((80, 80), np.float32), 0.05, (0.0, 0.0, turn))
    x, y = grid.places()
    shift = (middle[0] - float(x.mean()), middle[1] - float(y.mean()), turn)
    grid = replace(grid, origin=shift)
    return replace(grid, costs=(truth.danger_at(*grid.places()) >= 1.0).astype(np.float32))


@pytest.mark.parametrize("turn", [0.0, 0.7])
def test_shares_count_the_mistakes_that_a_map_has(turn: float) -> None:
    middle = 10.0 * turn, -9.0 * turn
    truth = graded(ramp(0.0, box(ObstacleKind.HAZARD, 1.0, middle), middle=middle), LIMITS)
    grid = heard(truth, turn, middle)
    dangers = int(grid.costs.sum())
    assert dangers == pytest.approx(400, rel=0.12)
    assert [share(w, grid, truth) for w in ("false_safe", "false_danger", "coverage")] == [0, 0, 1]
    wrong = grid.costs.copy()
    wrong.ravel()[np.flatnonzero(grid.costs)[:40]] = 0.0
    wrong.ravel()[np.flatnonzero(grid.costs == 0)[:60]] = 1.0
    wrong.ravel()[np.flatnonzero(grid.costs == 0)[60:100]] = np.nan
    mistaken = replace(grid, costs=wrong)
    assert share("false_safe", mistaken, truth) == pytest.approx(40 / dangers)
    assert share("false_danger", mistaken, truth) == pytest.approx(60 / (6400 - dangers - 40))
    assert share("coverage", mistaken, truth) == pytest.approx(1 - 40 / 6400)


@pytest.mark.parametrize("turn", [0.0, -1.2])
def test_a_grid_map_is_read_as_it_is_published(turn: float) -> None:
    truth = graded(ramp(0.0, box(ObstacleKind.HAZARD, 1.0)), LIMITS)
    grid = heard(truth, turn)
    layers = {"elevation": 0.0 * grid.costs.T, "traversability": 1.0 - grid.costs.T}
    data = grid_map(5, "map", 0.05, (0.0, 0.0, turn), layers)
    message = read_message(data, GRID_MAP)
    (again,) = grids_of(message)
    assert again.stamp_ns == 5
    assert again.origin == pytest.approx(grid.origin, abs=1e-6)
    np.testing.assert_allclose(again.costs, grid.costs, atol=1e-6)
    message.outer_start_index, message.inner_start_index = 3, 50  # of a map that went with its rover
    for layer in message.data:
        layer.data = np.roll(layer.data.reshape(80, 80), (50, 3), (0, 1)).ravel()
    (moved,) = grids_of(message)
    np.testing.assert_array_equal(moved.costs, again.costs)
    with pytest.raises(ValueError, match="traversability"):
        grids_of(SimpleNamespace(layers=["elevation"], info=None))


SCENARIO = """
about: A map that calls everything free is judged.
terrain: rocky
seed: 2
duration: 2
expect:
  map./costmap.false_safe: {min: 1}
  map./costmap.false_danger: {max: 0}
  map./costmap.coverage: {min: 1}
"""


def test_a_map_that_a_node_publishes_is_judged(tmp_path: Path, ros_domain: int) -> None:
    rclpy = pytest.importorskip("rclpy", reason="ROS 2 is not installed")
    from nav_msgs.msg import OccupancyGrid  # noqa: PLC0415 - with ROS alone
    from std_msgs.msg import Bool  # noqa: PLC0415

    from harness.scenario.trial import ScenarioTrial  # noqa: PLC0415

    del ros_domain
    (tmp_path / "m.scenario.yaml").write_text(SCENARIO)
    message = OccupancyGrid()
    message.info.resolution, message.info.width, message.info.height = 0.1, 200, 100
    message.info.origin.position.x, message.info.origin.position.y = -10.0, -5.0
    message.data = [0] * 20_000

    def mapper() -> Any:  # noqa: ANN401 - a node
        node = rclpy.create_node("mapper")
        publisher = node.create_publisher(OccupancyGrid, "/costmap", 1)
        node.create_subscription(Bool, "/rover/truth/contact", lambda _: publisher.publish(message), 10)
        return node

    with ScenarioTrial.load(tmp_path / "m.scenario.yaml") as trial:
        trial.host(mapper)
        assert trial.finish() == ()
    (tmp_path / "m.scenario.yaml").write_text(SCENARIO.replace("false_safe", "falsesafe"))
    with pytest.raises(UsageError, match="false_safe"):
        plan([tmp_path / "m.scenario.yaml"])
