"""What of a world's solids is its ground, and how far its map reaches.

Ground are level planes, heightmaps, and of meshes and boxes what is at least as wide and as deep as
the smallest map and has a twentieth of the largest such area or more. The rest stands on it.
"""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from harness.base.errors import UsageError
from harness.base.mesh import Mesh, areas_and_normals
from harness.base.mesh_file import read_mesh
from harness.spec.world import MESH_UNITS, SMALLEST_MAP
from harness.world.heightfield import resampled
from harness.world.heightmap.raster import Raster, read_raster
from harness.world.solid import MeshFile, Plane, Primitive, Relief, Solid
from harness.world.solids.pieces import bodies
from harness.world.solids.surface import ROUNDING, Bounds

SMALLEST_SHARE = 0.05  # of the largest ground's area
LEVEL = 0.9999  # upward part of the normal of a plane without end
LARGEST_PLANE = 150.0  # [m] of a plane without end that is mapped
MOST_LACKS = 5  # that a message names
GROUND = Plane((0.0, 0.0, 1.0), (100.0, 100.0))  # of models that stand in no world
MARGIN = 5.0  # [m] of it around what stands on it
MOST_SAMPLES = 513  # of a heightmap, along a side
BOX = np.array([[i & 1, i >> 1 & 1, i >> 2 & 1] for i in range(8)]) * 2.0 - 1.0
BOX_FACES = np.array(
    [
        [0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4],
        [2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5],
    ]
)  # fmt: skip


@dataclass
class Partition:
    """A world's solids, divided into its ground and what stands on it."""

    ground: list[Mesh] = field(default_factory=list)  # meshes, in the world
    # height of the highest level plane [m], if there is one; `mapped` are their bounds
    plane: float | None = None
    mapped: list[Bounds] = field(default_factory=list)
    # what stands on it, as a mesh in the world, with the solid that it comes from
    standing: list[tuple[Solid, Mesh]] = field(default_factory=list)
    # solids that are one shape each, of which none is ground
    primitives: list[Solid] = field(default_factory=list)
    grounds: list[Solid] = field(default_factory=list)  # solids that are ground, or some of them is
    hashes: dict[Path, str] = field(default_factory=dict)  # SHA-256 of the files that were read


def partition(
    solids: Sequence[Solid], notes: list[str], unit: str = "", up: str = "", *, is_loose: bool = False
) -> Partition:
    """Returns what is ground and what stands on it; UsageError if a file is unusable or none is ground.

    Args:
        solids: Of a world.
        notes: Takes what was done.
        unit: Of meshes; "" is as their files say.
        up: The axis of meshes that is up; "" is as their files say.
        is_loose: Whether solids without a ground are put on a level plane.
    """
    parts = Partition(grounds=[solid for solid in solids if isinstance(solid.shape, Plane | Relief)])
    candidates = list[tuple[Solid, Mesh]]()
    for solid in solids:
        match solid.shape:
            case Plane():
                _add_plane(parts, solid, solid.shape)
            case Relief():
                parts.ground.append(_of_relief(parts, solid, solid.shape))
            case MeshFile():
                whole = _of_file(parts, solid, solid.shape, unit, up)
                candidates += ((solid, body) for body in bodies(whole))
            case Primitive(shape="box") if _is_wide(box_mesh(solid)):
                candidates.append((solid, box_mesh(solid)))
            case _:
                parts.primitives.append(solid)
    areas = [_area(mesh) if _is_wide(mesh) else 0.0 for _, mesh in candidates]
    least = SMALLEST_SHARE * max(areas, default=0.0)
    for (solid, mesh), area in zip(candidates, areas, strict=True):
        if area > 0.0 and area >= least:
            parts.ground.append(_upright(mesh, solid, notes))
            parts.grounds.append(solid)
        elif isinstance(solid.shape, Primitive):
            parts.primitives.append(solid)
        else:
            parts.standing.append((solid, mesh))
    if not parts.ground and parts.plane is None:
        lacks = _left_out(notes)
        refused = "" if is_loose and solids else _groundless(solids, candidates, lacks)
        _put_on_plane(parts, notes, refused)
    return parts


