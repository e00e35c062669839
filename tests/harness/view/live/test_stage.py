"""What a page shows of a run, and what a click on it means, also where it follows a rover."""

import math
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest

pytest.importorskip("viser", reason="needs the extra [live]")

from harness.base.interrupt import StopRequest
from harness.episode.assembly import world_of
from harness.episode.direct import run_direct
from harness.episode.result import Outputs
from harness.robots import find_rover
from harness.samples import Place
from harness.spec.ros import RosOptions
from harness.spec.rover import RoverSetup
from harness.spec.run import Run
from harness.spec.world import WorldSpec
from harness.view.live.server import Server
from harness.view.live.stage import Stage
from harness.view.live.watch import Sight, Watch


def test_what_is_clicked_is_the_ground_there_wherever_the_followed_rover_is_and_a_goal_stands_on_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    run, watch, server = Run.of(terrain="rolling", lidar_beams=8), Watch(), Server("127.0.0.1", 0)
    posts, lines = list[dict[str, Any]](), Mock()
    monkeypatch.setattr(server.scene, "add_line_segments", lambda *_, **__: lines)
    monkeypatch.setattr(server.scene, "add_cylinder", lambda *_, **post: posts.append(post))
    try:
        stage, still = Stage(server.scene, run), (0.0,) * len(find_rover(run.rover.robot).joints)
        watch.sight = Sight((3.0, -2.0, 1.0), (1.0, 0.0, 0.0, 0.0), still)
        stage.draw([watch])
        hit = stage.under((1.0, 2.5, 20.0), (0.0, 0.0, -1.0))
        stage.mark(Place(4.0, 0.5, 1.0))
        watch.path = [(2.0, -2.0, 1.0), (2.5, -2.0, 1.0), (3.0, -2.0, 1.0)]
        stage.draw_paths([watch])
    finally:
        server.stop()
    height = world_of(run).ground.height_at(4.0, 0.5)
    assert hit == pytest.approx((4.0, 0.5, height), abs=0.02)
    assert lines.points[:, :, 0].tolist() == [[2.0, 2.5], [2.5, 3.0]]
    assert 1.0 < lines.points[..., 2].min() < 1.1  # over the ground
    assert posts[0]["position"] == pytest.approx((4.0, 0.5, height + 0.4))


def test_what_each_lidar_hits_is_shown_on_the_posts_of_the_world_and_on_the_other_rover(
    tmp_path: Path,
) -> None:
    leo = RoverSetup(name="a", robot="leo", start=(1.0, 0.5, 2.0), driver="straight")
    other = leo.but(name="b", robot="rover_zero4wd", start=(-1.0, 0.5, 2.0))
    run = Run(world=WorldSpec(terrain="posts"), rovers=(leo, other), duration=2.0)
    watches, server = [Watch(), Watch()], Server("127.0.0.1", 0)
    outputs = [Outputs(log_dir=tmp_path, observers=(watch,)) for watch in watches]
    run_direct(run, outputs, RosOptions(log_dir=tmp_path), StopRequest())
    try:
        stage = Stage(server.scene, run)
        stage.draw(watches)
        hits = [np.asarray(each.points) for each in stage.hits]
    finally:
        server.stop()
    things = [(*post.position[:2], math.hypot(*post.half_size[:2])) for post in world_of(run).obstacles]
    for points, beside in zip(hits, reversed(watches), strict=True):  # Leo's lidar is mounted backwards
        assert beside.sight is not None
        x, y, reach = np.array([*things, (*beside.sight.position[:2], 0.45)]).T
        beyond = np.hypot(points[:, :1] - x, points[:, 1:2] - y) - reach
        assert len(points) > 30
        assert beyond.min(axis=1).max() < 0.05
