"""Triangles from DAE, OBJ, STL and PLY files, by trimesh: in metres, z up.

Nothing in a file is trusted: its size is checked before it is decoded, XML with entities is refused, and
no other file that it names (materials, pictures) is looked at.
"""

import hashlib
import io
import re
import warnings
from pathlib import Path

import numpy as np

from harness.base.collada import UP, unit_and_axis
from harness.base.documents import read_bytes
from harness.base.errors import UsageError, find_named, told
from harness.base.made_of_files import Files, made_of_files
from harness.base.mesh import Mesh, joined

SUFFIXES = (".dae", ".obj", ".stl", ".ply")
MOST_BYTES = 128 * 2**20
MOST_TRIANGLES = 500_000
PLY_HEADER = 4096  # bytes that hold its counts
HEAD, FACE, LAST_LINE = 84, 50, 1000  # bytes of a binary STL's head and triangle; of a text's last line
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
        scale, axis = unit_and_axis(data) if path.suffix.lower() == ".dae" else (1.0, "z")
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
    is_text = data[:LAST_LINE].lstrip().lower().startswith(b"solid") and len(data) != end
    if b"endsolid" not in data[-LAST_LINE:].lower() if is_text else len(data) < end:
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
