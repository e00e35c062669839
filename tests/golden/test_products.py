"""What stands on a run gives the same run: scenarios and learning environments."""

import json
from contextlib import suppress
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode, SyncVectorEnv

import harness.gym  # noqa: F401 - registers its environments
from harness.scenario.__main__ import main as scenario
from tests.golden import kept
from tests.golden.drive import run_options
from tests.golden.evidence import read
from tests.golden.table import NONE, RUNS, GoldenRun

GROUND = ("terrain", "soil", "terrain_cell", "terrain_size", "mesh_unit")
WORLD = (*GROUND, "terrain_roughness", "rock", "targets", "route", "datum")
SETUP = ("robot", "driver", "noise", "sensors", "goal_area", "lidar_beams", "imu_rate", "actors")
# What no file of a scenario says: several rovers, a plan, another timestep, the way of the frames;
# faults of sensors change no drive of these, and are left out, too.
DRIVEN = [run for run in RUNS if not run.fault.startswith("cmd_vel")]
PLAIN = [run for run in DRIVEN if not run.is_fleet and not run.plan and run.numbers == NONE]
PUBLISHED = [
    run
    for run in RUNS
    if run.tf != NONE and not run.is_fleet and run.ros != "namespace" and "camera" not in run.sensors
]
IDS = ("RoverHarness/PointNav-v0", "RoverHarness/RoboTerrain-v0")


@pytest.mark.parametrize("run", PLAIN, ids=lambda run: run.name)
def test_a_scenario_drives_as_the_run_does(
    run: GoldenRun, files: dict[str, Path], tmp_path: Path
) -> None:
    fields = run_options(run, files, tmp_path).run.fields()
    keys = {key: fields[key] for key in (*WORLD, *SETUP) if fields.get(key) not in (None, [], "")}
    path_length = kept.references()[run.name]["summary"]["rover"]["path_length"]
    slack = 1e-6 if kept.references()[kept.ARITHMETIC] == kept.arithmetic() else kept.ABSOLUTE
    bounds = {"over": "end", "min": path_length - slack, "max": path_length + slack}
    times = {"duration": run.duration, "seed": int(run.no)}
    file = tmp_path / "a.scenario.yaml"
    expect = {"truth.path_length": [bounds]}
    file.write_text(json.dumps({"about": run.name, **keys, **times, "expect": expect}))
    assert scenario([str(file), "--jobs", "1", "--out", str(tmp_path / "out")]) == 0


@pytest.mark.parametrize("run", PUBLISHED[::6], ids=lambda run: run.name)
def test_a_trial_publishes_what_the_run_does(
    run: GoldenRun, files: dict[str, Path], tmp_path: Path
) -> None:
    pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")
    from harness.testing.trial import Trial  # noqa: PLC0415 - there may be no ROS

    before = kept.references()
    if before[kept.ARITHMETIC] != kept.arithmetic():
        pytest.skip("another arithmetic")
    options, folder = run_options(run, files, tmp_path), tmp_path / "kept"
    with (
        suppress(InterruptedError),
        Trial(options.run, folder, options.ros.frames, cmd_vel=options.ros.cmd_vel) as trial,
    ):
        while trial.advance():
            pass
        raise InterruptedError  # what has failed is kept
    expected = before[run.name]["hashes"]["messages"]
    for topic in ("/map", "/rover/metrics"):  # a trial has neither
        expected.pop(topic, None)
    assert kept.of_messages(read(folder / "trial.mcap")) == expected


@pytest.mark.parametrize("identifier", IDS)
@pytest.mark.parametrize("run", PLAIN[1::3], ids=lambda run: run.name)
def test_an_environment_alone_ours_of_many_and_gymnasiums_see_the_same(
    run: GoldenRun, identifier: str, files: dict[str, Path], tmp_path: Path
) -> None:
    fields = run_options(run, files, tmp_path).run.fields()
    options: dict[str, Any] = {key: fields[key] for key in ("robot", *GROUND, "noise")}
    mode, actions = AutoresetMode.SAME_STEP, np.full((5, 2, 2), 0.4, np.float32)
    ours = gymnasium.make_vec(identifier, num_envs=2, autoreset_mode=mode, **options)
    theirs = SyncVectorEnv([lambda: gymnasium.make(identifier, **options)] * 2, autoreset_mode=mode)
    alone = gymnasium.make(identifier, **options)
    assert_alike(ours.reset(seed=5)[0], theirs.reset(seed=5)[0])
    alone.reset(seed=5)
    for action in actions:
        (seen, *of_ours), (expected, *of_theirs) = ours.step(action), theirs.step(action)
        assert_alike(seen, expected)
        assert repr(of_ours[:3]) == repr(of_theirs[:3])
        own, *_ = alone.step(action[0])
        assert_alike({key: value[0] for key, value in seen.items()}, own)
    for env in (ours, theirs, alone):
        env.close()


def assert_alike(one: dict[str, Any], other: dict[str, Any]) -> None:
    assert one.keys() == other.keys()
    for key, value in one.items():
        np.testing.assert_array_equal(value, other[key], err_msg=key)
