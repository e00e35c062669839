"""All named terrains; `--list` shows them in this order."""

from harness.world.terrain import Terrain
from harness.world.terrains.ground import Dunes, Flat, Gravel, Rolling, Slope, Washboard
from harness.world.terrains.marsyard import Marsyard
from harness.world.terrains.maze import Maze
from harness.world.terrains.posts import Posts
from harness.world.terrains.rocky import Rocky

TERRAINS: dict[str, type[Terrain]] = {
    terrain.name: terrain
    for terrain in (Flat, Slope, Rolling, Gravel, Rocky, Washboard, Dunes, Posts, Maze, Marsyard)
}
WITH_HAZARDS = tuple(name for name, terrain in TERRAINS.items() if terrain.has_hazards)
