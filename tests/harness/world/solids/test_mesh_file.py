"""Meshes from files: units, axes, parts, and what is refused."""

import hashlib
import math
import os
import re
import struct
from pathlib import Path

import numpy as np
import pytest

from harness.errors import UsageError
from harness.world.solids import mesh_file
from harness.world.solids.mesh_file import Mesh, joined, read_mesh
from tests.harness.world.solids.shapes import box, write_dae, write_obj

BOX = box((1.0, 2.0, 3.0), (2.0, 4.0, 6.0))
LOW, HIGH = [0.0, 0.0, 0.0], [2.0, 4.0, 6.0]


def write_stl(path: Path, mesh: Mesh) -> Path:
    records = [struct.pack("<12fH", 0, 0, 0, *c.ravel().tolist(), 0) for c in mesh.corners]
    path.write_bytes(bytes(80) + struct.pack("<I", len(records)) + b"".join(records))
    return path


def volume(mesh: Mesh) -> float:
    return float(np.linalg.det(mesh.corners).sum() / 6.0)


@pytest.mark.parametrize("write", [write_stl, write_obj])
def test_a_box_is_read_with_its_vertices_shared(tmp_path: Path, write: object) -> None:
    path = write(tmp_path / ("a.stl" if write is write_stl else "a.obj"), BOX)  # type: ignore[operator]
    mesh, digest = read_mesh(path)
    assert (len(mesh.vertices), len(mesh.faces)) == (8, 12)
    np.testing.assert_allclose([mesh.vertices.min(0), mesh.vertices.max(0)], [LOW, HIGH])
    assert volume(mesh) == pytest.approx(48.0)
    assert digest == hashlib.sha256(path.read_bytes()).hexdigest()


def test_a_file_is_decoded_once_and_again_when_it_has_been_written_anew(tmp_path: Path) -> None:
    path = tmp_path / "a.obj"
    for second, mesh in enumerate((BOX, box((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))), start=1):
        os.utime(write_obj(path, mesh), (second, second))
        read, digest = read_mesh(path)
        assert volume(read) == pytest.approx(volume(mesh))
        assert digest == hashlib.sha256(path.read_bytes()).hexdigest()
        assert read_mesh(path)[0] is read


@pytest.mark.parametrize("prefix", ["", "c:"])
@pytest.mark.parametrize(
    ("up", "low", "high"),
    [
        ("Z_UP", [0, 0, 0.5], [2, 4, 6.5]),
        ("Y_UP", [0, -6.5, 0], [2, -0.5, 4]),
        ("X_UP", [-4, -6.5, 0], [0, -0.5, 2]),  # the file's y runs left, its z away from the viewer
    ],
)
def test_collada_is_turned_upright_and_scaled_to_metres(
    tmp_path: Path, up: str, low: list[float], high: list[float], prefix: str
) -> None:
    path = write_dae(tmp_path / "a.dae", BOX, "0.01", up)
    path.write_text(re.sub(r"(</?)(?=\w)", rf"\1{prefix}", path.read_text()))
    if prefix:
        path.write_text(path.read_text().replace("xmlns=", "xmlns:c="))
    mesh, _ = read_mesh(path)
    np.testing.assert_allclose(mesh.vertices.min(0), 0.01 * np.array(low), atol=1e-9)
    np.testing.assert_allclose(mesh.vertices.max(0), 0.01 * np.array(high), atol=1e-9)
    assert volume(mesh) == pytest.approx(48.0e-6)


def test_unit_and_axis_may_be_told_instead(tmp_path: Path) -> None:
    path = write_dae(tmp_path / "a.dae", BOX, "0.01", "Y_UP")
    for unit, length in {"m": 1.0, "cm": 0.01, "mm": 0.001, "ft": 0.3048, "in": 0.0254}.items():
        assert np.ptp(read_mesh(path, unit=unit)[0].vertices[:, 0]) == pytest.approx(2.0 * length)
    mesh, _ = read_mesh(path, unit="mm", up="z")
    np.testing.assert_allclose(mesh.vertices.max(0), [0.002, 0.004, 0.0065], atol=1e-12)


