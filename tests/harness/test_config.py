"""What determines an episode: defaults, edges of what is valid, counts of ticks, its world."""

import json
import math
import os
import subprocess
import sys
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest
from harness.world.terrain_file import TerrainFile

from harness.base.errors import UsageError
from harness.base.sim_time import TICKS_PER_CONTROL
from harness.spec.ros import FrameOptions, RosOptions
from harness.spec.run import Run
from harness.world.world import terrain_hash
from tests.support.rovers import LEO, ROVER_ZERO4WD


def test_the_process_that_publishes_an_episode_loads_neither_mujoco_nor_compiled_kernels() -> None:
    script = (
        "import sys, harness.run, harness.ros.session;"
        "print(sorted({'mujoco', 'numba'} & set(sys.modules)))"
    )
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert run.stdout == "[]\n"


def test_the_defaults_are_those_of_the_command_line() -> None:
    untold = "terrain_size terrain_height terrain_cell rock_height start noise sensors cmd_vel_timeout"
    empty = "resource_path rock hazard faults commands actors goals resets"
    expected = dict.fromkeys([*untold.split(), "goal_area"], None) | dict.fromkeys(empty.split(), ())
    assert asdict(Run()) == expected | {
        "terrain": "rocky",
        "robot": "leo",
        "seed": 0,
        "duration": 60.0,
        "driver": "wander",
        "difficulty": 0.5,
        "datum": (38.4064, -110.7919, 1382.0),
        "mesh_unit": "",
        "mesh_up": "",
        "timestep": 0.0025,
        "lidar_beams": 640,
        "imu_rate": 20,
        "name": "",
        "number": 0,
        "world_robot": "",
    }
    assert RosOptions(log_dir=Path()) == RosOptions(
        log_dir=Path(),
        host_metrics=True,
        wait_for=(),
        rate=None,
        ros_args=(),
        cmd_vel="auto",
        record=None,
        overwrite=False,
        frames=FrameOptions(odom_tf="ground_truth", odom_tf_3d=False, map_tf=False),
    )


@pytest.mark.parametrize(
    ("duration", "ticks", "periods"),
    [
        (0.01, 1, 1),
        (0.05, 5, 1),
        (0.06, 6, 2),
        (0.29, 29, 6),
        (2.05, 205, 41),
        (3600.0, 360_000, 72_000),
    ],
)
def test_an_episode_has_a_tick_each_10_ms_and_a_batch_each_50_ms_or_part_of_it(
    duration: float, ticks: int, periods: int
) -> None:
    config = Run.of(duration=duration)
    assert TICKS_PER_CONTROL == 5
    assert (config.total_ticks, config.total_periods) == (ticks, periods)


@pytest.mark.parametrize(
    "edge",
    [
        {"seed": 0},
        {"difficulty": 0.0},
        {"difficulty": 1.0},
        {"lidar_beams": 2},
        {"lidar_beams": 100_000},
        {"imu_rate": 1},
        {"imu_rate": 100},
        {"driver": "cmd_vel", "cmd_vel_timeout": 0.05},
        {"noise": "white"},
        {"noise": "hardware"},
        {"faults": ("imu:nan",)},
        {"start": (1.0, -2.0, math.tau)},
        {"start": (1.0, -2.0, -math.tau)},
        {"terrain": "no/such.npy", "terrain_size": (10.0, 50_000.0), "terrain_height": 0.0},
    ],
    ids=str,
)
def test_a_value_at_the_edge_of_what_is_valid_is_accepted(edge: dict[str, object]) -> None:
    Run.of(**edge).validate()  # type: ignore[arg-type]  # a table of keywords


