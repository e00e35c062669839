"""What a stranger's file may ask for: numbers, sizes and names beyond the bounds of docs/limits.md."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import trimesh

from harness.base import xml
from harness.base.errors import UsageError
from harness.base.mesh_file import read_mesh
from harness.base.ros_names import namespace_of
from harness.base.sdf.resources import Resources
from harness.drivers import find_driver
from harness.episode.assembly import check, world_of
from harness.scenario.case import cases_of
from harness.scenario.reading import read_scenario
from harness.sensors.depth import DepthOptions
from harness.sensors.height_scan import HeightScanOptions
from harness.spec.run import Run
from harness.spec.target import parse_target
from harness.world.actors.people import read_trajectories
from harness.world.heightfield import Heightfield
from harness.world.heightmap.raster import read_raster
from harness.world.sdf.reading import read_document
from harness.world.targets.placing import target_names
from harness.world.world import World, with_actors
from rover_metrics.log.documents import DocumentError, read_bytes
from tests.harness.world.solids.shapes import box, write_dae
from tests.support.words import parse_actors

BARE = World("bare", Heightfield(np.zeros((201, 201)), 0.1), (), seed=3, difficulty=0.0)
SHAPE = "<instance_geometry url='#g'/>"


def one_line(said: str, do: Callable[[], object]) -> None:
    with pytest.raises(UsageError, match=said) as raised:
        do()
    assert str(raised.value).isprintable()


def walk(path: Path, *points: str) -> Path:
    poses = "".join(f"<waypoint><pose>{point} 0 0 0</pose></waypoint>" for point in points)
    path.write_text(f"<trajectory>{poses}</trajectory>")
    return path


def test_routes_beyond_the_map_and_too_long_ones_are_refused_before_they_are_followed(
    tmp_path: Path,
) -> None:
    file = str(tmp_path / "a.sdf")
    texts = {
        "g=0,0/9,0/1e9,0": "off the map at 1000000000.00,0.00",
        file: "'a' walks 240 km, and 200 km",
    }
    walk(tmp_path / "a.sdf", *("0 0 0", "0 8 0") * 15_000, "0 0 0")
    for text, said in texts.items():
        one_line(said, lambda text=text: with_actors(BARE, parse_actors([text])))  # type: ignore[misc]
    walk(tmp_path / "a.sdf", "0 0 0", "0 8 1e300")
    one_line("walks 1e[+]297 km", lambda: with_actors(BARE, parse_actors([file])))


def node(name: str, inner: str) -> str:
    return f"<node id='{name}'>{inner}</node>"


@pytest.mark.parametrize(
    ("inner", "nodes", "said"),
    [
        (SHAPE * 20_000, "", "has 20,000 shapes; at most 5,000"),
        (
            "<instance_node url='#k0'/>",
            "".join(node(f"k{n}", f"<instance_node url='#k{n + 1}'/>" * 2) for n in range(40))
            + node("k40", SHAPE),
            f"has {2**40:,} shapes",
        ),
        ("<instance_node url='#k'/>", node("k", "<instance_node url='#k'/>" * 2), "stand in themselves"),
    ],
    ids=["flat", "nested", "circle"],
)
def test_scenes_of_too_many_shapes_are_refused(
    tmp_path: Path, inner: str, nodes: str, said: str
) -> None:
    text = write_dae(path := tmp_path / "a.dae", box((0, 0, 0), (1, 1, 1))).read_text()
    library = f"<library_nodes>{nodes}</library_nodes><library_visual_scenes>"
    path.write_text(text.replace(SHAPE, inner).replace("<library_visual_scenes>", library))
    one_line(said, lambda: read_mesh(path))


def test_arrays_of_too_many_bytes_are_refused_before_they_are_read(tmp_path: Path) -> None:
    path = tmp_path / "a.npy"
    for size, length, said in ((3_000_000_000, 118, "256 MiB; crop it"), (99, 2**31, "not that long")):
        with path.open("wb") as file:
            file.write(b"\x93NUMPY\x02\x00" + length.to_bytes(4, "little"))
            file.truncate(size)  # sparse: takes no room
        one_line(said, lambda: read_raster(path))


def test_policies_of_too_many_bytes_or_of_words_are_refused(tmp_path: Path) -> None:
    def policy(**arrays: np.ndarray) -> None:
        np.savez_compressed(tmp_path / "p.npz", activation=np.array("tanh"), **arrays)  # type: ignore[arg-type]
        find_driver(f"policy:{tmp_path / 'p.npz'}")

    one_line("holds more than 64 MiB", lambda: policy(weights_0=np.zeros(2**23 + 1)))
    words = np.full((20, 2), "0.5")
    one_line("weights_0 are no numbers", lambda: policy(weights_0=words, bias_0=np.zeros(2)))


def world(tmp_path: Path, inner: str, gravity: str = "0 0 -9.8", pose: str = "0 0 0 0 0 0") -> list[str]:
    geometry = "<geometry><box><size>2 4 6</size></box></geometry>"
    collision = f"<collision name='c'>{geometry}{inner}</collision>"
    body = f"<model name='m&#10;&#x9b;31m'><pose>{pose}</pose><link name='l'>{collision}</link></model>"
    path = tmp_path / "a.world"
    path.write_text(f"<sdf><world><gravity>{gravity}</gravity>{body}</world></sdf>", encoding="utf-8")
    document = read_document(path, Resources())
    return [*document.notes, *(solid.name for solid in document.solids)]


def friction(mu: str) -> str:
    return f"<surface><friction><ode><mu>{mu}</mu></ode></friction></surface>"


@pytest.mark.parametrize("mu", ["-5", "-1e30", "1_000", "\uff11", "0x1"])  # a full-width 1
def test_quantities_of_worlds_have_ranges_and_are_written_in_plain_digits(
    tmp_path: Path, mu: str
) -> None:
    one_line(f"<mu> of m  31m::l::c '{mu}' is not valid; give", lambda: world(tmp_path, friction(mu)))
    one_line("gravity '0 0 -1_0'", lambda: world(tmp_path, "", gravity="0 0 -1_0"))
    for gravity in ("0 0 -1e30", "0 0 -1e-3"):  # on the latter a rover hangs in the air
        one_line("not 0.01 to 100 m/s", lambda g=gravity: world(tmp_path, "", gravity=g))  # type: ignore[misc]
    one_line("pose of .* give at most", lambda: world(tmp_path, "", pose="1e300 0 0 0 0 0"))


def test_names_of_strangers_neither_begin_lines_nor_move_the_cursor(tmp_path: Path) -> None:
    texts = world(tmp_path, friction("1e16"))
    assert texts == ["not static, but nothing moves here: m  31m", "m  31m::l::c"]


def test_files_of_too_many_elements_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = walk(tmp_path / "a.sdf", "0 0 0")
    monkeypatch.setattr(xml, "MOST_ELEMENTS", 3)
    assert len(read_trajectories(path)) == 1
    walk(path, "0 0 0", "0 0 0")
    one_line("has more than 3 elements; take some out", lambda: read_trajectories(path))


@pytest.mark.parametrize("word", ["1_0", "\uff11", "\u0663"])
def test_numbers_of_options_are_written_in_plain_digits(word: str) -> None:
    for options in ({"start": f"{word},0"}, {"datum": f"{word},0"}, {"actors": (f"g={word},0",)}):
        one_line(re.escape(f"{word},0"), lambda options=options: Run.of(**options))  # type: ignore[misc]


SDF = "<sdf version='1.9'><world name='w'>{}</world></sdf>"
PLANE = "<plane><size>20 20</size></plane>"


def two_solids(folder: Path) -> None:
    shapes = (PLANE, "<box><size>1 1 1</size></box>")
    links = [f"<collision name='c'><geometry>{shape}</geometry></collision>" for shape in shapes]
    models = [
        f"<model name='m{at}'><static>1</static><pose>0 {6 * at} 0 0 0 0</pose><link name='l'>{link}"
        "</link></model>"
        for at, link in enumerate(links)
    ]
    (folder / "a.sdf").write_text(SDF.format("".join(models)))
    world_of(Run.of(terrain=str(folder / "a.sdf")))


def twelve_triangles(folder: Path) -> None:
    trimesh.creation.box().export(folder / "box.obj")
    read_mesh(folder / "box.obj")


def four_runs(folder: Path) -> None:
    (file := folder / "a.scenario.yaml").write_text(
        "{about: a, seeds: 2, matrix: {robot: [leo, husky]}, expect: {truth.speed: {max: 9}}}"
    )
    cases_of(file, read_scenario(file))


@pytest.mark.parametrize(
    ("bound", "amount", "take"),
    [
        ("harness.world.sdf.reading.MOST_SOLIDS", 2, two_solids),
        ("harness.base.mesh_file.MOST_TRIANGLES", 12, twelve_triangles),
        ("harness.scenario.case.MOST_RUNS", 4, four_runs),
        ("harness.base.ros_names.LONGEST_NAMESPACE", 5, lambda _: namespace_of("a/b_c")),
        ("harness.sensors.ranging.MOST_RAYS", 160 * 120, lambda _: DepthOptions(name="d")),
        ("harness.sensors.height_scan.MOST_CELLS", 400, lambda _: HeightScanOptions(name="h")),
        (
            *("harness.faults.lookup.MOST_COPIES", 6),
            lambda _: check(Run.of(faults=("imu:duplicate=2", "imu:duplicate=3"))),
        ),
        (
            *("harness.world.targets.placing.MOST_TARGETS", 2),
            lambda _: target_names([parse_target("post"), parse_target("gate")]),
        ),
        (
            *("harness.world.actors.people.MOST_ACTORS", 2),
            lambda _: world_of(Run.of(terrain="flat", actors=["a=2,2/4,2", "b=2,3/4,3"])),
        ),
    ],
)
def test_as_many_as_a_bound_says_are_taken_and_not_one_more(
    bound: str,
    amount: int,
    take: Callable[[Path], object],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(bound, amount)
    take(tmp_path)
    monkeypatch.setattr(bound, amount - 1)
    with pytest.raises((UsageError, ValueError)):
        take(tmp_path)


def test_a_file_of_as_many_bytes_as_a_bound_says_is_read(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"seven77")
    assert read_bytes(tmp_path / "a", 7) == b"seven77"
    with pytest.raises(DocumentError):
        read_bytes(tmp_path / "a", 6)
