"""A target from an OBJ file: convex bodies that are met, and triangles with a picture that are seen."""

import hashlib
import io
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
from PIL import Image

from harness.base.collada import UP
from harness.base.documents import read_bytes
from harness.base.errors import UsageError
from harness.base.mesh_file import MOST_BYTES, read_mesh
from harness.spec.target import TargetSpec
from harness.world.heightfield import Heightfield
from harness.world.obstacles import Obstacle, ObstacleKind
from harness.world.solids.pieces import obstacles_of
from harness.world.targets.forms import Place, Points, Skin

MOST_PIXELS = 4096 * 4096
LARGEST_IMAGE = 64 * 2**20  # bytes
GREY = (0.5, 0.5, 0.5, 1.0)
Files = tuple[tuple[str, str], ...]


def mesh_target(
    spec: TargetSpec, place: Place, ground: Heightfield
) -> tuple[tuple[Obstacle, ...], tuple[Skin, ...], Files]:
    """Returns bodies, skins and files of a mesh whose lowest point stands on the ground.

    Args:
        spec: Names the file; scale, up and texture.
        place: x, y, z of the ground [m], yaw [rad].
        ground: Around it.

    Raises:
        UsageError: A file is not readable, or nothing of it rises above the ground.
    """
    options, path = spec.options, Path(spec.file)
    mesh, digest = read_mesh(path, up=options.up)
    x, y, z, yaw = place
    lowest = options.scale * float(mesh.vertices[:, 2].min())
    pose, (cos, sin) = np.eye(4), (math.cos(yaw), math.sin(yaw))
    pose[:2, :2], pose[:3, 3] = [[cos, -sin], [sin, cos]], (x, y, z - lowest)
    moved = mesh.moved(pose, (options.scale,) * 3)
    bodies = tuple(
        replace(body, kind=ObstacleKind.HAZARD, color=GREY)
        for body in obstacles_of(moved, ground, lambda _: ObstacleKind.HAZARD, 0.0)
    )
    if not bodies:
        raise UsageError(f"mesh {path}: nothing of it rises above the ground; check scale and up")
    if not options.texture:
        return bodies, (), ((str(path), digest),)
    image, of_image = _picture(Path(options.texture))
    skins = _skins(path, UP[options.up], options.scale, pose, image)
    return bodies, skins, ((str(path), digest), (options.texture, of_image))


def _picture(path: Path) -> tuple[np.ndarray, str]:
    """A picture as RGB, and the SHA-256 of its file."""
    data = read_bytes(path, LARGEST_IMAGE)
    try:
        with Image.open(io.BytesIO(data)) as image:
            is_large = image.width * image.height > MOST_PIXELS
            pixels = np.zeros(0) if is_large else np.asarray(image.convert("RGB"))
    except Exception as error:  # decoders raise anything at all over a damaged file
        raise UsageError(f"texture {path} is no picture that can be read; give a PNG or JPEG") from error
    if is_large:
        raise UsageError(f"texture {path} has more than {MOST_PIXELS:,} pixels; make it smaller")
    return pixels, hashlib.sha256(data).hexdigest()


def _skins(
    path: Path, turned: Points, scale: float, pose: Points, image: np.ndarray
) -> tuple[Skin, ...]:
    """The parts of a mesh with texture coordinates; the file has been read and bounded before."""
    import trimesh  # noqa: PLC0415 - as of meshes

    data = io.BytesIO(read_bytes(path, MOST_BYTES))
    scene = trimesh.load_scene(data, file_type="obj", process=False, skip_materials=True)
    skins = []
    for part in scene.geometry.values():
        where = getattr(part.visual, "uv", None)
        if where is not None and len(where) == len(part.vertices):
            vertices = scale * np.asarray(part.vertices) @ turned.T @ pose[:3, :3].T + pose[:3, 3]
            down = np.column_stack([where[:, 0], 1.0 - where[:, 1]])  # its v runs upwards
            skins.append(Skin(vertices, np.asarray(part.faces, np.int64), down, image))
    if not skins:
        raise UsageError(f"mesh {path} has no texture coordinates (vt); leave out texture")
    return tuple(skins)
