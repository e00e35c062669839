"""What is in examples/, as far as it can be checked without Nav2, Foxglove and PlotJuggler."""

import json
import re
import runpy
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import pytest
from ruamel.yaml import YAML
from scipy import stats

from harness.robots import find_rover
from harness.robots.lidar import LidarSpec
from harness.spec.run import Run
from tests.support.layouts import FOXGLOVE, foxglove_panels
from tools.site.notebooks import as_markdown as told
from tools.site.pages import NOTEBOOKS

EXAMPLES = Path(__file__).parents[1] / "examples"
NAV2 = EXAMPLES / "nav2"
BASES = {"leo": "base_footprint", "rover_zero4wd": "base_link"}
COSTMAPS = ("local_costmap", "global_costmap")


def leaves(tree: Any, path: tuple[str, ...] = ()) -> dict[tuple[str, ...], Any]:  # noqa: ANN401 - YAML
    """Every value by the names above it, dotted names split."""
    if not isinstance(tree, dict):
        return {path: tree}
    found: dict[tuple[str, ...], Any] = {}
    for name, below in tree.items():
        found |= leaves(below, (*path, *name.split(".")))
    return found


def parameters(*files: str) -> dict[tuple[str, ...], Any]:
    """What Nav2 gets of files of which the later ones win."""
    merged: dict[tuple[str, ...], Any] = {}
    for file in files:
        merged |= leaves(YAML(typ="safe").load(NAV2 / file))
    return merged


def of(given: dict[tuple[str, ...], Any], *names: str) -> list[Any]:
    """The values whose path ends with these names, of every node that has them."""
    return [value for path, value in given.items() if path[-len(names) :] == names]


@pytest.mark.parametrize("robot", BASES)
def test_nav2_is_told_the_frames_the_outline_and_the_lidar_of_the_rover(robot: str) -> None:
    given, rover = parameters("nav2.yaml", f"{robot}.yaml"), find_rover(robot)
    x_min, x_max, y_min, y_max = rover.footprint
    assert set(of(given, "global_frame")) == {"odom"}
    assert of(given, "robot_base_frame") == [rover.odometry_child_frame] * 4 == [BASES[robot]] * 4
    corners = {(x, y) for x in (x_min, x_max) for y in (y_min, y_max)}
    for outline in of(given, "footprint"):
        assert {tuple(corner) for corner in YAML(typ="safe").load(outline)} == corners
    assert len(of(given, "footprint")) == len(COSTMAPS)
    circumscribed = max(abs(x) ** 2 + abs(y) ** 2 for x, y in corners) ** 0.5
    assert min(of(given, "inflation_radius")) > circumscribed
    lidar = LidarSpec()
    assert set(of(given, "scan", "obstacle_min_range")) == {lidar.range_min}
    assert max(of(given, "scan", "obstacle_max_range")) < lidar.range_max
    assert set(of(given, "scan", "sensor_frame")) == {"lidar_link"}
    assert {str(topic).strip("/") for topic in of(given, "odom_topic")} == {"odom_ground_truth"}


@pytest.mark.parametrize("robot", BASES)
def test_the_smoother_lets_through_what_the_controller_may_ask_for(robot: str) -> None:
    given = parameters("nav2.yaml", f"{robot}.yaml")
    ask = {name[-1]: value for name, value in given.items() if "FollowPath" in name}
    (most,), (least,) = of(given, "max_velocity"), of(given, "min_velocity")
    assert most == [ask["max_vel_x"], 0.0, ask["max_vel_theta"]]
    assert least == [ask["min_vel_x"], 0.0, -ask["max_vel_theta"]]
    assert of(given, "max_accel") == [[ask["acc_lim_x"], 0.0, ask["acc_lim_theta"]]]
    assert of(given, "max_decel") == [[ask["decel_lim_x"], 0.0, ask["decel_lim_theta"]]]
    assert of(given, "feedback") == ["OPEN_LOOP"]


@pytest.fixture
def launched(monkeypatch: pytest.MonkeyPatch) -> Any:  # noqa: ANN401 - a function
    """Gives the nodes of the launch file for a robot on a distribution; stand-ins of launch remember."""

    def launch(distribution: str, robot: str) -> list[Any]:
        monkeypatch.setenv("ROS_DISTRO", distribution)
        stand_ins: dict[str, dict[str, Any]] = {
            "launch": {"LaunchDescription": list, "LaunchContext": dict},
            "launch.actions": {
                "DeclareLaunchArgument": lambda name, **more: (name, more["default_value"]),
                "OpaqueFunction": lambda function: function,
            },
            "launch.substitutions": {
                "LaunchConfiguration": lambda name: SimpleNamespace(perform=lambda given: given[name])
            },
            "launch_ros": {},
            "launch_ros.actions": {"Node": SimpleNamespace},
        }
        for name, members in stand_ins.items():
            module = ModuleType(name)
            vars(module).update(members)
            monkeypatch.setitem(sys.modules, name, module)
        declared, nodes = runpy.run_path(str(NAV2 / "nav2.launch.py"))["generate_launch_description"]()
        assert declared == ("robot", "leo")
        started: list[Any] = nodes({"robot": robot})
        return started

    return launch


