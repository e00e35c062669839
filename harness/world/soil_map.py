"""Which soil lies where: one everywhere, a map of several, or those that a terrain has of its own."""

import io
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Self
from warnings import catch_warnings

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from harness.base.documents import read_bytes, read_mapping
from harness.base.errors import UsageError, told
from harness.soil.soils import SOILS, SUFFIXES, Soil, find_soil
from harness.spec.value import Value, listed, made
from harness.world.heightfield import Heightfield
from harness.world.terrains import TERRAINS
from rover_metrics.plugins import FILE

OWN = "terrain"  # the soils that a terrain has of its own
MOST_SOILS = 16
LARGEST_MAP = 2**28  # [bytes]


@dataclass(frozen=True, eq=False)
class Soils:
    """The soils of a ground."""

    kinds: tuple[Soil, ...]  # which there are
    # which of them lies at each vertex of the ground, uint8 of shape (rows, columns)
    patches: NDArray[np.uint8]
    keeps_ruts: bool = False  # whether ruts stay when all rovers are put back

    @property
    def leaves_ruts(self) -> bool:
        """Whether any of them stays where it was pressed to."""
        return any(soil.leaves_ruts for soil in self.kinds)

    def but(self, stiffness: float, friction: float) -> Self:
        """Returns these soils with other moduli and tangents of the friction angle, by these factors."""
        return replace(self, kinds=tuple(_scaled(soil, stiffness, friction) for soil in self.kinds))


class SoilMap(Value):
    """A file that says which soil lies where."""

    soils: Annotated[tuple[str, ...], Field(min_length=1, max_length=MOST_SOILS), listed()]
    map: str = Field(
        description="PNG of grey levels or .npy: the soil's number, from 0, at each vertex, north first"
    )


def find_soils(text: str) -> tuple[tuple[Soil, ...], str]:
    """Returns the soils that a name or a file means, and their map's file or ""; else UsageError."""
    soil_map = _map_of(text)
    if soil_map is None:
        return (find_soil(text),), ""
    return tuple(map(find_soil, soil_map.soils)), soil_map.map


def soil_files(text: str) -> Iterator[Path]:
    """Yields the files that a ground's soil is of: none for a name; UsageError as `find_soils`."""
    if _is_file(text):
        yield Path(text)
        if soil_map := _map_of(text):
            yield from map(Path, (soil_map.map, *filter(_is_file, soil_map.soils)))
            yield from (Path(soil.rpartition(":")[0]) for soil in soil_map.soils if FILE in soil)


def _is_file(text: str) -> bool:
    return text not in SOILS and text.lower().endswith(SUFFIXES)


def _map_of(text: str) -> SoilMap | None:
    """What a file says that is a map, its map and its own soils found beside it; None for a soil."""
    if not _is_file(text):
        return None
    values, folder = read_mapping(Path(text)), Path(text).parent
    if not values.keys() & SoilMap.model_fields.keys():
        return None
    stated = made(SoilMap, values, where=text)
    soils = tuple(
        str(folder / soil) if FILE in soil or _is_file(soil) else soil for soil in stated.soils
    )
    return stated.model_copy(update={"soils": soils, "map": str(folder / stated.map)})


def check_soil(text: str, terrain: str) -> None:
    """Checks that a ground can be of what a text names, but for the size of a map; else UsageError."""
    if text and text != OWN:
        find_soils(text)
    own = [name for name, each in TERRAINS.items() if each.soils]
    if text == OWN and terrain not in own:
        raise UsageError(
            f"{Path(terrain).name} has no soils of its own, only {', '.join(own)}; name one with --soil"
        )


def soils_on(text: str, ground: Heightfield, terrain: str) -> Soils:
    """Returns the soils of a ground.

    Args:
        text: A name, a file, or OWN.
        ground: Each of its vertices gets one.
        terrain: Its name, or a file.

    Raises:
        UsageError: As `check_soil`, or a map is of another size.
    """
    if text == OWN:
        own = TERRAINS[terrain]
        return Soils(tuple(SOILS[name] for name in own.soils), own.patches(ground))
    kinds, path = find_soils(text)
    shape = ground.heights.shape
    return Soils(kinds, _read(Path(path), shape, len(kinds)) if path else np.zeros(shape, np.uint8))


def _read(path: Path, shape: tuple[int, ...], count: int) -> NDArray[np.uint8]:
    content = read_bytes(path, LARGEST_MAP)
    try:
        if path.suffix.lower() == ".npy":
            numbers = np.load(io.BytesIO(content), allow_pickle=False)
            has = numbers.shape
        else:
            from PIL import Image  # noqa: PLC0415 - that only pictures need

            with catch_warnings(action="ignore"), Image.open(io.BytesIO(content)) as picture:
                has, numbers = picture.size[::-1], np.empty(0)
                if has == shape:  # else it is not decoded
                    numbers = np.asarray(picture if picture.mode == "P" else picture.convert("L"))
    except Exception as error:  # decoders raise anything at all over a damaged file
        raise UsageError(f"soil map {path} cannot be read: {told(error)}") from error
    if has != shape:
        sides = " x ".join(map(str, has[::-1]))
        raise UsageError(
            f"soil map {path} has {sides} numbers, the terrain {shape[1]} x {shape[0]} vertices"
        )
    if not np.isin(numbers, np.arange(count)).all():
        raise UsageError(f"soil map {path} has other numbers than 0 to {count - 1}, those of its soils")
    return np.ascontiguousarray(np.flipud(numbers), np.uint8)  # the first row is on top


def _scaled(soil: Soil, stiffness: float, friction: float) -> Soil:
    side = soil.side_modulus
    tangent = friction * math.tan(math.radians(soil.friction_angle_deg))
    changed = {
        "k_c": stiffness * soil.k_c,
        "k_phi": stiffness * soil.k_phi,
        "side_modulus": None if side is None else stiffness * side,
        "friction_angle_deg": math.degrees(math.atan(tangent)),
    }
    return soil.model_copy(update=changed)
