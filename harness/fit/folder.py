"""A fitted rover as a folder of its own: its model, and a rover.yaml with the numbers that are known."""

import shutil
import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML

from harness.base.errors import UsageError
from harness.base.version import __version__
from harness.fit.estimate import Estimate
from harness.fit.mount import AXES, placed
from harness.robots import RoverSpec, find_rover

DIGITS = 5
OF_WHEELS = ("rest_height", "lidar_height", "clearance")  # what grows with the wheels [m]
DROSS = shutil.ignore_patterns("*.html", "*.png", "*.md", ".*")


def check_new(out: Path) -> None:
    """Checks that a folder can be made; UsageError if it exists."""
    if out.exists():
        raise UsageError(f"{out} exists already and is not overwritten; name another --out")


def write_folder(
    rover: RoverSpec, estimates: Iterable[Estimate], out: Path, source: str, surface: str, page: str
) -> None:
    """Writes the folder, whole or not at all.

    Args:
        rover: As it was.
        estimates: What a fit came to.
        out: The folder, which must not exist.
        source: What was fitted to.
        surface: Which tyres and ground are stated for; "" for those of the rover.
        page: HTML, beside rover.yaml.

    Raises:
        UsageError: It cannot be written.
    """
    known = {one.key: round(one.after, DIGITS) for one in estimates if one.key and one.is_known}
    check_new(out)
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=out.parent, prefix=f".{out.name}-") as made:
            half_made = Path(made) / out.name
            shutil.copytree(rover.folder, half_made, ignore=DROSS)
            _change(half_made / "rover.yaml", rover, known, source, surface)
            (half_made / "fit.html").write_text(page, encoding="utf-8")
            find_rover(str(half_made))  # it can be driven
            half_made.rename(out)
    except OSError as error:
        raise UsageError(f"{out} cannot be written: {error.strerror}; name another --out") from error


def _change(path: Path, rover: RoverSpec, known: dict[str, float], source: str, surface: str) -> None:
    document = YAML()
    document.width = 100
    values: Any = document.load(path.read_text(encoding="utf-8"))
    values["model"] = rover.model or rover.model_path.name
    for key, value in known.items():
        section, _, name = key.rpartition(".")
        if section != "imu":
            _section(values, section, "" if name == "radius" else surface)[name] = value
    grown = known.get("tyres.radius", rover.wheel_radius) - rover.wheel_radius
    for name in OF_WHEELS if grown else ():
        if name in values:
            values[name] = round(float(values[name]) + grown, DIGITS)
    if any(key.startswith("imu.") for key in known):
        values["imu"] = _imu(rover, known)
    values.yaml_set_start_comment(f"Fitted by rover-harness {__version__} to {source}.\n")
    with path.open("w", encoding="utf-8") as file:
        document.dump(values, file)


def _section(values: Any, section: str, surface: str) -> Any:  # noqa: ANN401 - as ruamel's
    """The mapping of a section, made if it is missing; tyres on a surface are those of the surface."""
    if section == "tyres" and surface:
        return values.setdefault("surfaces", {}).setdefault(surface, {})
    return values.setdefault(section, {}) if section else values


def _imu(rover: RoverSpec, known: dict[str, float]) -> dict[str, list[float]]:
    place, angles = placed(rover)
    xyz = [known.get(f"imu.{axis}", value) for axis, value in zip("xyz", place, strict=True)]
    rpy = [known.get(f"imu.{axis}", value) for axis, value in zip(AXES, angles, strict=True)]
    return {"xyz": [round(v, DIGITS) for v in xyz], "rpy": [round(v, DIGITS) for v in rpy]}
