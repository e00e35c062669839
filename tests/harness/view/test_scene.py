"""What a picture shows of a run, and from where."""

import math
from contextlib import ExitStack, closing, nullcontext
from dataclasses import replace
from pathlib import Path
from unittest.mock import MagicMock, Mock

import mujoco
import numpy as np
import pytest

from harness.episode.assembly import fleet, world_of
from harness.episode.episode import Episode, episodes_of
from harness.episode.together import Together
from harness.physics.scene import build_scene
from harness.physics.world_geoms import TERRAIN
from harness.samples import LaserScan
from harness.spec.fleet import parse_rovers
from harness.spec.run import Run
from harness.view import picture
from harness.view.camera import View, best_view, chase_view
from harness.view.caption import captioned
from harness.view.ground import drawn
from harness.view.marks import HIT_COLOR, PATH_COLOR, TRACK_COLOR, beam_marks, path_marks, track_marks
from harness.view.states import States, StateWriter, read_states
from harness.world.heightfield import Heightfield
from harness.world.world import build_world
from tests.harness.view.recorded import CONFIG, recorded
from tests.support.rovers import LEO, ROVER_ZERO4WD


@pytest.fixture(scope="module")
def states(tmp_path_factory: pytest.TempPathFactory) -> States:
    return recorded(tmp_path_factory.mktemp("view") / "states")


def test_best_view_shows_the_path_and_stands_over_the_ground(states: States) -> None:
    world = world_of(CONFIG)
    episode = Episode(CONFIG)
    model = build_scene(world, LEO, 0.0025).model
    for others in (None, np.array([[1.5, 3.0, 0.0]]), np.array([[1.5, -3.0, 0.0]])):
        view = best_view(model, episode.simulation.data, states.path, states.yaw[-1], 0.7, others)
        assert view.sees(states.path if others is None else others, 0.7).all()
        assert view.eye[2] > world.ground.height_at(*view.eye[:2])


def test_chase_view_looks_where_the_rover_heads_from_above() -> None:
    view = chase_view(np.zeros(3), 0.0)
    assert view.direction[0] > 0.7
    assert view.direction[2] == pytest.approx(-math.sin(math.radians(24.0)))
    assert view.eye[0] < 0.0 < view.eye[2]
    aside, above = (chase_view(np.zeros(3), np.pi / 2, camera=camera).eye for camera in ("side", "top"))
    assert np.argmax(np.abs(aside)) == 0
    assert aside[0] < 0.0, "its left, as it heads to +y"
    assert above[2] > 10.0 * np.hypot(*above[:2])


@pytest.mark.parametrize("wall", [0.0, 1.0])
def test_the_view_is_from_the_front_unless_something_stands_there(wall: float) -> None:
    """The rover heads to +y, where a wall of 2 m may stand before the camera."""
    box = f'<geom type="box" pos="0 {1.2 + 20 * (1 - wall)} 1" size="10 .1 1"/>'
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><worldbody><geom type="plane" size="50 50 1"/>{box}</worldbody></mujoco>'
    )
    mujoco.mj_forward(model, data := mujoco.MjData(model))
    eye = best_view(model, data, np.zeros((1, 3)), np.pi / 2, 0.7).eye
    assert (eye[1] > 1.2) == (not wall)


