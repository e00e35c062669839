"""Drives golden runs, without ROS and through it, and keeps all that comes out.

The only place here that knows how a run is described and started.
"""

import gc
import json
import weakref
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from shutil import copytree
from typing import Any

import numpy as np
import pytest

from harness.base.interrupt import StopRequest
from harness.cli.options import RunOptions, parse_run
from harness.episode.assembly import actor_names
from harness.episode.batch import Batch
from harness.episode.direct import run_direct
from harness.episode.episode import Episode
from harness.episode.fingerprint import StreamHash
from harness.episode.helm import Helm
from harness.episode.manifest import manifest
from harness.episode.result import Outputs, RunResult
from harness.episode.social_recorder import SocialRecorder
from harness.episode.stream import EpisodeStream
from harness.page.run.recorder import RunRecorder
from harness.physics.simulation import Simulation
from harness.robots import ROVERS
from harness.robots.urdf.folder import write_folder
from harness.sensors.camera import painter
from harness.sensors.camera.painter import CameraPainter
from harness.spec.sensor import SensorChoice
from tests.golden.products import Onlookers
from tests.golden.table import NONE, GoldenRun
from tests.support.documents import ROOT
from tests.support.foreign_rovers import FOREIGN
from tests.support.forked_program import ForkedProgram
from tests.support.forking import ForkServer
from tests.support.waiting import PATIENCE

OF_ONE = "/b/metrics_node:\n  ros__parameters: {collision_threshold: 0.9, gravity: 9.6}\n"
PARAMS = "/**:\n  ros__parameters: {collision_threshold: 0.6, distance_threshold: 0.008, gravity: 9.7}\n"
MODEL = (
    "<model name='{}'><static>1</static><pose>{}</pose><link name='l'><collision name='c'>"
    "<geometry>{}</geometry></collision></link></model>"
)
BOX = "<box><size>{}</size></box>"
SDF = (
    "<sdf version='1.9'><world name='w'><gravity>0 0 -3.72</gravity>"
    + MODEL.format("ground", "0 0 0.2 0 0 0", "<plane><normal>0 0 1</normal><size>18 16</size></plane>")
    + "".join(
        MODEL.format(f"crate{x}", f"{x} {y} 0.5 0 0 0.3", BOX.format("0.6 0.6 1"))
        for x, y in ((4.5, 1), (-2, 3), (1, -3), (-4, -2))
    )
    + MODEL.format("step", "1.2 0.5 0.24 0 0 0.2", BOX.format("0.3 0.8 0.09"))  # for Leo alone a rock
    + MODEL.format("plank7", "-1 -1.5 0.35 0 0 0", BOX.format("0.2 0.2 0.3"))
    + "</world></sdf>"
)

BLACK = np.zeros((480, 640, 3), np.uint8)  # as an image is
CALLED = {"a200": "husky"}  # in the runs: the one of a URDF, which is older than the one that ships


