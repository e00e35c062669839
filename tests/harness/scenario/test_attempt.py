"""A run over a scripted episode: what is judged, told and kept of it."""

import json
import math
import re
import signal
import sys
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

from harness import __version__
from harness.base.errors import RunFailed
from harness.base.interrupt import Interrupted, StopRequest
from harness.episode import direct
from harness.episode.episode import Episode
from harness.episode.result import Outputs, RunResult
from harness.episode.social_recorder import SocialRecorder
from harness.samples import ContactEvent, LaserScan
from harness.scenario.attempt import AttemptOptions, attempt
from harness.scenario.baseline import write_baselines
from harness.scenario.case import Case
from harness.scenario.judge import Breach
from harness.scenario.quantities import QUANTITIES
from harness.scenario.series import SAMPLES, TruthSeries
from harness.scenario.verdict import Attempt
from harness.scenario.watch import contact_of
from harness.spec.ros import RosOptions
from harness.spec.run import Run
from rover_metrics.analysis.social.log import read_social_log
from rover_metrics.core.columns import COLUMNS
from tests.harness.scenario.conftest import MakeCases, Scripted

USED = "harness.scenario.attempt.run_direct"
pytestmark = pytest.mark.usefixtures("driven")


def one(make_cases: MakeCases, folder: Path, expect: str, more: str = "") -> Attempt:
    (case,) = make_cases(expect, more)
    return attempt(case, folder)


def test_a_run_that_is_as_expected_leaves_nothing(make_cases: MakeCases, tmp_path: Path) -> None:
    expect = """
  truth.path_length: {over: end, min: 1, max: 1}
  truth.goal_s: {over: end, min: 0.79, max: 0.81}
  truth.tilt_deg: [{max: 30.01}, {min: 29.99, over: end}, {max: 0, window: [0, 1.9]}]
  log.Current Velocity: {min: 0.5, max: 0.5}
  log.Scan Rate [Hz]: {over: end, min: 20, max: 20}
  run.rows: {min: 2, max: 2}
  truth.speed: {over: share, min: 0, share: 1}
  run.lost_messages: {max: 0}"""
    done = one(make_cases, tmp_path / "out", expect, "goal: {at: [1, 0], radius: 0.6}")
    assert done.passed, done
    assert (done.simulated_s, done.model_hash, done.terrain_hash) == (2.0, "model", "terrain")
    length, _, *tilts, speed, share, lost = done.measured[:6] + done.measured[-2:]
    values = [(round(one.value or 0, 6), one.unit) for one in (length, *tilts, share, lost)]
    assert values == [(1.0, "m"), *[(30.0, "deg")] * 2, (0.0, "deg"), (1.0, ""), (0.0, "")]
    assert speed.unit == "m/s"
    assert done.recorded is None
    assert not (tmp_path / "out").exists()


def test_a_run_that_fails_says_what_touched_what_and_leaves_its_evidence(
    make_cases: MakeCases, tmp_path: Path
) -> None:
    far = one(make_cases, tmp_path / "far", "{truth.goal_s: {over: end, max: 9}}", "goal: {at: [9, 9]}")
    assert far.breaches == ("truth.goal_s: the goal was not reached",)
    for _ in range(2):  # the second replaces what the first has left
        if (tmp_path / "out").exists():
            (tmp_path / "out/log_of_earlier.csv").touch()
        expect = "{log.Current Velocity: {min: 0.5}, truth.hazard_contacts: {max: 0}}"
        done = one(make_cases, tmp_path / "out", expect)
    told = "truth.hazard_contacts: 1 > 0, first at 1.05 s: front left wheel against hazard_3"
    assert done.breaches == (told,)
    page, log, manifest = done.kept
    assert {path.parent for path in done.kept} == {tmp_path / "out"}
    assert sorted(page.parent.iterdir()) == sorted(done.kept)
    assert told.partition(":")[0] in page.read_text()
    assert log.read_text().splitlines()[0] == ",".join(COLUMNS)
    assert len(log.read_text().splitlines()) == 3
    assert manifest.name == f"{log.stem}.json"
    outcome = json.loads(manifest.read_text())
    assert outcome["outcome"] == {"status": "failed", "reason": told}
    assert outcome["log"] == str(log)
    unkept = one(make_cases, log / "out", expect)  # a file is no folder
    assert unkept.breaches[0] == told
    assert "could not be kept" in unkept.breaches[1]
    assert (unkept.error, unkept.kept) == (None, ())
    assert one(make_cases, tmp_path / "out", "{truth.hazard_contacts: {max: 1}}").passed
    assert not (tmp_path / "out").exists(), "of a run that passes nothing is left, nor of one before it"


