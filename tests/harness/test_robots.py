"""The rover specifications and how they are found."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import mujoco
import pytest

from harness import robots
from harness.errors import UsageError
from harness.robots import ROVERS, RoverSpec, find_rover
from harness.validation.expected import expected_of
from tests.support.rovers import LEO

BOTH = pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS.keys())


@BOTH
def test_a_rover_is_found_by_its_name(rover: RoverSpec) -> None:
    assert find_rover(rover.name) is rover


def test_an_unknown_name_is_refused_with_the_names_that_exist() -> None:
    with pytest.raises(UsageError, match=r"robot 'spot' does not exist; available: leo, rover_zero4wd"):
        find_rover("spot")


@BOTH
def test_every_published_joint_exists_in_the_model(rover: RoverSpec) -> None:
    model = mujoco.MjSpec.from_file(str(rover.model_path)).compile()
    hinges = [model.joint(index).name for index in range(model.njnt)]
    assert hinges[0] == "root"
    assert sorted(rover.joints) == sorted(hinges[1:])


@BOTH
def test_cruising_stays_within_the_speed_of_the_wheels(rover: RoverSpec) -> None:
    turning = rover.cruise_yaw_rate * rover.controller_separation / 2
    assert (rover.cruise_speed + turning) / rover.controller_radius < rover.wheel_speed_limit


@pytest.fixture
def copied(tmp_path: Path) -> Path:
    """A rover of the user's own, by another name."""
    folder = tmp_path / "mine"
    folder.mkdir()
    (folder / "mine.xml").write_bytes(LEO.model_path.read_bytes())
    (folder / "rover.yaml").write_bytes((LEO.folder / "rover.yaml").read_bytes())
    return folder


def test_a_folder_is_all_that_it_takes_to_add_a_rover(
    copied: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(robots, "MODELS_DIR", copied.parent)
    assert list(ROVERS) == ["mine"]
    assert find_rover("mine") == replace(LEO, name="mine")
    assert expected_of(find_rover("mine")).passages[0].height == find_rover("mine").clearance


@pytest.mark.parametrize(
    ("file", "old", "new", "said"),
    [
        (
            "rover.yaml",
            "track: 0.3579",
            "tracks: 0.3579",
            "rover.yaml: key 'tracks' does not exist; valid",
        ),
        ("rover.yaml", "track: 0.3579", "", "rover.yaml: key 'track' is missing; give a number"),
        ("rover.yaml", "track: 0.3579", "track: -1", "track = -1 is not valid; give a number above 0"),
        ("rover.yaml", "track: 0.3579", "lidar_x: 1.0", "key 'lidar_x' does not exist"),
        ("rover.yaml", "0.218", "-0.3", "footprint = .* is empty"),
        (
            "mine.xml",
            'name="wheel_FL" class="wheel"',
            'class="wheel"',
            "mine.xml is not as models/README",
        ),
        ("mine.xml", "<option", "<opt", "mine.xml is not as models/README"),
        ("mine.xml", "</mujoco>", "", "mine.xml is not as models/README"),
    ],
)
def test_a_mistake_in_a_rovers_files_is_one_line_that_names_it(
    copied: Path, file: str, old: str, new: str, said: str
) -> None:
    text = (copied / file).read_text()
    assert old in text
    (copied / file).write_text(text.replace(old, new))
    with pytest.raises(UsageError, match=said) as told:
        robots.read_rover(copied)
    assert "\n" not in str(told.value)


@BOTH
def test_what_the_model_says_is_not_repeated_but_read_from_it(rover: RoverSpec) -> None:
    model = mujoco.MjSpec.from_file(str(rover.model_path)).compile()
    radius, half_width, _ = model.geom("wheel_FL").size
    assert (rover.wheel_radius, rover.wheel_width) == (radius, 2 * half_width)
    assert tuple(model.actuator(i).name for i in range(model.nu)) == rover.wheel_joints
    assert rover.wheel_speed_limit == model.actuator_ctrlrange[0, 1]
    assert rover.lidar_x == model.site("lidar").pos[0]
    assert (0.0, 0.0, -rover.gravity) == tuple(model.opt.gravity)


def test_rovers_are_read_without_mujoco() -> None:
    code = """import sys
from harness.robots import ROVERS
sys.exit(not list(ROVERS.values()) or 'mujoco' in sys.modules)"""
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