def make_files(folder: Path) -> dict[str, Path]:
    """Writes what the table's words in braces stand for; returns where it is."""
    x, y = np.meshgrid(np.linspace(-7, 7, 71), np.linspace(6, -6, 61))
    np.save(folder / "hills.npy", 0.5 * np.sin(0.6 * x) * np.cos(0.5 * y) + 0.02 * np.sin(9 * x))
    at = np.arange(-700, 701, 100)  # [cm]
    points = [(a, b, 25 * np.sin(a / 150) + 15 * np.cos(b / 200)) for a in at for b in at]
    n, corners = len(at), range(len(at) - 1)
    faces = [
        (n * i + j, n * i + n + j, n * i + n + j + 1, n * i + j + 1) for i in corners for j in corners
    ]
    lines = [f"v {a} {b} {c:.3f}" for a, b, c in points]
    lines += [f"f {a + 1} {b + 1} {c + 1}\nf {a + 1} {c + 1} {d + 1}" for a, b, c, d in faces]
    (folder / "valley.obj").write_text("\n".join(lines) + "\n")
    (folder / "yard.sdf").write_text(SDF)
    np.save(folder / "patches.npy", np.tile(np.arange(401) // 205, (401, 1)).astype(np.uint8))
    (folder / "mixed.yaml").write_text("soils: [dry_sand, firm]\nmap: patches.npy\n")
    (folder / "params.yaml").write_text(PARAMS)
    (folder / "of_one.yaml").write_text(OF_ONE)
    steps = copytree(ROVERS["leo"].folder, folder / "rk4") / "leo.xml"
    steps.write_text(steps.read_text().replace('"implicitfast"', '"RK4"'))
    made_of_urdf = {CALLED.get(name, name): foreign for name, foreign in FOREIGN.items()}
    for name, foreign in made_of_urdf.items():
        (folder / f"{name}.urdf").write_text(foreign.urdf)
        write_folder(name, folder / f"{name}.urdf", folder / name)
    files = {"dem": "hills.npy", "mesh": "valley.obj", "sdf": "yard.sdf", "params": "params.yaml"}
    files |= {"of_one": "of_one.yaml", "rk4": "rk4", "mixed": "mixed.yaml"}
    made = {name: folder / file for name, file in files.items()}
    return (
        made
        | {name: folder / name for name in made_of_urdf}
        | {"policy": ROOT / "examples/point_nav.npz"}
    )


@dataclass(frozen=True, kw_only=True)
class Driven:
    """What one rover of a run has left behind.

    Attributes:
        name: Of the rover in a fleet, else "".
        result: What the run came to.
        manifest: Its JSON, parsed.
        csv: The log's text; `social` is that of the log of people, "" without any.
        stream: Hash of the stream of samples; `samples` is their number.
        recorder: What the page of the run is made from.
        products: Hashes of what else is made of it; of runs without ROS alone.
    """

    name: str
    result: RunResult
    manifest: dict[str, Any]
    csv: str
    social: str
    stream: str
    samples: int
    recorder: RunRecorder
    products: dict[str, str]

    @property
    def lasting(self) -> RunResult:
        """The result as if it had taken a second."""
        return replace(self.result, wall_s=1.0, first_row_s=1.0)


class WithoutSensor(StreamHash):
    """Hashes a stream as if it had no sensor of that name.

    Args:
        sensor: Its name; "" for the whole stream.
    """

    def __init__(self, sensor: str) -> None:
        super().__init__()
        self._sensor = sensor

    def take(self, batch: Batch) -> None:
        """Takes the next batch."""
        if not self._sensor:
            super().take(batch)
            return
        ticks = [
            replace(tick, samples=tuple(s for s in tick.samples if not self._is_left_out(s)))
            for tick in batch.ticks
        ]
        super().take(replace(batch, ticks=tuple(ticks)))

    def _is_left_out(self, sample: object) -> bool:
        return getattr(sample, "sensor", "") == self._sensor


def run_options(run: GoldenRun, files: dict[str, Path], folder: Path) -> RunOptions:
    """Returns what the command line and the plan of a run ask for.

    Args:
        run: A line of the table.
        files: What its words in braces stand for.
        folder: Gets the logs.
    """
    options = parse_run([*run.words(files), "--log-dir", str(folder)])
    assert options is not None
    return replace(options, run=options.run.but(plan=options.run.plan.but(**run.plan)))


def elsewhere(options: RunOptions, folder: Path, sensor: str = "") -> RunOptions:
    """Returns the same run with another folder for its logs; all rovers carry that one more sensor."""
    more = (SensorChoice(sensor),) if sensor else ()
    rovers = tuple(
        rover.but(sensors=(*(rover.sensors or ()), *more) or None) for rover in options.run.rovers
    )
    ros = options.ros.but(log_dir=folder)
    return replace(options, run=options.run.but(rovers=rovers), ros=ros)


def drive_direct(
    options: RunOptions, folder: Path, sensor: str = "", recording: Path | None = None
) -> list[Driven]:
    """Drives a run without ROS; the hash of its stream leaves out that one more sensor.

    With one it is steered by nobody at a rate that is out of its reach, and goes on step by step as
    if it was paused, which is to change nothing.
    Images are not recorded: to draw them takes longer than all else, and is done through ROS.
    """
    options = elsewhere(options, folder, sensor)
    with (
        _outputs(options, sensor, None if sensor else folder) as (outputs, observers),
        pytest.MonkeyPatch.context() as patch,
    ):
        patch.setattr(CameraPainter, "image", lambda *_: None)
        stop, ros = StopRequest(), options.ros.but(record=recording)
        with _no_world_is_kept():
            results = run_direct(
                options.run, outputs, ros, stop, helm=_stepped(stop) if sensor else None
            )
    return [_driven(*each) for each in zip(results, observers, strict=True)]


@contextmanager
def _no_world_is_kept() -> Iterator[None]:
    """Checks that what is simulated is freed as the run ends, without a collection of garbage."""
    worlds, begin = list[weakref.ref[Simulation]](), EpisodeStream.begin

    def begun(stream: EpisodeStream) -> tuple[Episode, ...]:
        episodes = begin(stream)
        worlds.extend(weakref.ref(episode.simulation) for episode in episodes)
        return episodes

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(EpisodeStream, "begin", begun)
        gc.disable()
        try:
            yield
            assert worlds
            assert not any(world() for world in worlds)
        finally:
            gc.enable()


def _stepped(stop: StopRequest) -> Helm:
    helm = Helm(1e4, stop)
    helm.paused, helm.idle = True, helm.step
    return helm


def drive_through_ros(
    run: GoldenRun, options: RunOptions, folder: Path, recording: Path
) -> list[Driven]:
    """Drives a run through ROS 2 and records it; its metrics_node is another process if it says so.

    Images are black but for some worlds, fleets and ruts: starting to draw takes longer than all else.
    """
    from harness.ros.session import run_through_ros  # noqa: PLC0415 - there may be no ROS

    options = elsewhere(options, folder)
    ros = options.ros.but(record=recording)
    with _outputs(options) as (outputs, observers), pytest.MonkeyPatch.context() as patch:
        patch.setattr(painter, "multiprocessing", ForkServer())
        if not run.is_drawn and run.soil == NONE:
            patch.setattr(CameraPainter, "image", lambda *_: BLACK)
        if run.ros != "elsewhere":
            with _no_world_is_kept():
                results = run_through_ros(options.run, outputs, ros, StopRequest())
            return [_driven(*each) for each in zip(results, observers, strict=True)]
        ros = ros.but(host_metrics=False, wait_for=("metrics_node",))
        settings = {**options.settings[0].parameters, "log_dir": str(folder)}
        words = (f"{name}:={json.dumps(value)}" for name, value in settings.items() if value != [])
        node = ["--ros-args", "-p", "use_sim_time:=true", *(w for pair in words for w in ("-p", pair))]
        with ForkedProgram("rover_metrics.metrics_node", node, folder.parent / "node.txt") as program:
            (result,) = run_through_ros(options.run, outputs, ros, StopRequest())
            program.terminate()
            assert program.wait(PATIENCE) == 0, program.said.read_text()
    (log,) = folder.glob("*.csv")
    return [_driven(replace(result, log_path=log), observers[0])]


Observers = tuple[WithoutSensor, RunRecorder, SocialRecorder | None, Onlookers | None]


@contextmanager
def _outputs(
    options: RunOptions, sensor: str = "", states: Path | None = None
) -> Iterator[tuple[list[Outputs], list[Observers]]]:
    """Where the data of each rover go, and who watches them."""
    names = actor_names(options.run.world)
    folders = [options.log_dir(rover) for rover in options.run.rovers]
    people = [SocialRecorder(names, None, folder) if names else None for folder in folders]
    watching: list[Observers] = [
        (
            WithoutSensor(sensor),
            RunRecorder(),
            log,
            None if states is None else Onlookers(options.run, number, states),
        )
        for number, log in enumerate(people)
    ]
    outputs = [
        Outputs(log_dir=folder, observers=tuple(filter(None, observers)), settings=settings)
        for folder, observers, settings in zip(folders, watching, options.settings, strict=True)
    ]
    try:
        yield outputs, watching
    finally:
        for recorder in filter(None, people):
            recorder.close()


def _driven(result: RunResult, observers: Observers) -> Driven:
    stream, recorder, people, onlookers = observers
    assert result.log_path is not None, result.failure
    social = None if people is None else people.path
    return Driven(
        name=result.rover.name,
        result=result,
        manifest=json.loads(json.dumps(manifest(replace(result, social_log=social)))),
        csv=result.log_path.read_text(),
        social="" if social is None else social.read_text(),
        stream=stream.hexdigest(),
        samples=stream.samples,
        recorder=recorder,
        products={} if onlookers is None else onlookers.products(),
    )


def files_below(folder: Path) -> Sequence[str]:
    """Returns the names of all files below a folder."""
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())
