"""Files and folders of scenarios to runs."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.base.errors import UsageError
from harness.robots.content import MODELS_DIR
from harness.scenario.case import find_files, plan
from harness.spec.run import Run
from tests.harness.scenario.conftest import MakeCases, cases_with
from tests.support.documents import ROOT

SPEED = "{truth.speed: {min: 0}}"
HEAD = "about: a test\nterrain: flat\nduration: 2\n"
MATRIX = "matrix: {robot: [leo, rover_zero4wd], difficulty: [0, 1.0]}\nseeds: [4, 7]"


def test_every_combination_is_run_with_every_seed_and_can_be_repeated_alone(
    make_cases: MakeCases, tmp_path: Path
) -> None:
    cases = make_cases(SPEED, MATRIX)
    assert [case.name for case in cases] == [
        f"two[{robot}-{difficulty}-{seed}]"
        for robot in ("leo", "rover_zero4wd")
        for difficulty in ("0.0", "1.0")
        for seed in (4, 7)
    ]
    file = tmp_path / "two.scenario.yaml"
    assert cases[3].folder == Path(*tmp_path.parts[1:], "two@leo-1.0-7")
    outside = replace(cases[3], path=Path("../my runs/two.scenario.yaml"))
    assert outside.folder == Path("my runs/two@leo-1.0-7")
    words = "'../my runs/two.scenario.yaml' --seed 7 --only robot=leo --only difficulty=1.0"
    assert outside.command == f"python -m harness.scenario {words}"
    for one in ("1.0", "1"):
        assert plan([file], [7], (("robot", "leo"), ("difficulty", one))) == [cases[3]]
    assert [case.run.seed for case in plan([file], range(3))] == [0, 1, 2] * 4
    with pytest.raises(UsageError, match=r"yaml: 100,004 runs are more than 100,000; give fewer seeds"):
        plan([file], range(25_001))
    with pytest.raises(UsageError, match="no run has robot=mole; available: robot=leo, "):
        plan([file], None, (("robot", "mole"),))
    with pytest.raises(UsageError, match="robot: two are called 'rover'"):
        make_cases(SPEED, "matrix: {robot: [a/rover, b/rover]}")


def test_a_file_becomes_the_configuration_that_it_describes(
    make_cases: MakeCases, tmp_path: Path
) -> None:
    cases = make_cases(SPEED, "matrix: {driver: [goal, straight]}\ngoal: {at: [3, 4], yaw: 1}")
    assert [case.run.plan.goals for case in cases] == [((0.0, 3.0, 4.0, 1.0),), ()]
    grounds = "soil: [null, dry_sand], surface: [null, snow], actuators: [real]"
    runs = [case.run for case in make_cases(SPEED, f"robot: husky\nmatrix: {{{grounds}}}")]
    assert [(run.world.soil, run.rover.surface) for run in runs] == [
        *(("", ""), ("", "snow"), ("dry_sand", ""), ("dry_sand", "snow"))
    ]
    assert {run.rover.actuators for run in runs} == {"real"}
    route = "3,0/5,-2:radius=0.7,within=9,stop=true,limit=20"
    (case,) = make_cases(SPEED, f"driver: goal\nroute: {route}")
    assert case.run.plan.route == Run.of(driver="goal", route=route).plan.route
    more = """
driver: cmd_vel
events: [{at: 0.5, command: [0.3, 0]}, {at: 1, reset: true},
  {at: 1.2345678, fault: "scan:nan", for: 0.2}]
