"""What a suite has done so far, so that one that was stopped can go on: a line of JSON a run."""

import hashlib
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import fields
from pathlib import Path

from pydantic import TypeAdapter

from harness.base.documents import parse_json
from harness.base.errors import UsageError
from harness.base.version import __version__
from harness.drivers.base import OF_POLICY
from harness.episode.assembly import world_of
from harness.robots import ROVERS
from harness.robots.content import content_of
from harness.scenario.baseline import path_of
from harness.scenario.case import Case
from harness.scenario.verdict import Attempt
from harness.spec.run import Run
from harness.world.files import files_beside, is_heightmap, is_terrain_file
from harness.world.soil_map import soil_files

_ATTEMPT = TypeAdapter(Attempt)
_OWN = [field.name for field in fields(Attempt) if field.name != "case"]
DIGITS = 12  # of the hash in the file's name


class Progress:
    """A file in the folder of the evidence, from the first run to the last; other runs have another.

    Where it cannot be written the suite runs all the same, and cannot go on after a stop.

    Args:
        cases: All runs of the suite.
        folder: Of the evidence.
        compare: Whether the runs are compared with their baselines.
    """

    def __init__(self, cases: Sequence[Case], folder: Path, *, compare: bool) -> None:
        self._cases, self._folder = cases, folder
        self._identity = _identity(cases, compare=compare)
        names = repr([(case.name, str(case.path)) for case in cases])
        digest = hashlib.sha256(names.encode()).hexdigest()[:DIGITS]
        self._path = folder / f"unfinished-{digest}.jsonl"

    @property
    def exists(self) -> bool:
        """Whether something is kept."""
        return self._path.exists()

    def read(self) -> dict[int, Attempt]:
        """Returns what was done before, by the place of its case."""
        return dict(self._lines())

    def begin(self) -> None:
        """Forgets what was done before."""
        with suppress(OSError):
            self._path.unlink(missing_ok=True)

    def keep(self, index: int, attempt: Attempt) -> None:
        """Keeps a run, where a kill of this process leaves it."""
        text = _ATTEMPT.dump_json(attempt, include=set(_OWN)).decode()
        with suppress(OSError):
            self._folder.mkdir(parents=True, exist_ok=True)
            with self._path.open("a", encoding="utf-8") as file:
                if not file.tell():
                    file.write(f"{self._identity}\n")
                file.write(f"[{index}, {text}]\n")

    def end(self) -> None:
        """Removes the file of a suite that is done, and the folder if there is nothing else in it."""
        self.begin()
        with suppress(OSError):
            self._folder.rmdir()

    def _lines(self) -> Iterator[tuple[int, Attempt]]:
        try:
            identity, *lines = self._path.read_text(encoding="utf-8").splitlines()
        except (OSError, ValueError):
            return
        for line in lines if identity == self._identity else ():
            with suppress(UsageError, ValueError):  # of a process that was killed
                index, values = parse_json(line, "a line")
                attempt = _ATTEMPT.validate_python({"case": self._cases[index], **values})
                # What could not run may be mended since, and what a run has left cleared away.
                if attempt.error is None and all(path.exists() for path in attempt.kept):
                    yield index, attempt


def _identity(cases: Sequence[Case], *, compare: bool) -> str:
    """A hash of all that the outcomes depend on, the contents of files included."""
    runs = {(case.run.world, case.run.rovers): case.run for case in cases}.values()  # of any seed
    files = {file for case in cases for file in (case.path, path_of(case.path))}
    files |= {file for run in runs for file in _files_of(run)}
    digest = hashlib.sha256(repr((__version__, compare)).encode())
    for path in sorted(files):
        if path.is_file():
            digest.update(path.read_bytes())
    for case in cases:
        digest.update(repr((case.run, case.params)).encode())
    return digest.hexdigest()


def _files_of(run: Run) -> Iterator[Path]:
    """What a run may read: world, soil, people, targets, policy, FILE.py of parts, rover's folder."""
    world, driver, sensors = run.world, run.rover.driver, run.rover.sensors or ()
    yield from (Path(world.terrain), Path(driver.removeprefix(OF_POLICY)))
    parts = (driver, world.terrain, world.soil, *(choice.name for choice in sensors))
    yield from (Path(name.rpartition(":")[0]) for name in parts)
    if is_terrain_file(world.terrain) and is_heightmap(world.terrain):
        yield from files_beside(world.terrain)
    elif is_terrain_file(world.terrain):
        with suppress(UsageError):  # which the run tells
            yield from (Path(file) for file, _ in world_of(run).files)
    yield from soil_files(world.soil)
    yield from (Path(actor.file) for actor in world.actors)
    yield from (Path(file) for target in world.targets for file in target.files)
    yield from content_of(Path(run.rover.robot)) if run.rover.robot not in ROVERS else ()
