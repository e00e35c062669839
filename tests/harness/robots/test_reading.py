"""rover.yaml of a folder: what it may say, what is told of mistakes, what belongs to a rover."""

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from harness.base.errors import UsageError
from harness.robots import MODELS_DIR, RoverSpec, find_rover, read_rover, robot_name
from harness.robots.reading import model_hash

Foreign = Callable[[str], RoverSpec]


@pytest.fixture
def folder(foreign: Foreign, tmp_path: Path) -> Path:
    """A copy of the buggy's."""
    return Path(shutil.copytree(foreign("buggy").folder, tmp_path / "buggy"))


def add(folder: Path, text: str) -> None:
    file = folder / "rover.yaml"
    file.write_text(file.read_text() + text)


def test_rover_yaml_wins_over_what_is_derived(folder: Path) -> None:
    add(folder, "clearance: 0.04\nsensors: [{kind: barometer, rate: 10}]\ncontroller_radius: 0.05\n")
    rover = read_rover(folder)
    assert (rover.clearance, rover.controller_radius) == (0.04, 0.05)
    assert rover.sensors == ({"kind": "barometer", "rate": 10},)
    assert rover.wheel_radius == pytest.approx(0.0508)


STEERING = "[left_steering, right_steering]"
MISTAKES = {
    "wheel_diameter: 0.1": "key 'wheel_diameter' does not exist; valid: ",
    "wheel_radius: 0.1": "key 'wheel_radius' does not exist; valid: ",  # the model says it
    "clearance: high": "clearance = 'high' is not valid; give a number",
    "clearance: -0.1": "clearance = -0.1 is not valid; give a number above 0",
    "clearance: .nan": "clearance = nan is not valid; give a number",
    "footprint: [1, 0, 0, 1]": "is empty; give x_min, x_max, y_min, y_max",
    "sensors: [1]": "sensors [1] = 1 is not valid; give keys with values",
    "lidar: {boddy: x}": "lidar: key 'boddy' does not exist; valid: body, xyz, rpy",
    "lidar: {body: mast}": "lidar: body 'mast' does not exist in buggy.xml; available: chassis",
    "drive: {left: [front_letf_joint]}": "left: hinge 'front_letf_joint' does not exist; did you mean "
    "'front_left_joint'?",
    "drive: {kind: hover}": "drive: kind = 'hover' is not valid; give skid or ackermann",
    "drive: {kind: ackermann}": "drive: steering = [] is not valid with kind 'ackermann'",
    "drive: {left: [rear_left_joint], right: [front_right_joint, rear_right_joint]}": "1 wheels left "
    "and 2 right are not valid",
    "drive: {left: [front_left_joint], right: [front_right_joint]}": "need <velocity> actuators",
    f"drive: {{kind: ackermann, steering: {STEERING}, steering_rate: 0}}": "steering_rate = 0 "
    "is not valid; give a number above 0",
    "drive: {kind: ackermann, steering: [rear_left_joint, right_steering]}": "steering joint "
    "'rear_left_joint' needs a <position> actuator",
    "drive: {steering_limit: wide}": "drive: steering_limit = 'wide' is not valid; give a number",
    "model: cart.xml": "cart.xml, the rover's model, does not exist; put it there, or mend key 'model'",
}


@pytest.mark.parametrize(("line", "told"), MISTAKES.items(), ids=MISTAKES)
def test_a_mistake_is_told_in_one_line_with_the_file_and_what_is_valid(
    line: str, told: str, folder: Path
) -> None:
    (folder / "rover.yaml").write_text(f"{line}\n")
    with pytest.raises(UsageError) as error:
        read_rover(folder)
    assert told in str(error.value)
    assert str(folder) in str(error.value)
    assert "\n" not in str(error.value)


def test_a_folder_without_a_rover_yaml_is_told_how_to_get_one(tmp_path: Path) -> None:
    (tmp_path / "mine.urdf").write_text("<robot/>")
    with pytest.raises(UsageError, match=r"harness.robot new NAME --from .*mine\.urdf writes a folder"):
        find_rover(str(tmp_path))
    (tmp_path / "rover.yaml").write_text("summary: mine\n")
    with pytest.raises(UsageError, match="key 'model' is missing; give an MJCF file"):
        find_rover(str(tmp_path))


def test_a_path_finds_the_same_rover_from_everywhere(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(folder.parent)
    assert find_rover("buggy") == find_rover(str(folder)) == read_rover(folder)
    assert [robot_name(robot) for robot in ("leo", "./buggy", f"{folder}/")] == ["leo", "buggy", "buggy"]


def test_a_rover_that_has_changed_is_read_anew_and_has_another_hash(folder: Path) -> None:
    before, first = read_rover(folder), model_hash(read_rover(folder))
    (folder / "photo.png").write_bytes(b"a picture changes nothing")
    assert model_hash(read_rover(folder)) == first
    add(folder, "cruise_speed: 0.123\n")
    assert (read_rover(folder).cruise_speed, before.cruise_speed) == (0.123, 1.0)
    hashes = {first, model_hash(read_rover(folder))}
    (folder / "hull.stl").write_bytes(b"solid")
    assert len(hashes | {model_hash(read_rover(folder))}) == 3


def test_the_hash_does_not_depend_on_where_the_folder_is(folder: Path) -> None:
    elsewhere = Path(shutil.copytree(folder, folder.parent / "there"))
    assert model_hash(read_rover(elsewhere)) == model_hash(read_rover(folder))
    assert read_rover(MODELS_DIR / "leo").folder.parent == MODELS_DIR
