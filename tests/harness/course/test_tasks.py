"""A public seed asks the same of everybody: receipts of other days are compared with those of today."""

import hashlib
import json
from pathlib import Path

from harness.course.entry import BASELINES, LEARNED, find_entry
from harness.course.tracks import TRACKS, find_track
from tests.support.snapshots import check_snapshot


def test_a_public_seed_asks_what_it_asked_and_baselines_drive_as_they_did(tmp_path: Path) -> None:
    lines = []
    for name in TRACKS:
        track = find_track(name)
        task = track.task(track.cases(2)[1], tmp_path)
        asked = json.dumps(task.run.model_dump(mode="json", exclude_defaults=True))
        lines += [f"{name}: {task.shortest:.6f} m, {task.optimal:.6f} s, {task.rule}", asked]
        drivers = (find_entry(entry).driver(name, tmp_path) for entry in (*BASELINES, LEARNED))
        lines.append(", ".join(driver.rpartition("/")[2] for driver in drivers))
    files = sorted(path for path in tmp_path.rglob("*") if path.is_file())
    lines += [f"{path.name}: {hashlib.sha256(path.read_bytes()).hexdigest()[:16]}" for path in files]
    check_snapshot("course_tasks.txt", "\n".join(lines).replace(f"{tmp_path}/", "") + "\n")
