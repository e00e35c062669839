"""Writes the folder of a rover: model, meshes, and a rover.yaml that says what was guessed."""

import json
import re
import shutil
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.sax.saxutils import quoteattr

import mujoco

from harness.base.errors import UsageError
from harness.base.sdf.resources import Missing, model_file
from harness.robots.measures import frame_name
from harness.robots.model import compiled, free_root, show_what_collides, sort_geoms
from harness.robots.reading import read_rover
from harness.robots.sections import ACKERMANN, SKID
from harness.robots.spec import RoverSpec, schema
from harness.robots.urdf.equipment import Equipment, equip
from harness.robots.urdf.joints import Joints, find_joints
from harness.robots.urdf.source import read_urdf

SCHEMA = "rover.schema.json"  # for editors
NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]*")
NAMES = "letters, digits, '_', '-' or '.'; where it is put, --out says"
# Keys whose derived values the file shows, so that users who know better can set them.
SHOWN = (
    "odometry_child_frame", "linear_acceleration", "angular_acceleration", "cruise_speed",
    "cruise_yaw_rate", "encoder_ticks", "odometry_rate", "rest_height", "track", "wheelbase",
    "footprint", "clearance", "lidar_height", "step_limit", "slope_limit",
)  # fmt: skip
ALIKE = 0.97  # of the largest wheel's radius, from which on wheels roll as it does
LEAST = 1e-6  # [m], [rad]: less is the arithmetic's
GUESSED = {"linear_acceleration", "angular_acceleration", "encoder_ticks", "step_limit", "slope_limit"}


@dataclass(frozen=True)
class Written:
    """A folder made of a URDF."""

    folder: Path  # where the rover is
    rover: RoverSpec
    notes: tuple[str, ...]  # what was dropped or mended, and what hangs loose
    guesses: tuple[str, ...]  # what nobody states, and the value that was chosen


def write_folder(
    name: str,
    urdf: Path,
    folder: Path,
    *,
    left: tuple[str, ...] = (),
    right: tuple[str, ...] = (),
    folders: Sequence[Path] = (),
    trust_xacro: bool = False,
) -> Written:
    """Makes a rover of a URDF.

    Args:
        name: Of the rover.
        urdf: Its file, which may be SDF; or the folder of a model of Gazebo.
        folder: To be made; must not exist.
        left: Joints of the wheels on the left, front to rear; sorted by their places if left out.
        right: Joints of the wheels on the right.
        folders: With meshes and packages that are not beside the URDF or above it.
        trust_xacro: Whether the file may be xacro.

    Raises:
        UsageError: An argument or the URDF is not valid, or the folder exists.
    """
    if not NAME.fullmatch(name):
        raise UsageError(f"name '{name}' is not valid; give {NAMES}")
    if folder.exists():
        raise UsageError(f"{folder} exists already, not overwriting; choose another NAME or --out")
    if urdf.is_dir():
        try:
            urdf = model_file(urdf)
        except Missing as missing:
            raise UsageError(f"{missing}; name its SDF file, or its URDF") from missing
    spec, robot, mended = read_urdf(urdf, folders, name, trust_xacro=trust_xacro)
    free_root(spec, urdf)
    sort_geoms(spec)
    model = compiled(spec.copy(), urdf)
    joints = find_joints(model, left, right, str(urdf))
    show_what_collides(spec)
    equipment = equip(spec, robot, joints, float(model.body_mass.sum()))
    notes = (
        *mended,
        *_mended(joints, model),
        *_of_sizes(joints, equipment),
        *_loose(spec, joints),
    )
    spec.modelname = name
    rover = _placed(folder, name, spec, joints, equipment, urdf)
    guesses = tuple(f"{key}: {guess}" for key, guess in equipment.guesses.items())
    return Written(folder, rover, notes, guesses)


def _mended(joints: Joints, model: mujoco.MjModel) -> list[str]:
    """What is otherwise than the joints of the URDF say."""
    notes = [f"joint '{joint}': its axis pointed backwards; turned" for joint in joints.backwards]
    notes += [f"joint '{joint}' steers; held straight" for joint in joints.held]
    return notes + [
        f"joint '{name}': its limits are left out, so that the wheel rolls on"
        for name in joints.wheels
        if model.jnt_limited[model.joint(name).id]
    ]


def _of_sizes(joints: Joints, equipment: Equipment) -> list[str]:
    """What is odd about the wheels' radii, and about those that a plugin believes."""
    smallest, largest, notes = min(joints.radius.values()), max(joints.radius.values()), list[str]()
    if smallest < ALIKE * largest:
        notes.append(
            f"wheels of {smallest:.3g} to {largest:.3g} m: all are turned as those of {largest:.3g}"
        )
    believed = equipment.beliefs.get("controller_radius", largest)
    if not ALIKE < believed / largest < 1 / ALIKE:
        notes.append(
            f"a plugin takes its wheels for {believed:.3g} m, not {largest:.3g}: it drives "
            f"{largest / believed:.3g} times as fast as it is told"
        )
    return notes


