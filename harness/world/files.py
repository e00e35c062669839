"""The door to worlds from files: heightmaps, SDF worlds, meshes."""

from harness.world.heightmap.dem import heightmap_world
from harness.world.terrain_file import TerrainFile
from harness.world.world import World


def file_world(file: TerrainFile, seed: int) -> World:
    """Makes a world from a file of any kind.

    Raises:
        UsageError: It is not readable, incomplete, or nowhere fit to stand on.
    """
    if file.is_heightmap:
        return heightmap_world(file, seed)
    from harness.world.sdf.world_file import solid_world  # noqa: PLC0415 - other worlds save its libraries

    return solid_world(file, seed)
