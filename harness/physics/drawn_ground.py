"""The ground of a scene on soil that is only drawn: fine near a place, in the terrain's cells elsewhere.

OpenGL takes seconds to take over and to draw the finer ground of a whole map. So the terrain is drawn as
if it were rigid, but for a window around the place: there its vertices lie below, and a second
heightfield of fine cells covers them, ABOVE what else would be the same surface along the window's edge.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.physics.berths import Member
from harness.physics.scene import Dress, Scene, build_scenes
from harness.physics.stage import SOIL_TILE
from harness.physics.world_geoms import (
    BASE_THICKNESS,
    SOIL_ROOM,
    TERRAIN,
    UNTOUCHED,
    VISUAL_GROUP,
    heights_of,
    soil_ground,
)
from harness.world.heightfield import Field
from harness.world.world import World

RUTS, GROUND = "ruts", "ground"
ABOVE = 1e-3  # [m]
NEAR = 4.0  # [m] from the middle of the window to a side, or a little more

Patch = tuple[int, int, np.ndarray]  # first row and column, heights [m]


class DrawnGround:
    """Draws the ruts near a place.

    Args:
        world: Of any ground; one that keeps no ruts is drawn as rigid ground is.
        reach: From the place in which they are drawn [m], a little more at times; math.inf: everywhere.

    Attributes:
        leaves_ruts: Whether there can be any.
        heights: Of the ground with its ruts in fine cells [m], shape (rows, columns); to be changed by
            who knows the ruts.
        cell: Distance of two of them [m].
        corner: x, y of the first one [m].
    """

    def __init__(self, world: World, reach: float = NEAR) -> None:
        ground, fine = world.ground, soil_ground(world)
        self.leaves_ruts = world.soil is not None and world.soil.leaves_ruts
        self._world, self._fresh, self.heights = world, fine.heights, fine.heights.copy()
        left, _, low, _ = fine.bounds()
        self.cell, self.corner = fine.cell, np.array([left, low])
        self._parts = round(ground.cell / fine.cell)
        # The window moves by whole tiles of the ground's texture, which so goes on in it.
        self._tile = max(round(SOIL_TILE / ground.cell), 1)
        self._cells = np.array(ground.heights.shape) - 1
        half = np.ceil(reach / ground.cell / self._tile) * self._tile
        self._span = (2 * np.minimum(half, self._cells // 2) + self._cells % 2).astype(int)
        self._base = float(fine.heights.min()) - SOIL_ROOM
        self._relief = float(np.ptp(fine.heights)) + 2.0 * SOIL_ROOM
        self._patch, self._window = (slice(0), slice(0)), (slice(0), slice(0))

    def scenes(self, fleet: Sequence[Member], timestep: float, dress: Dress) -> tuple[Scene, ...]:
        """Returns the scenes of rovers in the world, with no ruts yet.

        Args:
            fleet: The rovers.
            timestep: Of the physics [s].
            dress: Adds what is only to be seen.
        """

        def dressed(spec: mujoco.MjSpec) -> None:
            dress(spec)
            if self.leaves_ruts:
                self._add(spec)

        scenes = build_scenes(replace(self._world, soil=None), fleet, timestep, dressed)
        self._model = model = scenes[0].model
        if not self.leaves_ruts:
            return scenes
        terrain, self._geom = (model.geom(name).id for name in (TERRAIN, RUTS))
        self._terrain, self._ruts = (int(model.geom_dataid[geom]) for geom in (terrain, self._geom))
        model.geom_pos[terrain, 2], model.hfield_size[self._terrain, 2] = self._base, self._relief
        self._shown, self._drawn = heights_of(model, terrain), heights_of(model, self._geom)
        self._shown[:] = self._shares(self._world.ground.heights)
        return scenes

    def smooth(self) -> None:
        """Takes all ruts out."""
        self.heights[:] = self._fresh

    def take(self, patch: Patch) -> None:
        """Takes heights from a row and a column on, and none elsewhere."""
        row, column, heights = patch
        self.heights[self._patch] = self._fresh[self._patch]
        self._patch = slice(row, row + heights.shape[0]), slice(column, column + heights.shape[1])
        self.heights[self._patch] = heights

    def show(self, x: float, y: float, upload: Callable[[int], object]) -> None:
        """Shows the ruts near a place.

        Args:
            x: In the world [m].
            y: In the world [m].
            upload: Called with the number of each heightfield that changes.
        """
        if not self.leaves_ruts:
            return
        off = (np.array([y, x]) - self.corner[::-1]) / (self.cell * self._parts) - 0.5 * self._cells
        free = (self._cells - self._span) // 2
        tiles = np.clip(np.round(off / self._tile), -(free // self._tile), free // self._tile)
        first = free + self._tile * tiles.astype(int)
        window = _slices(first * self._parts, self._span * self._parts + 1)
        if window != self._window:
            self._window = window
            middle = self.corner[::-1] + self.cell * self._parts * (first + 0.5 * self._span)
            self._model.geom_pos[self._geom, :2] = middle[::-1]
            terrain = self._shown
            covered = _slices(first + 1, self._span - 1)
            kept, terrain[covered] = terrain[covered].copy(), 0.0
            upload(self._terrain)
            terrain[covered] = kept  # for rays
        ruts = self.heights[window] - self._fresh[window]
        # Softened: a cell is shaded as a whole, so that a wall would be a row of teeth.
        for across in (ruts, ruts.T):
            across[1:-1] = 0.25 * across[:-2] + 0.5 * across[1:-1] + 0.25 * across[2:]
            across[[0, -1]] = 0.0  # along the edge there are none
        self._drawn[:] = self._shares(self._fresh[window] + ruts)
        upload(self._ruts)

    def _add(self, spec: mujoco.MjSpec) -> None:
        ground, tile = self._world.ground, self._tile * self._world.ground.cell
        rows, columns = self._span
        half_y, half_x = 0.5 * ground.cell * self._span
        spec.add_hfield(
            name=RUTS,
            size=[half_x, half_y, self._relief, BASE_THICKNESS],
            nrow=rows * self._parts + 1,
            ncol=columns * self._parts + 1,
            userdata=[0.0] * ((rows * self._parts + 1) * (columns * self._parts + 1)),
        )
        spec.material(GROUND).texrepeat = [2.0 * half / tile for half in ground.half_size]
        material = spec.add_material(name=RUTS, specular=0.0, reflectance=0.0)
        material.texrepeat = [2.0 * half_x / tile, 2.0 * half_y / tile]
        material.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = GROUND
        spec.worldbody.add_geom(
            name=RUTS,
            type=mujoco.mjtGeom.mjGEOM_HFIELD,
            hfieldname=RUTS,
            material=RUTS,
            pos=[1.0, 0.0, self._base + ABOVE],
            group=VISUAL_GROUP,
            **UNTOUCHED,
        )

    def _shares(self, heights: Field) -> Field:
        return (heights - self._base) / self._relief


def _slices(first: NDArray[np.int64], count: NDArray[np.int64]) -> tuple[slice, slice]:
    (row, column), (rows, columns) = first.tolist(), count.tolist()
    return slice(row, row + rows), slice(column, column + columns)
