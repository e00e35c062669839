"""A folder -> RoverSpec.

The rovers of models/ are read without MuJoCo. Of any other the model is compiled, so that a mistake is
told at once, and what rover.yaml leaves out is derived from it (harness.robots.measures).
"""

import hashlib
from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

from harness.base.errors import UsageError
from harness.robots.mjcf import told_by_mjcf
from harness.robots.spec import DRIVES, GIVEN, MAY_BE_ZERO, TOLD, Drive, RoverSpec
from harness.yaml_file import fill, read_mapping

MODELS_DIR = next(
    folder
    for folder in (Path(__file__).parents[1] / "models", Path(__file__).parents[2] / "models")
    if folder.is_dir()
)
# Of what a rover is made; pictures of it and notes about it do not change it.
CONTENT = {".yaml", ".xml", ".stl", ".obj", ".msh"}


def read_rover(folder: Path) -> RoverSpec:
    """Returns the rover of a folder.

    Raises:
        UsageError: One of its files is not valid; the message names file, key and what is.
    """
    if not (folder / "rover.yaml").is_file():
        raise UsageError(_no_rover(folder))
    stamps = tuple((path, path.stat().st_mtime_ns, path.stat().st_size) for path in content_of(folder))
    return _read(folder, stamps)


def content_of(folder: Path) -> list[Path]:
    """Returns the files of a folder that make its rover, in the order of their names."""
    found = (path for path in folder.rglob("*") if path.suffix.lower() in CONTENT)
    return sorted(path for path in found if path.is_file())


def model_hash(rover: RoverSpec) -> str:
    """Returns the SHA-256 of a shipped rover's model file; of another's that of its folder's content."""
    if rover.folder.parent == MODELS_DIR:
        return hashlib.sha256(rover.model_path.read_bytes()).hexdigest()
    content = hashlib.sha256()
    for path in content_of(rover.folder):
        data = path.read_bytes()
        content.update(f"{path.relative_to(rover.folder)} {len(data)}\n".encode() + data)
    return content.hexdigest()


@lru_cache(maxsize=16)
def _read(folder: Path, _: tuple[object, ...]) -> RoverSpec:
    """The rover of a folder whose files were changed at those times."""
    path = folder / "rover.yaml"
    values = read_mapping(path)
    if folder.parent == MODELS_DIR:
        rover = fill(RoverSpec, values, str(path), name=folder.name, folder=folder, **_shipped(folder))
    else:
        rover = _brought_along(folder, values)
    check_values(rover, path)
    return rover


def _shipped(folder: Path) -> dict[str, Any]:
    model = folder / f"{folder.name}.xml"
    try:
        return told_by_mjcf(ET.parse(model).getroot())  # noqa: S314 - no stranger's
    except (OSError, ET.ParseError, AttributeError, KeyError, ValueError, IndexError) as error:
        raise UsageError(f"{model} is not as models/README.md says: {error!r}") from error


def _brought_along(folder: Path, values: Mapping[str, Any]) -> RoverSpec:
    """A rover that does not ship; loads MuJoCo."""
    from harness.robots.measures import Measures  # noqa: PLC0415 - whoever publishes leo does without

    path = folder / "rover.yaml"
    unsaid = dict.fromkeys(RoverSpec.__dataclass_fields__)
    said = fill(RoverSpec, values, str(path), otherwise=unsaid, **dict.fromkeys(GIVEN))
    model = str(said.model or _only_model(folder))
    measures = Measures(
        replace(said, name=folder.name, folder=folder, model=model, drive=said.drive or Drive())
    )
    given = {key: getattr(measures, key) for key in TOLD}
    rest = {key: value for key, value in values.items() if key not in ("drive", "model")}
    given |= {"name": folder.name, "folder": folder, "model": model, "drive": measures.drive}
    return fill(RoverSpec, rest, str(path), otherwise=measures.derived(), **given)


def _only_model(folder: Path) -> str:
    """The name of the model's file, where rover.yaml does not say it."""
    names = sorted(path.name for path in folder.glob("*.xml"))
    if f"{folder.name}.xml" in names:
        return f"{folder.name}.xml"
    if len(names) == 1:
        return names[0]
    told = f"which of {', '.join(names)} is the model" if names else "an MJCF file (.xml) of the model"
    raise UsageError(f"{folder / 'rover.yaml'}: key 'model' is missing; give {told}")


def _no_rover(folder: Path) -> str:
    urdf = sorted(path.name for path in folder.glob("*") if path.suffix in (".urdf", ".xacro"))
    source = folder / urdf[0] if urdf else "robot.urdf"
    return (
        f"{folder} holds no rover.yaml; python -m harness.robot new NAME --from {source} writes "
        "a folder that does"
    )


def check_values(rover: RoverSpec, path: Path) -> None:
    """Checks the numbers of a rover.

    Raises:
        UsageError: One is not valid; the message names the file, the key and what is.
    """
    for key, value in vars(rover).items():
        number = isinstance(value, int | float) and not isinstance(value, bool)
        if number and not (key in MAY_BE_ZERO or 0 < value < float("inf")):
            raise UsageError(f"{path}: {key} = {value:g} is not valid; give a number above 0")
    if min(rover.length, rover.width) <= 0:
        raise UsageError(
            f"{path}: footprint = {rover.footprint} is empty; give x_min, x_max, y_min, y_max"
        )
    if not 0 < rover.drive.steering_rate < float("inf"):
        raise UsageError(
            f"{path}: drive: steering_rate = {rover.drive.steering_rate:g} is not valid; "
            "give a number above 0"
        )
    if rover.drive.kind not in DRIVES:
        raise UsageError(
            f"{path}: drive: kind = '{rover.drive.kind}' is not valid; give {' or '.join(DRIVES)}"
        )
