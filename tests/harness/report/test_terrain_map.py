import math
from dataclasses import replace

import numpy as np
import pytest

from harness.report.hillshade import shade
from harness.report.log import Event
from harness.report.recorder import Stretch
from harness.report.terrain_map import map_figure, roughness
from harness.world.world import build_world
from tests.harness.report.made import stretches

NO_POINTS = np.empty((0, 2))


def test_roughness_counts_in_both_directions_and_holds_where_no_sample_is() -> None:
    quiet = {"lowest_acceleration": 9.81, "highest_acceleration": 9.81}
    dip = {"lowest_acceleration": 6.81, "highest_acceleration": 10.0}
    assert roughness(stretches(quiet, dip, {}), 9.81) == pytest.approx([0.0, 3.0, 3.0])


def test_map_of_a_run_that_never_moved_or_diverged_shows_the_terrain() -> None:
    world = build_world("flat", seed=0)
    lost = Stretch(1.0, (math.nan, 0.0, 0.0), 0.0)
    figure = map_figure(
        world, shade(world.ground), [lost], collisions=[], contacts=[], scan=NO_POINTS, gravity=9.81
    )
    assert figure["data"] == []
    assert figure["layout"]["xaxis"]["range"] == [-20.0, 20.0]


def test_the_path_is_coloured_by_roughness_with_the_roughest_on_top() -> None:
    levels = (12.81, 9.81, 10.81)
    track = stretches(*({"lowest_acceleration": 9.81, "highest_acceleration": h} for h in levels))
    world = build_world("flat", seed=0)
    one = Event(1.0, 2.0, (7.0, 8.0, 0.0))
    other = replace(one, position=(5.0, 6.0, 0.0))
    figure = map_figure(
        world,
        shade(world.ground),
        track,
        collisions=[one],
        contacts=[other],
        scan=NO_POINTS,
        gravity=9.81,
    )
    traces = {trace["name"]: trace for trace in figure["data"]}
    path = traces["path"]
    assert path["x"] == [2.0, 3.0, 1.0]
    assert path["marker"]["color"] == pytest.approx([0.0, 1.0, 3.0])
    assert path["customdata"][0] == [2.0, 0.0, 0.0]
    assert path["marker"]["cmax"] == 5.0
    assert (traces["start"]["x"], traces["end"]["x"]) == ([1.0], [3.0])
    hit, counted = traces["contact with a hazard (truth)"], traces["collision (metric)"]
    assert (hit["x"], hit["y"], counted["x"], counted["y"]) == ([5.0], [6.0], [7.0], [8.0])
    assert counted["text"] == ["1.0 to 2.0 s"]