def test_a_run_that_ends_early_is_a_failure_and_what_stops_the_command_is_none(
    make_cases: MakeCases, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (case,) = make_cases("{truth.hazard_contacts: {max: 1}, run.rows: {min: 2}}")
    run, scratch = direct.run_direct, list[Path]()

    def fail(config: Run, outputs: Any, options: RosOptions, *rest: Any) -> tuple[RunResult, ...]:  # noqa: ANN401
        scratch.append(options.log_dir.parent)
        (result,) = run(config, outputs, options, *rest)
        return (replace(result, failure="it fell", info=None),)

    monkeypatch.setattr(USED, fail)
    done = attempt(case, tmp_path / "out", AttemptOptions(scratch=tmp_path))
    assert (done.breaches, done.model_hash, done.terrain_hash) == (("run: it fell",), "", "")
    assert json.loads(done.kept[2].read_text())["outcome"]["reason"] == "it fell"
    attempt(case, tmp_path / "out", AttemptOptions(scratch=tmp_path / "gone"))
    assert scratch == [tmp_path, Path(tempfile.gettempdir())]

    def end_with(error: Exception) -> Attempt:
        monkeypatch.setattr(USED, lambda *_: (_ for _ in ()).throw(error))
        return attempt(case, tmp_path)

    assert end_with(RunFailed("no")) == Attempt(case, error="no")
    with pytest.raises(Interrupted):
        end_with(Interrupted(signal.SIGINT))


def test_without_ros_only_what_needs_it_could_not_run(
    make_cases: MakeCases, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "harness.scenario.trial", None)
    assert one(make_cases, tmp_path, "{truth.path_length: {max: 1}}").passed
    for expect, more in (("{topic./scan.rate: {min: 1}}", ""), ("{truth.x: {min: 0}}", "launch: [ls]")):
        told = str(one(make_cases, tmp_path, expect, more).error)
        assert re.fullmatch(r"nodes and topics need ROS 2, .* a ROS 2 installation", told)


EVENTS = tuple(
    ContactEvent(kind, round(start * 1e9), round(end * 1e9), part, other, 1.0, (0.0, 0.0, 0.0))  # type: ignore[arg-type]
    for kind, start, end, part, other in (
        ("hazard", 1.0, 1.2, "wheel_RL", "post_1"),
        ("rock", 1.9, 2.1, "wheel_R", "rock_1"),
        ("hazard", 2.0, 2.4, "chassis", "post_2"),
        ("hazard", 5.0, 5.1, "wheel_FR", "post_3"),
    )
)


@pytest.mark.parametrize(
    ("name", "time_s", "told"),
    [
        ("truth.hazard_contacts", 1.05, ": rear left wheel against post_1"),
        ("truth.hazard_contacts", 2.05, ": chassis against post_2"),
        ("truth.contact_force", 2.3, ": chassis against post_2"),
        ("truth.rock_contacts", 2.0, ": right wheel against rock_1"),
        ("truth.hazard_contacts", 9.0, ""),
        ("truth.hazard_contacts", None, ""),
        ("truth.speed", 1.05, ""),
        ("log.Slip", 1.05, ""),
    ],
)
def test_the_contact_of_a_breach_is_that_of_its_time_and_kind(
    name: str, time_s: float | None, told: str
) -> None:
    assert contact_of(name, Breach("", time_s), EVENTS) == told


def test_a_baseline_is_kept_until_something_differs(make_cases: MakeCases, tmp_path: Path) -> None:
    expect = """
  truth.path_length: [{over: end, relative: 0.1}, {over: mean, absolute: 1, window: [1, 2]}]
  truth.hazard_contacts: {max: 1}"""
    (case,) = make_cases(expect, "same_bytes: true")
    path, out = tmp_path / "two.baseline.json", tmp_path / "out"
    assert "there is no baseline of it" in str(attempt(case, out).error)
    done = attempt(case, out, AttemptOptions(compare=False))
    assert done.recorded is not None
    assert write_baselines([(case, done.recorded)]) == [path]
    recorded = json.loads(path.read_text())["two[0]"]
    versions = {"rover-harness": __version__, "mujoco": mujoco.__version__}
    of_run = {"model": "model", "terrain's hash": "terrain", "terrain": "flat", "duration": 2.0}
    assert recorded["of"] == versions | of_run
    mean = pytest.approx(0.75)
    assert recorded["values"] == {"truth.path_length end": 1.0, "truth.path_length mean 1-2 s": mean}
    assert len(recorded["log"]) == 4  # the end of the last line is one more
    elsewhere = replace(case, run=case.run.alone(terrain="elsewhere/flat"))
    assert attempt(case, out).passed
    assert attempt(elsewhere, out).passed

    def changed(case: Case = case, **values: object) -> Attempt:
        path.write_text(json.dumps({"two[0]": recorded | values}))
        return attempt(case, out)

    other = [*recorded["log"][:2], recorded["log"][2].replace(",", ",9", 1), ""]
    shorter = recorded["values"] | {"truth.path_length end": 0.8}
    told = ("truth.path_length: at the end 1 m, baseline 0.8 m, allowed +- 0.08 m",)
    assert changed(values=shorter).breaches == told
    assert changed(log=other).breaches[0].startswith("same_bytes: row 2: ")
    longer = changed(of=recorded["of"] | {"duration": 9.0})
    assert str(longer.error).startswith("the baseline is of duration 9.0, this run of 2.0; ")
    other_params = changed(replace(case, params={"collision_threshold": 5.0}))
    assert "the default, this run of {'collision_threshold'" in str(other_params.error)
    for text in ("[", "[]"):
        path.write_text(text)
        assert str(path) in str(attempt(case, out).error)


def test_the_truth_that_is_judged_is_that_of_the_simulator(
    make_cases: MakeCases, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.undo()  # the scripted episode
    end = "{over: end, max: 9}"
    expect = f"{{truth.x: {end}, truth.z: {end}, truth.tilt_deg: {end}}}"
    (case,) = make_cases(expect, "driver: straight")
    episode = Episode(case.run.alone(terrain="slope"))
    assert all(True for _ in episode.batches())
    x, _, z = episode.simulation.position
    tilt = math.degrees(math.acos(episode.simulation.data.xmat[1].reshape(3, 3)[2, 2]))
    done = attempt(replace(case, run=episode.run), tmp_path / "out")
    assert [one.value for one in done.measured] == pytest.approx([x, z, tilt], abs=0.02)


@pytest.mark.parametrize(
    ("expect", "more", "wanted", "drives"),
    [  # what was wanted by whoever drove last: None is everything, for a log
        ("truth.hazard_contacts: {max: 1}", "driver: wander", SAMPLES | {LaserScan}, 1),
        ("truth.hazard_contacts: {max: 1}", "driver: straight", SAMPLES, 1),
        ("truth.hazard_contacts: {max: 0}", "", None, 2),  # for its evidence
        ("truth.hazard_contacts: {max: 0}", "expected_to_fail: [{reason: so}]", None, 1),
        ("truth.hazard_contacts: {max: 1}, run.rows: {max: 2}", "", None, 1),
        ("truth.hazard_contacts: {max: 1}", "same_bytes: true", None, 1),
    ],
)
def test_only_what_the_truth_cannot_say_takes_a_log_and_every_sensor(
    expect: str,
    more: str,
    wanted: object,
    drives: int,
    make_cases: MakeCases,
    tmp_path: Path,
    driven: list[Run],
) -> None:
    (case,) = make_cases(f"{{{expect}}}", more)
    attempt(case, tmp_path, AttemptOptions(compare=False))
    assert (Scripted.wanted, len(driven)) == (wanted, drives)


def test_the_truth_is_the_same_without_the_other_sensors(
    make_cases: MakeCases, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.undo()  # the scripted episode
    (case,) = make_cases("{truth.speed: {max: 9}}", "driver: wander\nnoise: white\nlidar_beams: 90")
    config = case.run.alone(terrain="rocky", duration=1.0, actors=("a=2,0/2,3:speed=1.5", "b=9,9/9,8"))
    full, alone, stop = TruthSeries(QUANTITIES), TruthSeries(QUANTITIES), StopRequest()
    social = SocialRecorder(("a", "b"), tmp_path / "social.csv", tmp_path)
    outputs = Outputs(log_dir=tmp_path, observers=(full, social))
    (first,) = direct.run_direct(config, (outputs,), RosOptions(log_dir=tmp_path), stop)
    social.close()
    second = direct.run_unlogged(config, stop, SAMPLES, (alone,))
    assert (second.truth, second.along) == (first.truth, first.along)
    pairs = zip(full.series().values(), alone.series().values(), strict=True)
    assert all(np.array_equal(a.values, b.values, equal_nan=True) for a, b in pairs)
    nearest = read_social_log(tmp_path / "social.csv").distance.min(axis=1)
    least = alone.series()["truth.person_distance"].values[-1]  # of the last 50 ms
    assert least <= nearest[0] + 0.005
    assert least == pytest.approx(nearest[0], abs=0.05 * 2.0)