def test_the_path_lies_on_the_ground_and_grows_with_time_between_the_tracks(states: States) -> None:
    ground = world_of(CONFIG).ground
    marks = path_marks(states, ground)
    assert len(marks) > 5
    for mark in marks:
        assert abs(mark.position[2] - ground.height_at(*mark.position[:2])) < 0.02
    slope = Heightfield(0.3 * X - 0.2 * Y, CELL)
    turns = np.linspace(0.0, 16.0, 800)  # 48 m on a circle of 3 m to the left, about the origin
    around = np.column_stack([3.0 * np.sin(turns), -3.0 * np.cos(turns), 0 * turns])
    facing = np.column_stack([np.cos(turns / 2), 0 * turns, 0 * turns, np.sin(turns / 2)])
    circle = replace(states, times=turns, path=around, orientations=facing)
    for mark in path_marks(circle, slope):  # each piece is there once it was driven
        assert mark.end is not None
        assert mark.end[:2] == pytest.approx(
            3.0 * np.array([math.sin(mark.since), -math.cos(mark.since)]), abs=0.01
        )
    marks = track_marks(circle, slope, LEO)
    for mark in marks:  # each lies flat on it
        x, y, z = mark.position + 0.1 * mark.frame[:, 0]
        assert z == pytest.approx(slope.height_at(x, y))
    since = [mark.since for mark in marks]
    assert (since[0], since[-1]) == pytest.approx((8.0 / 3.0, 16.0), abs=0.1)  # of the last 40 m
    inner, outer = (np.array([mark.position[:2] for mark in marks[side::2]]) for side in (0, 1))
    assert np.linalg.norm(inner, axis=1) == pytest.approx(3.0 - LEO.track / 2, abs=0.01)
    assert np.linalg.norm(outer, axis=1) == pytest.approx(3.0 + LEO.track / 2, abs=0.01)


