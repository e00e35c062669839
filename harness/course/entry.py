"""What is judged: a baseline that ships, or a folder with a driver, a policy or a ROS program.

A folder has `entry.yaml`, whose `driver`, `policy` or `launch` says which, and `lock`, a file that pins
what it was made with. Its files travel by value, so that a worker on another machine has them too.
"""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Annotated, Self

from pydantic import Field, model_validator

from harness.base.documents import read_bytes, read_mapping
from harness.base.errors import UsageError, unknown
from harness.drivers import DRIVERS, takes_goals
from harness.drivers.base import OF_POLICY
from harness.spec.value import Value, made

FILE = "entry.yaml"
MOST_BYTES = 64 * 2**20
POLICIES = "policies"
# The driver of each baseline; "learned" has policies by track in policies/, and is `goal` on the others.
BASELINES = {"straight": "beeline", "goal": "goal", "gap": "gap", "dwa": "dwa", "mppi": "mppi"}
LEARNED = "learned"


class EntryFile(Value):
    """What entry.yaml says.

    Attributes:
        name: On pages and receipts; that of the folder if left out.
        driver: FILE.py:CLASS, a driver as harness.drivers has them (docs/course.md).
        policy: FILE.npz (docs/gym.md).
        launch: Words of a command that starts a ROS 2 node; `node` is the node's full name.
        lock: File of the folder that pins what it needs, e.g. requirements.txt.
    """

    name: Annotated[str, Field(max_length=60)] = ""
    driver: str = ""
    policy: str = ""
    launch: tuple[str, ...] = ()
    node: str = ""
    lock: str

    @model_validator(mode="after")
    def _is_one_thing(self) -> Self:
        given = [name for name in ("driver", "policy", "launch") if getattr(self, name)]
        if len(given) != 1:
            raise ValueError(f"give one of driver, policy and launch, not {len(given)} of them")
        if bool(self.launch) != bool(self.node):
            raise ValueError("launch and node belong together: the command, and its node's full name")
        return self


@dataclass(frozen=True)
class Entry:
    """What is judged, by value.

    Attributes:
        name: On pages and receipts.
        files: Name and content of each file; empty for a baseline.
        about: What entry.yaml says; None for a baseline.
    """

    name: str
    files: tuple[tuple[str, bytes], ...] = ()
    about: EntryFile | None = None

    @property
    def digest(self) -> str:
        """SHA-256 of its files, or of what a baseline is called; the code of that is the version's."""
        digest = hashlib.sha256(self.name.encode() if self.about is None else b"")
        for name, content in self.files:
            digest.update(f"{len(name)} {name} {len(content)} ".encode() + content)
        return digest.hexdigest()

    def driver(self, track: str, folder: Path) -> str:
        """Returns the name of its driver on a track, as harness.drivers finds it in its folder."""
        if self.about is None:
            policy = str(files("harness.course").joinpath(POLICIES, f"{track}.npz"))
            learned = OF_POLICY + policy if Path(policy).is_file() else "goal"
            return (BASELINES | {LEARNED: learned})[self.name]
        if self.about.policy:
            return f"{OF_POLICY}{folder / self.about.policy}"
        return str(folder / self.about.driver)


def find_entry(name: str) -> Entry:
    """Returns the baseline of that name, or the entry of a folder; UsageError if it is neither."""
    if name in (*BASELINES, LEARNED):
        return Entry(name)
    folder = Path(name)
    if not folder.is_dir():
        raise UsageError(
            f"{unknown('entry', name, (*BASELINES, LEARNED))}; or give a folder with {FILE}"
        )
    about = made(EntryFile, _said(folder / FILE), str(folder / FILE))
    entry = Entry(about.name or folder.resolve().name, _content(folder), about)
    known = {name for name, _ in entry.files}
    for key, file in (("lock", about.lock), ("policy", about.policy), ("driver", about.driver)):
        if file and file.rpartition(":")[0 if key == "driver" else 2] not in known:
            raise UsageError(f"{folder / FILE}: {key} '{file}' names no file of the folder")
    if not about.launch and not takes_goals(entry.driver("", folder)):
        raise UsageError(
            f"{folder / FILE}: {about.driver} has no head_for(x, y, yaw): it hears of no goal"
        )
    return entry


def _said(path: Path) -> Mapping[str, object]:
    if not path.is_file():
        raise UsageError(f"{path} does not exist; it says what the entry is (docs/course.md)")
    return read_mapping(path)


def _content(folder: Path) -> tuple[tuple[str, bytes], ...]:
    """All files below a folder but what Python and git leave there."""
    paths = (path for path in folder.rglob("*") if path.is_file())
    own = {path.relative_to(folder).as_posix(): path for path in paths}
    kept = [n for n in sorted(own) if not any(p.startswith((".", "__pycache__")) for p in n.split("/"))]
    content = tuple((name, read_bytes(own[name], MOST_BYTES)) for name in kept)
    if sum(len(data) for _, data in content) > MOST_BYTES:
        raise UsageError(f"entry {folder} holds more than {MOST_BYTES >> 20} MiB; take some out")
    return content


def unpack(entry: Entry, folder: Path) -> None:
    """Writes the files of an entry into a folder."""
    for name, content in entry.files:
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)


assert set(BASELINES.values()) <= set(DRIVERS)  # noqa: S101 - a mistake of this file
