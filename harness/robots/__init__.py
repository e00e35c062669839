"""The rovers: a folder each, with a model and what the model cannot say in rover.yaml.

Those of models/ are known by their names; any other is known by the path of its folder. A model has
geometry and masses, joints, wheels, limits of the drive and gravity; models/README.md gives the
conventions of those that ship and the source of every number, docs/robots.md what others need.
"""

from collections.abc import Iterator, Mapping
from contextlib import suppress
from pathlib import Path

from harness.base.errors import UsageError
from harness.robots.content import MODELS_DIR
from harness.robots.reading import read_rover
from harness.robots.sections import Tyres
from harness.robots.spec import RoverSpec as RoverSpec
from rover_metrics.errors import sibling

IDEAL, REAL = "ideal", "real"  # what drives the wheels


class _Rovers(Mapping[str, RoverSpec]):
    """The folders of models/ by name; each is read when it is first asked for."""

    def __getitem__(self, name: str) -> RoverSpec:
        if Path(name).name != name or not (MODELS_DIR / name / "rover.yaml").is_file():
            raise KeyError(name)
        return read_rover(MODELS_DIR / name)

    def __iter__(self) -> Iterator[str]:
        return iter(sorted(path.parent.name for path in MODELS_DIR.glob("*/rover.yaml")))

    def __len__(self) -> int:
        return sum(1 for _ in self)


ROVERS: Mapping[str, RoverSpec] = _Rovers()


def find_rover(robot: str) -> RoverSpec:
    """Returns the rover of a name, or of a folder's path; UsageError, which names those there are."""
    with suppress(KeyError):
        return ROVERS[robot]
    if Path(robot).name == "rover.yaml":
        raise UsageError(f"robot '{robot}' is a file of a rover; give its folder, {Path(robot).parent}")
    if Path(robot).is_file():
        raise UsageError(
            f"robot '{robot}' is a file; a rover is a folder, which `{sibling('harness.robot')} new "
            f"NAME --from {robot}` makes of a URDF (docs/robots.md)"
        )
    if not robot or not Path(robot).is_dir():
        raise UsageError(
            f"robot '{robot}' does not exist; available: {', '.join(ROVERS)}, "
            "or the path of a folder with a rover.yaml (docs/robots.md)"
        )
    return read_rover(Path(robot).resolve())


def equipped(rover: RoverSpec, actuators: str, surface: str) -> RoverSpec:
    """Returns a rover with motors and tyres as a run has them.

    Args:
        rover: As its folder says.
        actuators: IDEAL for the model's servos, REAL for those of its section `actuators`.
        surface: The name of one of its surfaces; "" for tyres as the folder says.

    Raises:
        UsageError: The folder has no such section or surface.
    """
    where = rover.folder / "rover.yaml"
    if actuators == REAL and rover.actuators is None:
        raise UsageError(
            f"--actuators real needs the section 'actuators', which {where} lacks "
            "(docs/real_rovers.md); give it, or leave the option out"
        )
    rover = rover.but(real=True) if actuators == REAL else rover
    if not surface:
        return rover
    if surface not in rover.surfaces:
        there = ", ".join(rover.surfaces) or "none"
        raise UsageError(f"surface '{surface}' is not one of {where}; available: {there}")
    met = rover.surfaces[surface]
    usual = Tyres()
    stated = {name: getattr(met, name) for name in Tyres.model_fields}
    tyres = rover.tyres.but(**{k: v for k, v in stated.items() if v != getattr(usual, k)})
    return rover.but(
        tyres=tyres,
        vibration=met.vibration,
        wheel_friction=tyres.friction or rover.wheel_friction,
        wheel_radius=tyres.radius or rover.wheel_radius,
    )


def robot_name(robot: str) -> str:
    """Returns what a robot is called, whether it was given by its name or by the path of its folder."""
    return robot if robot in ROVERS else Path(robot).resolve().name