@pytest.mark.parametrize(
    ("beyond", "told"),
    [
        (
            {"commands": ((1.0, 0.3, 0.0),)},
            "driver 'wander' is told nothing; this needs driver 'cmd_vel'",
        ),
        (
            {"driver": "cmd_vel", "commands": ((1.0, math.nan, 0.0),)},
            "a command or goal is not valid; give finite numbers",
        ),
        (
            {"driver": "cmd_vel", "commands": ((60.0, 0.3, 0.0),)},
            "an event at 60 s is not in the run of 60 s",
        ),
        (
            {"goals": ((0.0, 1.0, 2.0, 0.0),)},
            "driver 'wander' is told nothing; this needs driver 'goal'",
        ),
        (
            {"driver": "goal", "goals": ((0.0, 1.0, math.inf, 0.0),)},
            "a command or goal is not valid; give finite numbers",
        ),
        ({"resets": (-0.1,)}, "an event at -0.1 s is not in the run of 60 s"),
        ({"resets": (math.nan,)}, "an event at nan s is not in the run of 60 s"),
        ({"seed": -1}, "seed -1 is not valid; give a whole number from 0 up"),
        ({"difficulty": -1e-9}, "difficulty -1e-09 is not valid; give 0 to 1"),
        ({"difficulty": 1.001}, "difficulty 1.001 is not valid; give 0 to 1"),
        ({"difficulty": math.nan}, "difficulty nan is not valid; give 0 to 1"),
        ({"lidar_beams": 1}, "1 lidar beams are not valid; give 2 to 100000"),
        ({"lidar_beams": 100_001}, "100001 lidar beams are not valid; give 2 to 100000"),
        ({"imu_rate": 0}, "rate 0 Hz does not divide"),
        ({"timestep": 0.003}, "timestep 0.003 s is refused"),
        ({"duration": 0.0}, "duration 0 s is not valid"),
        (
            {"driver": "cmd_vel", "cmd_vel_timeout": 0.049},
            "command timeout 0.049 s is not valid; give 0.05 or more",
        ),
        ({"driver": "cmd_vel", "cmd_vel_timeout": math.inf}, "command timeout inf s is not valid"),
        (
            {"cmd_vel_timeout": 1.0},
            "--cmd-vel-timeout is for --driver cmd_vel only; other drivers go on",
        ),
        ({"noise": ""}, "'' does not exist; available: white, hardware, gazebo"),
        ({"faults": ("imu:gone",)}, "gone"),
        ({"start": (0.0, math.nan, 0.0)}, "start 0,nan,0 is not valid; give x and y in metres"),
        ({"datum": (90.0, 0.0, 0.0)}, "datum: latitude 90 is not valid; give -89.9 to 89.9 degrees"),
        ({"actors": ("walker",)}, "actor 'walker' is not valid; give [NAME=]FILE"),
        (
            {"goal_area": (0.0, 1.0, 0.0, 1.0)},
            "a goal area gives goals by itself: it needs driver 'goal' or a policy",
        ),
        (
            {"driver": "goal", "goal_area": (0, 1, 0, 1), "goals": ((0.0, 1.0, 2.0, 0.0),)},
            "a goal area gives goals by itself: leave out the goals",
        ),
        ({"driver": "goal", "goal_area": (1.0, 0.0, 0.0, 1.0)}, "goal area 1,0,0,1 is not valid"),
        ({"robot": "r2d2"}, "robot 'r2d2' does not exist"),
        ({"driver": "drunk"}, "driver 'drunk' does not exist"),
        ({"terrain": "moon"}, "terrain 'moon' does not exist; available: flat, slope, rolling, gravel"),
        (
            {"terrain": "a.npy", "difficulty": 0.6},
            "a terrain from a file has no difficulty; leave out --difficulty",
        ),
        ({"terrain": "a.npy", "terrain_height": -1.0}, "terrain height -1 m is not valid"),
        *(
            ({option.replace("-", "_"): 0.0}, f"--{option} applies to terrains from files only")
            for option in (
                *("terrain-size", "terrain-height", "terrain-cell", "resource-path", "mesh-unit"),
                *("mesh-up", "rock-height", "rock", "hazard"),
            )
        ),
    ],
    ids=str,
)
def test_a_value_beyond_it_is_refused_in_one_line(beyond: dict[str, object], told: str) -> None:
    with pytest.raises(UsageError) as refusal:
        Run.of(**beyond).validate()  # type: ignore[arg-type]  # a table of keywords
    assert told in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_what_a_terrains_file_leaves_open_is_what_was_told_and_the_rover_that_sorts_its_obstacles(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    rovers = {"leo": replace(LEO, step_limit=0.04), "rover_zero4wd": ROVER_ZERO4WD}
    monkeypatch.setattr("harness.config.find_rover", rovers.__getitem__)
    told = Run.of(
        terrain="a.sdf",
        robot="rover_zero4wd",
        world_robot="leo",
        terrain_size=(1.0, 2.0),
        terrain_height=3.0,
        terrain_cell=4.0,
        resource_path=("p", "q"),
        mesh_unit="cm",
        mesh_up="y",
        rock_height=5.0,
        rock=("r",),
        hazard=("h",),
    )
    expected = TerrainFile(
        path=Path("a.sdf"),
        size=(1.0, 2.0),
        relief=3.0,
        needs_start=True,
        folders=(Path("p"), Path("q")),
        cell=4.0,
        mesh_unit="cm",
        mesh_up="y",
        rock_height=5.0,
        rocks=("r",),
        hazards=("h",),
        clearance=LEO.clearance,
        step_limit=0.04,
    )
    assert told._terrain_file() == expected
    own = replace(told, world_robot="", start=(0.0, 0.0, 0.0))._terrain_file()
    assert own == replace(
        expected,
        needs_start=False,
        clearance=ROVER_ZERO4WD.clearance,
        step_limit=ROVER_ZERO4WD.step_limit,
    )
    assert own.clearance != expected.clearance


def test_a_file_on_which_nobody_can_stand_is_a_world_for_whoever_chooses_a_start(tmp_path: Path) -> None:
    np.save(tmp_path / "steep.npy", np.add.outer(np.linspace(0.0, 20.0, 41), np.zeros(41)))
    steep = Run.of(terrain=str(tmp_path / "steep.npy"), terrain_size=(20.0, 20.0))
    with pytest.raises(UsageError, match="no rover can stand within"):
        steep.world()
    assert replace(steep, start=(1.0, 2.0, 3.0)).world().start == (1.0, 2.0, 3.0)


def test_a_file_that_has_been_written_anew_is_another_world(tmp_path: Path) -> None:
    path, ramp = tmp_path / "ramp.npy", np.add.outer(np.linspace(0.0, 1.0, 41), np.zeros(41))
    config = Run.of(terrain=str(path), terrain_size=(20.0, 30.0), seed=3)
    for second, relief in enumerate((1.0, 2.0), start=1):
        np.save(path, relief * ramp)
        os.utime(path, (second, second))
        world = config.world()
        assert np.ptp(world.ground.heights) == pytest.approx(relief)
        assert (world.ground.half_size, world.seed) == ((10.0, 15.0), 3)
    assert config.world() is config.world()


@pytest.mark.parametrize("fault", ["imu:nan@{}", "imu:nan@{}+5", "clock:reset@{}"])
def test_a_fault_may_begin_with_the_last_tick_but_not_after_it(fault: str) -> None:
    for begin in (0.0, 2.99, 3.0):
        Run.of(duration=3.0, faults=(fault.format(begin),)).validate()
    late = fault.format(3.01)
    with pytest.raises(UsageError) as refused:
        Run.of(duration=3.0, faults=("imu:nan", late)).validate()
    assert str(refused.value) == (
        f"fault '{late}' begins after the end of the run at 3 s; begin it earlier, or give a longer "
        "--duration"
    )


def test_a_manifest_s_arguments_make_the_same_episode_again() -> None:
    config = Run.of(
        terrain="a.npy", terrain_size=(20.0, 30.0), start=(1.0, 2.0, 0.5), faults=("imu:nan",)
    )
    again = Run.of(**json.loads(json.dumps(asdict(config))))
    assert again == config
    assert hash(again) == hash(config)


def test_gravity_and_people_are_those_of_a_world_that_tells_of_them(tmp_path: Path) -> None:
    moon = tmp_path / "moon.sdf"
    ground = "<collision name='c'><geometry><plane><size>20 20</size></plane></geometry></collision>"
    way = "".join(
        f"<waypoint><time>{n}</time><pose>{n} 0 0 0 0 0</pose></waypoint>" for n in range(1, 3)
    )
    moon.write_text(
        "<sdf version='1.9'><world name='moon'><gravity>0 0 -1.62</gravity>"
        f"<model name='m'><static>1</static><link name='l'>{ground}</link></model>"
        f"<actor name='ann'><script><trajectory id='0' type='walk'>{way}</trajectory></script></actor>"
        "</world></sdf>"
    )
    people = Run.of(terrain=str(moon), actors=("bob=5,6",)).actor_names()
    assert people == ("ann_actor", "bob_actor"), "first those of the world"
    assert Run.of(terrain=str(moon)).gravity() == 1.62
    assert Run.of(terrain="flat").gravity() == 9.8
    Run.of(terrain=str(moon)).check_world()
    off = tmp_path / "off.sdf"
    off.write_text(moon.read_text().replace("<pose>2 0", "<pose>99 0"))
    with pytest.raises(UsageError, match="ann"):
        Run.of(terrain=str(off)).check_world()


def test_the_world_is_that_of_terrain_seed_and_difficulty_and_the_start_changes_nothing_else() -> None:
    told = Run.of(terrain="gravel", seed=7, difficulty=0.25)
    given, world = (replace(told, start=start).world() for start in ((3.0, -4.0, 1.0), None))
    assert (world.name, world.seed, world.difficulty) == ("gravel", 7, 0.25)
    assert (given.start, world.start) == ((3.0, -4.0, 1.0), (0.0, 0.0, 0.0))
    assert terrain_hash(given) == terrain_hash(world)
