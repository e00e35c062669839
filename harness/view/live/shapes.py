"""What is seen of a MuJoCo model, as textured triangles: a glTF of each body that moves by itself."""

import math
from collections import defaultdict
from collections.abc import Mapping

import mujoco
import numpy as np
import trimesh
from numpy.typing import NDArray
from PIL import Image
from trimesh.visual import TextureVisuals
from trimesh.visual.material import PBRMaterial

from harness.physics.stage import visible_groups
from harness.physics.world_geoms import UNPAINTED

MOST_VERTICES = 250_000  # of a ground: of larger ones every other is shown, or fewer
SLICES = 24  # of everything round
ENDLESS = 100.0  # [m] of a plane without an end
WORLD = 0  # the body of what stands still
ROUGHNESS = 0.95  # of all surfaces: nothing here shines

Array = NDArray[np.float64]
Surface = tuple[Array, NDArray[np.int64], Array | None, Array | None]  # vertices, faces, normals, (u, v)


def gltf_of_bodies(model: mujoco.MjModel, data: mujoco.MjData) -> Mapping[int, bytes]:
    """Returns the glTF binary (GLB) of what is seen of each body, in its frame, by the body's number.

    What is fixed to a body is part of it; what stands still is part of body 0.

    Args:
        model: A dressed scene.
        data: Its state, with kinematics up to date.
    """
    seen = visible_groups().geomgroup
    scenes: dict[int, trimesh.Scene] = defaultdict(trimesh.Scene)
    for geom in range(model.ngeom):
        if seen[model.geom_group[geom]] and _color(model, geom)[3] > 0.0:
            body = carrier(model, int(model.geom_bodyid[geom]))
            placed = _in_body(data, body, geom)
            scenes[body].add_geometry(_painted(model, geom), transform=placed)
    return {body: bytes(scene.export(file_type="glb")) for body, scene in scenes.items()}  # type: ignore[no-untyped-call] # trimesh half types itself


def carrier(model: mujoco.MjModel, body: int) -> int:
    """Returns the body that a body moves with: itself, or what it is fixed to."""
    return body if model.body_mocapid[body] >= 0 else int(model.body_weldid[body])


def _in_body(data: mujoco.MjData, body: int, geom: int) -> Array:
    """The pose of a geom in a body's frame, shape (4, 4)."""
    turned = data.xmat[body].reshape(3, 3)
    pose = np.eye(4)
    pose[:3, :3] = turned.T @ data.geom_xmat[geom].reshape(3, 3)
    pose[:3, 3] = turned.T @ (data.geom_xpos[geom] - data.xpos[body])
    return pose


def _painted(model: mujoco.MjModel, geom: int) -> trimesh.Trimesh:
    vertices, faces, normals, uv = _surface(model, geom)
    mesh = trimesh.Trimesh(vertices, faces, vertex_normals=normals, process=False)
    color, image = _color(model, geom), _image(model, geom)
    material = PBRMaterial(  # type: ignore[no-untyped-call]
        baseColorFactor=np.round(255 * color).astype(np.uint8),
        baseColorTexture=image if uv is not None else None,
        metallicFactor=0.0,
        roughnessFactor=ROUGHNESS,
        alphaMode="OPAQUE" if color[3] >= 1.0 else "BLEND",
        doubleSided=True,
    )
    mesh.visual = TextureVisuals(uv=uv, material=material)  # type: ignore[no-untyped-call]
    return mesh


def _color(model: mujoco.MjModel, geom: int) -> Array:
    """RGBA from 0 to 1: of the geom, or of its material if it has none of its own."""
    own, material = model.geom_rgba[geom], int(model.geom_matid[geom])
    color = model.mat_rgba[material] if material >= 0 and np.allclose(own, UNPAINTED) else own
    return np.asarray(color, np.float64)


def _image(model: mujoco.MjModel, geom: int) -> Image.Image | None:
    """The texture of a geom; None without one."""
    material = int(model.geom_matid[geom])
    texture = -1 if material < 0 else int(model.mat_texid[material, mujoco.mjtTextureRole.mjTEXROLE_RGB])
    if texture < 0 or model.tex_type[texture] != mujoco.mjtTexture.mjTEXTURE_2D:
        return None
    shape = model.tex_height[texture], model.tex_width[texture], model.tex_nchannel[texture]
    at = int(model.tex_adr[texture])
    return Image.fromarray(model.tex_data[at : at + math.prod(shape)].reshape(shape)).transpose(
        Image.Transpose.FLIP_TOP_BOTTOM
    )