def test_all_of_a_scene_stands_where_it_stood_in_the_simulation(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By MuJoCo's own state, of two rovers and two people, at each state that ends a control period."""
    run = Run.of(terrain="rocky", driver="straight", duration=1.0, actors=["a=2,2/4,2", "b=-2,2/-4,3"])
    one, other = parse_rovers(("leo:a", "rover_zero4wd:b,x=3,y=3,yaw=2.5"), run.rover)
    run = fleet(run, (one, other.but(lidar_beams=500)))
    episodes, files = episodes_of(run), [tmp_path / "a", tmp_path / "b"]
    data, there = episodes[0].simulation.data, dict[int, tuple[np.ndarray, ...]]()
    with ExitStack() as at_end:
        writers = [at_end.enter_context(closing(StateWriter(f, run, n))) for n, f in enumerate(files)]
        for batches in Together(episodes).batches():
            for writer, batch in zip(writers, batches, strict=True):
                writer.take(batch)
            stamp_ns, scans = batches[0].ticks[-1].stamp_ns, [b.ticks[-1].of(LaserScan) for b in batches]
            there[stamp_ns] = data.qpos.copy(), data.mocap_pos.copy(), data.mocap_quat.copy()
    monkeypatch.setattr(mujoco, "Renderer", MagicMock())
    monkeypatch.setattr(picture, "add_marks", marked := Mock())
    with picture.Studio(files, picture.VIDEO_QUALITY, lidar=True) as studio:
        placed = mujoco.MjData(studio.model)
        for index in range(4, 25, 5):
            state = there[round(1e9 * studio.recording.times[index])]
            placed.qpos[:], placed.mocap_pos[:], placed.mocap_quat[:] = state
            mujoco.mj_forward(studio.model, placed)
            studio.pose(index)
            assert studio.data.xpos == pytest.approx(placed.xpos, abs=1e-6)
            assert studio.data.xmat == pytest.approx(placed.xmat, abs=1e-6)
        studio.image(24, chase_view(np.zeros(3), 0.0))
    marks = [mark for mark in marked.call_args.args[1] if mark.color == PATH_COLOR]
    hits = [mark.position for mark in marked.call_args.args[1] if mark.color == HIT_COLOR]
    sites = [studio.data.site(name).xpos for name in ("lidar", "/b/lidar")]
    ranges = [scan.ranges[np.isfinite(scan.ranges)] for scan in scans if scan is not None]
    origins = np.repeat(sites, [*map(len, ranges)], axis=0)
    assert np.linalg.norm(hits - origins, axis=1) == pytest.approx(np.concatenate(ranges), abs=1e-6)
    tracks = [mark for mark in marked.call_args.args[1] if mark.color == TRACK_COLOR]
    assert {mark.size[1] for mark in tracks} == {0.5 * each.wheel_width for each in (LEO, ROVER_ZERO4WD)}
    for file in files:  # the path of each lies where it has been
        x, y, _ = read_states(file).path[-1]
        assert min(math.dist(mark.end[:2], (x, y)) for mark in marks) < 0.1


def driven(folder: Path, run: Run) -> list[Path]:
    """Drives a fleet; returns where the states of each rover are."""
    episodes = episodes_of(run)
    files = [folder / f"{episode.number}.states" for episode in episodes]
    with ExitStack() as at_end:
        writers = [at_end.enter_context(closing(StateWriter(f, run, n))) for n, f in enumerate(files)]
        for batches in Together(episodes).batches():
            for writer, batch in zip(writers, batches, strict=True):
                writer.take(batch)
    return files


@pytest.mark.parametrize(
    ("resets", "keep", "is_whole"), [((), False, True), ((1.6,), True, True), ((1.6,), False, False)]
)
def test_the_end_of_a_run_is_drawn_with_the_ruts_of_all_of_it_or_since_the_last_reset(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    resets: tuple[float, ...],
    keep: bool,
    is_whole: bool,
) -> None:
    """By the heights that OpenGL is given where the rover has come from."""
    words = {"terrain": "flat", "soil": "dry_sand", "driver": "straight", "start": (1.0, 0.0, 0.0)}
    run = Run.of(**words, duration=2.0, resets=resets, keep_ruts=keep)
    run = fleet(run, parse_rovers(("leo:a", "leo:b,x=1,y=1.5"), run.rover))
    files, given = driven(tmp_path, run), Mock()
    end = read_states(files[0])
    monkeypatch.setattr(mujoco, "Renderer", Mock(return_value=given))
    monkeypatch.setattr(mujoco, "mjr_uploadHField", Mock())
    given.scene = mujoco.MjvScene(mujoco.MjModel.from_xml_string("<mujoco/>"), 100)
    with picture.Studio(files, picture.VIDEO_QUALITY, lidar=False) as studio:
        heights, view = studio.model.hfield_data, chase_view(end.path[-1], 0.0)
        studio.image(0, view)
        assert given.scene.ngeom <= 2  # of the paths nothing but what is driven
        before, terrain = heights.copy(), studio.model.geom(TERRAIN)
        studio.image(-1, view)
        assert given.scene.ngeom > 10
        _, _, relief, _ = studio.model.hfield_size[terrain.dataid[0]]
        assert terrain.pos[2] + relief * np.median(before) == pytest.approx(0.0, abs=1e-3)
        columns = int(studio.model.hfield_ncol[studio.model.geom("ruts").dataid[0]])
    pressed = np.flatnonzero(heights < before - 1e-6)
    assert len(pressed) > 50
    assert np.ptp(pressed // columns) * 0.025 > 1.5  # [m] across: of both rovers
    along = np.ptp(pressed % columns) * 0.025  # [m] of which axles and tyres are 0.45
    assert along > 0.7 if is_whole else along < 0.6


def test_each_frame_of_a_video_looks_from_behind_at_where_the_rover_is_then(
    tmp_path: Path, states: States, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("av", reason="the extra [video] is not installed")
    turns = np.linspace(2.0, 3.5, 50)
    place = 20.0 * np.column_stack([np.sin(turns), -np.cos(turns), 0 * turns])
    facing = np.column_stack([np.cos(turns / 2), 0 * turns, 0 * turns, np.sin(turns / 2)])
    arc, frames = replace(states, path=place, orientations=facing), list[tuple[int, View]]()
    arc = replace(arc, times=np.linspace(0.0, 1.96, 50))
    monkeypatch.setattr(picture, "captioned", said := Mock(return_value=FRAME))

    class Kept(nullcontext[None]):
        def __init__(self, *_: object, **__: object) -> None:
            self.recording, self.scale = arc, 1.0

        def __enter__(self) -> "Kept":  # type: ignore[override] # itself
            return self

        def image(self, index: int, view: View) -> np.ndarray:
            frames.append((index, view))
            return FRAME

    monkeypatch.setattr(picture, "Studio", Kept)
    monkeypatch.setattr(picture, "MOST_FRAMES", 10)
    picture.draw(["states"], {"--video": str(tmp_path / "a.mp4")}, "", lidar=False)
    assert [index for index, _ in frames] == [*range(0, 50, 5)]
    told = [(arc.times[index], arc.speed[index], 5) for index, _ in frames]
    assert [call.args[1:] for call in said.call_args_list] == told
    for index, view in frames:
        assert math.dist(view.target, place[index]) < 1.0
        assert view.direction[:2] @ (np.cos(turns[index]), np.sin(turns[index])) > 0.5


def test_every_hit_is_shown_and_of_many_beams_few_lines() -> None:
    few = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0]])
    hit, beam = beam_marks(np.zeros(3), few, np.array([2.0, np.inf, -np.inf], np.float32))
    assert (tuple(hit.position), tuple(beam.position)) == ((2.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    assert beam.end is not None
    assert tuple(beam.end) == (2.0, 0.0, 0.0)
    angles = np.linspace(-np.pi, np.pi, 640, endpoint=False)
    directions = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(640)])
    ranges = np.full(640, 3.0, np.float32)
    marks = beam_marks(np.zeros(3), directions, ranges)
    ends = np.array([mark.end for mark in marks if mark.end is not None])
    assert len(marks) - len(ends) == 640
    assert 36 <= len(ends) <= 72
    bearings = np.arctan2(ends[:, 1], ends[:, 0])
    np.testing.assert_allclose(np.diff(bearings), np.diff(bearings)[0], atol=1e-6)  # evenly spread


