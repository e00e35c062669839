"""A folder -> RoverSpec.

The rovers of models/ are read without MuJoCo. The model of any other is compiled, so that a mistake is
reported at once, and what rover.yaml leaves out is derived from it (harness.robots.measures).
"""

from functools import lru_cache
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

from harness.base.documents import read_mapping
from harness.base.errors import UsageError
from harness.robots.content import MODELS_DIR, content_of
from harness.robots.mjcf import stated_by_mjcf
from harness.robots.spec import RoverFile, RoverSpec
from harness.spec.value import made
from rover_metrics.errors import sibling


def read_rover(folder: Path) -> RoverSpec:
    """Returns the rover of a folder; UsageError, which names file and key, if a file is not valid."""
    if not (folder / "rover.yaml").is_file():
        raise UsageError(_no_rover(folder))
    stamps = tuple((path, path.stat().st_mtime_ns, path.stat().st_size) for path in content_of(folder))
    return _read(folder, stamps)


@lru_cache(maxsize=16)
def _read(folder: Path, _: tuple[object, ...]) -> RoverSpec:
    """The rover of a folder whose files were changed at those times."""
    path = folder / "rover.yaml"
    values = read_mapping(path, or_empty=True)  # each key may be left out
    stated = made(RoverFile, values, str(path))
    if folder.parent == MODELS_DIR:
        facts = _shipped(folder) | {"name": folder.name, "folder": folder}
        facts["wheel_radius"] = stated.tyres.radius or facts["wheel_radius"]
        width = {"wheel_width": facts.pop("wheel_width")}
        return made(RoverSpec, width | values | facts, str(path))
    # Here, for a process that only publishes a rover that ships does without MuJoCo.
    from harness.robots.measures import Measures  # noqa: PLC0415

    facts = {"name": folder.name, "folder": folder, "model": stated.model or _only_model(folder)}
    measures = Measures(RoverSpec.model_construct(**stated.__dict__ | facts))
    return made(RoverSpec, measures.derived() | values | facts | measures.facts(), str(path))


def _shipped(folder: Path) -> dict[str, Any]:
    model = folder / f"{folder.name}.xml"
    try:
        return stated_by_mjcf(ET.parse(model).getroot())  # noqa: S314 - it ships with this package
    except (OSError, ET.ParseError, AttributeError, KeyError, ValueError, IndexError) as error:
        raise UsageError(f"{model} is not as models/README.md says: {error!r}") from error


def _only_model(folder: Path) -> str:
    """The name of the model's file, where rover.yaml does not say it."""
    names = sorted(path.name for path in folder.glob("*.xml"))
    if f"{folder.name}.xml" in names:
        return f"{folder.name}.xml"
    if len(names) == 1:
        return names[0]
    missing = (
        f"which of {', '.join(names)} is the model" if names else "an MJCF file (.xml) of the model"
    )
    raise UsageError(f"{folder / 'rover.yaml'}: key 'model' is missing; give {missing}")


def _no_rover(folder: Path) -> str:
    models = sorted(folder.glob("*.xml"))
    if len(models) == 1:
        return f"{folder} holds no rover.yaml; put one beside {models[0].name}, which may be empty"
    urdf = sorted(path.name for path in folder.glob("*") if path.suffix in (".urdf", ".xacro"))
    source = folder / urdf[0] if urdf else "robot.urdf"
    return (
        f"{folder} holds no rover.yaml; {sibling('harness.robot')} new NAME --from {source} writes "
        "a folder that does"
    )