def _put_on_plane(parts: Partition, notes: list[str], refused: str) -> None:
    if refused:
        raise UsageError(refused)
    _add_plane(parts, Solid("ground_plane", GROUND, np.eye(4)), GROUND)
    notes.append("its models stand in no world: put on a level plane")


def _groundless(solids: Sequence[Solid], candidates: list[tuple[Solid, Mesh]], lacks: str) -> str:
    if not solids:
        mend = lacks or "; give its models a <collision>"
        return f"nothing in it can be collided with{mend}"
    widest = max(
        (tuple(np.ptp(m.vertices[:, :2], axis=0)) for _, m in candidates), default=None, key=min
    )
    size = "" if widest is None else f" (the widest is {widest[0]:.3g} x {widest[1]:.3g} m)"
    return (
        f"it has no ground: neither a plane nor a heightmap, nor a mesh or box of {SMALLEST_MAP:g} x "
        f"{SMALLEST_MAP:g} m or more{size}; add a ground plane, or give the unit by --mesh-unit, "
        f"the axis by --mesh-up{lacks}"
    )


def _left_out(notes: Sequence[str]) -> str:
    """What a world without ground lacks: files, the ground's among them, before elements."""
    lacks = [note.removeprefix("left out: ") for note in notes if note.startswith("left out: ")]
    lacks.sort(key=lambda lack: lack.startswith("<"))
    more = f"; and {len(lacks) - MOST_LACKS} more" if len(lacks) > MOST_LACKS else ""
    return f"; left out: {'; '.join(lacks[:MOST_LACKS])}{more}" if lacks else ""


def map_bounds(parts: Partition) -> Bounds:
    """Returns how far the map reaches: the ground's meshes and, of a plane, what stands on it too."""
    points = [mesh.vertices[:, :2] for mesh in parts.ground]
    if parts.plane is not None:
        standing = [mesh.vertices[:, :2] for _, mesh in parts.standing]
        standing += [_corners(solid)[:, :2] for solid in parts.primitives]
        points += [p + side for p in standing for side in (-MARGIN, MARGIN)]
        points += [np.array([[x, y], [x_to, y_to]]) for x, x_to, y, y_to in parts.mapped]
    every = np.concatenate(points)
    (x, y), (x_to, y_to) = every.min(axis=0), every.max(axis=0)
    return float(x), float(x_to), float(y), float(y_to)


def box_mesh(solid: Solid) -> Mesh:
    """Returns a box's twelve triangles in the world."""
    assert isinstance(solid.shape, Primitive)  # noqa: S101 - the caller has looked
    return Mesh(BOX * solid.shape.half_size, BOX_FACES).moved(solid.pose)


def _corners(solid: Solid) -> NDArray[np.float64]:
    """Corners of a box around a primitive, in the world."""
    assert isinstance(solid.shape, Primitive)  # noqa: S101 - the caller has looked
    half = solid.shape.half_size
    half = (half[0], half[0], half[1]) if solid.shape.shape == "cylinder" else half
    return (BOX * half) @ solid.pose[:3, :3].T + solid.pose[:3, 3]


def _area(mesh: Mesh) -> float:
    """Seen from above or below, whichever is more [m2]."""
    seen = _seen(mesh)
    return max(float(seen[seen > 0.0].sum()), float(-seen[seen < 0.0].sum()))


def _seen(mesh: Mesh) -> NDArray[np.float64]:
    """Areas of the triangles seen from above [m2], shape (f,); negative where they face down."""
    areas, normals = areas_and_normals(mesh.corners)
    return areas * normals[:, 2]


def _is_wide(mesh: Mesh) -> bool:
    return bool((np.ptp(mesh.vertices[:, :2], axis=0) >= SMALLEST_MAP - ROUNDING).all())


