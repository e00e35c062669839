"""All named terrains; `--list` shows them in this order."""

from harness.world.terrain import Terrain
from harness.world.terrains.dunes import Dunes
from harness.world.terrains.flat import Flat
from harness.world.terrains.gravel import Gravel
from harness.world.terrains.marsyard import Marsyard
from harness.world.terrains.maze import Maze
from harness.world.terrains.posts import Posts
from harness.world.terrains.rocky import Rocky
from harness.world.terrains.rolling import Rolling
from harness.world.terrains.slope import Slope
from harness.world.terrains.washboard import Washboard

TERRAINS: dict[str, type[Terrain]] = {
    terrain.name: terrain
    for terrain in (Flat, Slope, Rolling, Gravel, Rocky, Washboard, Dunes, Posts, Maze, Marsyard)
}
