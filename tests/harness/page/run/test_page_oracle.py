"""The figures of a run's page, recomputed from its batches and its log."""

import csv
import json
import math
import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from harness.base.interrupt import StopRequest
from harness.episode.assembly import world_of
from harness.episode.batch import Batch
from harness.episode.direct import run_direct
from harness.episode.result import Outputs
from harness.page.run.content import render
from harness.page.run.recorder import RunRecorder
from harness.robots import RoverSpec, find_rover
from harness.run import main
from harness.samples import ActorPoses, Imu, LaserScan, Pose, Sample
from harness.spec.ros import RosOptions
from harness.spec.run import Run
from harness.world.obstacles import ObstacleKind
from tests.support.pages import without_plotly

PEOPLE = ("ann=4,0.7/-2,0.7", "bob=3,-3/3,3:speed=0.5")
Spans = list[tuple[float, float]]


@dataclass
class Seen:
    """A run by its tenths of a second, its log, and the figures of its page.

    Attributes:
        felt: Least and largest |a| of each tenth [m/s^2].
        touched: Whether a hazard was touched in it.
    """

    samples: list[list[Sample]]
    times: NDArray[np.float64]
    place: NDArray[np.float64]
    way: NDArray[np.float64]
    felt: tuple[NDArray[np.float64], NDArray[np.float64]]
    touched: NDArray[np.bool_]
    rows: list[dict[str, str]]
    figures: dict[str, Any]

    @property
    def contacts(self) -> Spans:
        return joined((now - 0.1, now) for now in self.times[self.touched].tolist())


def joined(spans: Iterable[tuple[float, float]]) -> Spans:
    """Spans [s] of which those less than half a second apart are one."""
    whole: Spans = []
    for begin, end in spans:
        goes_on = bool(whole) and begin - whole[-1][1] <= 0.5
        whole.append((whole.pop()[0] if goes_on else begin, end))
    return whole


@pytest.fixture(scope="module")
def seen(tmp_path_factory: pytest.TempPathFactory) -> Seen:
    """A drive against the nearest post, past two people."""
    posts = [o for o in world_of(Run.of(terrain="posts")).obstacles if o.kind is ObstacleKind.HAZARD]
    x, y, _ = min((post.position for post in posts), key=lambda place: math.hypot(*place[:2]))
    run = Run.of(terrain="posts", driver="straight", duration=12.0, actors=PEOPLE,
                 start=(0.0, 0.0, round(math.atan2(y, x), 3)))  # fmt: skip
    folder, batches, recorder = tmp_path_factory.mktemp("page"), list[Batch](), RunRecorder()

    class Kept:
        def take(self, batch: Batch) -> None:
            batches.append(batch)

    outputs = [Outputs(log_dir=folder, observers=(recorder, Kept()))]
    (result,) = run_direct(run, outputs, RosOptions(log_dir=folder), StopRequest())
    (figures,) = re.findall(r'id="figures">(.*?)</script>', without_plotly(render(result, recorder)))
    assert result.log_path is not None
    rows = list(csv.DictReader(result.log_path.read_text().splitlines()))
    pairs = [batches[n : n + 2] for n in range(0, len(batches), 2)]
    samples = [[s for one in pair for tick in one.ticks for s in tick.samples] for pair in pairs]
    sizes = [
        [np.linalg.norm(s.linear_acceleration) for s in some if isinstance(s, Imu)] for some in samples
    ]
    times, place, way, contact = (
        np.array([getattr(pair[-1].truth, name) for pair in pairs])
        for name in ("time_ns", "position", "path_length", "hazard_contact_s")
    )
    felt = np.array([min(some) for some in sizes]), np.array([max(some) for some in sizes])
    touched = np.diff(contact, prepend=0.0) > 0.0
    return Seen(samples, times / 1e9, place, way, felt, touched, rows, json.loads(figures))


