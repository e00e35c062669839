"""A run as one value: made of text or of JSON, refused in one line, the same after a round trip."""

import json
import math
import pickle
import subprocess
import sys
from typing import Any

import pytest

from harness.base.errors import UsageError
from harness.robots.sections import Drive, Tyres
from harness.sensors.noise import PRESETS
from harness.spec import Run
from harness.spec.fleet import parse_rovers
from harness.spec.live import LiveOptions
from harness.spec.ros import FrameOptions
from harness.spec.run import OWNERS
from harness.spec.value import Value, made

NOWHERE = {"at": None, "lat": None, "lon": None, "target": "", "stop": False}
FULL: dict[str, Any] = {  # another value than the default for each field
    "terrain": "a.sdf",
    "difficulty": 0.25,
    "soil": "clay",
    "keep_ruts": True,
    "terrain_size": [20.0, 30.0],
    "terrain_height": 3.0,
    "terrain_cell": 0.5,
    "terrain_roughness": "F",
    "resource_path": ["p", "q"],
    "mesh_unit": "cm",
    "mesh_up": "y",
    "rock_height": 0.3,
    "rock": ["r"],
    "hazard": ["h"],
    "actors": ["guide=1,2/3,4.5:speed=0.5,route=closed", "a/b.sdf:delay=2", "w=social"],
    "targets": ["start=aruco:id=3,x=5,y=2", "gate:lat=38.4,lon=-110.7", "a/b.obj:texture=c.png"],
    "datum": [-33.9, 151.2, 20.0],
    "name": "a",
    "robot": "rover_zero4wd",
    "start": [1.0, 2.0, -0.5],
    "driver": "goal",
    "goal_area": [0.0, 1.0, 2.0, 3.0],
    "cmd_vel_timeout": 0.5,
    "lidar_beams": 90,
    "imu_rate": 50,
    "actuators": "real",
    "surface": "ice",
    "noise": "hardware",
    "sensors": ["lidar3d=vlp16", "gnss"],
    "faults": ["imu:nan@1+2", "clock:jump=-3@4"],
    "route": {
        "points": [
            NOWHERE | {"at": [1.0, 2.0], "radius": 0.5, "within": 9.0},
            NOWHERE | {"target": "start", "radius": 1.0, "within": None, "stop": True},
        ],
        "order": "any",
        "limit": 60.0,
    },
    "drivers": [[1.5, "cmd_vel"]],
    "commands": [[0.0, 0.3, -0.1]],
    "goals": [[1.0, 2.0, 3.0, 0.5]],
    "resets": [2.5],
    "aborts": [1.5],
    "resumes": [3.5],
    "link_losses": [[1.0, 2.0]],
    "duration": 7.0,
    "timestep": 0.005,
    "seed": 4,
}


@pytest.mark.parametrize(
    "value",
    [Run(), LiveOptions(), FrameOptions(), Drive(), Tyres(), *(one.ranges for one in PRESETS.values())],
)
def test_what_the_program_states_unchecked_is_valid(value: Value) -> None:
    assert made(type(value), value.model_dump()) == value


def test_every_field_survives_json_and_pickle() -> None:
    assert FULL.keys() == OWNERS.keys()
    run = Run.of(**FULL)
    assert run.fields() == FULL
    assert all(run.fields()[name] != value for name, value in Run().fields().items())
    assert Run.of(**json.loads(json.dumps(run.fields()))) == run
    assert made(Run, json.loads(run.model_dump_json())) == run
    again = pickle.loads(pickle.dumps(run))  # noqa: S301 - as a spawned process gets it
    assert (again, hash(again)) == (run, hash(run))


@pytest.mark.parametrize("name", sorted(FULL))
def test_a_changed_field_changes_nothing_else(name: str) -> None:
    changed = Run().alone(**{name: FULL[name]}).fields()
    assert changed == Run().fields() | {name: FULL[name]}


