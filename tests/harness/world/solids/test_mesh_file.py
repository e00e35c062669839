"""Meshes from files: units, axes, parts, and what is refused."""

import hashlib
import math
import os
import re
import struct
from pathlib import Path

import numpy as np
import pytest

from harness.base import mesh_file
from harness.base.errors import UsageError
from harness.base.mesh import Mesh, joined
from harness.base.mesh_file import read_mesh
from tests.harness.world.solids.shapes import at, box, write_dae, write_mesh

BOX = box((1.0, 2.0, 3.0), (2.0, 4.0, 6.0))
LOW, HIGH = [0.0, 0.0, 0.0], [2.0, 4.0, 6.0]


def volume(mesh: Mesh) -> float:
    return float(np.linalg.det(mesh.corners).sum() / 6.0)


@pytest.mark.parametrize("name", ["a.stl", "a.OBJ", "a.ply"])
def test_a_box_is_read_with_its_vertices_shared(tmp_path: Path, name: str) -> None:
    path = write_mesh(tmp_path / name, BOX)
    mesh, digest = read_mesh(path)
    assert (len(mesh.vertices), len(mesh.faces)) == (8, 12)
    np.testing.assert_allclose([mesh.vertices.min(0), mesh.vertices.max(0)], [LOW, HIGH])
    assert volume(mesh) == pytest.approx(48.0)
    assert digest == hashlib.sha256(path.read_bytes()).hexdigest()


def test_a_file_is_decoded_once_and_again_when_it_has_been_written_anew(tmp_path: Path) -> None:
    path = tmp_path / "a.obj"
    for second, mesh in enumerate((BOX, box((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))), start=1):
        os.utime(write_mesh(path, mesh), (second, second))
        read, digest = read_mesh(path)
        assert volume(read) == pytest.approx(volume(mesh))
        assert digest == hashlib.sha256(path.read_bytes()).hexdigest()
        assert read_mesh(path)[0] is read


@pytest.mark.parametrize("prefix", ["", "c:"])
@pytest.mark.parametrize(
    ("asset", "unit", "low", "high"),
    [
        ("<unit meter='0.01'/><up_axis>Z_UP</up_axis>", 0.01, [0, 0, 0.5], [2, 4, 6.5]),
        ("<unit meter='2'/><up_axis> y_up </up_axis>", 2.0, [0, -6.5, 0], [2, -0.5, 4]),
        ("<unit/><up_axis>X_UP</up_axis>", 1.0, [-4, -6.5, 0], [0, -0.5, 2]),  # y runs left, z away
        ("", 1.0, [0, -6.5, 0], [2, -0.5, 4]),  # Y_UP
    ],
)
def test_collada_is_turned_upright_and_scaled_to_metres(
    tmp_path: Path, asset: str, unit: float, low: list[float], high: list[float], prefix: str
) -> None:
    text = write_dae(path := tmp_path / "a.DAE", BOX, asset).read_text()
    path.write_text(
        re.sub(r"(</?)(?=\w)", rf"\1{prefix}", text).replace("xmlns=", f"xmlns{':c' * bool(prefix)}=")
    )
    mesh, _ = read_mesh(path)
    bounds = np.array([mesh.vertices.min(0), mesh.vertices.max(0)])
    np.testing.assert_allclose(bounds / unit, [low, high], atol=1e-7)
    assert volume(mesh) == pytest.approx(48.0 * unit**3)
    assert volume(read_mesh(path, unit=0.01)[0]) == pytest.approx(48e-6), "what is told wins"


def test_a_part_is_found_by_its_name_and_a_shape_that_stands_in_two_places_is_there_twice(
    tmp_path: Path,
) -> None:
    path = write_dae(tmp_path / "a.dae", BOX)
    (node,) = re.findall("<node .*</node>", path.read_text())
    other = node.replace("'n'", "'o'").replace("0 0 0.5", "9 0 0")
    path.write_text(path.read_text().replace(node, node + other))
    both = read_mesh(path)[0]
    assert (len(both.faces), both.vertices[:, 0].max()) == (24, 11.0)
    assert len(read_mesh(path, submesh="g")[0].faces) == 12
    with pytest.raises(UsageError, match="its part 'm' does not exist; available: g"):
        read_mesh(path, submesh="m")