def test_the_map_is_that_of_the_batches(seen: Seen) -> None:
    traces = seen.figures["map"]["data"]
    drawn = {one["name"]: [other for other in traces if other["name"] == one["name"]] for one in traces}
    place, (low, high) = seen.place, seen.felt
    line, marks = drawn["path"]
    assert np.column_stack([line["x"], line["y"]]) == pytest.approx(place[:, :2], abs=1e-4)
    rough = np.maximum(high - 9.8, 9.8 - low)
    told = np.array(sorted(marks["customdata"]))
    assert told == pytest.approx(np.column_stack([seen.times, rough, place[:, 2]]), abs=1e-3)
    assert marks["marker"]["color"] == pytest.approx(np.sort(rough), abs=1e-3)
    (end,) = drawn["end"]
    assert [*end["x"], *end["y"]] == pytest.approx(place[-1, :2], abs=1e-3)

    pose, nearest, ways = place[0], [math.inf] * 2, list[Any]()
    for some in seen.samples:
        for sample in some:
            pose = np.array(sample.position) if isinstance(sample, Pose) else pose
            if isinstance(sample, ActorPoses):
                crowd = np.array(sample.position)[:, :2]
                nearest = np.minimum(nearest, np.hypot(*(crowd - pose[:2]).T)).tolist()
        ways.append(crowd)
    for number, name in enumerate(("ann_actor", "bob_actor")):
        way = np.column_stack([drawn[name][0]["x"], drawn[name][0]["y"]])
        assert way == pytest.approx(np.array(ways)[:, number], abs=1e-4)
    (closest,) = drawn["closest to a person"]
    assert {*np.round(nearest, 2)} <= {float(text.split()[2]) for text in closest["hovertext"]}

    scan = next(s for s in reversed(seen.samples[-1]) if isinstance(s, LaserScan))
    assert len(drawn["last scan"][0]["x"]) == pytest.approx(np.isfinite(scan.ranges).sum(), abs=40)
    (touches,) = drawn["contact with a hazard (truth)"]
    assert touches["text"] == [f"{begin:.1f} to {end:.1f} s" for begin, end in seen.contacts]
    assert touches["x"][0] == pytest.approx(place[seen.touched][0, 0], abs=1e-3)
    stamps = [0.0, *(float(row["Timestamp"]) for row in seen.rows)]
    risen = np.diff([0.0, *(float(row["Total Collisions"]) for row in seen.rows)]) > 0.0
    counted = joined((stamps[n], stamps[n + 1]) for n in np.flatnonzero(risen).tolist())
    assert drawn["collision (metric)"][0]["text"] == [f"{a:.1f} to {b:.1f} s" for a, b in counted]


def test_each_series_is_that_of_the_log_beside_the_batches(seen: Seen) -> None:
    names = [name for name in seen.rows[0] if name not in ("Timestamp", "Notes")]
    stamps, times, way = [float(row["Timestamp"]) for row in seen.rows], seen.times, seen.way
    beside = {
        "Distance Traveled": [(times, way)],
        "Current Velocity": [(times[1:], np.diff(way) / np.diff(times))],
        "IMU Acceleration Magnitude": [(times, edge) for edge in seen.felt],
    }
    shown = {
        n: seen.figures[f"series-{i}"] for i, n in enumerate(names) if f"series-{i}" in seen.figures
    }
    assert shown.keys() > beside.keys()
    for name, figure in shown.items():
        (log,) = (trace for trace in figure["data"] if trace["name"] == "log")
        values = np.array([float(row[name] or "nan") for row in seen.rows])
        assert log["x"] == pytest.approx(stamps, abs=1e-4)
        drawn, values = np.array(log["y"], float), np.where(np.isfinite(values), values, np.nan)
        assert drawn == pytest.approx(values, abs=1e-4, nan_ok=True), name
        others = [trace for trace in figure["data"] if trace["name"] != "log"]
        for (x, y), other in zip(beside.get(name, []), others, strict=True):
            assert other["x"] == pytest.approx(x, abs=1e-4), name
            assert other["y"] == pytest.approx(y, abs=1e-3), name
        bands = [(s["x0"], s["x1"]) for s in figure["layout"]["shapes"] if s["type"] == "rect"]
        assert np.array(bands) == pytest.approx(np.array(seen.contacts))


def test_pages_of_a_fleet_show_each_rovers_own_scan_ruts_and_wheels(
    tmp_path: Path, foreign: Callable[[str], RoverSpec]
) -> None:
    six = foreign("sojourner")  # whose lidar looks ahead; Leo's looks back
    two = ["--rover", "leo:a", "--rover", f"{six.folder}:b,x=-1.5,y=1,yaw=2"]
    words = ["--terrain", "posts", "--driver", "straight", "--soil", "firm", "--duration", "1"]
    assert main([*two, *words, "--direct", "--page", "--log-dir", str(tmp_path)]) == 0
    things = [
        (*post.position[:2], math.hypot(*post.half_size[:2]))
        for post in world_of(Run.of(terrain="posts")).obstacles
    ]
    for name, other, rover in (("a", "b", find_rover("leo")), ("b", "a", six)):
        (page,) = (tmp_path / name).glob("*.html")
        (text,) = re.findall(r'id="figures">(.*?)</script>', without_plotly(page.read_text()))
        figures = json.loads(text)
        drawn = {one["name"]: np.array([one["x"], one["y"]], float) for one in figures["map"]["data"]}
        x, y, reach = np.array([*things, (*drawn[other][:, -1], 0.6)]).T[..., None]
        beyond = np.hypot(drawn["last scan"][0] - x, drawn["last scan"][1] - y) - reach
        assert beyond.shape[1] > 30
        assert beyond.min(axis=0).max() < 0.05
        hubs = drawn["ruts (truth)"] - drawn["end"][:, -1:]
        assert np.hypot(*hubs).max() < rover.reach + 0.6
        assert tuple(curve["name"] for curve in figures["soil-0"]["data"]) == rover.wheel_names
