import math
from dataclasses import replace

import numpy as np
import pytest

from harness.page.figure import DASH, keys
from harness.report.encounters import encounters
from harness.report.hillshade import shade
from harness.report.log import Event, Log, collisions, contacts, meetings
from harness.report.recorder import Approach, Stretch
from harness.report.tables import encounter_rows, people
from harness.report.terrain_map import map_figure, roughness
from harness.world.world import build_world, with_actors
from tests.harness.report.stretches import stretches
from tests.support.words import parse_actors

NO_POINTS = np.empty((0, 2))


def test_roughness_counts_in_both_directions_and_holds_where_no_sample_is() -> None:
    quiet = {"lowest_acceleration": 9.81, "highest_acceleration": 9.81}
    dip = {"lowest_acceleration": 6.81, "highest_acceleration": 10.0}
    assert roughness(stretches(quiet, dip, {}), 9.81) == pytest.approx([0.0, 3.0, 3.0])


def test_map_shows_the_path_and_everything_that_happened_on_it() -> None:
    world = build_world("rocky", seed=0)
    track = stretches({"contact_s": 0.1, "nearest_range": 0.1}, {}, {})
    log = Log([1.0], {"Total Collisions": [5.0]})
    figure = map_figure(
        world,
        shade(world.ground),
        track,
        collisions=collisions(log, track),
        contacts=contacts(track),
        scan=np.array([[1.0, 2.0]]),
        gravity=9.81,
    )
    assert {key.name for key in keys(figure)} == {
        "rock",
        "hazard",
        "last scan",
        "start",
        "end",
        "collision (metric)",
        "contact with a hazard (truth)",
    }
    (path,) = (trace for trace in figure["data"] if "customdata" in trace)
    assert sorted(path["x"]) == [1.0, 2.0, 3.0]


def test_map_shows_where_people_walked_and_where_they_were_near() -> None:
    world = with_actors(build_world("flat", seed=0), parse_actors(["a=1,1", "b=2,2/2,3"]))
    near = [
        {
            "people": ((1.0, 1.0, 0.9), (2.0, y, 0.9)),
            "approaches": (Approach(4.0, 2.5, (3.0, 0.0), (1.0, 1.0)), Approach(far, y, (y, 0), (2, y))),
        }
        for y, far in ((2.0, 1.2), (2.5, 1.1), (3.0, 0.2))
    ]
    track = stretches({}, *near)
    met = meetings(track)
    assert met == [Event(2.0, 4.0, (3.0, 0.0, 0.0))]
    figure = map_figure(
        world,
        shade(world.ground),
        track,
        collisions=[],
        contacts=[],
        meetings=met,
        scan=NO_POINTS,
        gravity=9.81,
    )
    by_name = {trace["name"]: trace for trace in reversed(figure["data"])}
    assert by_name["b_actor"]["y"] == [2.0, 2.5, 3.0]
    assert by_name["closest to a person"]["x"] == [3.0, 1.0, None, 3.0, 2.0, None]
    assert by_name["person within 1.2 m"]["x"] == [3.0]
    told = {key.name: key.swatch for key in keys(figure)}
    assert (told["a_actor"], told["person within 1.2 m"]) == ("line", "circle-open")
    assert encounter_rows(encounters(track), world.people) == [
        ("1", "a_actor", "4.00 m", "2.5 s", DASH, "3.0, 0.0", "1.0, 1.0"),
        ("2", "b_actor", "0.20 m", "3.0 s", "3.0 s", "3.0, 0.0", "2.0, 3.0"),
    ]
    rows = [(row.quantity, row.truth) for row in people(track)]
    assert rows == [("People within 1.2 m", "1 times"), ("Nearest person", "0.20 m")]
    assert people(stretches({})) == []


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
