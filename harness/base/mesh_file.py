"""Triangles from DAE, OBJ, STL and PLY files, by trimesh: in metres, z up.

Nothing in a file is trusted: its size is checked before it is decoded, XML with entities is refused, and
no other file that it names (materials, pictures) is looked at.
"""

import hashlib
import io
import re
import warnings
from dataclasses import dataclass
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np
from numpy.typing import NDArray

from harness.base.documents import read_bytes
from harness.base.errors import UsageError, find_named, told
from harness.base.made_of_files import Files, made_of_files
from harness.base.xml import DEEPEST, parse_xml
from rover_metrics.number import number

SUFFIXES = (".dae", ".obj", ".stl", ".ply")
MOST_BYTES = 128 * 2**20
MOST_TRIANGLES = 500_000
PLY_HEADER = 4096  # bytes that hold its counts
HEAD, FACE, LAST_LINE = 84, 50, 1000  # bytes of a binary STL's head and triangle; of a text's last line
MOST_SHAPES = 5_000  # of a scene, each as often as it stands there
# What axis is up in a file -> R_world_file, as COLLADA defines its three.
UP = {
    "z": np.eye(3),
    "y": np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]),
    "x": np.array([[0.0, -1.0, 0.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]]),
}
SIMPLER = "simplify it first (Blender: Decimate; MeshLab: Quadric Edge Collapse)"


def is_mesh(path: Path) -> bool:
    """Returns whether a file is a mesh by its suffix or, of PLY, by its 1 to MOST_TRIANGLES faces."""
    if path.suffix.lower() != ".ply":
        return path.suffix.lower() in SUFFIXES
    if not path.is_file():
        return False
    with path.open("rb") as file:
        faces = re.search(rb"element face (\d{1,12})", file.read(PLY_HEADER))
    return faces is not None and 0 < int(faces[1]) <= MOST_TRIANGLES


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


@made_of_files(8)  # a world names a file many times
def read_mesh(
    path: Path, submesh: str = "", unit: float = 0.0, up: str = ""
) -> tuple[tuple[Mesh, str], Files]:
    """Returns the triangles of a file and the SHA-256 of what was read; UsageError if it is unusable.

    Args:
        path: The file, whose name tells what it is.
        submesh: The name of the only part that is meant; "" for all.
        unit: Its length [m]; 0 is as the file says, else 1.
        up: One of UP; "" is as the file says, else z.
    """
    if path.suffix.lower() not in SUFFIXES:
        kinds = ", ".join(SUFFIXES)
        raise UsageError(f"mesh {path}: meshes of that kind are not read; readable are {kinds}")
    content = read_bytes(path, MOST_BYTES)
    try:
        data = _without_more(content) if path.suffix.lower() == ".stl" else content
        _check_coded(data, path.suffix.lower())
        scale, axis = _unit_and_axis(data) if path.suffix.lower() == ".dae" else (1.0, "z")
        parts = _loaded(data, path.suffix.lower())
        mesh = joined([find_named("its part", submesh, parts)] if submesh else [*parts.values()])
        _check(mesh)
    except UsageError as error:
        raise UsageError(f"mesh {path}: {error}") from error
    turned = np.eye(4)
    turned[:3, :3] = UP[up or axis]
    metres = mesh.moved(turned, (unit or scale,) * 3)
    return (metres, hashlib.sha256(content).hexdigest()), [path]


def _without_more(data: bytes) -> bytes:
    """An STL file as far as its triangles go; UsageError if there are fewer than it says."""
    end = HEAD + FACE * int.from_bytes(data[HEAD - 4 : HEAD], "little")
    is_text = data.lstrip().startswith(b"solid") and len(data) != end
    if b"endsolid" not in data[-LAST_LINE:] if is_text else len(data) < end:
        raise UsageError("it is damaged or cut short; export it anew")
    return data if is_text else data[:end]


