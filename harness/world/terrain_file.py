"""A terrain that is a file: which, and what the file leaves open."""

import os
from dataclasses import dataclass
from pathlib import Path

from harness.base.errors import UsageError
from harness.world.solids.mesh_file import SUFFIXES as MESHES
from harness.world.solids.mesh_file import UNITS, UP
from harness.world.terrains import TERRAINS
from harness.world.world import Start

HEIGHTMAPS = (".tif", ".tiff", ".png", ".npy")
WORLDS = (".world", ".sdf")
MIDDLE: Start = (0.0, 0.0, 0.0)
SMALLEST_MAP, LARGEST_MAP = 10.0, 50_000.0  # [m] along a side
LARGEST_RELIEF = 10_000.0  # [m]
STEEPEST_START = 15.0  # [deg]
SMALLEST_CELL, LARGEST_CELL = 0.02, 10.0  # [m]


@dataclass(frozen=True, kw_only=True)
class TerrainFile:
    """A heightmap, an SDF world or a mesh, and what its file may leave open.

    Attributes:
        path: The file.
        size: Length of a heightmap along x and y [m]; None as the file says.
        relief: From its lowest to its highest point [m]; None as the file says.
        needs_start: Whether a place to start from is to be looked for.
        folders: In which models and meshes are looked for first.
        cell: Distance of the vertices that a mesh becomes [m]; None is chosen.
        mesh_unit: Name of the unit of meshes; "" as their files say. Likewise `mesh_up`, their axis.
        rock_height: Height above the ground up to which an obstacle is a rock [m]; None: `clearance`.
        rocks: Patterns of names of solids that are rocks whatever their height; likewise `hazards`.
        clearance: Of the rover [m]; likewise `step_limit`.
    """

    path: Path
    size: tuple[float, float] | None = None
    relief: float | None = None
    needs_start: bool = True
    folders: tuple[Path, ...] = ()
    cell: float | None = None
    mesh_unit: str = ""
    mesh_up: str = ""
    rock_height: float | None = None
    rocks: tuple[str, ...] = ()
    hazards: tuple[str, ...] = ()
    clearance: float = 0.1
    step_limit: float = 0.07

    @property
    def is_heightmap(self) -> bool:
        """Whether it is neither a world nor a mesh."""
        return self.path.suffix.lower() not in (*WORLDS, *MESHES)

    def check(self) -> None:
        """Checks the values by themselves.

        Raises:
            UsageError: One is not valid, or is not for a file of that kind.
        """
        self._check_kind()
        for name, given, valid in (("unit", self.mesh_unit, UNITS), ("axis", self.mesh_up, UP)):
            if given and given not in valid:
                raise UsageError(f"mesh {name} '{given}' does not exist; available: {', '.join(valid)}")
        if self.cell is not None and not SMALLEST_CELL <= self.cell <= LARGEST_CELL:
            raise UsageError(
                f"terrain cell {self.cell:g} m is not valid; give {SMALLEST_CELL:g} to {LARGEST_CELL:g}"
            )
        if self.rock_height is not None and not 0.0 <= self.rock_height <= LARGEST_RELIEF:
            raise UsageError(
                f"rock height {self.rock_height:g} m is not valid; give 0 to {LARGEST_RELIEF:g}"
            )
        for length in self.size or ():
            if not SMALLEST_MAP <= length <= LARGEST_MAP:
                raise UsageError(
                    f"terrain size {length:g} m is not valid; give {SMALLEST_MAP:g} to {LARGEST_MAP:g}"
                )
        if self.relief is not None and not 0.0 <= self.relief <= LARGEST_RELIEF:
            raise UsageError(
                f"terrain height {self.relief:g} m is not valid; give 0 to {LARGEST_RELIEF:g}"
            )

    def _check_kind(self) -> None:
        """Options of heightmaps are not for worlds and meshes, and the other way round."""
        options = {
            "--terrain-size": (self.size, True),
            "--terrain-height": (self.relief, True),
            "--resource-path": (self.folders, False),
            "--terrain-cell": (self.cell, False),
            "--mesh-unit": (self.mesh_unit, False),
            "--mesh-up": (self.mesh_up, False),
            "--rock-height": (self.rock_height, False),
            "--rock": (self.rocks, False),
            "--hazard": (self.hazards, False),
        }
        for flag, (given, is_of_heightmap) in options.items():
            if given not in (None, (), "") and is_of_heightmap != self.is_heightmap:
                kinds = "heightmaps" if is_of_heightmap else "SDF worlds and meshes"
                raise UsageError(f"{flag} is for {kinds}; leave it out with {self.path.name}")


def is_terrain_file(name: str) -> bool:
    """Returns whether the name of a terrain means a file rather than one of the named terrains."""
    if name in TERRAINS:
        return False
    return (
        os.sep in name or name.lower().endswith((*HEIGHTMAPS, *WORLDS, *MESHES)) or Path(name).exists()
    )
