"""Models that know nothing of the house's rules are made to fit; those that ship stay as they are."""

from pathlib import Path

import mujoco
import pytest

from harness.base.errors import UsageError
from harness.physics.scene import build_scene
from harness.robots import ROVERS, RoverSpec
from harness.robots.model import compiled_alone, read_model
from harness.robots.reading import read_rover
from harness.world.world import build_world

WHEEL = (
    '<body name="{0}" pos="{1} {2} 0.1"><joint name="{0}" axis="0 1 0"/>'
    '<geom type="cylinder" size="0.1 0.03" zaxis="0 1 0"/></body>'
)
MOTOR = '<velocity joint="{0}" kv="5" ctrlrange="-10 10" forcerange="-5 5"/>'
NAMES = {"a": (0.2, 0.2), "b": (-0.2, 0.2), "c": (0.2, -0.2), "d": (-0.2, -0.2)}


def brought_along(folder: Path, body: str = "", **words: str) -> Path:
    """A folder with a car of four wheels as somebody may have it, with a floor and without sites."""
    wheels = "".join(WHEEL.format(name, *place) for name, place in NAMES.items())
    text = (
        '<mujoco><worldbody><geom type="plane" size="9 9 1"/><light pos="0 0 3"/>'
        '<body name="car"><geom name="hull" type="box" size="0.25 0.1 0.05" pos="0 0 0.2"/>'
        f"{wheels}{body}</body></worldbody>"
        f"<actuator>{''.join(map(MOTOR.format, NAMES))}</actuator></mujoco>"
    )
    for old, new in words.items():
        text = text.replace(old, new)
    folder.mkdir(exist_ok=True)
    (folder / "car.xml").write_text(text)
    (folder / "rover.yaml").write_text("model: car.xml\n")
    return folder


@pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS)
def test_the_models_that_ship_are_not_changed(rover: RoverSpec) -> None:
    plain = mujoco.MjSpec.from_file(str(rover.model_path)).to_xml()
    assert read_model(rover).to_xml() == plain


def test_a_model_gets_what_scenes_need(tmp_path: Path) -> None:
    rover = read_rover(brought_along(tmp_path / "car"))
    model = read_model(rover).compile()
    assert model.jnt_type[0] == mujoco.mjtJoint.mjJNT_FREE
    assert model.nlight == 0
    assert mujoco.mjtGeom.mjGEOM_PLANE not in model.geom_type
    colliding = model.geom_group == 3
    assert colliding.sum() == 5
    assert set(zip(model.geom_contype[colliding], model.geom_conaffinity[colliding], strict=True)) == {
        (1, 2)
    }
    assert (model.geom_group == 2).sum() == 5  # something to be seen of each body, without a weight
    water = 1000 * (0.5 * 0.2 * 0.1 + 4 * 0.06 * 0.031416)  # MuJoCo's density of what tells none
    assert model.body_mass.sum() == pytest.approx(water, rel=1e-3)
    assert [model.sensor(name).dim[0] for name in ("imu_accelerometer", "imu_gyro")] == [3, 3]
    assert model.site("lidar").pos[2] == pytest.approx(0.25 + 0.05)
    assert rover.drive.left == ("a", "b")
    assert rover.drive.right == ("c", "d")


def test_parts_without_a_name_scrape_too_and_every_key_may_be_left_out(tmp_path: Path) -> None:
    skid = '<body pos="-0.3 0 0.1"><geom size="0.05"/></body>'
    folder = brought_along(tmp_path / "car", skid)
    (folder / "rover.yaml").write_text("# as the model says\n")
    scene = build_scene(build_world("flat", 0), read_rover(folder), 0.0025)
    names = [scene.model.sensor(sensor).name for sensor in range(scene.model.nsensor)]
    assert [name for name in names if name.startswith("scrape")] == [
        "scrape_contact_car",
        "scrape_contact_part_5",
    ]


def test_mounts_of_rover_yaml_place_sensors_that_the_model_lacks(tmp_path: Path) -> None:
    folder = brought_along(tmp_path / "car")
    (folder / "rover.yaml").write_text(
        "model: car.xml\nlidar: {xyz: [0.1, 0.2, 0.4], rpy: [0, 0, 1.5]}\n"
        "imu: {body: a, xyz: [0, 0, 0.1]}\n"
    )
    rover = read_rover(folder)
    assert (rover.lidar_x, rover.lidar_y, rover.lidar_yaw) == pytest.approx((0.1, 0.2, 1.5))
    assert rover.lidar_height == pytest.approx(0.4)
    model, data = compiled_alone(rover)
    assert data.site("imu").xpos == pytest.approx((0.2, 0.2, 0.2))
    assert model.sensor("imu_gyro").objid[0] == model.site("imu").id


def asset(text: str) -> dict[str, str]:
    return {"<worldbody>": f"<asset>{text}</asset><worldbody>"}


def option(text: str) -> dict[str, str]:
    return {"<worldbody>": f"<option {text}/><worldbody>"}


def hinge(text: str) -> dict[str, str]:
    return {'name="d" axis': f'name="d" {text} axis'}


