"""rover.yaml of a folder: what it may say, how mistakes are reported, what belongs to a rover."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import jsonschema
import pytest
from ruamel.yaml import YAML

from harness.base.errors import UsageError
from harness.robots import ROVERS, RoverSpec, find_rover, robot_name
from harness.robots.content import MODELS_DIR, model_hash
from harness.robots.reading import read_rover
from harness.robots.spec import schema

Foreign = Callable[[str], RoverSpec]
PUBLISHED = (MODELS_DIR / "rover.schema.json").read_text()
RULES = jsonschema.Draft202012Validator(json.loads(PUBLISHED))


@pytest.fixture
def folder(foreign: Foreign, tmp_path: Path) -> Path:
    """A copy of the buggy's."""
    return Path(shutil.copytree(foreign("buggy").folder, tmp_path / "buggy"))


def add(folder: Path, text: str) -> None:
    file = folder / "rover.yaml"
    file.write_text(file.read_text() + text)


def test_rover_yaml_wins_over_what_is_derived(folder: Path) -> None:
    add(folder, "clearance: 0.04\nsensors: [{kind: barometer, rate: 10}]\ncontroller_radius: 0.05\n")
    add(folder, "expected: {yaw_ratio: {low: 0.5, high: .inf, source: tape}}\n")
    rover = read_rover(folder)
    assert (rover.clearance, rover.controller_radius) == (0.04, 0.05)
    assert rover.sensors == ({"kind": "barometer", "rate": 10},)
    assert rover.expected.yaw_ratio.describe(1) == "at least 0.5"
    assert rover.wheel_radius == pytest.approx(0.0508)


STEERING = "[left_steering, right_steering]"
# Each with what the message must name: the key, and what would be valid. The schema refuses them too.
WRONG_VALUES = {
    "wheel_diameter: 0.1": ("wheel_diameter", "does not exist"),
    "clearence: 0.1": ("clearence", "clearance"),
    "wheel_radius: 0.1": ("wheel_radius", "does not exist"),  # the model says it
    "clearance: high": ("clearance", "number"),
    "clearance: true": ("clearance", "number"),
    "clearance: -0.1": ("clearance", "more than 0"),
    "odometry_rate: 2.5": ("odometry_rate", "a whole number"),
    "footprint: [1, 2, 3]": ("footprint.3", "missing"),
    "sensors: [1]": ("sensors.0", "keys with values"),
    "frames: [{parent: a, chid: b}]": ("chid", "child"),
    "lidar: {boddy: x}": ("boddy", "body"),
    "drive: {kind: hover}": ("drive.kind", "'skid' or 'ackermann'"),
    "drive: {lef: []}": ("lef", "left"),
    f"drive: {{kind: ackermann, steering: {STEERING}, steering_rate: 0}}": (
        "drive.steering_rate",
        "more than 0",
    ),
    "lidar: {rpy: [0, 0, 180]}": ("lidar.rpy", "6.28"),
    "imu: {xyz: [0, 0, 300]}": ("imu.xyz", "20"),
    "drive: {steering_limit: 30}": ("drive.steering_limit", "1.5"),
    "drive: {steering_limit: wide}": ("drive.steering_limit", "number"),
    "expected: {at_half: {low: 1, high: 2}}": ("expected.at_half", "source", "missing"),
    "expected: {passages: [{name: belly}]}": ("expected.passages.0", "aside", "missing"),
}
WRONG_FOR_THE_MODEL = {
    "clearance: .nan": ("clearance", "number"),
    "footprint: [1, 0, 0, 1]": ("footprint", "x_min, x_max, y_min, y_max"),
    "lidar: {body: mast}": ("mast", "chassis"),
    "drive: {left: [front_letf_joint]}": ("left", "'front_left_joint'"),
    "drive: {kind: ackermann}": ("steering", "left and the right front wheel"),
    "drive: {left: [rear_left_joint], right: [front_right_joint, rear_right_joint]}": ("1", "2"),
    "drive: {left: [front_left_joint], right: [front_right_joint]}": ("<velocity>",),
    "drive: {kind: ackermann, steering: [rear_left_joint, right_steering]}": (
        "rear_left_joint",
        "<position>",
    ),
    "model: cart.xml": ("cart.xml", "key 'model'"),
    "model: ../../etc/x": ("key 'model'", "is not in the rover's folder"),
    "[1, 2]": ("keys with values",),
    "a: [1": ("not valid YAML",),
    "clearance: 1\nclearance: 2": ("duplicate key",),
}
MISTAKES = WRONG_VALUES | WRONG_FOR_THE_MODEL


