"""Reads a .db3 file of rosbag2: whole, short, or around a bad page."""

import sqlite3
from collections.abc import Collection, Iterator
from contextlib import closing
from pathlib import Path
from urllib.parse import quote

from rover_metrics.bag.message import Message, UnreadableError

LARGEST_SKIP = 2**32  # rows


class SqliteFile:
    """A .db3 file; `topics` has the message type of each topic with messages.

    Raises:
        UnreadableError: It is not a rosbag2 database, or its list of topics is lost.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._names: dict[int, str] = {}
        self.topics: dict[str, str] = {}
        try:
            with closing(self._connect()) as database:
                for key, name, kind in database.execute("SELECT id, name, type FROM topics"):
                    self._names[key] = str(name)
                    if _has_messages(database, key):
                        self.topics[str(name)] = str(kind)
        except sqlite3.Error as error:
            raise UnreadableError(f"not readable as a rosbag2 database ({error})") from error

    def messages(self, wanted: Collection[str], problems: list[str]) -> Iterator[Message]:
        """Yield each message, in the order of recording."""
        gaps: list[str] = []
        with closing(self._connect()) as database:
            for key, time_ns, data in self._rows(database, wanted, gaps):
                if key in self._names and isinstance(time_ns, int):
                    yield Message(self._names[key], time_ns, data if isinstance(data, bytes) else b"")
        if gaps:
            problems.append(
                f"{self._path.name} is damaged; messages were lost in {len(gaps)} place(s), "
                f"the first {gaps[0]}"
            )

    def _rows(
        self, database: sqlite3.Connection, wanted: Collection[str], gaps: list[str]
    ) -> Iterator[tuple[int, object, object]]:
        """Walk the messages; past a bad page, look ever further ahead for the next good one."""
        keys = ",".join(str(key) for key, name in self._names.items() if name in wanted)
        query = (
            "SELECT id, topic_id, timestamp, "  # noqa: S608 - the keys are whole numbers
            f"CASE WHEN topic_id IN ({keys}) THEN data END FROM messages WHERE id > ? ORDER BY id"
        )
        after, skip = -1, 1
        while skip < LARGEST_SKIP:
            try:
                for row_id, key, time_ns, data in database.execute(query, (after,)):
                    after, skip = row_id, 1
                    yield key, time_ns, data
            except sqlite3.Error as error:  # noqa: PERF203 - each try walks on behind a gap
                if skip == 1:
                    gaps.append(f"after row {after} ({error})")
                after, skip = after + skip, skip * 2
            else:
                return

    def _connect(self) -> sqlite3.Connection:
        """Open for reading; nothing is written, unless a write-ahead log has to be taken in."""
        wal = self._path.with_name(f"{self._path.name}-wal")
        mode = "mode=ro" if wal.exists() else "mode=ro&immutable=1"
        database = sqlite3.connect(f"file:{quote(str(self._path.absolute()))}?{mode}", uri=True)
        # Lets SQLite open a file that is shorter than its header says.
        database.execute("PRAGMA writable_schema=ON")
        return database


def _has_messages(database: sqlite3.Connection, topic: int) -> bool:
    """Whether a topic has messages; where the database is damaged, they are only to be hoped for."""
    try:
        found = database.execute("SELECT 1 FROM messages WHERE topic_id = ? LIMIT 1", (topic,))
        return found.fetchone() is not None
    except sqlite3.DatabaseError:
        return True
