"""Episodes on disk, and driving what is missing."""

import io
import json
import shutil
import zipfile
from collections.abc import Callable, Generator, Sequence
from pathlib import Path
from typing import Any

import pytest

from harness.base.errors import RunFailed, UsageError
from harness.base.workers import WorkerLost, Workers
from harness.tune.episodes import store as storing
from harness.tune.episodes import sweep as sweeping
from harness.tune.episodes.plan import Planned, plan
from harness.tune.episodes.record import EpisodeRecord
from harness.tune.episodes.store import Store, encode
from tests.support.rovers import LEO

MakeRecord = Callable[..., EpisodeRecord]
PLANNED = plan(("leo", "rover_zero4wd"), 4, 0, 5.0)


class Prepared(Workers):
    """Workers that hand back prepared bytes, last first, and die where they are told to."""

    def __init__(self, content: bytes, dies_after: Sequence[int] = ()) -> None:
        self._content = content
        self._dies_after = list(dies_after)
        self.driven: list[Planned] = []

    def map(self, _: object, items: Sequence[Any]) -> Generator[Any, None, None]:
        patience = self._dies_after.pop(0) if self._dies_after else len(items)
        for item in reversed(items):
            if patience == 0:
                raise WorkerLost("a worker was killed")
            patience -= 1
            self.driven.append(item[0])
            yield item[0], self._content


@pytest.fixture
def content(make_record: MakeRecord) -> bytes:
    windows = [{"roughness": 0.01}]
    return encode(make_record([1.0, float("inf")], contacts=[(0.05, 0.1)], windows=windows))


def test_a_sweep_drives_everything_once(tmp_path: Path, content: bytes) -> None:
    workers, shown = Prepared(content), list[int]()
    records = sweeping.sweep(PLANNED, Store(tmp_path, PLANNED), workers, shown.append)
    assert sorted(e.index for e in workers.driven) == list(range(8))
    assert list(records) == list(PLANNED)
    assert [encode(record) for record in records.values()] == [content] * 8
    assert shown == list(range(9))


def test_what_was_driven_before_is_not_driven_again_unless_its_file_is_torn(
    tmp_path: Path, content: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = Prepared(content, dies_after=[3, 0, 0, 0])
    with pytest.raises(RunFailed, match="the same command goes on"):
        sweeping.sweep(PLANNED, Store(tmp_path, PLANNED), first, lambda _: None)
    second, third = Prepared(content), Prepared(content)
    sweeping.sweep(PLANNED, Store(tmp_path, PLANNED), second, lambda _: None)
    huge = io.BytesIO(content)
    with zipfile.ZipFile(huge, "a", zipfile.ZIP_DEFLATED) as episode:
        episode.writestr("more", bytes(1 << 17))
    monkeypatch.setattr(storing, "LARGEST", 1 << 16)
    for number, damage in enumerate((b"", b"PK", huge.getvalue(), content[:100])):
        next((tmp_path / "episodes").glob(f"000{number}-*.npz")).write_bytes(damage)
    sweeping.sweep(PLANNED, Store(tmp_path, PLANNED), third, lambda _: None)
    assert (len(first.driven), len(second.driven)) == (3, 5)
    assert [e.index for e in third.driven] == [3, 2, 1, 0]  # torn files


def test_a_sweep_outlives_an_option_that_it_does_not_use(tmp_path: Path) -> None:
    Store(tmp_path, PLANNED)
    sweep = json.loads((tmp_path / "sweep.json").read_text())
    for config in sweep["episodes"].values():
        config |= {"of_another_day": None, "some_of_another_day": []}
    (tmp_path / "sweep.json").write_text(json.dumps(sweep))
    Store(tmp_path, PLANNED)
    config["some_of_another_day"] = [1.0]
    (tmp_path / "sweep.json").write_text(json.dumps(sweep))
    with pytest.raises(UsageError, match="other robots, driver, seed or duration"):
        Store(tmp_path, PLANNED)


@pytest.mark.parametrize("changed", ["rover/leo.xml", "mine.py"])
def test_a_sweep_of_files_of_ones_own_is_another_once_one_has_changed(
    changed: str, tmp_path: Path, content: bytes
) -> None:
    shutil.copytree(LEO.folder, tmp_path / "rover")
    (tmp_path / "mine.py").write_text("from harness.drivers.wander import Roam as Mine\n")
    planned = plan((str(tmp_path / "rover"),), 4, 0, 5.0, f"{tmp_path / 'mine.py'}:Mine")
    for left in (4, 0):
        workers = Prepared(content)
        sweeping.sweep(planned, Store(tmp_path / "out", planned), workers, lambda _: None)
        assert len(workers.driven) == left
    (tmp_path / changed).write_text((tmp_path / changed).read_text() + "\n")
    with pytest.raises(UsageError, match="another sweep's files"):
        Store(tmp_path / "out", planned)


def with_text(change: Callable[[str], str]) -> Callable[[Path], None]:
    """Makes a folder of the sweep whose sweep.json has been changed."""

    def changed(folder: Path) -> None:
        Store(folder, PLANNED)
        (folder / "sweep.json").write_text(change((folder / "sweep.json").read_text()))

    return changed


@pytest.mark.parametrize(
    ("before", "mend"),
    [
        (lambda at: Store(at, plan(("leo",), 4, 0, 5.0)), "4 episodes instead of 8"),
        (lambda at: Store(at, plan(("leo", "rover_zero4wd"), 4, 1, 5.0)), "other robots, driver, seed"),
        (
            with_text(lambda s: json.dumps(json.loads(s) | {"version": "0.0.1"})),
            "version 0.0.1 instead of",
        ),
        *(
            (with_text(lambda _, text=text: text), "is not readable")  # type: ignore[misc]
            for text in ("", "[]", "{}", "[" * 9**5, '{"episodes": 3}')
        ),
        (lambda at: (at / "episodes/a.npz").mkdir(parents=True), "no known sweep"),
        (Path.touch, "cannot write to"),
    ],
)
def test_a_folder_of_no_or_another_sweep(
    before: Callable[[Path], object], mend: str, tmp_path: Path
) -> None:
    folder = tmp_path / "out"
    before(folder)
    with pytest.raises(UsageError, match=f"{mend}.*choose another --out") as caught:
        Store(folder, PLANNED)
    assert str(folder) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_full_disk_is_reported(
    tmp_path: Path, content: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    store = Store(tmp_path, PLANNED)
    with pytest.raises(RunFailed, match=r"8 episodes in .* cannot be read again"):
        sweeping.sweep(PLANNED, store, Prepared(b"PK"), lambda _: None)
    monkeypatch.setattr(store, "write", full)
    with pytest.raises(RunFailed, match=f"cannot write episode 0007-.* to {tmp_path}: No space left"):
        sweeping.sweep(PLANNED, store, Prepared(content), lambda _: None)
