"""One npz file per episode, there whole or not at all; one JSON file says which sweep they are of."""

import io
import json
from hashlib import sha256
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import numpy as np

from harness.base.documents import read_json
from harness.base.errors import UsageError
from harness.base.files import whole_file
from harness.base.version import __version__
from harness.drivers.base import OF_POLICY
from harness.robots import ROVERS, find_rover
from harness.robots.content import model_hash
from harness.spec.run import Run
from harness.tune.episodes.plan import Planned
from harness.tune.episodes.record import EVENT, SCAN, SCHEMA, WINDOW, Ending, EpisodeRecord, Table
from rover_metrics.errors import counted
from rover_metrics.log.files import json_safe, write_whole

EPISODES, SWEEP = "episodes", "sweep.json"
UNSET: tuple[Any, ...] = (None, (), [])  # options that an episode does not use; JSON has lists
DEFAULTS = json_safe(Run().fields())  # as they are read
TABLES = {"scans": SCAN, "windows": WINDOW, "events": EVENT}
LARGEST = 1 << 28  # bytes of an episode in memory: nine days of driving
LABELS = ("ending", "driver", "terrain")


def encode(record: EpisodeRecord) -> bytes:
    """Returns the bytes of an npz file with an array per column; equal records give equal bytes."""
    buffer = io.BytesIO()
    columns = {
        f"{table}.{column}": getattr(record, table)[column]
        for table, dtype in TABLES.items()
        for column in dtype.names or ()
    }
    labels = {name: np.array(str(getattr(record, name))) for name in LABELS}
    length = np.array(record.path_length)
    np.savez_compressed(buffer, allow_pickle=False, path_length=length, **columns, **labels)
    return buffer.getvalue()


def decode(content: bytes) -> EpisodeRecord:
    """Returns the record in the bytes of an npz file.

    Raises:
        ValueError: It is not one, or of another schema.
    """
    try:
        with np.load(io.BytesIO(content), allow_pickle=False) as npz:
            _check_size(npz.zip)
            tables = dict[str, Table]()
            for name, dtype in TABLES.items():
                columns = [npz[f"{name}.{column}"] for column in dtype.names or ()]
                tables[name] = np.rec.fromarrays(columns, dtype=dtype).view(dtype, np.ndarray)
            ending, driver, terrain = (str(npz[name]) for name in LABELS)
            length = float(npz["path_length"])
    except Exception as error:
        # zipfile, zlib and numpy each have their own ways to say that bytes are damaged.
        raise ValueError(f"not an episode: {error}") from error
    return EpisodeRecord(
        **tables, ending=Ending(ending), path_length=length, driver=driver, terrain=terrain
    )


def _check_size(file: ZipFile) -> None:
    if sum(info.file_size for info in file.infolist()) > LARGEST:
        raise ValueError(f"it unpacks to more than {LARGEST >> 20} MB")


class Store:
    """The folder of one sweep, made if it is not there.

    Raises:
        UsageError: The folder cannot be used, or holds another sweep's files.
    """

    def __init__(self, folder: Path, planned: tuple[Planned, ...]) -> None:
        self.folder = folder
        self._episodes = folder / EPISODES
        try:
            self._episodes.mkdir(parents=True, exist_ok=True)
            self._claim(planned)
        except OSError as error:
            message = f"cannot write to {folder}: {error.strerror}; choose another --out"
            raise UsageError(message) from error

    def write(self, planned: Planned, content: bytes) -> None:
        """Keeps an episode's npz bytes."""
        with whole_file(self._path(planned)) as part:
            part.write_bytes(content)

    def read(self, planned: Planned) -> EpisodeRecord | None:
        """Returns an episode that was driven before; None if it was not, or its file cannot be read."""
        try:
            return decode(self._path(planned).read_bytes())
        except (OSError, ValueError):
            return None

    def _path(self, planned: Planned) -> Path:
        return self._episodes / f"{planned.name}.npz"

    def _claim(self, planned: tuple[Planned, ...]) -> None:
        path, identity = self.folder / SWEEP, _identity(planned)
        if not path.exists():
            if any(self._episodes.iterdir()):
                raise UsageError(f"{self._episodes} holds files of no known sweep; choose another --out")
            write_whole(path, json.dumps(identity, indent=2) + "\n")
        elif difference := _difference(path, identity):
            raise UsageError(
                f"{self.folder} holds another sweep's files ({difference}); "
                "choose another --out or remove the folder"
            )


def _identity(planned: tuple[Planned, ...]) -> dict[str, Any]:
    """What determines a sweep; exact sensors are false, as in the sweeps that users keep."""
    configs = {one.name: one.run.fields() | {"noise": one.run.rover.noise or False} for one in planned}
    identity = {"version": __version__, "schema": SCHEMA, "episodes": _used(configs)}
    folders = {one.run.rover.robot for one in planned} - set(ROVERS)
    if folders:  # those that ship change with the version
        identity["folders"] = {robot: model_hash(find_rover(robot)) for robot in sorted(folders)}
    drivers = sorted({one.run.rover.driver for one in planned})
    files = [name.removeprefix(OF_POLICY) for name in drivers if name.startswith(OF_POLICY)]
    files += [name.rpartition(":")[0] for name in drivers if ".py:" in name]
    if files:
        identity["policies"] = [sha256(Path(file).read_bytes()).hexdigest() for file in files]
    return dict(json_safe(identity))  # as it will be read: lists for tuples


def _used(configs: dict[str, dict[str, Any]]) -> dict[str, dict[str, Any]]:
    """Configurations without what is unset or left to its default: a sweep outlives options to come."""
    return {
        name: {
            field: value
            for field, value in config.items()
            if value not in UNSET and json_safe(value) != DEFAULTS.get(field)
        }
        for name, config in configs.items()
    }


def _difference(path: Path, ours: dict[str, Any]) -> str:
    """What tells the sweep of a folder from ours, in a few words; empty if nothing does."""
    try:
        theirs = read_json(path)
        if theirs | {"episodes": _used(theirs["episodes"])} == ours:
            return ""
        for name in ("version", "schema"):
            if theirs[name] != ours[name]:
                return f"{name} {theirs[name]} instead of {ours[name]}"
        episodes = len(theirs["episodes"])
    except (UsageError, TypeError, LookupError, AttributeError):
        return f"{SWEEP} is not readable"
    if episodes != len(ours["episodes"]):
        return f"{counted(episodes, 'episode')} instead of {len(ours['episodes'])}"
    return "other robots, driver, seed or duration"