def _surface(model: mujoco.MjModel, geom: int) -> Surface:
    """The triangles of a geom in its own frame."""
    kind, size = mujoco.mjtGeom(model.geom_type[geom]), model.geom_size[geom]
    if kind == mujoco.mjtGeom.mjGEOM_HFIELD:
        return _ground(model, geom)
    if kind == mujoco.mjtGeom.mjGEOM_MESH:
        return _mesh(model, int(model.geom_dataid[geom]))
    made = _solid(kind, size)
    return made.vertices, made.faces, None, None


def _solid(kind: mujoco.mjtGeom, size: Array) -> trimesh.Trimesh:
    (radius, half, _), make = size.tolist(), trimesh.creation
    solid: trimesh.Trimesh
    match kind:
        case mujoco.mjtGeom.mjGEOM_BOX:
            solid = make.box(2.0 * size)
        case mujoco.mjtGeom.mjGEOM_CYLINDER:
            solid = make.cylinder(radius, 2.0 * half, SLICES)
        case mujoco.mjtGeom.mjGEOM_CAPSULE:
            solid = make.capsule(2.0 * half, radius, count=(SLICES, SLICES))
        case mujoco.mjtGeom.mjGEOM_PLANE:
            solid = make.box([2.0 * radius or ENDLESS, 2.0 * half or ENDLESS, 0.01])
        case _:
            solid = make.icosphere(3, 1.0).apply_scale(size if half else radius)
    return solid


def _mesh(model: mujoco.MjModel, mesh: int) -> Surface:
    """A mesh with the normals that MuJoCo has for its corners, which no two faces share."""
    start, count = int(model.mesh_faceadr[mesh]), int(model.mesh_facenum[mesh])
    rows = slice(start, start + count)

    def corners(values: Array, first: NDArray[np.int32], of_faces: NDArray[np.int32]) -> Array:
        return np.asarray(values[int(first[mesh]) + of_faces[rows].ravel()], np.float64)

    uv = None
    if model.mesh_texcoordadr[mesh] >= 0:
        uv = corners(model.mesh_texcoord, model.mesh_texcoordadr, model.mesh_facetexcoord)
    return (
        corners(model.mesh_vert, model.mesh_vertadr, model.mesh_face),
        np.arange(3 * count).reshape(-1, 3),
        corners(model.mesh_normal, model.mesh_normaladr, model.mesh_facenormal),
        uv,
    )


def _ground(model: mujoco.MjModel, geom: int) -> Surface:
    """A heightfield, split along (row, column)-(row+1, column+1) as MuJoCo's is."""
    field, material = int(model.geom_dataid[geom]), int(model.geom_matid[geom])
    rows, columns = int(model.hfield_nrow[field]), int(model.hfield_ncol[field])
    half_x, half_y, top, _ = model.hfield_size[field]
    at = int(model.hfield_adr[field])
    heights = top * np.asarray(model.hfield_data[at : at + rows * columns], np.float64)
    stride = max(1, math.ceil(math.sqrt(rows * columns / MOST_VERTICES)))
    row, column = _thinned(rows, stride), _thinned(columns, stride)
    z = heights.reshape(rows, columns)[np.ix_(row, column)]
    u, v = np.meshgrid(column / (columns - 1), row / (rows - 1))
    x, y = half_x * (2.0 * u - 1.0), half_y * (2.0 * v - 1.0)
    slope_y, slope_x = np.gradient(z, y[:, 0], x[0])
    normals = np.dstack([-slope_x, -slope_y, np.ones_like(z)])
    normals /= np.linalg.norm(normals, axis=2, keepdims=True)
    repeat = model.mat_texrepeat[material] if material >= 0 else (1.0, 1.0)
    vertices, uv = np.dstack([x, y, z]), np.dstack([u * repeat[0], v * repeat[1]])
    corner = np.arange(z.size).reshape(z.shape)
    here, right, above, far = corner[:-1, :-1], corner[:-1, 1:], corner[1:, :-1], corner[1:, 1:]
    faces = np.concatenate([np.dstack([here, right, far]), np.dstack([here, far, above])])
    return vertices.reshape(-1, 3), faces.reshape(-1, 3), normals.reshape(-1, 3), uv.reshape(-1, 2)


def _thinned(count: int, stride: int) -> NDArray[np.int64]:
    """Every `stride`-th of some indices, the last one among them."""
    return np.unique(np.append(np.arange(0, count, stride), count - 1))
