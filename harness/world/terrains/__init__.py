"""All named terrains; `--list` shows them in this order."""

from harness.world.terrain import Terrain
from harness.world.terrains.ground import Dunes, Flat, Gravel, Rolling, Slope, Washboard
from harness.world.terrains.marsyard import Marsyard
from harness.world.terrains.maze import Maze
from harness.world.terrains.posts import Posts
from harness.world.terrains.rocky import Rocky
from rover_metrics.plugins import Table

SHIPPED = (Flat, Slope, Rolling, Gravel, Rocky, Washboard, Dunes, Posts, Maze, Marsyard)
TERRAINS = Table[type[Terrain]](
    "terrains",
    {terrain.name: terrain for terrain in SHIPPED},
    lambda value: isinstance(value, type) and issubclass(value, Terrain) and isinstance(value.name, str),
    "a subclass of harness.world.terrain.Terrain with a name",
)
WITH_HAZARDS = tuple(name for name, terrain in TERRAINS.shipped.items() if terrain.has_hazards)
