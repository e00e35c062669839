"""What of solids is ground: planes, wide boxes and meshes, reliefs; how far the map reaches."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tifffile
import trimesh
from scipy.spatial.transform import Rotation

from harness.base.errors import UsageError
from harness.base.mesh import Mesh
from harness.world.solid import MeshFile, Plane, Primitive, Relief, Solid
from harness.world.solids.ground import Partition, map_bounds, partition
from tests.harness.world.solids.shapes import at, box, flat, write_mesh

UP = (0.0, 0.0, 1.0)


def plane(pose: np.ndarray, normal: tuple[float, float, float] = UP, size: Any = (40.0, 30.0)) -> Solid:  # noqa: ANN401 - two numbers
    return Solid("plane", Plane(normal, size), pose)


def cube(pose: np.ndarray, *half_size: float) -> Solid:
    return Solid("cube", Primitive("box", half_size), pose)


def sort(*solids: Solid) -> tuple[Partition, list[str]]:
    notes = list[str]()
    return partition(solids, notes), notes


def body_of(mesh: Mesh) -> trimesh.Trimesh:
    return trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)


def test_of_level_planes_the_highest_counts_and_all_are_mapped_up_to_a_limit() -> None:
    low, high, wide = (
        plane(at(1.0, 2.0, 0.5), (0.0, 0.0, 7.0)),
        plane(at(-9.0, 5.0, 1.5), size=(20.0, 4.0)),
        plane(at(0.0, 0.0, 1.0), size=(1e4, 100.0)),
    )
    found, notes = sort(low, high, wide)
    assert (found.plane, found.ground, notes) == (1.5, [], [])
    assert found.mapped == [(-19, 21, -13, 17), (-19, 1, 3, 7), (-75, 75, -50, 50)]
    assert map_bounds(found) == (-75.0, 75.0, -50.0, 50.0)


def test_a_plane_reaches_five_metres_around_what_stands_on_it(tmp_path: Path) -> None:
    path = write_mesh(tmp_path / "m.obj", box((0, 0, 0), (2, 4, 6)))
    pole = Solid("pole", Primitive("cylinder", (0.5, 2.0)), at(0.0, -30.0, 0.0))
    beam = Solid("beam", pole.shape, at(-20.0, 0.0, 0.0, 0.0, np.pi / 2, 0.0))
    found, _ = sort(
        plane(at(0.0, 0.0, 0.0), size=(10.0, 10.0)),
        cube(at(40.0, 0.0, 0.0), 1.0, 2.0, 3.0),
        *(pole, beam),
        Solid("mesh", MeshFile(path), at(0.0, 50.0, 0.0)),
    )
    assert map_bounds(found) == pytest.approx((-27.0, 46.0, -35.5, 57.0))
    assert [solid.name for solid in found.primitives] == ["cube", "pole", "beam"]
    assert [solid.name for solid, _ in found.standing] == ["mesh"]


LEANING = at(3.0, 4.0, 5.0, 0.0, -0.2, 0.0)


@pytest.mark.parametrize(
    ("pose", "normal"),
    [
        (LEANING, UP),
        (LEANING, (1.0, 2.0, 3.0)),
        (LEANING, (0.3, -0.2, -0.1)),
        (LEANING, (0.0, 0.0, -2.0)),
    ],
)
def test_a_plane_that_leans_is_two_triangles_that_face_its_normal_40_m_along_x_and_30_along_y(
    pose: np.ndarray, normal: tuple[float, float, float]
) -> None:
    """Its z is turned to the normal about the axis across both; by half a turn about x or y alike."""
    found, notes = sort(plane(pose, normal))
    (mesh,) = found.ground
    expected = pose[:3, :3] @ normal / np.linalg.norm(normal)
    axis = np.cross(UP, normal) if np.any(normal[:2]) else np.array([1.0, 0.0, 0.0])
    angle = np.arccos(normal[2] / np.linalg.norm(normal))
    turned = Rotation.from_rotvec(angle * axis / max(np.linalg.norm(axis), 1e-12)).as_matrix()
    flat_again = (mesh.vertices - pose[:3, 3]) @ pose[:3, :3] @ turned
    np.testing.assert_allclose(np.abs(flat_again), [[20.0, 15.0, 0.0]] * 4, atol=1e-9)
    made = body_of(mesh)
    np.testing.assert_allclose(made.face_normals, [expected] * 2, atol=1e-12)
    np.testing.assert_allclose([made.area, *made.centroid], [40.0 * 30.0, *pose[:3, 3]])
    assert (found.plane, notes) == (None, [])


def test_a_wide_box_is_ground_unless_another_has_twenty_times_its_area() -> None:
    """What is narrower than 10 m never is; a twentieth of the largest still is."""
    great, twentieth = cube(at(0.0, 0.0, 0.0), 50.0, 20.0, 1.0), cube(at(0.0, 0.0, 3.0), 10.0, 5.0, 1.0)
    greater = cube(at(0.0, 0.0, 0.0), 50.0, 20.01, 1.0)
    less, narrow = cube(at(0.0, 0.0, 3.0), 10.0, 4.99, 1.0), cube(at(0.0, 0.0, 9.0), 400.0, 4.9, 1.0)
    for solids, ground in (
        *(((great, twentieth), 2), ((greater, twentieth), 1), ((less, narrow), 0)),
        ((cube(at(0.0, 0.0, 0.0, 0.0, 0.0, 1.0), 5.0, 5.0, 1.0),), 1),
        ((cube(at(0.0, 22.9868098108107, 0.0), 5.0, 5.0, 1.0),), 1),  # 10 m less a rounding
        ((cube(at(0.0, 0.0, 0.0, 0.0, np.pi / 2, 0.0), 1.0, 5.0, 5.0),), 1),
    ):
        if not ground:
            with pytest.raises(UsageError, match=r"\(the widest is 20 x 9\.98 m\)|has no ground"):
                sort(*solids)
            continue
        found, _ = sort(*solids)
        assert (len(found.ground), len(found.primitives)) == (ground, len(solids) - ground)
        for made, solid in zip(map(body_of, found.ground), solids, strict=False):
            assert isinstance(solid.shape, Primitive)
            whole = trimesh.creation.box(2.0 * np.array(solid.shape.half_size), solid.pose)
            assert made.volume == pytest.approx(whole.volume)  # of faces that all face out
            np.testing.assert_allclose(made.bounds, whole.bounds)


@pytest.mark.parametrize("turned", [False, True])
def test_a_sheet_that_faces_down_is_turned_over_and_noted(turned: bool, tmp_path: Path) -> None:
    sheet = flat(1.0)
    faces = sheet.faces[:, ::-1] if turned else sheet.faces
    path = write_mesh(tmp_path / "m.obj", Mesh(sheet.vertices, faces))
    great = cube(at(0.0, 0.0, 9.0), 50.0, 40.0, 1.0)  # twenty times its area, seen from above
    found, notes = sort(great, Solid("m", MeshFile(path), at(0.0, 0.0, 2.0)))
    _, made = map(body_of, found.ground)
    assert made.face_normals.tolist() == [[0.0, 0.0, 1.0]] * 2
    assert made.vertices[:, 2].tolist() == [3.0] * 4
    assert notes == ["m: its triangles face down; turned over"] * turned
    assert [*found.hashes] == [path]


def test_a_mesh_is_scaled_then_moved_and_a_part_may_be_centred_before(tmp_path: Path) -> None:
    block = box((10.0, 20.0, 30.0), (8.0, 8.0, 2.0))
    block.vertices[0] += 1.0  # the middle is not the mean of the corners
    path = write_mesh(tmp_path / "m.obj", block)
    for centred, middle in ((False, (21.0, 62.0, 33.0)), (True, (1.0, 2.0, 3.0))):
        file = MeshFile(path, (2.0, 3.0, 1.0), centred=centred)
        (mesh,) = sort(Solid("m", file, at(1.0, 2.0, 3.0)))[0].ground
        low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
        assert 0.5 * (low + high) == pytest.approx(middle)
        assert high - low == pytest.approx((16.0, 24.0, 2.0))


def test_a_relief_is_as_high_as_its_values_say(tmp_path: Path) -> None:
    for value, kind, height, top in (
        (255, np.float32, 2.0, 255.0),  # floats are metres
        *((255, np.uint8, 2.0, 2.0), (51, np.uint8, 2.0, 2.0), (65_535, np.uint16, 2.0, 2.0)),
    ):
        np.save(path := tmp_path / "h.npy", np.full((9, 11), value, kind))
        relief = Relief(path, (30.0, 24.0, height), (1.0, 2.0, 3.0))
        found, _ = sort(Solid("h", relief, at(100.0, 0.0, 10.0)))
        (made,) = map(body_of, found.ground)
        assert made.vertices[:, 2] == pytest.approx(top + 13.0)
        assert map_bounds(found) == pytest.approx((86.0, 116.0, -10.0, 14.0))
        assert made.face_normals.tolist() == [[0.0, 0.0, 1.0]] * (2 * 8 * 10)
        edge = made.edges_unique_length.max()
        assert (made.area, edge) == pytest.approx((30.0 * 24.0, np.hypot(3, 3)))


@pytest.mark.parametrize(
    ("kind", "size", "width", "low", "high"),
    [
        (np.uint8, (30.0, 30.0, 4.0), 30.0, 2.0, 4.0),  # as Gazebo: the largest value is as high as told
        (np.uint16, (30.0, 30.0, 4.0), 30.0, 2.0, 4.0),
        (np.float32, (30.0, 30.0, 4.0), 30.0, 4.0, 8.0),  # a survey's relief is
        (np.float32, None, 20.0, 60.0, 120.0),  # and without a size it is as it was measured
    ],
)
def test_a_heightmap_is_as_large_as_in_gazebo(
    tmp_path: Path, kind: type, size: tuple[float, ...] | None, width: float, low: float, high: float
) -> None:
    values: np.ndarray = np.full((11, 11), 60, kind)
    values[5, 5] = 120
    scale = [(33550, "d", 3, (2.0, 2.0, 0.0), True)] if kind is np.float32 else []
    tifffile.imwrite(path := tmp_path / "h.tif", values, extratags=scale)
    solid = Solid("h", Relief(path, size, (0.0, 0.0, 0.0)), np.eye(4))  # type: ignore[arg-type]
    (mesh,) = sort(solid)[0].ground
    heights = mesh.vertices[:, 2]
    assert (np.ptp(mesh.vertices[:, 0]), heights.min(), heights.max()) == pytest.approx(
        (width, low, high)
    )


def test_a_relief_without_all_of_its_values_is_refused_and_a_fine_one_is_sampled(tmp_path: Path) -> None:
    path = tmp_path / "h.npy"
    row, column = np.mgrid[0:9, 0:1025].astype(float)
    np.save(path, 0.01 * column - 0.1 * row)
    solid = Solid("h", Relief(path, (1024.0, 80.0, 11.04), (0.0, 0.0, 0.0)), at(0.0, 0.0, 0.0))
    (mesh,) = sort(solid)[0].ground
    assert len(mesh.vertices) == 9 * 513
    x, y, z = mesh.vertices.T
    inner = np.abs(x) < 510.0  # of the mean over three samples, but at the edge
    assert z[inner] == pytest.approx((0.01 * (x + 512.0) - 0.1 * (40.0 - y) / 10.0)[inner])
    np.save(path, np.where(column == 3, np.nan, 0.0))
    with pytest.raises(UsageError, match=r"heightmap .*h\.npy: values are missing; fill them"):
        sort(solid)
