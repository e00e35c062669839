"""Where files are that a world names: model://PACKAGE/path, file://, and plain paths.

Relative names are looked for in the folders of `--resource-path`, those of Gazebo's variables of the
environment, the folder of the file that names them and the two above it, in this order, and in a folder
`models` of each of the last three; a name that leads out of all of these is refused. Nothing is fetched.
"""

import os
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path, PurePosixPath
from urllib.parse import unquote
from xml.etree.ElementTree import Element

from harness.base.errors import UsageError
from harness.base.xml import parse_xml, read_xml

VARIABLES = (
    *("GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH", "GAZEBO_MODEL_PATH"),
    "GAZEBO_RESOURCE_PATH",  # of Gazebo classic's own media/
)
SCHEME = re.compile(r"^([a-z][a-z0-9+.-]*):(?://)?(.*)$", re.IGNORECASE | re.DOTALL)
LOCAL_SCHEMES = ("model", "package", "file")
PLANE = b"<geometry><plane><normal>0 0 1</normal><size>100 100</size></plane></geometry>"
GROUND_PLANE = parse_xml(
    b"<model name='ground_plane'><static>1</static><link name='link'><collision name='collision'>"
    + PLANE
    + b"</collision></link></model>"
)
# What Gazebo brings itself, by the end of its address, so that worlds seldom do; a lamp is nothing here.
OF_GAZEBO: Mapping[str, tuple[Element, ...]] = {"ground_plane": (GROUND_PLANE,), "sun": ()}


class Missing(Exception):
    """What a world names cannot be had; its text says why."""


class Resources:
    """The folders in which names are looked for, those of `--resource-path` first of all."""

    def __init__(self, folders: Sequence[Path] = ()) -> None:
        for folder in folders:
            if not folder.is_dir():
                raise UsageError(f"--resource-path {folder} is not a folder; name one that has models")
        words = (os.environ.get(name, "").split(os.pathsep) for name in VARIABLES)
        self._folders = [*folders, *(Path(word) for folder in words for word in folder if word)]

    def find(self, uri: str, named_in: Path) -> Path:
        """Returns the file or folder that a URI in a file means; Missing if it cannot be had."""
        scheme, name = _split(uri)
        if scheme not in ("", *LOCAL_SCHEMES):
            raise Missing(
                f"{uri}: nothing is fetched; download it, and name its folder by --resource-path"
            )
        if name.startswith("/") and scheme not in ("model", "package"):
            if Path(name).exists():
                return Path(name)
            raise Missing(f"{uri}: there is no such file on this machine")
        name = name.lstrip("/")
        if not name:
            raise Missing(f"'{uri}': names nothing")
        leads_out = False
        for root in self._roots(named_in):
            path = Path(os.path.normpath(root / name))
            if not any(path.is_relative_to(top) for top in self._roots(named_in)):
                leads_out = True
            elif path.exists():
                return path
        if leads_out:
            raise Missing(f"{uri}: it leads out of the folders that are looked in")
        first, *below = PurePosixPath(name).parts
        is_file = not below and PurePosixPath(name).suffix
        what = first if is_file else f"{first}/"
        raise Missing(f"{uri}: not found; name the folder that has {what} by --resource-path")

    def _roots(self, named_in: Path) -> Iterator[Path]:
        home = Path(os.path.abspath(named_in)).parent  # noqa: PTH100 - links are not followed: names count
        yield from (Path(os.path.abspath(folder)) for folder in self._folders)  # noqa: PTH100 - as below
        above = [folder for folder in [*home.parents][:2] if folder != folder.parent]  # not /
        for folder in (home, *above):
            yield from (folder, folder / "models")


def of_gazebo(uri: str) -> tuple[Element, ...] | None:
    """Returns the models that Gazebo has under a URI wherever it is installed; None if it has none."""
    return OF_GAZEBO.get(unquote(uri).rpartition("/")[2].lower().replace(" ", "_"))


def _split(uri: str) -> tuple[str, str]:
    match = SCHEME.match(uri.strip())
    if match is None:
        return "", uri.strip()
    return match[1].lower(), unquote(match[2])


def model_file(path: Path) -> Path:
    """Returns the SDF file of a model: itself, or what its folder's model.config names; else Missing."""
    if not path.is_dir():
        return path
    config = path / "model.config"
    if not config.is_file():
        plain = path / "model.sdf"
        if plain.is_file():
            return plain
        raise Missing(f"{path}: neither model.config nor model.sdf is in it")
    named = [item for item in read_xml(config).findall("sdf") if (item.text or "").strip()]
    if not named:
        raise Missing(f"{config}: it names no <sdf>")
    newest = max(named, key=lambda item: [int(n) for n in re.findall(r"\d+", item.get("version", "0"))])
    file = Path(os.path.normpath(path / (newest.text or "").strip()))
    if not file.is_relative_to(path) or not file.is_file():
        raise Missing(f"{config}: there is no {(newest.text or '').strip()} beside it")
    return file