def _check_coded(data: bytes, suffix: str) -> None:
    faces = int.from_bytes(data[HEAD - 4 : HEAD], "little")
    stl = faces if len(data) == HEAD + FACE * faces else data.count(b"endfacet")
    counts = {".obj": data.count(b"\nf "), ".stl": stl}
    _check_count(counts.get(suffix, 0))  # before anything is decoded


def _check_count(triangles: int) -> None:
    if triangles > MOST_TRIANGLES:
        raise UsageError(
            f"it has {triangles:,} triangles; at most {MOST_TRIANGLES:,} are read: {SIMPLER}"
        )


def _unit_and_axis(data: bytes) -> tuple[float, str]:
    """What the asset of a COLLADA file says: length of its unit [m], axis that is up."""
    root = parse_xml(data)
    _check_shapes(root)
    asset = {_tag(element): element for element in next((e for e in root if _tag(e) == "asset"), ())}
    up = (asset["up_axis"].text or "") if "up_axis" in asset else "Y_UP"  # COLLADA's default
    text = asset["unit"].get("meter", "1") if "unit" in asset else "1"
    try:
        unit = number(text)
    except ValueError:
        unit = 0.0
    if not 0.0 < unit < 1e6:
        raise UsageError(f"its unit of {text} m is not valid; give a length in metres")
    axis = up.strip().lower().removesuffix("_up")
    if axis not in UP:
        raise UsageError(f"its up_axis '{up.strip()}' is not valid; COLLADA has X_UP, Y_UP and Z_UP")
    return unit, axis


def _tag(element: Element) -> str:
    return element.tag.rpartition(":")[2]  # expat leaves prefixes as they are


def _check_shapes(root: Element) -> None:
    """Counts the shapes of COLLADA scenes, in which nodes stand in other nodes as often as they like."""
    nodes = {element.get("id", ""): element for element in root.iter() if _tag(element) == "node"}
    known: dict[str, int] = {}

    def count(element: Element, depth: int) -> int:
        if depth > DEEPEST:
            raise UsageError(f"its nodes stand in themselves, or more than {DEEPEST} in each other")
        total = 0
        for child in element:
            if _tag(child) == "node":
                total += count(child, depth + 1)
            elif _tag(child) == "instance_node" and (url := child.get("url", "")[1:]) in nodes:
                if url not in known:
                    known[url] = count(nodes[url], depth + 1)
                total += known[url]
            total += _tag(child) in ("instance_geometry", "instance_controller")
        return total

    shapes = sum(count(element, 0) for element in root.iter() if _tag(element) == "visual_scene")
    if shapes > MOST_SHAPES:
        raise UsageError(f"its scene has {shapes:,} shapes; at most {MOST_SHAPES:,} are read: join them")


def _loaded(data: bytes, kind: str) -> dict[str, Mesh]:
    """Its parts by name, each where the file's own scene has it."""
    import trimesh  # noqa: PLC0415 - 0.2 s that other terrains save

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            scene = trimesh.load_scene(
                io.BytesIO(data), file_type=kind, process=False, skip_materials=True
            )
            parts, triangles = {}, 0
            for node in scene.graph.nodes_geometry:
                pose, name = scene.graph[node]
                geometry = scene.geometry[name]
                if isinstance(geometry, trimesh.Trimesh):
                    _check_count(triangles := triangles + len(geometry.faces))
                    mesh = Mesh(np.asarray(geometry.vertices), np.asarray(geometry.faces))
                    parts[str(node)] = mesh.moved(np.asarray(pose))
    except UsageError:
        raise
    except Exception as error:  # decoders raise anything at all over a damaged file
        raise UsageError(f"it is damaged or cut short: {told(error)}") from error
    return parts


def _check(mesh: Mesh) -> None:
    _check_count(len(mesh.faces))
    finite = np.isfinite(mesh.vertices).all(axis=1)
    if not finite.all():
        raise UsageError(f"{int((~finite).sum())} of its vertices are NaN or infinite; mend the file")
    if not len(mesh.faces):
        raise UsageError("it holds no triangles")
