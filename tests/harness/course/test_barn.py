"""The track BARN against BARN's own tables and files."""

import csv
import math
from collections import defaultdict
from pathlib import Path

import numpy as np
import pytest

from harness.base.errors import UsageError
from harness.course.task import Case
from harness.course.tracks import find_track
from harness.course.tracks.barn import Barn, generated, is_passable
from harness.course.tracks.barn_files import path_length, read_worlds
from harness.episode.assembly import world_of
from harness.world.world import World, terrain_hash

DATA = Path(__file__).parents[4] / "shared/data/barn"
needs_data = pytest.mark.skipif(not DATA.is_dir(), reason="BARN's tables are not there")


def world(case: Case, folder: Path) -> World:
    return world_of(Barn().task(case, folder).run)


def places(built: World) -> set[tuple[float, float]]:
    return {(round(o.position[0], 3), round(o.position[1], 3)) for o in built.obstacles}


@needs_data
def test_worlds_that_ship_are_those_of_the_tables(tmp_path: Path) -> None:
    told: dict[str, set[tuple[float, float]]] = defaultdict(set)
    with (DATA / "cylinders.csv").open() as file:
        for row in csv.DictReader(file):
            told[row["world"]].add((float(row["x"]), float(row["y"])))
    for case in Barn().cases(50)[::7]:
        assert case.world is not None
        assert places(world(case, tmp_path)) == told[case.world.name[5:-4]]


@needs_data
def test_files_tables_and_what_ships_are_one_world(tmp_path: Path) -> None:
    of_files = [w.name for w in read_worlds(DATA / "sdf") if w.name.startswith("barn")]
    assert of_files == ["barn_0.world", "barn_60.world", "barn_150.world", "barn_294.world"]
    file = next(case for case in Barn().cases(50, DATA / "sdf") if case.world.name == "barn_60.world")  # type: ignore[union-attr]
    table = next(case for case in Barn().cases(100, DATA) if case.world.name == "barn_60.sdf")  # type: ignore[union-attr]
    shipped = Barn().cases(50)[10]
    assert terrain_hash(world(table, tmp_path)) == terrain_hash(world(shipped, tmp_path))
    assert places(world(file, tmp_path)) == places(world(shipped, tmp_path))
    lengths = [Barn().task(case, tmp_path).shortest for case in (table, shipped)]
    assert lengths[0] == pytest.approx(lengths[1], abs=1e-3)


def test_unseen_worlds_are_passable_and_of_the_same_kinds() -> None:
    shipped = [len(case.world.text) for case in Barn().cases(50)]  # type: ignore[union-attr]
    unseen = [Barn().unseen(seed) for seed in range(12)]
    assert unseen == [Barn().unseen(seed) for seed in range(12)]
    sizes = [len(case.world.text) for case in unseen]  # type: ignore[union-attr]
    assert 0.8 * min(shipped) < min(sizes) < max(sizes) < 1.2 * max(shipped)
    wall = np.zeros((30, 30), np.int64)
    wall[15] = 1
    assert is_passable(np.zeros((30, 30), np.int64))
    assert not is_passable(wall)
    assert (generated(3, 0)[:, 0] == 1).all()


def test_a_table_may_have_other_cases_and_spaces_and_is_refused_in_millimetres(tmp_path: Path) -> None:
    (tmp_path / "cylinders.csv").write_text("World, X, Y\n7, -1.5, 6.0\n7, -3.0, 6.0\n")
    (case,) = Barn().cases(50, tmp_path)
    assert Barn().task(case, tmp_path).shortest == pytest.approx(10.0, abs=0.2)
    (tmp_path / "cylinders.csv").write_text("world,x,y,radius\n7,-1.5,6.0,0.3\n7,-3.0,6.0,\n")
    text = read_worlds(tmp_path)[0].text.decode()
    assert text.count("<radius>0.3<") == text.count("<radius>0.075<") > 0
    fence = "".join(f"7,{-3.25 + 0.4 * n},6.0\n" for n in range(6))  # whose gaps are too narrow
    (tmp_path / "cylinders.csv").write_text(f"world,x,y\n{fence}")
    (case,) = Barn().cases(50, tmp_path)
    assert Barn().task(case, tmp_path).shortest > 10.3
    (tmp_path / "cylinders.csv").write_text("world,x,y\n7,-1500,6000\n7,-3000,6000\n")
    (case,) = Barn().cases(50, tmp_path)
    with pytest.raises(UsageError, match="metres"):
        Barn().task(case, tmp_path)


def test_worlds_of_a_folder_come_by_their_numbers_each_with_its_own_path(tmp_path: Path) -> None:
    (tmp_path / "path_files").mkdir()
    for number in range(11):
        (tmp_path / f"world_{number}.world").write_text(f"<sdf>{number}</sdf>")
        cells = [(15, 5 + row) for row in range(40)] + [(15 + number, 45)]
        np.save(tmp_path / "path_files" / f"path_{number}.npy", cells)
    worlds = read_worlds(tmp_path)
    assert [one.text for one in worlds] == [f"<sdf>{number}</sdf>".encode() for number in range(11)]
    lengths = [one.length for one in worlds]
    assert None not in lengths
    assert lengths == sorted(lengths)  # type: ignore[type-var] # not None
    assert lengths[-1] > lengths[0] + 1.0  # type: ignore[operator]


def test_a_path_is_as_long_in_whatever_order_its_points_stand(tmp_path: Path) -> None:
    (tmp_path / "cylinders.csv").write_text("x;y;world\n-1,5;6,0;7\n")  # and with decimal commas
    for rows in ("7,0,-2.5,5\n7,1,-2.0,8\n", "7,1,-2.0,8\n7,0,-2.5,5\n"):
        (tmp_path / "paths.csv").write_text(f"world,i,x,y\n{rows}")
        (world,) = read_worlds(tmp_path)
        assert world.length == pytest.approx(path_length([(-2.5, 5.0), (-2.0, 8.0)]))


@pytest.mark.parametrize("seed", range(0, 40, 3))
def test_no_mover_of_dynabarn_is_near_the_start_when_a_rover_enters(seed: int, tmp_path: Path) -> None:
    built = world_of(find_track("dynabarn").task(Case("dynabarn", seed), tmp_path).run)
    walks = [person.walk() for person in built.people]
    places = [walk.place(time) for walk in walks for time in range(4)]  # type: ignore[union-attr]
    assert min(math.dist((place.x, place.y), built.start[:2]) for place in places) > 2.0 - 1e-3


@pytest.mark.parametrize(
    ("files", "named"),
    [
        ({}, "0 worlds"),
        ({"cylinders.csv": "world,x,y\n1,0,5,3,0\n"}, "more values"),
        ({"cylinders.csv": "world,x\n1,2\n"}, "world, x, y"),
        ({"cylinders.csv": "world,x,y\n1,2,nan\n"}, "finite"),
        ({"world_1.world": "", "path_1.npy": "no"}, "path_1.npy"),
    ],
)
def test_folders_that_hold_no_worlds_are_named(
    files: dict[str, str], named: str, tmp_path: Path
) -> None:
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    with pytest.raises(UsageError, match=named):
        read_worlds(tmp_path)