MISTAKES = {
    "two bodies": ({"</worldbody>": '<body name="x"/></worldbody>'}, "it holds car, x"),
    "a rail": ({'="car">': '="car"><joint name="s" type="slide"/>'}, "take joint 's' away"),
    "no wheels": ({"<velocity": "<motor", ' kv="5"': ""}, "actuators; it has 0; others: number 0"),
    "an axis": ({'name="d" axis="0 1 0"': 'name="d" axis="0 -1 0"'}, "joint 'd' must turn about +y"),
    "a gear": ({'kv="5"': 'kv="5" gear="2"'}, "the motor of 'a' has gear 2"),
    "no limit": ({'ctrlrange="-10 10"': ""}, "'a' has no limit ahead and back"),
    "no way back": ({'ctrlrange="-10': 'ctrlrange="0'}, "'a' has no limit ahead and back"),
    "no mass": ({'size="0.1 0.03"': 'size="0.1 0.03" mass="0"'}, "an <inertial> with a mass"),
    "no name": (
        {'joint name="d" axis': "joint axis", '<velocity joint="d"': '<velocity joint="c"'},
        "no name",
    ),
    "the world's name": ({'name="hull"': 'name="terrain"'}, "the name 'terrain' is the world's"),
    "no XML": ({"<mujoco>": "<mujoco"}, "is not XML"),
    "no MJCF": ({"plane": "plain"}, "is no model that MuJoCo reads"),
    "entities": ({"<mujoco>": "<!DOCTYPE m><mujoco>"}, "declares a document type or entities"),
    "a medium": (option('density="1.2" wind="9 0 0"'), "take wind and density out of <option>"),
    "motors off": (option('actuatorgroupdisable="0"'), "take actuatorgroupdisable out"),
    "gravity": (option('gravity="0 -9.81 0"'), "gravity 0 -9.81 0 does not point down"),
    "a balloon": ({'name="car"': 'name="car" gravcomp="1"'}, "gravcomp 1 of body 'car'"),
    "an anchor": ({"<actuator>": '<equality><weld body1="car"/></equality><actuator>'}, "to the world"),
    "a wheel's range": (hinge('range="-9 9"'), "wheel 'd' has a range"),
    "a wheel's spring": (hinge('stiffness="1"'), "wheel 'd' has a stiffness"),
    "two motors": ({"<actuator>": '<actuator><motor joint="a"/>'}, "wheel 'a' has a second actuator"),
    "a delay": ({'kv="5"': 'kv="5" delay="0.1" nsample="60"'}, "wheel 'a' has a delay"),
    "no IMU": (
        {
            "<actuator>": '<sensor><gyro name="imu_accelerometer" site="x"/></sensor><actuator>',
            '<geom name="hull"': '<site name="x"/><geom name="hull"',
        },
        "sensor 'imu_accelerometer' is of another kind",
    ),
    "friction": ({'name="hull"': 'name="hull" friction="-5"'}, "friction -5 of geom 'hull'"),
    "endless friction": ({'name="hull"': 'name="hull" friction="1e30"'}, "give 0 to 100"),
    "mass": ({'name="hull"': 'name="hull" mass="1e30"'}, "mass 1e+30 kg of body 'car'"),
    "size": ({'size="0.25': 'size="9e9'}, "size 9e+09 m of geom 'hull'"),
    "damping": (hinge('damping="-1"'), "damping -1 of joint 'd'"),
    "dry friction": (hinge('frictionloss="-1"'), "friction -1 of joint 'd'"),
    "stiffness": (hinge('stiffness="1e99"'), "give 0 to 1e+09"),
    "no gravity": (
        {"<worldbody>": '<option><flag gravity="disable"/></option><worldbody>'},
        'take <flag gravity="disable"/> out',
    ),
    "a heightfield": (
        asset('<hfield nrow="30000" ncol="30000"/>'),
        "<hfield>: 30000 x 30000 cells are more than 4,194,304",
    ),
    "a picture": (
        asset('<hfield name="h" file="big.png" size="1 1 1 1"/>'),
        "big.png: 30000 x 30000 cells",
    ),
    "copies": (
        {"<worldbody>": '<worldbody><replicate count="99"><replicate count="99"/></replicate>'},
        "<replicate> makes 9801 copies",
    ),
    "an include": ({"<worldbody>": '<include file="../x.xml"/><worldbody>'}, "is not in the rover's"),
    "a side of a cube": (
        asset('<texture name="s" type="cube" fileright="../x.png"/>'),
        "is not in the rover's",
    ),
    "an include of itself": ({"<worldbody>": '<include file="car.xml"/><worldbody>'}, "than 100 files"),
    "a mesh elsewhere": (asset('<mesh file="/etc/x.stl"/>'), "<mesh>: /etc/x.stl is not in the rover's"),
    "a texture elsewhere": (
        asset('<texture type="2d" file="/etc/x.png"/>'),
        "<texture>: /etc/x.png is not in the rover's folder",
    ),
    "textures elsewhere": (
        asset('<texture type="2d" file="x.stl"/></asset><compiler texturedir="../"/><asset>'),
        "<texture>: ",
    ),
    "meshes elsewhere": (
        asset('<mesh file="x.stl"/></asset><compiler meshdir="../"/><asset>'),
        "is not in the rover's folder",
    ),
    "assets elsewhere": (
        asset('<mesh file="x.stl"/></asset><compiler assetdir="../"/><asset>'),
        "is not in the rover's folder",
    ),
    "no mesh": (asset('<mesh file="x.stl"/>'), "x.stl, which does not exist"),
}


@pytest.mark.parametrize(("words", "told"), MISTAKES.values(), ids=MISTAKES)
def test_a_model_that_is_no_rover_is_told_of_in_one_line(
    words: dict[str, str], told: str, tmp_path: Path
) -> None:
    folder = brought_along(tmp_path / "car", **words)
    (tmp_path / "x.xml").write_text("<mujocoinclude/>")
    (tmp_path / "x.stl").touch()
    (folder / "big.png").write_bytes(b"\x89PNG\r\n\x1a\n" + bytes(8) + 2 * (30000).to_bytes(4, "big"))
    with pytest.raises(UsageError) as error:
        read_rover(folder)
    assert told in str(error.value)
    assert "car.xml" in str(error.value)
    assert "\n" not in str(error.value)
