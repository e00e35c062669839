"""The figures of a run's page, recomputed from its batches and its log."""

import csv
import json
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from harness.base.interrupt import StopRequest
from harness.episode.assembly import world_of
from harness.episode.batch import Batch
from harness.episode.direct import run_direct
from harness.episode.result import Outputs
from harness.report.content import render
from harness.report.recorder import RunRecorder
from harness.samples import ActorPoses, Imu, LaserScan, Pose
from harness.spec.ros import RosOptions
from harness.spec.run import Run
from harness.world.obstacles import ObstacleKind
from tests.support.pages import without_plotly

TRUTH = {"Distance Traveled", "Current Velocity"}


class Kept:
    def __init__(self) -> None:
        self.batches = list[Batch]()

    def take(self, batch: Batch) -> None:
        self.batches.append(batch)


def joined(spans: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Spans [s] of which those less than half a second apart are one."""
    whole = list[tuple[float, float]]()
    for begin, end in spans:
        if whole and begin - whole[-1][1] <= 0.5:
            begin = whole.pop()[0]
        whole.append((begin, end))
    return whole


def test_the_map_and_all_series_of_a_page_are_those_of_the_batches(tmp_path: Path) -> None:
    people = ("ann=4,0.7/-2,0.7", "bob=3,-3/3,3:speed=0.5")
    post = min(
        (o for o in world_of(Run.of(terrain="posts")).obstacles if o.kind is ObstacleKind.HAZARD),
        key=lambda o: math.hypot(*o.position[:2]),
    )
    x, y, _ = post.position
    run = Run.of(terrain="posts", driver="straight", duration=12.0, actors=people,
                 start=(0.0, 0.0, round(math.atan2(y, x), 3)))  # fmt: skip
    kept, recorder = Kept(), RunRecorder()
    outputs = [Outputs(log_dir=tmp_path, observers=(recorder, kept))]
    (result,) = run_direct(run, outputs, RosOptions(log_dir=tmp_path), StopRequest())
    page = without_plotly(render(result, recorder))
    figures: dict[str, Any] = json.loads(re.findall(r'id="figures">(.*?)</script>', page)[0])
    drawn = {name: [t for t in figures["map"]["data"] if t["name"] == name] for name in
             {t["name"] for t in figures["map"]["data"]}}  # fmt: skip

    stretches = [kept.batches[n : n + 2] for n in range(0, len(kept.batches), 2)]
    samples = [[s for b in pair for tick in b.ticks for s in tick.samples] for pair in stretches]
    ends = [pair[-1].truth for pair in stretches]
    t = np.array([end.time_ns for end in ends]) / 1e9
    place, way = np.array([end.position for end in ends]), np.array([end.path_length for end in ends])
    felt = [
        [np.linalg.norm(s.linear_acceleration) for s in some if isinstance(s, Imu)] for some in samples
    ]
    low, high = (np.array([of(some) for some in felt]) for of in (min, max))
    line, marks = drawn["path"]
    assert np.column_stack([line["x"], line["y"]]) == pytest.approx(place[:, :2], abs=1e-4)
    rough = np.maximum(high - 9.8, 9.8 - low)
    assert np.array(sorted(marks["customdata"])) == pytest.approx(
        np.column_stack([t, rough, place[:, 2]]), abs=1e-2
    )
    assert marks["marker"]["color"] == sorted(marks["marker"]["color"])
    assert max(marks["marker"]["color"]) == pytest.approx(rough.max(), abs=1e-2)
    assert (drawn["end"][0]["x"], drawn["end"][0]["y"]) == pytest.approx(place[-1, :2, None], abs=1e-3)

    crowds = [[s for s in some if isinstance(s, ActorPoses)][-1].position for some in samples]
    for number, name in enumerate(("ann_actor", "bob_actor")):
        walked = np.array([crowd[number][:2] for crowd in crowds])
        assert np.column_stack([drawn[name][0]["x"], drawn[name][0]["y"]]) == pytest.approx(
            walked, abs=1e-4
        )
    pose, nearest, scan = place[0], [math.inf, math.inf], None
    for some in samples:
        for sample in some:
            pose = np.array(sample.position) if isinstance(sample, Pose) else pose
            if isinstance(sample, ActorPoses):
                gaps = [math.dist(pose[:2], person[:2]) for person in sample.position]
                nearest = [min(pair) for pair in zip(nearest, gaps, strict=True)]
            scan = sample if isinstance(sample, LaserScan) else scan
    met = [
        float(re.findall(r"([\d.]+) m", text)[0])
        for text in drawn["closest to a person"][0]["hovertext"]
    ]
    assert sorted({*met} & {*np.round(nearest, 2)}) == sorted({*np.round(nearest, 2)})
    assert scan is not None
    assert abs(len(drawn["last scan"][0]["x"]) - np.isfinite(scan.ranges).sum()) < 40

    touched = np.diff([end.hazard_contact_s for end in ends], prepend=0.0) > 0.0
    spans = joined([(now - 0.1, now) for now in t[touched].tolist()])
    assert spans, "it meets a post"
    (contacts,) = drawn["contact with a hazard (truth)"]
    assert contacts["text"] == [f"{begin:.1f} to {end:.1f} s" for begin, end in spans]
    assert contacts["x"][0] == pytest.approx(place[touched][0, 0], abs=1e-3)

    assert result.log_path is not None
    rows = list(csv.DictReader(result.log_path.read_text().splitlines()))
    names = [name for name in rows[0] if name not in ("Timestamp", "Notes")]
    stamps = [float(row["Timestamp"]) for row in rows]
    counts = [0, *(int(float(row["Total Collisions"])) for row in rows)]
    counted = [
        (begin, end)
        for begin, end, a, b in zip([0.0, *stamps], stamps, counts, counts[1:], strict=False)
        if b > a
    ]
    assert drawn["collision (metric)"][0]["text"] == [
        f"{a:.1f} to {b:.1f} s" for a, b in joined(counted)
    ]
    shown = {n: figures[f"series-{i}"] for i, n in enumerate(names) if f"series-{i}" in figures}
    assert shown.keys() > TRUTH
    for name, figure in shown.items():
        *before, log = [trace for trace in figure["data"] if trace["name"] != "truth"]
        values = [float(row[name] or "nan") for row in rows]
        assert (log["x"], log["y"]) == (
            pytest.approx(stamps, abs=1e-4),
            [pytest.approx(v, abs=1e-4) if math.isfinite(v) else None for v in values],
        ), name
        bands = [[s["x0"], s["x1"]] for s in figure["layout"]["shapes"] if s["type"] == "rect"]
        assert bands == [pytest.approx(span) for span in spans]
        for edge, of in zip(before, (low, high), strict=False):
            assert (name, edge["y"]) == ("IMU Acceleration Magnitude", pytest.approx(of, abs=1e-4))
    (truth,) = (trace for trace in shown["Distance Traveled"]["data"] if trace["name"] == "truth")
    assert (truth["x"], truth["y"]) == (pytest.approx(t, abs=1e-4), pytest.approx(way, abs=1e-4))
    (truth,) = (trace for trace in shown["Current Velocity"]["data"] if trace["name"] == "truth")
    speeds = np.diff(way) / np.diff(t)
    assert (truth["x"], truth["y"]) == (pytest.approx(t[1:], abs=1e-4), pytest.approx(speeds, abs=1e-3))