@pytest.mark.parametrize(("text", "named"), MISTAKES.items(), ids=MISTAKES)
def test_a_mistake_is_one_line_with_the_file_the_key_and_what_is_valid(
    text: str, named: tuple[str, ...], folder: Path
) -> None:
    (folder / "rover.yaml").write_text(f"{text}\n")
    with pytest.raises(UsageError) as error:
        read_rover(folder)
    message = str(error.value)
    assert [word for word in (str(folder), *named) if word not in message] == []
    assert "\n" not in message
    if text in WRONG_VALUES:
        with pytest.raises(jsonschema.ValidationError):
            RULES.validate(YAML(typ="safe").load(text))


def test_a_shipped_rover_states_all_that_is_not_in_its_model(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("harness.robots.reading.MODELS_DIR", tmp_path)
    leo = Path(shutil.copytree(MODELS_DIR / "leo", tmp_path / "leo"))
    text = (leo / "rover.yaml").read_text()
    (leo / "rover.yaml").write_text(text.replace("lidar_height: 0.798\n", ""))
    with pytest.raises(UsageError, match=r"rover\.yaml: lidar_height None is not valid; give a number"):
        read_rover(leo)
    (leo / "rover.yaml").write_text(text)
    (leo / "leo.xml").write_text("<mujoco/>")
    with pytest.raises(UsageError, match=r"leo\.xml is not as models/README\.md says"):
        read_rover(leo)


def test_the_published_schema_is_that_of_the_code_and_takes_what_reading_takes(foreign: Foreign) -> None:
    assert schema() == PUBLISHED, "python -m harness.robot schema > models/rover.schema.json"
    for rover in (*ROVERS.values(), foreign("buggy")):
        text = (rover.folder / "rover.yaml").read_text()
        RULES.validate(YAML(typ="safe").load(text))
    rules = json.loads(PUBLISHED)["properties"]
    assert [key for key, rule in rules.items() if not rule.get("description")] == []


def test_a_folder_without_a_rover_yaml_says_how_to_get_one(tmp_path: Path) -> None:
    (tmp_path / "mine.urdf").write_text("<robot/>")
    with pytest.raises(UsageError, match=r"harness.robot new NAME --from .*mine\.urdf writes a folder"):
        find_rover(str(tmp_path))
    (tmp_path / "rover.yaml").write_text("summary: mine\n")
    with pytest.raises(UsageError, match=f"give its folder, {tmp_path}"):
        find_rover(str(tmp_path / "rover.yaml"))
    with pytest.raises(UsageError, match="key 'model' is missing; give an MJCF file"):
        find_rover(str(tmp_path))
    for name in ("c", "a", "b"):
        (tmp_path / f"{name}.xml").touch()
    with pytest.raises(UsageError, match=r"'model' is missing; give which of a\.xml, b\.xml, c\.xml is"):
        find_rover(str(tmp_path))


def test_a_path_finds_the_same_rover_from_everywhere(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(folder.parent)
    assert find_rover("buggy") == find_rover(str(folder)) == read_rover(folder)
    assert [robot_name(robot) for robot in ("leo", "./buggy", f"{folder}/")] == ["leo", "buggy", "buggy"]


def test_a_rover_that_has_changed_is_read_anew_and_has_another_hash(folder: Path) -> None:
    before, first = read_rover(folder), model_hash(read_rover(folder))
    elsewhere = Path(shutil.copytree(folder, folder.parent / "there"))
    assert model_hash(read_rover(elsewhere)) == first
    (folder / "photo.png").write_bytes(b"a picture changes nothing")
    assert model_hash(read_rover(folder)) == first
    add(folder, "cruise_speed: 0.123\n")
    assert (read_rover(folder).cruise_speed, before.cruise_speed) == (0.123, 1.0)
    hashes = {first, model_hash(read_rover(folder))}
    for content in (b"solid", b"other"):  # of the same length
        (folder / "hull.stl").write_bytes(content)
        hashes.add(model_hash(read_rover(folder)))
    assert len(hashes) == 4