def _upright(mesh: Mesh, solid: Solid, notes: list[str]) -> Mesh:
    """A sheet whose normals point down is turned over."""
    seen = _seen(mesh)
    if -seen[seen < 0.0].sum() <= 2.0 * seen[seen > 0.0].sum():
        return mesh
    notes.append(f"{solid.name}: its triangles face down; turned over")
    return Mesh(mesh.vertices, mesh.faces[:, ::-1])


def _add_plane(parts: Partition, solid: Solid, plane: Plane) -> None:
    normal = np.array(plane.normal) / np.linalg.norm(plane.normal)
    height = float(solid.pose[2, 3])
    if (solid.pose[:3, :3] @ normal)[2] >= LEVEL:
        parts.plane = height if parts.plane is None else max(height, parts.plane)
        half = [0.5 * min(length, LARGEST_PLANE) for length in plane.size]
        x, y = solid.pose[:2, 3].tolist()
        parts.mapped.append((x - half[0], x + half[0], y - half[1], y + half[1]))
        return
    signs = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * 0.5 * np.array(plane.size)
    turned, _ = Rotation.align_vectors(normal, (0.0, 0.0, 1.0))  # the shortest way, as Gazebo turns it
    corners = signs @ turned.as_matrix()[:, :2].T
    parts.ground.append(Mesh(corners, np.array([[0, 1, 2], [0, 2, 3]])).moved(solid.pose))


def _of_file(parts: Partition, solid: Solid, file: MeshFile, unit: str, up: str) -> Mesh:
    mesh, parts.hashes[file.path] = read_mesh(file.path, file.submesh, MESH_UNITS.get(unit, 0.0), up)
    if file.centred:
        low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
        mesh = Mesh(mesh.vertices - 0.5 * (low + high), mesh.faces)
    return mesh.moved(solid.pose, file.scale)


def _of_relief(parts: Partition, solid: Solid, relief: Relief) -> Mesh:
    """A heightmap as triangles, its first row in the north."""
    raster = read_raster(relief.path)
    parts.hashes[relief.path] = hashlib.sha256(relief.path.read_bytes()).hexdigest()
    values = raster.values
    if np.isnan(values).any():
        raise UsageError(f"heightmap {relief.path}: values are missing; fill them")
    width_depth, scale = _scaled(raster, relief)
    shape = tuple(min(count, MOST_SAMPLES) for count in values.shape)
    step = tuple((n - 1) / (m - 1) for n, m in zip(values.shape, shape, strict=True))
    values = resampled(values, step, shape) if shape != values.shape else values
    rows, columns = values.shape
    half_x, half_y = (0.5 * length for length in width_depth)
    x, y = np.meshgrid(np.linspace(-half_x, half_x, columns), np.linspace(half_y, -half_y, rows))
    vertices = np.column_stack([x.ravel(), y.ravel(), scale * values.ravel()]) + relief.position
    corner = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    below = corner + columns
    faces = np.concatenate(
        [np.column_stack([corner, below, below + 1]), np.column_stack([corner, below + 1, corner + 1])]
    )
    return Mesh(vertices, faces).moved(solid.pose)


def _scaled(raster: Raster, relief: Relief) -> tuple[tuple[float, float], float]:
    """Width and depth of a heightmap [m] and height of one of its values, as Gazebo has them.

    Its height is that of a picture's largest value, or the relief of a survey; without a size this is as
    it was measured.
    """
    extent = np.ptp(raster.values) if raster.in_metres else raster.values.max()
    if relief.size is not None:
        return relief.size[:2], relief.size[2] / float(extent) if extent > 0.0 else 1.0
    if not raster.in_metres:
        return (1.0, 1.0), 1.0 / float(extent or 1.0)
    if isinstance(raster.pixel, str):
        raise UsageError(f"heightmap {relief.path}: {raster.pixel}; give it a <size>")
    rows, columns = raster.values.shape
    return (raster.pixel[0] * (columns - 1), raster.pixel[1] * (rows - 1)), 1.0
