"""What a click on a page means, in a page that stands around the rover which is followed."""

import pytest

pytest.importorskip("viser", reason="needs the extra [live]")

from harness.episode.assembly import world_of
from harness.live.server import Server
from harness.live.stage import Stage
from harness.live.watch import Sight, Watch
from harness.robots import find_rover
from harness.spec.run import Run


def test_what_is_clicked_is_the_ground_there_wherever_the_followed_rover_is() -> None:
    run, watch, server = Run.of(terrain="rolling", lidar_beams=8), Watch(), Server("127.0.0.1", 0)
    try:
        stage, still = Stage(server.scene, run), (0.0,) * len(find_rover(run.rover.robot).joints)
        watch.sight = Sight((3.0, -2.0, 1.0), (1.0, 0.0, 0.0, 0.0), still)
        stage.draw([watch])
        hit = stage.under((1.0, 2.5, 20.0), (0.0, 0.0, -1.0))
    finally:
        server.stop()
    height = world_of(run).ground.height_at(4.0, 0.5)
    assert hit == pytest.approx((4.0, 0.5, height), abs=0.02)
