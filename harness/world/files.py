"""Worlds from files: which names are files, which options a kind of file takes, and the world of one."""

import os
from pathlib import Path

from harness.base.collada import UP
from harness.base.errors import UsageError, find_named
from harness.base.mesh_file import SUFFIXES as MESHES
from harness.base.mesh_file import is_mesh
from harness.spec.world import DEFAULT_DIFFICULTY, FILE_FIELDS, HEIGHTMAPS, MESH_UNITS, SOLIDS, WorldSpec
from harness.world.heightmap.cloud import SUFFIXES as CLOUDS
from harness.world.heightmap.cloud import is_cloud
from harness.world.terrains import TERRAINS
from harness.world.world import RoverNeeds, World

RASTERS = (".tif", ".tiff", ".png", ".npy", ".asc", *CLOUDS)
WORLDS = (".world", ".sdf")


def is_terrain_file(name: str) -> bool:
    """Returns whether the name of a terrain means a file rather than one of the named terrains."""
    if name in TERRAINS:
        return False
    return os.sep in name or name.lower().endswith((*RASTERS, *WORLDS, *MESHES)) or Path(name).exists()


def is_heightmap(file: str) -> bool:
    """Returns whether a file is neither an SDF world nor a mesh."""
    path = Path(file)
    return path.suffix.lower() not in WORLDS and not is_mesh(path)


def files_beside(file: str) -> list[Path]:
    """Returns the files from which sizes and units of a heightmap are read too, where they are there."""
    from harness.world.heightmap.geotiff import WORLD_FILES  # noqa: PLC0415 - as in `file_world`

    path = Path(file)
    beside = [path.with_suffix(suffix) for suffix in (*WORLD_FILES, ".prj")]
    return [*beside, path.with_name(f"{path.name}.aux.xml")] if is_heightmap(file) else []


def check_terrain(spec: WorldSpec) -> None:
    """Checks that a terrain exists or is a file, and all options are for its kind; else UsageError."""
    if is_terrain_file(spec.terrain):
        kind = HEIGHTMAPS if is_heightmap(spec.terrain) else SOLIDS
        if spec.difficulty != DEFAULT_DIFFICULTY:
            raise UsageError("a terrain from a file has no difficulty; leave out --difficulty")
    else:
        kind = find_named("terrain", spec.terrain, TERRAINS).name
    for name, valid in FILE_FIELDS.items():
        if name == "terrain_cell" and kind == HEIGHTMAPS and is_cloud(Path(spec.terrain)):
            continue
        if kind != valid and getattr(spec, name) not in (None, (), ""):
            flag, terrain = name.replace("_", "-"), Path(spec.terrain).name
            raise UsageError(f"--{flag} applies to {valid} only; leave it out with {terrain}")
    if spec.mesh_unit:
        find_named("mesh unit", spec.mesh_unit, MESH_UNITS)
    if spec.mesh_up:
        find_named("mesh axis", spec.mesh_up, UP)


def file_world(spec: WorldSpec, rover: RoverNeeds, seed: int) -> World:
    """Makes the world of a file; UsageError if it is unreadable, incomplete or nowhere fit to stand on.

    Args:
        spec: Names the file and says what it leaves open.
        rover: What the rover needs of it.
        seed: Of the world, which has no randomness of its own.
    """
    # Imported here, since named terrains save the libraries of either.
    if is_heightmap(spec.terrain):
        from harness.world.heightmap.dem import heightmap_world  # noqa: PLC0415

        return heightmap_world(spec, seed, rover)
    from harness.world.solids.assembly import solid_world  # noqa: PLC0415

    return solid_world(spec, rover, seed)
