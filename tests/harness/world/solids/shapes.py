"""Meshes written down for tests."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from harness.base.mesh import Mesh, joined

Array = NDArray[np.float64]


def sheet(
    height: Callable[[Array, Array], Array],
    half_x: float = 10.0,
    half_y: float = 10.0,
    step: float = 1.0,
) -> Mesh:
    """An open sheet that faces up, with a height for x and y [m]."""
    xs, ys = (np.arange(-half, half + 1e-9, step) for half in (half_x, half_y))
    x, y = np.meshgrid(xs, ys)
    vertices = np.column_stack([x.ravel(), y.ravel(), height(x, y).ravel()])
    first = (np.arange(len(ys) - 1)[:, None] * len(xs) + np.arange(len(xs) - 1)).ravel()
    above = first + len(xs)
    faces = [np.column_stack(c) for c in ((first, first + 1, above + 1), (first, above + 1, above))]
    return Mesh(vertices, np.concatenate(faces))


def flat(height: float = 0.0, half_x: float = 10.0, half_y: float = 10.0) -> Mesh:
    """Two triangles that face up."""
    corners = [(-half_x, -half_y), (half_x, -half_y), (half_x, half_y), (-half_x, half_y)]
    return Mesh(np.array([(x, y, height) for x, y in corners]), np.array([(0, 1, 2), (0, 2, 3)]))


def box(middle: tuple[float, float, float], size: tuple[float, float, float]) -> Mesh:
    """A closed box whose triangles face out: sides by hand, so that no code under test makes them."""
    around = ((-1, -1), (1, -1), (1, 1), (-1, 1))
    corners = 0.5 * np.array(size) * [(x, y, z) for z in (-1, 1) for x, y in around]
    quads = ((3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
    faces = [face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))]
    return Mesh(corners + middle, np.array(faces))


def both(*meshes: Mesh) -> Mesh:
    return joined([*meshes])


def at(x: float, y: float, z: float, *turned: float) -> Array:
    """T_world_thing of a place [m] and angles about fixed x, y, z [rad]."""
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = Rotation.from_euler("xyz", turned or (0, 0, 0)).as_matrix(), (x, y, z)
    return pose


def write_mesh(path: Path, mesh: Mesh) -> Path:
    """An OBJ or STL file, by its name."""
    trimesh.Trimesh(mesh.vertices, mesh.faces, process=False).export(path)
    return path


def write_dae(path: Path, mesh: Mesh, asset: str = "<up_axis>Z_UP</up_axis>") -> Path:
    points = " ".join(f"{value:.9g}" for value in mesh.vertices.ravel().tolist())
    indices = " ".join(map(str, mesh.faces.ravel().tolist()))
    axes = "".join(f"<param name='{name}' type='float'/>" for name in "XYZ")
    path.write_text(
        "<COLLADA xmlns='http://www.collada.org/2005/11/COLLADASchema' version='1.4.1'>"
        f"<asset>{asset}</asset>"
        "<library_geometries><geometry id='g'><mesh>"
        f"<source id='p'><float_array id='a' count='{mesh.vertices.size}'>{points}</float_array>"
        f"<technique_common><accessor source='#a' count='{len(mesh.vertices)}' stride='3'>{axes}"
        "</accessor></technique_common></source>"
        "<vertices id='v'><input semantic='POSITION' source='#p'/></vertices>"
        f"<triangles count='{len(mesh.faces)}'><input semantic='VERTEX' source='#v' offset='0'/>"
        f"<p>{indices}</p></triangles></mesh></geometry></library_geometries>"
        "<library_visual_scenes><visual_scene id='s'><node id='n'><translate>0 0 0.5</translate>"
        "<instance_geometry url='#g'/></node></visual_scene></library_visual_scenes>"
        "<scene><instance_visual_scene url='#s'/></scene></COLLADA>"
    )
    return path
