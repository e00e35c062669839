"""Clouds of points as ground: a plane comes back as that plane, whatever the file."""

from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
import pytest
import trimesh
from numpy.typing import NDArray

from harness.base.errors import UsageError
from harness.spec.world import WorldSpec
from harness.world.files import check_terrain, file_world
from harness.world.world import RoverNeeds, World

SLOPE_X, SLOPE_Y, EAST, NORTH = 0.1, -0.05, 500_000.0, 4_100_000.0
SIDE = 12.0  # [m]


def cloud() -> NDArray[np.float64]:
    """Points of a tilted plane, as many as make the mean of a cell its middle, in metres of a survey."""
    axis = np.arange(0.0, SIDE + 1e-9, 0.05)
    x, y = np.meshgrid(axis, axis)
    z = 300.0 + SLOPE_X * x + SLOPE_Y * y
    return np.column_stack([x.ravel() + EAST, y.ravel() + NORTH, z.ravel()])


def write_npy(path: Path) -> None:
    lost = np.array([(np.nan, NORTH, 300.0), (EAST, np.inf, 300.0), (EAST + 1.0, NORTH + 1.0, np.nan)])
    np.save(path, np.vstack([cloud(), lost]))


def write_ply(path: Path) -> None:
    trimesh.PointCloud(cloud()).export(path)  # type: ignore[no-untyped-call]


def write_las(path: Path, scale: float = 1.0, records: Mapping[int, bytes] | None = None) -> None:
    """A cloud in a unit that is `scale` metres long, as these records of its CRS say."""
    laspy = pytest.importorskip("laspy", reason="the extra [cloud] is not installed")
    header = laspy.LasHeader(point_format=0, version="1.2")
    header.scales, header.offsets = [1e-3] * 3, [EAST / scale, NORTH / scale, 0.0]
    las = laspy.LasData(header)
    las.x, las.y, las.z = cloud().T / scale
    for number, data in (records or {}).items():
        las.header.vlrs.append(laspy.VLR("LASF_Projection", number, "", data))
    las.write(path)


def world(path: Path, **values: float) -> World:
    spec = WorldSpec(terrain=str(path), **values)  # type: ignore[arg-type]
    check_terrain(spec)
    return file_world(spec, RoverNeeds(wheel_radius=0.06), 0)


@pytest.mark.parametrize(
    ("name", "write", "tolerance"),
    [
        ("a.npy", write_npy, 1e-6),
        ("a.ply", write_ply, 0.2),
        ("a.las", write_las, 2e-3),
        ("a.laz", write_las, 2e-3),
    ],
)
def test_a_plane_of_points_becomes_that_plane(
    name: str, write: Callable[[Path], None], tolerance: float, tmp_path: Path
) -> None:
    write(tmp_path / name)
    made = world(tmp_path / name, terrain_cell=0.25)
    ground = made.ground
    assert (ground.cell, ground.half_size) == (0.25, (SIDE / 2, SIDE / 2))
    rise = ground.height_at(4.0, 1.0) - ground.height_at(-4.0, -1.0)
    assert rise == pytest.approx(8.0 * SLOPE_X + 2.0 * SLOPE_Y, abs=tolerance)
    assert any("points become a height each 0.25 m" in note for note in made.notes)
    assert any("coarser than the wheels" in note for note in made.notes)


US_FOOT = 1200 / 3937
DEGREE = 'GEOGCS["NAD83",UNIT["degree",0.0174532925199433]]'
FEET = f'UNIT["US survey foot",{US_FOOT:.15f},AUTHORITY["EPSG","9003"]]'
GROUND, HEIGHTS = (
    f'PROJCS["NAD83 / X (ftUS)",{DEGREE},{FEET}]',
    f'VERT_CS["NAVD88",VERT_DATUM[""],{FEET}]',
)
BODY = 'ELLIPSOID["Z",1,2,LENGTHUNIT["metre",1]]'
NEW = f'PROJCRS["X",BASEGEOGCRS["Y",{BODY}],AXIS["E",LENGTHUNIT["ft",0.3048]]]'


