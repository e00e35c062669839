"""A recording on the page: what is shown at a time is what was there at that time."""

from pathlib import Path

import numpy as np
import pytest

from harness.base.interrupt import StopRequest
from harness.episode.batch import Batch
from harness.episode.direct import run_direct
from harness.episode.helm import Helm
from harness.episode.manifest import write_manifest
from harness.episode.result import Outputs
from harness.play import main
from harness.samples import Truth
from harness.spec.fleet import parse_rovers
from harness.spec.ros import RosOptions
from harness.spec.run import Run
from harness.view.live.recording import Player, manifests_near, read_tracks, run_of
from harness.view.live.watch import MOST_POINTS, Sight, Watch
from harness.view.states import PERIOD_NS

SECOND = 1_000_000_000


class Kept:
    """What a watch has seen at two times."""

    def __init__(self) -> None:
        self.watch, self.at = Watch(), dict[int, tuple[object, ...]]()

    def take(self, batch: Batch) -> None:
        self.watch.take(batch)
        if batch.truth.time_ns in (SECOND, 2 * SECOND):
            seen = self.watch
            self.at[batch.truth.time_ns] = seen.sight, seen.ranges, seen.people


@pytest.mark.parametrize(
    "fleet", [(), ("leo:a", "rover_zero4wd:b,x=3,y=3"), ("leo:a",)], ids=["one", "two", "below"]
)
def test_at_a_time_a_recording_shows_what_was_seen_then(tmp_path: Path, fleet: tuple[str, ...]) -> None:
    run = Run.of(terrain="posts", duration=3.0, lidar_beams=36, actors=["anna=2,2/4,2", "ben=-2,2/-4,3"])
    run = run.but(rovers=parse_rovers(fleet, run.rover)) if fleet else run
    file, kept = tmp_path / "run.mcap", [Kept() for _ in run.rovers]
    options = RosOptions(log_dir=tmp_path, record=file)
    outputs = [
        Outputs(log_dir=tmp_path / rover.name, observers=(one,))
        for rover, one in zip(run.rovers, kept, strict=True)
    ]
    for result in reversed(run_direct(run, outputs, options, StopRequest())):  # the last is the first
        assert result.log_path is not None
        write_manifest(result, result.log_path.with_suffix(".json"))
    again = run_of(file, (), near := manifests_near(tmp_path))
    assert again == run
    given = [each.with_suffix(".given") for each in near]
    for found, each in zip(near, given, strict=True):
        each.write_text(found.read_text().replace('"seed": 0,', '"seed": 7,'))
    assert run_of(file, given, near) == run.but(seed=7)
    if len(fleet) == 1:  # as one without a name that has driven in a namespace
        again = again.but(rovers=(again.rover.but(name=""),))
    for track, one in zip(read_tracks(file, again), kept, strict=True):
        for at, (sight, ranges, people) in one.at.items():
            watch = Watch()
            track.show(watch, at)
            assert (watch.sight, watch.time_s) == (sight, at / SECOND)
            assert np.array_equal(np.asarray(watch.ranges), np.asarray(ranges))
            assert watch.people == pytest.approx(people)
            assert len(watch.path) <= at / PERIOD_NS + 2  # of the drive up to then
        assert watch.path[0] == pytest.approx(one.watch.path[0], abs=0.02)


def test_a_path_of_any_length_is_shown_whole_and_evenly() -> None:
    watch = Watch()
    for n in range(15_000):
        watch.see(Sight((0.06 * n, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0), ()), Truth(n), None)
    x = np.array(watch.path)[:, 0]
    assert len(x) <= MOST_POINTS
    assert np.diff(x).max() < 1.5 * np.diff(x).min()
    assert (x[0], x[-1]) == pytest.approx((0.0, 900.0), abs=0.5)


def test_a_recording_stands_at_its_end_and_goes_on_step_by_step() -> None:
    helm, player = Helm(2.0, StopRequest()), Player(SECOND)
    for _ in range(12):
        player.go_on(helm)
    assert player.time_ns == SECOND
    player.seek(0.5)
    helm.paused = True
    helm.step()
    for _ in range(2):
        player.go_on(helm)
    assert player.time_ns == SECOND * 0.55
    helm.paused, helm.rate, hour = False, None, Player(3600 * SECOND)  # as fast as it can
    for _ in range(30):
        hour.go_on(helm)
    assert hour.time_ns == hour.end_ns


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ((), "no manifest of its run is near"),
        (("--live", "x y"), "give HOST, PORT"),
        (("--manifest", "none.json"), "none.json cannot be read"),
        (("--manifest", "other.json"), "other.json is no manifest"),
    ],
)
def test_a_mistake_is_one_line(
    words: tuple[str, ...], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([str(tmp_path / "gone.mcap")]) == 2
    assert "gone.mcap does not exist" in capsys.readouterr().err
    (tmp_path / "run.mcap").touch()
    (tmp_path / "other.json").write_text('{"recording": 5}')
    words = tuple(str(tmp_path / word) if word.endswith(".json") else word for word in words)
    assert main([str(tmp_path / "run.mcap"), *words]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert said in line