CELL = 0.2
X, Y = np.meshgrid(np.arange(-60, 61) * CELL, np.arange(-50, 51) * CELL)
RADIUS = 6.0


def crater(cell: float = CELL) -> Heightfield:
    """A rim 3 m high: round, but its vertices are not."""
    r = np.hypot(X, Y) / CELL * cell
    return Heightfield(np.where(r < RADIUS, 3 * (r / RADIUS) ** 4, 3 * np.exp((RADIUS - r) / 0.6)), cell)


def rim(ground: Heightfield) -> np.ndarray:
    angles = np.linspace(0.0, 2 * np.pi, 2000)
    points = zip(RADIUS * np.cos(angles), RADIUS * np.sin(angles), strict=True)
    return np.array([ground.height_at(x, y) for x, y in points])


def test_a_sharp_crest_loses_its_teeth_and_all_else_is_where_it_was(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    ground, shown = crater(), drawn(crater())
    raw, smooth = rim(ground), rim(shown)
    assert np.ptp(raw) > 0.4
    assert np.ptp(smooth) < 0.25 * np.ptp(raw)
    assert smooth.mean() == pytest.approx(raw.mean(), abs=0.3)
    assert (shown.cell, *shown.half_size) == pytest.approx((CELL / 2, *ground.half_size))
    away = abs(np.hypot(X, Y) - RADIUS) > 1.0
    np.testing.assert_allclose(shown.heights[::2, ::2][away], ground.heights[away], atol=0.02)
    monkeypatch.setattr("harness.view.ground.MOST_HALVED", ground.heights.size - 1)
    large = drawn(ground)  # whose cells stay as they are
    assert (large.cell, large.heights.shape) == (CELL, ground.heights.shape)
    assert np.ptp(rim(large)) < 0.4 * np.ptp(raw)


@pytest.mark.parametrize("name", ["rocky", "gravel", "washboard"])
def test_grain_and_gentle_ground_are_shown_as_they_are_driven(name: str) -> None:
    ground = build_world(name, 1, 1.0).ground
    assert drawn(ground) is ground


FRAME = np.full((480, 960, 3), 200, np.uint8)


def test_caption_covers_a_corner_and_nothing_else() -> None:
    frame = captioned(FRAME, 1234.5, 0.25, 12)
    rows, columns = np.nonzero((frame != FRAME).any(axis=2))
    assert frame.shape == FRAME.shape
    assert 420 < rows.min() < rows.max() < 480
    assert 0 < columns.min() < columns.max() < 480
    panel = frame[rows.min() : rows.max(), columns.min() : columns.max()]
    assert panel.min() < 110  # a darkened ground
    assert panel.max() > 250  # and white on it
    assert not (panel[:, -9:] > 230).any(), "the text ends within the panel"
