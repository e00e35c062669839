"""The world of a run: a terrain or a file, who walks there, and what is to be found there."""

from operator import not_
from typing import Annotated, Literal, get_args

from pydantic import BeforeValidator, Field

from harness.spec.actor import ActorOptions, ActorText
from harness.spec.target import FORM, KINDS, MESH, TargetText
from harness.spec.value import Latitude, Longitude, Option, Share, Value, as_tuple, listed, numbers

DEFAULT_DIFFICULTY = 0.5
# Mars Desert Research Station, Utah, where rovers of universities compete.
DEFAULT_DATUM = (38.4064, -110.7919, 1382.0)  # [deg], [deg], [m]
Altitude = Annotated[float, Field(ge=-500.0, le=9000.0)]  # [m]: of what rovers drive on

SMALLEST_MAP, LARGEST_MAP = 10.0, 50_000.0  # [m] along a side
LARGEST_RELIEF = 10_000.0  # [m]
GRAVITY = 0.01, 100.0  # [m/s^2] on which rovers drive
MESH_UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "ft": 0.3048, "in": 0.0254}  # length [m]
MESH_AXES = ("z", "y", "x")

Roughness = Literal["", "A", "B", "C", "D", "E", "F", "G", "H"]  # classes of ISO 8608
ROUGHNESS: tuple[str, ...] = get_args(Roughness)[1:]
MapLength = Annotated[float, Field(ge=SMALLEST_MAP, le=LARGEST_MAP)]  # [m]
Relief = Annotated[float, Field(ge=0.0, le=LARGEST_RELIEF)]  # [m]
Cell = Annotated[float, Field(ge=0.02, le=10.0)]  # [m]
Texts = Annotated[tuple[str, ...], listed()]


def _both_lengths(value: object) -> object:
    """One length is that of both sides."""
    if isinstance(value, str | float | int):
        return (value, value)
    sides = as_tuple(value)
    return (*sides, *sides) if isinstance(sides, tuple) and len(sides) == 1 else sides


class WorldSpec(Value):
    """What determines a world, beside the seed of the run.

    What is left out of a terrain from a file is as the file says.
    """

    terrain: Annotated[str, Option("NAME|FILE")] = Field(
        default="rocky",
        description="see --list; a heightmap: GeoTIFF, TIFF, PNG, .npy, .asc; points: .ply, .las, .laz, "
        "N x 3 .npy; an SDF world: .world, .sdf; a mesh: .dae, .obj, .stl, .ply (docs/worlds.md)",
    )
    difficulty: Annotated[Share, Option("D")] = Field(
        default=DEFAULT_DIFFICULTY, description="0 to 1, of a named terrain"
    )
    soil: Annotated[str, Option("NAME|FILE")] = Field(
        default="",
        description="ground that gives way (docs/soil.md): see --list, a YAML file of a soil or of a "
        "map of soils, or `terrain` for what the terrain has (dunes); default: rigid ground",
    )
    keep_ruts: Annotated[bool, Option("")] = Field(
        default=False,
        description="of --soil: leave ruts as they are when all rovers are put back to their starts; "
        "default: they go",
    )
    terrain_size: Annotated[
        tuple[MapLength, MapLength] | None, BeforeValidator(_both_lengths), Option("M", many=True)
    ] = Field(
        default=None,
        description="length along x and y, or of both, of a heightmap that does not say [m]",
    )
    terrain_height: Annotated[Relief | None, Option("M")] = Field(
        default=None, description="relief, lowest to highest point, of a heightmap that does not say [m]"
    )
    terrain_cell: Annotated[Cell | None, Option("M")] = Field(
        default=None,
        description="distance of the heights that a mesh becomes (default: 0.1), or a cloud of points "
        "(default: as its density allows) [m]",
    )
    terrain_roughness: Annotated[Roughness, Option("CLASS")] = Field(
        default="",
        exclude_if=not_,  # older than it are manifests
        description="detail that a heightmap's cells are too coarse for, by the seed, as rough as a "
        f"class of ISO 8608: {', '.join(ROUGHNESS)} (docs/worlds.md); default: none",
    )
    resource_path: Annotated[Texts, Option("DIR")] = Field(
        default=(), description="folder of an SDF world's models; repeatable; default: none"
    )
    mesh_unit: Annotated[str, Option("NAME")] = Field(
        default="", description=f"unit of meshes: {', '.join(MESH_UNITS)}; default: as their files say"
    )
    mesh_up: Annotated[str, Option("AXIS")] = Field(
        default="",
        description=f"axis of meshes that is up: {', '.join(MESH_AXES)}; default: as a lone file says, "
        "z in worlds",
    )
    rock_height: Annotated[Relief | None, Option("M")] = Field(
        default=None,
        description="obstacles of files up to it are rocks [m]; default: the rover's clearance",
    )
    rock: Annotated[Texts, Option("PATTERN")] = Field(
        default=(), description="models that are rocks; repeatable; default: by height"
    )
    hazard: Annotated[Texts, Option("PATTERN")] = Field(
        default=(), description="models that are hazards; repeatable; default: by height"
    )
    actors: Annotated[tuple[ActorText, ...], listed(), Option("SPEC", flag="actor")] = Field(
        default=(),
        description="a person who walks; repeatable: NAME=X,Y/X,Y/... (way points), [NAME=]FILE.sdf (a "
        "trajectory, or actors of a world), NAME=random or NAME=social; behind it :KEY=VALUE,... of "
        f"{', '.join(ActorOptions.model_fields)} (docs/worlds.md); default: nobody",
    )
    targets: Annotated[tuple[TargetText, ...], listed(), Option("SPEC", flag="target")] = Field(
        default=(),
        description=f"something to be found; repeatable: {FORM}; kinds: "
        f"{', '.join(kind for kind in KINDS if kind != MESH)}, or a FILE{MESH} (docs/missions.md); "
        "default: nothing",
    )
    datum: Annotated[
        tuple[Latitude, Longitude, Altitude],
        numbers("LAT,LON or LAT,LON,ALT in degrees and metres", 3, rest=0.0),
        Option("LAT,LON[,ALT]"),
    ] = Field(
        default=DEFAULT_DATUM,
        description="where the world's origin is, for GNSS and its like: degrees and metres; "
        "default: " + ",".join(f"{value:.7g}" for value in DEFAULT_DATUM),
    )


HEIGHTMAPS, SOLIDS = "heightmaps", "SDF worlds and meshes"
FILE_FIELDS = {  # for terrains from files alone, and for which kind of file
    "terrain_size": HEIGHTMAPS,
    "terrain_height": HEIGHTMAPS,
    "terrain_cell": SOLIDS,
    "terrain_roughness": HEIGHTMAPS,
    "resource_path": SOLIDS,
    "mesh_unit": SOLIDS,
    "mesh_up": SOLIDS,
    "rock_height": SOLIDS,
    "rock": SOLIDS,
    "hazard": SOLIDS,
}