def test_a_part_is_found_by_its_name(tmp_path: Path) -> None:
    path = write_dae(tmp_path / "a.dae", BOX)
    assert len(read_mesh(path, submesh="g")[0].faces) == 12
    with pytest.raises(UsageError, match="its part 'm' does not exist; available: g"):
        read_mesh(path, submesh="m")


def test_mirrored_meshes_are_turned_inside_out_so_that_they_still_face_out() -> None:
    for scale, turned in (((1.0, 1.0, -2.0), np.eye(4)), ((1.0, 1.0, 2.0), np.diag([1.0, -1, 1, 1]))):
        assert volume(BOX.moved(turned, scale)) == pytest.approx(96.0)


def test_triangles_are_joined_at_the_same_corners_and_those_without_area_are_dropped() -> None:
    mesh = joined([BOX, BOX.moved(np.eye(4) + np.array([[0, 0, 0, 2.0]] + [[0] * 4] * 3))])
    assert (len(mesh.vertices), len(mesh.faces)) == (12, 24)
    for third in (0.0, 1.0):  # where the first corner is, or the second
        thin = Mesh(np.array([[0.0, 0, 0], [1, 0, 0], [third, 0, 1e-7]]), np.array([[0, 1, 2]]))
        assert not len(joined([thin]).faces)
    assert not len(joined([]).faces)


@pytest.mark.parametrize(
    ("name", "content", "told"),
    [
        ("a.fbx", b"x", "readable are .dae, .obj, .stl"),
        ("a.obj", b"", "it holds no triangles|damaged or cut short"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv nan 1 0\nf 1 2 3\n", "1 of its vertices are NaN or infinite"),
        ("a.stl", bytes(80) + struct.pack("<I12fH", 1, *[math.inf] * 12, 0), "its vertices are NaN"),
        ("a.stl", b"solid x\nfacet", "damaged or cut short|no triangles"),
        ("a.dae", b"<COLLADA/>", "damaged or cut short: .+ .+"),  # the reason in words
        ("a.dae", b"<!DOCTYPE a [<!ENTITY b 'c'>]><COLLADA/>", "declares a document type"),
        ("a.dae", b"<COLLADA><asset><unit meter='-1'/></asset></COLLADA>", "unit of -1 m is not valid"),
        ("a.dae", b"<COLLADA><asset><unit meter='x'/></asset></COLLADA>", "unit of x m is not valid"),
        ("a.dae", b"<COLLADA><asset><up_axis>W_UP</up_axis></asset></COLLADA>", "up_axis 'W_UP' is not"),
    ],
)
def test_what_is_no_mesh_is_refused_in_one_line(
    tmp_path: Path, name: str, content: bytes, told: str
) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(UsageError, match=told) as raised:
        read_mesh(tmp_path / name)
    assert "\n" not in str(raised.value)
    assert str(raised.value).startswith(f"mesh {tmp_path / name}: ")


def test_too_many_triangles_and_missing_files_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(mesh_file, "MOST_TRIANGLES", 11)
    for write in (write_dae, write_obj, write_stl):
        path = write(tmp_path / f"a.{write.__name__[-3:]}", BOX)
        with pytest.raises(UsageError, match=r"it has 12 triangles; at most 11 are read: simplify it"):
            read_mesh(path)
        monkeypatch.setattr(mesh_file, "_loaded", None)  # those of the others are counted before
    monkeypatch.setattr(mesh_file, "MOST_BYTES", 100)
    with pytest.raises(UsageError, match="larger than 0 MiB; simplify"):
        read_mesh(tmp_path / "a.stl")
    with pytest.raises(UsageError, match=r"cannot be read: No such file"):
        read_mesh(tmp_path / "b.stl")