@pytest.mark.parametrize(
    ("records", "unit"),
    [
        ({2112: GROUND.encode()}, US_FOOT),
        ({2112: f'COMPD_CS["a + b",{GROUND},{HEIGHTS}]'.encode()}, US_FOOT),
        ({2112: NEW.encode()}, 0.3048),
        ({34735: np.array([1, 1, 0, 1, 3076, 0, 1, 9002], "<u2").tobytes()}, 0.3048),
        (
            {34735: np.array([1, 1, 0, 1, 1026, 34737, 8, 0], "<u2").tobytes(), 34737: b"X (ftUS)"},
            US_FOOT,
        ),
    ],
)
def test_a_survey_in_feet_becomes_metres(
    records: Mapping[int, bytes], unit: float, tmp_path: Path
) -> None:
    write_las(tmp_path / "a.las", unit, records)
    ground = world(tmp_path / "a.las", terrain_cell=0.25).ground
    assert (2 * ground.half_size[0], 2 * ground.half_size[1]) == pytest.approx((SIDE, SIDE), abs=0.25)
    rise = ground.height_at(4.0, 1.0) - ground.height_at(-4.0, -1.0)
    assert rise == pytest.approx(8.0 * SLOPE_X + 2.0 * SLOPE_Y, abs=2e-3)


@pytest.mark.parametrize(
    ("crs", "said"),
    [
        ('PROJCS["WGS 84 / Pseudo-Mercator"', "stretches"),
        ('PROJCS["a",PROJECTION["Mercator_1SP"]', "stretches"),
        ('COMPD_CS["a",PROJCS["b"],VERT_CS["c",AXIS["Depth",DOWN]', "depths"),
        (3832, "stretches"),  # by EPSG's number alone
    ],
)
def test_a_survey_that_stretches_or_has_depths_is_refused(
    tmp_path: Path, crs: str | int, said: str
) -> None:
    keys = {34735: np.array([1, 1, 0, 1, 3072, 0, 1, crs], "<u2").tobytes()} if crs == 3832 else {}
    write_las(tmp_path / "a.las", 1.0, keys or {2112: f'{crs},UNIT["metre",1]]'.encode()})
    with pytest.raises(UsageError, match=said):
        world(tmp_path / "a.las")


def test_a_cell_is_chosen_by_the_density_of_the_points(tmp_path: Path) -> None:
    write_npy(tmp_path / "a.npy")
    assert world(tmp_path / "a.npy").ground.cell == pytest.approx(0.1)


@pytest.mark.parametrize(
    ("array", "said"),
    [
        (np.zeros((8, 3)), "it has 8 points; 64 to "),
        (np.full((99, 3), np.nan), "it has 0 points; 64 to "),
        (cloud()[:200], "pixels are too few"),
        (cloud() * [1e-5, 1e-5, 1.0], "degrees"),
    ],
)
def test_a_cloud_that_is_no_ground_is_told_in_a_line(
    array: NDArray[np.float64], said: str, tmp_path: Path
) -> None:
    np.save(tmp_path / "a.npy", array)
    with pytest.raises(UsageError, match=said):
        world(tmp_path / "a.npy")
    (tmp_path / "a.ply").write_bytes(b"ply\nnothing")
    with pytest.raises(UsageError, match=r"a\.ply"):
        world(tmp_path / "a.ply")


@pytest.mark.parametrize(
    ("mark", "value"), [("classification", 5), ("classification", 7), ("withheld", 1)]
)
def test_vegetation_noise_and_withheld_points_are_no_ground(
    mark: str, value: int, tmp_path: Path
) -> None:
    write_las(tmp_path / "a.las")
    las = pytest.importorskip("laspy").read(tmp_path / "a.las")
    others = np.arange(len(las.x)) % 50 == 0
    las.z = las.z + 30.0 * others
    setattr(las, mark, others * value)
    las.write(tmp_path / "a.las")
    made = world(tmp_path / "a.las", terrain_cell=0.25)
    assert np.ptp(made.ground.heights) == pytest.approx(SIDE * (SLOPE_X - SLOPE_Y), abs=0.02)
    assert f"{others.sum():,} points left out" in made.notes[0]