@pytest.mark.parametrize(
    ("name", "text", "value"),
    [
        ("start", "-1.5,2", [-1.5, 2.0, 0.0]),
        ("start", "-1.5,2,0.25", [-1.5, 2.0, 0.25]),
        ("datum", "-33.9,151.2", [-33.9, 151.2, 0.0]),
        ("goal_area", "-.5,2,-3,4", [-0.5, 2.0, -3.0, 4.0]),
        ("terrain_size", "30", [30.0, 30.0]),
        ("terrain_size", ["30", "40"], [30.0, 40.0]),
        ("targets", "post:x=1,y=2", ["post:x=1,y=2"]),
        ("sensors", "gnss, lidar3d=vlp16", ["gnss", "lidar3d=vlp16"]),
        ("sensors", "none", ["none"]),
        ("sensors", [], ["none"]),
        ("faults", "imu:nan", ["imu:nan"]),
        ("seed", "7", 7),
        ("duration", "2.5", 2.5),
    ],
)
def test_text_becomes_the_value_that_it_means(name: str, text: object, value: object) -> None:
    assert Run.of(**{name: text}).fields()[name] == value


@pytest.mark.parametrize(
    "edge",
    [
        {"difficulty": 0.0},
        {"difficulty": 1.0},
        {"lidar_beams": 2},
        {"lidar_beams": 100_000},
        {"imu_rate": 1},
        {"imu_rate": 100},
        {"cmd_vel_timeout": 0.05},
        {"start": (1.0, -2.0, math.tau)},
        {"start": (1.0, -2.0, -math.tau)},
        {"terrain_size": (10.0, 50_000.0), "terrain_height": 0.0},
        {"duration": 3.0, "faults": ["imu:nan@3.0"]},
        {"duration": 3.0, "resets": [2.99]},
    ],
    ids=str,
)
def test_the_edges_of_what_is_valid_are_valid(edge: dict[str, Any]) -> None:
    Run.of(**edge)


@pytest.mark.parametrize(
    ("wrong", "mend"),
    [
        ({"terain": "x"}, "did you mean 'terrain'?"),
        ({"zzz": "x"}, "available: terrain, "),
        ({"seed": -1}, "give 0 or more"),
        ({"seed": "1.5"}, "give a whole number"),
        ({"seed": True}, "seed True is not valid; give a number"),
        ({"start": [True, 0, 0]}, "give a number"),
        ({"difficulty": -1e-9}, "give 0 to 1"),
        ({"difficulty": 1.001}, "give 0 to 1"),
        ({"difficulty": math.nan}, "give 0 to 1"),
        ({"lidar_beams": 1}, "give 2 to 100000"),
        ({"lidar_beams": 100_001}, "give 2 to 100000"),
        ({"imu_rate": 33}, "nearest valid: 20 or 25"),
        ({"timestep": 0.003}, "nearest valid: "),
        ({"duration": 0.0}, "give 0.01 s or more"),
        ({"duration": 0.015}, "nearest valid: 0.01 or 0.02"),
        ({"duration": "long"}, "give a number"),
        ({"cmd_vel_timeout": 0.049}, "give 0.05 or more"),
        ({"cmd_vel_timeout": math.inf}, "give a finite number"),
        ({"terrain_size": 9.9}, "give 10 to 50000"),
        ({"terrain_size": (20, 20, 20)}, "give at most 2"),
        ({"terrain_cell": 0.01}, "give 0.02 to 10"),
        ({"rock_height": -0.1}, "give 0 to 10000"),
        ({"start": "1"}, "give X,Y or X,Y,YAW in metres and radians"),
        ({"start": "1,north"}, "give X,Y or X,Y,YAW in metres and radians"),
        ({"start": (0.0, math.nan, 0.0)}, "give a finite number"),
        ({"start": (0.0, 0.0, 90.0)}, "yaw in radians from -6.28 to 6.28"),
        ({"goal_area": (1.0, 0.0, 0.0, 1.0)}, "XMIN below XMAX"),
        ({"goal_area": "1,2,3"}, "give XMIN,XMAX,YMIN,YMAX in metres"),
        ({"name": "1a"}, "a letter first"),
        ({"commands": [(60.0, 0.3, 0.0)]}, "not in the run of 60 s"),
        *(
            ({"duration": 1.0, name: FULL[name]}, "s is not in the run of 1 s")
            for name in ("drivers", "goals", "resets", "aborts", "resumes", "link_losses")
        ),
        ({"goals": [(0.0, 1.0, math.inf, 0.0)]}, "give a finite number"),
        ({"resets": [-0.1]}, "give 0 or more"),
        ({"faults": ["imu"]}, "SENSOR:FAULT[=VALUE][@START[+LENGTH]]"),
        ({"faults": ["imu:nan@soon"]}, "give seconds from 0 up"),
        ({"faults": ["imu:nan@1+0"]}, "give more, or leave it out"),
        ({"faults": ["imu:nan@60.1"]}, "begin it earlier, or give a longer --duration"),
        ({"actors": ["walker"]}, "give [NAME=]FILE.sdf"),
        ({"actors": ["1,2/3,4"]}, "has no name"),
        ({"actors": ["a=random:sped=1"]}, "did you mean 'speed'?"),
        ({"actors": ["a=random:speed=99"]}, "give 0.05 to 10"),
        ({"actors": ["a=random:route=back"]}, "give one of 'mirror' or 'closed'"),
        ({"actors": ["a=random:radius=1,height=1.5"]}, "give a smaller radius"),
        ({"rovers": []}, "key 'rovers' does not exist"),
    ],
    ids=str,
)
def test_a_mistake_is_one_line_with_the_mend(wrong: dict[str, Any], mend: str) -> None:
    with pytest.raises(UsageError) as refused:
        Run.of(**wrong)
    assert mend in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("duration", "ticks", "periods"), [(0.01, 1, 1), (0.05, 5, 1), (0.06, 6, 2), (2.05, 205, 41)]
)
def test_a_run_has_a_tick_each_10_ms_and_a_batch_each_50_ms_or_part(
    duration: float, ticks: int, periods: int
) -> None:
    run = Run.of(duration=duration)
    assert (run.total_ticks, run.total_periods) == (ticks, periods)