def _placed(
    folder: Path, name: str, spec: mujoco.MjSpec, joints: Joints, equipment: Equipment, urdf: Path
) -> RoverSpec:
    """Makes the folder, whole or not at all."""
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=folder.parent, prefix=f".{name}-") as made:
            half_made = Path(made) / folder.name
            half_made.mkdir()
            try:
                rover = _write(half_made, name, spec, joints, equipment, urdf)
            except UsageError as error:  # of a file that is gone by then
                reason = str(error).replace(f"{half_made.resolve()}/", "").removeprefix("rover.yaml: ")
                raise UsageError(f"{urdf} becomes no rover: {reason}") from error
            half_made.rename(folder)
    except OSError as error:
        raise UsageError(f"cannot write {folder}: {error.strerror}") from error
    return rover.but(folder=folder.resolve())


def _write(
    folder: Path, name: str, spec: mujoco.MjSpec, joints: Joints, equipment: Equipment, urdf: Path
) -> RoverSpec:
    model = _with_meshes_beside(spec.to_xml(), spec, folder)
    (folder / f"{name}.xml").write_text(model, encoding="utf-8")
    stated = _stated(name, joints, equipment, urdf) + _frames(spec)
    path = folder / "rover.yaml"
    path.write_text(stated, encoding="utf-8")
    rover = read_rover(folder.resolve())
    path.write_text(stated + _derived(rover, stated), encoding="utf-8")
    (folder / SCHEMA).write_text(schema(), encoding="utf-8")
    return rover


def _with_meshes_beside(text: str, spec: mujoco.MjSpec, folder: Path) -> str:
    """The model's text with its meshes in the folder, which can be moved then."""
    for number, file in enumerate(sorted({mesh.file for mesh in spec.meshes if mesh.file})):
        beside = f"meshes/{number}_{Path(file).name}"
        (folder / "meshes").mkdir(exist_ok=True)
        shutil.copyfile(file, folder / beside)
        text = text.replace(f"file={quoteattr(file)}", f"file={quoteattr(beside)}")
    return text


def _loose(spec: mujoco.MjSpec, joints: Joints) -> list[str]:
    """Joints that nothing drives, holds or ties to another."""
    tied = {name for tie in spec.equalities for name in (tie.name1, tie.name2)}
    moved = {motor.target for motor in spec.actuators} | tied | set(joints.wheels)
    names = [joint.name for joint in spec.joints if joint.type != mujoco.mjtJoint.mjJNT_FREE]
    return [f"joint '{name}' has no motor and moves freely" for name in names if name not in moved]


def _stated(name: str, joints: Joints, equipment: Equipment, urdf: Path) -> str:
    """The keys that the URDF states."""
    lines = [
        f"# yaml-language-server: $schema={SCHEMA}",
        f"# {name}: what {name}.xml cannot say; made of {urdf.name}. Metres, radians, seconds.",
        "# docs/robots.md tells the keys. Guesses are marked as guesses.",
        "",
        f"model: {name}.xml",
    ]
    lines += [
        *(
            f"# guess in the model, {key[7:]}: {guess}"
            for key, guess in equipment.guesses.items()
            if ": " in key
        ),
        "drive:",
        f"  kind: {ACKERMANN if joints.steering else SKID}",
        f"  left: {json.dumps(joints.left)}  # front to rear, by their places",
        f"  right: {json.dumps(joints.right)}",
        f"  driven: {json.dumps(equipment.driven)}",
    ]
    if joints.steering:
        guess = "  # guess" if "drive" in equipment.guesses else ""
        lines += [
            f"  steering: {json.dumps(joints.steering)}",
            f"  steering_rate: {equipment.steering_rate:g}{guess}",
        ]
    lines += [f"{key}: {value:g}  # a plugin of the URDF" for key, value in equipment.beliefs.items()]
    for key, link in (("imu_frame", equipment.imu), ("lidar_frame", equipment.lidar)):
        lines += [f"{key}: {json.dumps(link)}"] if link else []
    for sensor in ("lidar", "imu"):
        if sensor in equipment.guesses:
            lines += [f"# guess, {sensor}: {equipment.guesses[sensor]}"]
            lines += [f"# {sensor}: {{body: , xyz: [0, 0, 0], rpy: [0, 0, 0]}}"]
    return "\n".join([*lines, ""])


def _frames(spec: mujoco.MjSpec) -> str:
    """The keys that let frames be called as the URDF's links, where the rule calls them otherwise."""
    others = [body for body in spec.bodies[1:] if frame_name(body.name) != body.name]
    root = [body for body in others if body.parent == spec.worldbody]
    lines = [f"odometry_child_frame: {json.dumps(body.name)}" for body in root]
    rows = [(body.parent.name, body.name) for body in others if body not in root]
    lines += ["frames:  # called as the links of the URDF"] if rows else []
    for parent, name in rows:
        lines += ["  - " + json.dumps({"parent": parent, "child": name, "body": name})]
    return "\n".join([*lines, ""])


def _derived(rover: RoverSpec, stated: str) -> str:
    lines = ["", "# Derived from the model, or guessed; take the # away to set another value."]
    for key in SHOWN:
        value = getattr(rover, key)
        if isinstance(value, tuple):
            value = [round(number, 4) or 0.0 for number in value]
        elif isinstance(value, float):
            value = f"{value if abs(value) > LEAST else 0.0:.4g}"
        if f"\n{key}:" not in stated:
            lines.append(f"# {key}: {value}{'  # guess' if key in GUESSED else ''}")
    return "\n".join([*lines, ""])
