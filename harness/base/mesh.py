"""Triangles that share vertices: moved, joined, measured."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles that share vertices; seen from outside, their corners go round counter-clockwise."""

    vertices: NDArray[np.float64]  # shape (v, 3) [m]
    faces: NDArray[np.int64]  # indices of vertices, shape (f, 3)

    @property
    def corners(self) -> NDArray[np.float64]:
        """Shape (f, 3, 3): triangle, corner, coordinate."""
        return self.vertices[self.faces]

    def moved(self, pose: NDArray[np.float64], scale: tuple[float, ...] = (1.0,) * 3) -> "Mesh":
        """Returns it scaled, then moved by a T_world_mesh; mirrored ones are turned inside out."""
        vertices = (self.vertices * scale) @ pose[:3, :3].T + pose[:3, 3]
        is_mirrored = np.linalg.det(pose[:3, :3]) * np.prod(scale) < 0.0
        return Mesh(vertices, self.faces[:, ::-1] if is_mirrored else self.faces)

    def part(self, chosen: NDArray[np.int64] | NDArray[np.bool_]) -> "Mesh":
        """Returns some of its triangles with the vertices of these alone."""
        faces = self.faces[chosen]
        is_used = np.zeros(len(self.vertices), np.bool_)
        is_used[faces] = True
        return Mesh(self.vertices[is_used], (np.cumsum(is_used) - 1)[faces])


def areas_and_normals(corners: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Returns areas [m2] and unit normals, or 0 without an area, of triangles, shape (f, 3, 3)."""
    doubled = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(doubled, axis=1)
    return 0.5 * lengths, doubled / np.maximum(lengths, 1e-300)[:, None]


def joined(meshes: "list[Mesh]") -> Mesh:
    """Returns all triangles as one mesh; corners at the same place, to 10 um, become one vertex."""
    if not meshes:
        return Mesh(np.empty((0, 3)), np.empty((0, 3), np.int64))
    starts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes[:-1])])
    vertices = np.concatenate([mesh.vertices for mesh in meshes])
    faces = np.concatenate([m.faces + start for m, start in zip(meshes, starts, strict=True)])
    _, first, same = np.unique(np.round(vertices, 5), axis=0, return_index=True, return_inverse=True)
    faces = same.reshape(-1)[faces]
    edges = np.sort(faces, axis=1)
    has_area = (edges[:, 0] != edges[:, 1]) & (edges[:, 1] != edges[:, 2])
    return Mesh(vertices[first], faces[has_area])
