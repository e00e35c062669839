import json
import time
from collections.abc import Iterator
from datetime import timedelta
from pathlib import Path

import pytest

from rover_metrics.core.thresholds import Thresholds
from rover_metrics.log import session_record as records
from rover_metrics.log.session_record import SessionEnd, SessionRecord, session_end
from tests.rover_metrics.conftest import STARTED


@pytest.fixture
def log(tmp_path: Path) -> Path:
    return tmp_path / "metrics_log_20250116_120457.csv"


@pytest.fixture
def _in_nepal(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A time zone that no other is taken for."""
    with monkeypatch.context() as patch:
        patch.setenv("TZ", "NPT-5:45")
        time.tzset()
        yield
    time.tzset()


def read(log: Path) -> dict[str, object]:
    record: dict[str, object] = json.loads(log.with_suffix(".json").read_text())
    return record


@pytest.mark.usefixtures("_in_nepal")
def test_a_session_is_unmarked_until_it_ends_and_its_record_tells_the_rest(log: Path) -> None:
    assert session_end(log) is SessionEnd.UNKNOWN
    clock = (STARTED + timedelta(minutes=minute) for minute in range(9))
    record = SessionRecord("/leo/metrics_node", lambda: next(clock), print)
    record.begin(log)
    assert session_end(log) is SessionEnd.UNMARKED
    begun = {"log": str(log), "outcome": None, "node": "/leo/metrics_node"}
    begun |= {"started": "2025-01-16T12:04:57+05:45", "ended": None}
    assert read(log) == begun
    record.end(log, 0, {"rows": 7})
    assert session_end(log) is SessionEnd.MARKED
    ended = {"outcome": {"status": "complete", "reason": None}, "ended": "2025-01-16T12:05:57+05:45"}
    assert read(log) == {**begun, **ended, "lost_rows": 0, "rows": 7}


def test_a_session_that_broke_has_failed(log: Path) -> None:
    for failure, lost_rows, reason in (
        (None, 1, "1 rows could not be written"),
        ("ValueError: boo", 12, "ValueError: boo"),
    ):
        record = SessionRecord("/metrics_node", lambda: STARTED, print)
        assert record.failure is None
        record.failure = failure
        record.end(log, lost_rows, {})
        record.end(log, 0, {"rows": 8})  # once is enough
        assert "rows" not in read(log)
        assert read(log)["outcome"] == {"status": "failed", "reason": reason}
        assert read(log)["lost_rows"] == lost_rows


def test_a_record_that_cannot_be_written_is_told_and_costs_nothing(tmp_path: Path) -> None:
    told: list[str] = []
    record = SessionRecord("/metrics_node", lambda: STARTED, told.append)
    record.begin(tmp_path / "gone/log.csv")
    place = f"{tmp_path}/gone/log.json"
    assert told == [f"cannot write the session's record to {place}: No such file or directory"]


def test_the_outcome_of_the_real_manifest_is_the_one_that_is_looked_for(log: Path) -> None:
    manifest = pytest.importorskip("harness.episode.manifest", exc_type=ImportError)
    from harness.episode.result import RunResult  # noqa: PLC0415 - the harness is optional here
    from harness.spec.run import Run  # noqa: PLC0415

    records.write_record(log, None, {})
    manifest.write_manifest(RunResult(run=Run(), mode="direct"), log.with_suffix(".json"))
    assert session_end(log) is SessionEnd.MARKED


UNKNOWN, UNMARKED, MARKED = SessionEnd.UNKNOWN, SessionEnd.UNMARKED, SessionEnd.MARKED


@pytest.mark.parametrize(
    ("record", "end", "arguments", "collision"),
    [
        *((text, UNKNOWN, {}, None) for text in ("[" * 5000, f"[{'9' * 5001}]", " " * 2**23)),
        (f'{{"thresholds": {{"collision_threshold": 1{"0" * 400}}}}}', UNKNOWN, {}, None),
        *((text, UNKNOWN, {}, None) for text in ("{", "7", '{"log": 3}', "\x00\x00")),
        ('{"outcome": null}', UNMARKED, {}, None),
        ('{"outcome": {}, "mode": "ROS 2"}', MARKED, {}, None),
        ('{"arguments": {"seed": 3}, "options": {"seed": 4}}', UNKNOWN, {"seed": 3}, None),
        ('{"arguments": ["--seed"]}', UNKNOWN, {}, None),
        ('{"thresholds": {"collision_threshold": 0.3, "of_another_version": 1.0}}', UNKNOWN, {}, 0.3),
        ('{"thresholds": {}}', UNKNOWN, {}, 0.2),
        ('{"thresholds": {"collision_threshold": "0.75"}}', UNKNOWN, {}, 0.75),
        ('{"thresholds": [1]}', UNKNOWN, {}, None),
        *(
            (f'{{"thresholds": {{"collision_threshold": {value}}}}}', UNKNOWN, {}, None)
            for value in ("-1", '"x"', "null")
        ),
    ],
)
def test_a_record_is_read_as_far_as_it_makes_sense(
    log: Path, record: str, end: SessionEnd, arguments: dict[str, object], collision: float | None
) -> None:
    log.with_suffix(".json").write_text(record)
    told = records.session_thresholds(log)
    assert told == (None if collision is None else Thresholds(collision_threshold=collision))
    assert (session_end(log), records.session_arguments(log)) == (end, arguments)
    other = log.parent / "other.csv"
    assert (session_end(other), records.session_arguments(other)) == (UNKNOWN, {})
    assert records.session_thresholds(other) is None
