"""Episodes on disk, and driving what is missing."""

import json
from collections.abc import Callable, Generator, Sequence
from pathlib import Path
from typing import Any

import pytest

from harness.base.errors import RunFailed, UsageError
from harness.tune.episodes import sweep as sweeping
from harness.tune.episodes.plan import Planned, plan
from harness.tune.episodes.record import EpisodeRecord
from harness.tune.episodes.store import Store, decode, encode
from harness.workers import WorkerLost, Workers

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
    return encode(make_record([1.0, 0.5], contacts=[(0.05, 0.1)], windows=[{"roughness": 0.01}]))


def test_a_record_survives_its_file_and_equal_records_are_equal_bytes(make_record: MakeRecord) -> None:
    record = make_record([1.0, float("inf")], contacts=[(0.05, 0.1)], windows=[{"rocks": 0.1}])

    again = decode(encode(record))

    assert encode(again) == encode(record)
    assert again.scans["nearest"].tolist() == [1.0, float("inf")]
    assert (again.driver, again.ending) == (record.driver, record.ending)


@pytest.mark.parametrize("damage", [b"", b"PK", b"\x93NUMPY"])
def test_damaged_bytes_are_no_record(damage: bytes) -> None:
    with pytest.raises(ValueError, match="not an episode"):
        decode(damage)


def test_a_sweep_drives_everything_once(tmp_path: Path, content: bytes) -> None:
    workers, shown = Prepared(content), list[int]()

    records = sweeping.sweep(PLANNED, Store(tmp_path, PLANNED), workers, shown.append)

    assert sorted(e.index for e in workers.driven) == list(range(8))
    assert list(records) == list(PLANNED)
    assert shown == list(range(9))


def test_what_was_driven_before_is_not_driven_again(tmp_path: Path, content: bytes) -> None:
    first = Prepared(content, dies_after=[3, 0, 0, 0])
    with pytest.raises(RunFailed, match="the same command goes on"):
        sweeping.sweep(PLANNED, Store(tmp_path, PLANNED), first, lambda _: None)

    second = Prepared(content)
    sweeping.sweep(PLANNED, Store(tmp_path, PLANNED), second, lambda _: None)

    assert len(first.driven) == 3
    assert len(second.driven) == 5


def test_episodes_of_a_killed_worker_are_driven_again(tmp_path: Path, content: bytes) -> None:
    workers = Prepared(content, dies_after=[2, 3])

    records = sweeping.sweep(PLANNED, Store(tmp_path, PLANNED), workers, lambda _: None)

    assert len(records) == 8
    assert len(workers.driven) == len(set(workers.driven)) == 8


def test_a_full_disk_is_told(tmp_path: Path, content: bytes, monkeypatch: pytest.MonkeyPatch) -> None:
    store = Store(tmp_path, PLANNED)

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(store, "write", full)
    with pytest.raises(RunFailed, match=f"cannot write episode 0007-.* to {tmp_path}: No space left"):
        sweeping.sweep(PLANNED, store, Prepared(content), lambda _: None)


def test_a_torn_file_is_driven_again(tmp_path: Path, content: bytes) -> None:
    sweeping.sweep(PLANNED, Store(tmp_path, PLANNED), Prepared(content), lambda _: None)
    torn = next((tmp_path / "episodes").glob("0003-*.npz"))
    torn.write_bytes(torn.read_bytes()[:100])

    workers = Prepared(content)
    sweeping.sweep(PLANNED, Store(tmp_path, PLANNED), workers, lambda _: None)

    assert [e.index for e in workers.driven] == [3]


@pytest.mark.parametrize(
    ("other", "difference"),
    [
        (plan(("leo", "rover_zero4wd"), 6, 0, 5.0), "8 episodes instead of 12"),
        (plan(("leo", "rover_zero4wd"), 4, 1, 5.0), "other robots, driver, seed or duration"),
    ],
)
def test_another_sweeps_folder_is_refused(
    tmp_path: Path, other: tuple[Planned, ...], difference: str
) -> None:
    Store(tmp_path, PLANNED)

    with pytest.raises(UsageError, match=difference):
        Store(tmp_path, other)


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


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"episodes": 3}'])
def test_an_unreadable_sweep_file_is_refused(tmp_path: Path, text: str) -> None:
    Store(tmp_path, PLANNED)
    (tmp_path / "sweep.json").write_text(text)

    with pytest.raises(UsageError, match="is not readable"):
        Store(tmp_path, PLANNED)


def test_files_of_no_known_sweep_are_refused(tmp_path: Path) -> None:
    (tmp_path / "episodes").mkdir()
    (tmp_path / "episodes" / "a.npz").touch()

    with pytest.raises(UsageError, match="no known sweep"):
        Store(tmp_path, PLANNED)


def test_a_folder_that_is_a_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "out").touch()

    with pytest.raises(UsageError, match="choose another --out"):
        Store(tmp_path / "out", PLANNED)