@pytest.mark.parametrize("distribution", ["humble", "jazzy", "kilted"])
@pytest.mark.parametrize("robot", BASES)
def test_the_launch_file_starts_the_nodes_with_files_that_are_there(
    launched: Any,  # noqa: ANN401 - a function
    distribution: str,
    robot: str,
) -> None:
    *nodes, manager = launched(distribution, robot)
    assert manager.parameters[0]["node_names"] == [node.name for node in nodes]
    files = [Path(file).name for file in nodes[0].parameters]
    assert files == ["nav2.yaml", f"{robot}.yaml", "humble.yaml"][: 3 if distribution == "humble" else 2]
    assert all(node.parameters == nodes[0].parameters for node in nodes)
    given = parameters(*files)
    assert {name for name, *_ in given} - {"/**", *COSTMAPS} == {node.name for node in nodes}
    separator = "/" if distribution == "humble" else "::"
    assert of(given, "GridBased", "plugin") == [f"nav2_smac_planner{separator}SmacPlanner2D"]
    for behavior in given["behavior_server", "ros__parameters", "behavior_plugins"]:
        (plugin,) = of(given, behavior, "plugin")
        assert plugin.startswith(f"nav2_behaviors{separator}")


def test_only_the_smoother_sends_what_the_rover_hears(launched: Any) -> None:  # noqa: ANN401 - a function
    for node in launched("kilted", "leo")[:-1]:
        sent = {"controller_server": "cmd_vel", "behavior_server": "cmd_vel"}.get(node.name)
        sent = "cmd_vel_smoothed" if node.name == "velocity_smoother" else sent
        heard = dict(node.remappings).get(str(sent), sent)
        assert (heard == "cmd_vel") == (node.name == "velocity_smoother")


def test_a_robot_without_parameters_is_refused_by_name(launched: Any) -> None:  # noqa: ANN401 - a function
    with pytest.raises(RuntimeError, match=r"robot:=husky; give one of leo, rover_zero4wd$"):
        launched("kilted", "husky")


def test_the_foxglove_layout_shows_each_of_its_panels_once() -> None:
    def shown(node: Any) -> list[str]:  # noqa: ANN401 - JSON
        return [node] if isinstance(node, str) else [*shown(node["first"]), *shown(node["second"])]

    layout = json.loads(FOXGLOVE.read_text())["layout"]
    assert sorted(shown(layout)) == sorted(foxglove_panels())


@pytest.mark.parametrize("name", [path.stem for path in EXAMPLES.glob("*.ipynb")])
def test_a_notebook_is_kept_without_what_a_machine_made_of_it_and_is_on_the_site(name: str) -> None:
    cells = json.loads((EXAMPLES / f"{name}.ipynb").read_text())["cells"]
    ran = [(cell["outputs"], cell["execution_count"]) for cell in cells if cell["cell_type"] == "code"]
    assert ran == [([], None)] * len(ran)
    assert name in NOTEBOOKS


def ran(name: str, **given: object) -> tuple[str, dict[str, Any]]:
    """What the site tells of a notebook with these parameters, and what its cells defined."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("MPLBACKEND", "Agg")
        names: dict[str, Any] = {}
        return told(EXAMPLES / f"{name}.ipynb", given, names), names


def test_the_first_run_shows_its_log_and_draws_clearance_and_path(tmp_path: Path) -> None:
    config = Run.of(terrain="rocky", duration=3.0)
    text, names = ran("first_run", CONFIG=config, LOGS=tmp_path)
    log = pd.read_csv(names["result"].log_path)
    assert re.search(rf"^2 +{log.Timestamp[2]} +0 +{log['Obstacle Clearance'][2]}", text, re.MULTILINE)
    assert text.count("](data:image/png;base64,") == 2
    assert f"{names['result'].truth.path_length:.2f} m driven, 0 contacts, 3 rows" in text
    assert names["axes"].get_lines()[0].get_xydata().tolist() == [
        [x, y] for x, y, _ in names["result"].along.path
    ]


def test_two_rovers_are_compared_world_by_world(tmp_path: Path) -> None:
    text, names = ran("compare_rovers", METRICS=("OC",), SEEDS=range(2), DURATION=1.0, LOGS=tmp_path)
    means = [
        np.array([pd.read_csv(log)["Obstacle Clearance"].mean() for log in logs])
        for logs in names["logs"].values()
    ]
    difference = means[1] - means[0]
    clearance = names["table"].loc["Obstacle clearance [m]"]
    assert clearance["paired"]
    half = stats.t.ppf(0.975, 1) * stats.sem(difference)
    expected = [means[0].mean(), means[1].mean(), difference.mean(), difference.mean() - half]
    columns = ["means_first", "means_second", "difference", "interval_low"]
    assert clearance[columns].to_list() == pytest.approx(expected)
    assert text.count("](data:image/png;base64,") == 1


def test_the_policy_of_the_notebook_reaches_the_goal_and_is_evaluated() -> None:
    text, names = ran("learn", TERRAINS=["gravel"], EPISODES=1)
    assert names["info"]["ending"] == "reached"
    assert names["policy"].beams == LidarSpec().beams  # as harness.run has it without further words
    drawn = names["axes"].get_lines()[-2].get_xydata()
    assert np.hypot(*(drawn[-1] - names["goal"])) < 0.5
    rows = re.findall(r"^\| (learned|straight) \| gravel \| \d of 1 ", text, re.MULTILINE)
    assert rows == ["learned", "straight"]