start: [1, 2, 0.5]
noise: white
lidar_beams: 8
datum: [1, 2, 3]
actors: ['p=walk.sdf:delay=1', random]"""
    walk = "<waypoint><time>1</time><pose>1 0 0 0 0 0</pose></waypoint>"
    walk = f"<actor name='a'><script><trajectory id='0'>{walk}</trajectory></script></actor>"
    (tmp_path / "walk.sdf").write_text(walk)
    (case,) = make_cases(SPEED, more)
    assert case.run == Run.of(
        terrain="flat",
        duration=2.0,
        driver="cmd_vel",
        start=(1.0, 2.0, 0.5),
        noise="white",
        lidar_beams=8,
        datum=(1.0, 2.0, 3.0),
        faults=("scan:nan@1.2345678+0.2",),
        commands=((0.5, 0.3, 0.0),),
        resets=(1.0,),
        actors=(f"p={tmp_path / 'walk.sdf'}:delay=1", "random"),
    )


def test_files_and_folders_stand_relative_to_the_scenario(make_cases: MakeCases, tmp_path: Path) -> None:
    np.save(tmp_path / "hill.npy", np.zeros((40, 40)))
    for name in ("mole", "leo", "flat"):  # a rover, but where one that ships is called so; no terrain
        (tmp_path / name).symlink_to(MODELS_DIR / "rover_zero4wd")
    runs = [case.run for case in make_cases(SPEED, "matrix: {robot: [mole, leo]}")]
    assert [run.rover.robot for run in runs] == [f"{tmp_path}/mole", "leo"]
    assert runs[0].world.terrain == "flat"
    (case,) = make_cases(SPEED)
    text = case.path.read_text().replace("terrain: flat", "matrix: {terrain: [hill.npy]}")
    case.path.write_text(f"{text}terrain_size: [40, 40]\nterrain_height: 1\n")
    (case,) = plan([case.path])
    assert case.run.world.terrain == str(tmp_path / "hill.npy")
    (tmp_path / "models").mkdir()
    (tmp_path / "a.world").write_text("<sdf version='1.9'><world name='a'/></sdf>")
    values = {"mesh_unit": "cm", "mesh_up": "y", "rock_height": 0.0}
    values |= {"resource_path": ["models", "elsewhere"], "rock": ["r*"], "hazard": ["h", "i"]}
    lines = "".join(f"{name}: {json.dumps(value)}\n" for name, value in values.items())
    case.path.write_text(f"{HEAD.replace('flat', 'a.world')}expect: {SPEED}\n{lines}")
    (case,) = plan([case.path])
    values["resource_path"] = [str(tmp_path / "models"), "elsewhere"]
    assert {name: case.run.fields()[name] for name in values} == values


@pytest.mark.parametrize(
    ("more", "mend"),
    [
        ("robot: mole", r":\d:8: robot 'mole' does not exist; available"),
        ("terrain_size: [40, 40]", ": .*terrain"),
        ("sensors: sonar", r":\d:10: .*sonar"),
        ("cmd_vel_timeout: 1", ": .*for --driver cmd_vel only"),
    ],
)
def test_what_no_run_can_be_is_told_with_the_file(make_cases: MakeCases, more: str, mend: str) -> None:
    with pytest.raises(UsageError, match=rf"two\.scenario\.yaml{mend}"):
        make_cases(SPEED, more)


def test_energy_can_only_be_expected_of_a_rover_with_a_battery(make_cases: MakeCases) -> None:
    energy = '{"log.Energy [Wh]": {max: 1}}'
    with pytest.raises(UsageError, match=r"Energy \[Wh\]' is of a rover with a battery; give sensors"):
        make_cases(energy)
    (case,) = make_cases(energy, "sensors: [battery]\nactuators: real")
    assert case.run.rover.actuators == "real"


def test_parameters_of_the_metrics_stand_beside_the_scenario_too(
    make_cases: MakeCases, tmp_path: Path
) -> None:
    near = "metrics_node: {ros__parameters: {collision_threshold: 5.0}}"
    for file in (f"my_rover: {{{near}}}", near):  # wherever the only metrics_node is
        cases = cases_with(make_cases, tmp_path, file)
        assert [case.params for case in cases] == [{"collision_threshold": 5.0}, {}]
    assert [case.name for case in cases] == ["two[near.yaml-0]", "two[null-0]"]
    assert plan([cases[0].path], None, (("params", "null"),)) == cases[1:]
    with pytest.raises(UsageError, match=r"two\.scenario\.yaml: params: .*near\.yaml: .*collision_t"):
        cases_with(make_cases, tmp_path, near.replace("old", "ol"))


def test_parts_in_a_file_stand_beside_the_scenario_too(tmp_path: Path) -> None:
    shutil.copy(ROOT / "examples/plugin/my_rover_parts.py", tmp_path / "parts.py")
    own = {"soil": "REGOLITH", "driver": "Weave", "terrain": "Crater"}
    lines = [f"{key}: parts.py:{name}" for key, name in own.items()]
    (tmp_path / "depth").touch()  # which is no part
    path = tmp_path / "own.scenario.yaml"
    about = [
        "about: a test",
        "duration: 2",
        f"expect: {SPEED}",
        "sensors: [parts.py:INCLINOMETER, depth]",
    ]
    path.write_text("\n".join([*about, *lines]))
    (case,) = plan([path])
    world, rover, there = case.run.world, case.run.rover, f"{tmp_path / 'parts.py'}:"
    assert [world.soil, rover.driver, world.terrain] == [f"{there}{name}" for name in own.values()]
    assert [str(choice) for choice in rover.sensors or ()] == [f"{there}INCLINOMETER", "depth"]


def test_a_failure_is_expected_of_the_runs_that_have_all_that_it_names(make_cases: MakeCases) -> None:
    known = (
        "[{reason: one, robot: leo, terrain: flat}, {reason: two, terrain: hill.npy},"
        " {reason: three, robot: rover_zero4wd}]"
    )
    (case,) = make_cases(SPEED, f"expected_to_fail: {known}")
    found = []
    for robot in ("leo", "robots/rover_zero4wd"):
        for terrain in ("flat", "slope", "maps/hill.npy"):
            told = replace(case, run=case.run.alone(robot=robot, terrain=terrain))
            found.append(told.expected_failure and told.expected_failure.reason)
    assert found == ["one", None, "two", "three", "three", "two"]


def test_files_are_found_in_order_and_what_is_not_there_is_told(tmp_path: Path) -> None:
    paths = [tmp_path / f"{name}.scenario.yaml" for name in ("b", "a", "c/d")]
    (tmp_path / "c").mkdir()
    (tmp_path / "e").mkdir()
    for path in paths:
        path.touch()
    (tmp_path / "other.yaml").touch()
    b, a, d = paths
    assert find_files([tmp_path]) == [a, b, d]
    assert find_files([b, tmp_path, d]) == [b, a, d]
    with pytest.raises(UsageError, match=r"there is no \*.scenario.yaml below .*e$"):
        find_files([tmp_path / "e"])
    with pytest.raises(UsageError, match="there is no scenario nowhere"):
        find_files([Path("nowhere")])