def test_meshes_are_scaled_along_their_own_axes_and_mirrored_ones_still_face_out() -> None:
    for scale, turned, low, high in (
        ((1.0, 1.0, -2.0), np.eye(4), (0, 0, -12), (2, 4, 0)),
        ((1.0, 1.0, 2.0), np.diag([1.0, -1, 1, 1]), (0, -4, 0), (2, 0, 12)),
        ((1.0, 2.0, 1.0), at(5.0, 0, 0, 0, 0, 0.5 * math.pi), (-3, 0, 0), (5, 2, 6)),
    ):
        mesh = BOX.moved(turned, scale)
        assert volume(mesh) == pytest.approx(96.0)
        np.testing.assert_allclose([mesh.vertices.min(0), mesh.vertices.max(0)], [low, high], atol=1e-9)


def test_triangles_are_joined_at_the_same_corners_and_those_without_area_are_dropped() -> None:
    mesh = joined([BOX, BOX.moved(np.eye(4) + np.array([[0, 0, 0, 2.0]] + [[0] * 4] * 3))])
    assert (len(mesh.vertices), len(mesh.faces)) == (12, 24)
    for third in (0.0, 1.0):  # where the first corner is, or the second
        thin = Mesh(np.array([[0.0, 0, 0], [1, 0, 0], [third, 0, 1e-7]]), np.array([[0, 1, 2]]))
        assert not len(joined([thin]).faces)
    assert not len(joined([]).faces)


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("a.fbx", b"x", "readable are .dae, .obj, .stl"),
        ("a.obj", b"", "it holds no triangles|damaged or cut short"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv nan 1 0\nf 1 2 3\n", "1 of its vertices are NaN or infinite"),
        ("a.stl", bytes(80) + struct.pack("<I12fH", 1, *[math.inf] * 12, 0), "its vertices are NaN"),
        ("a.dae", b"<COLLADA/>", "damaged or cut short: .+ .+"),  # the reason in words
        ("a.dae", b"<!DOCTYPE a [<!ENTITY b 'c'>]><COLLADA/>", "declares a document type"),
        ("a.dae", b"<COLLADA><asset><unit meter='-1'/></asset></COLLADA>", "unit of -1 m is not valid"),
        ("a.dae", b"<COLLADA><asset><unit meter='1e6'/></asset></COLLADA>", "unit of 1e6 m is"),
        ("a.dae", b"<COLLADA><asset><up_axis>W_UP</up_axis></asset></COLLADA>", "up_axis 'W_UP' is not"),
    ],
)
def test_what_is_no_mesh_is_refused_in_one_line(
    tmp_path: Path, name: str, content: bytes, said: str
) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(UsageError, match=said) as raised:
        read_mesh(tmp_path / name)
    assert "\n" not in str(raised.value)
    assert str(raised.value).startswith(f"mesh {tmp_path / name}: ")


def test_too_many_triangles_and_missing_files_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(mesh_file, "MOST_TRIANGLES", 11)
    for name, write in (("a.dae", write_dae), ("a.obj", write_mesh), ("a.stl", write_mesh)):
        path = write(tmp_path / name, BOX)
        with pytest.raises(UsageError, match=r"it has 12 triangles; at most 11 are read: simplify it"):
            read_mesh(path)
        monkeypatch.setattr(mesh_file, "_loaded", None)  # those of the others are counted before
    monkeypatch.setattr(mesh_file, "MOST_BYTES", 100)
    with pytest.raises(UsageError, match="larger than 100 bytes"):
        read_mesh(tmp_path / "a.stl")
    with pytest.raises(UsageError, match=r"cannot read .*: No such file"):
        read_mesh(tmp_path / "b.stl")