def test_rovers_share_what_is_not_their_own() -> None:
    shared = Run.of(noise="white", start="1,2", faults="scan:nan", cmd_vel_timeout=1.0).rover
    words = "leo:a,fault=imu:nan@1,fault=odometry:dropout", "rover_zero4wd,x=3,y=4,driver=cmd_vel"
    first, second = parse_rovers((*words, "leo:c,sensors=gnss+lidar3d=vlp16,noise=gazebo")[:2], shared)
    assert (first.name, first.robot, first.start, first.cmd_vel_timeout) == ("a", "leo", (1, 2, 0), None)
    assert [str(fault) for fault in first.faults] == ["scan:nan", "imu:nan@1", "odometry:dropout"]
    assert (second.name, second.start, second.driver) == ("rover2", (3.0, 4.0, 0.0), "cmd_vel")
    assert (second.noise, second.cmd_vel_timeout) == ("white", 1.0)
    (_, third) = parse_rovers((words[0], "leo:c,sensors=gnss+lidar3d=vlp16,noise=gazebo"), shared)
    assert (third.noise, third.start) == ("gazebo", None)
    assert [str(choice) for choice in third.sensors or ()] == ["gnss", "lidar3d=vlp16"]


@pytest.mark.parametrize(
    ("text", "mend"),
    [
        ("leo:1a", "a letter first"),
        (
            "leo:a,colour=red",
            "available: x, y, yaw, driver, noise, actuators, surface, sensors, fault=VALUE",
        ),
        ("leo:a,x=1", "give both, in metres"),
        ("leo:a,x=1,y=north", "give a number"),
        ("leo:a,fault=clock:freeze@1", "give its faults as --fault"),
    ],
)
def test_a_mistyped_rover_is_one_line(text: str, mend: str) -> None:
    with pytest.raises(UsageError, match=f"^--rover {text}: .*{mend}") as refused:
        parse_rovers([text], Run().rover)
    assert "\n" not in str(refused.value)


def test_rovers_differ_in_their_seeds_alone_where_they_are_alike() -> None:
    seeds = [Run.of(seed=5).own_seed(number) for number in range(4)]
    assert seeds[0] == 5
    assert len(set(seeds)) == 4
    assert seeds != [Run.of(seed=6).own_seed(number) for number in range(4)]


def test_a_run_through_ros_loads_mujoco_and_compiled_kernels_while_nodes_are_discovered() -> None:
    script = (
        "import sys, harness.cli.run_command, harness.ros.session;"
        "print(sorted({'mujoco', 'numba'} & set(sys.modules)))"
    )
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert run.stdout == "[]\n"
