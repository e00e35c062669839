"""OMPL plans on /map what the simulator's own obstacles leave free."""

import math
from pathlib import Path

import numpy as np
import pytest

from harness.episode.assembly import world_of
from harness.spec.run import Run as RunValue
from harness.world.obstacles import ObstacleKind
from tests.clients.conftest import Run, recorded

START, GOAL = (0.0, 0.0), (-6.0, 6.0)  # [m]


def test_a_path_that_ompl_finds_on_the_map_meets_no_obstacle(run: Run, tmp_path: Path) -> None:
    base = pytest.importorskip("ompl.base", reason="needs ompl: make test-clients")
    geometric = pytest.importorskip("ompl.geometric")
    pytest.importorskip("ompl.util").RNG.setSeed(1)
    path = tmp_path / "run.mcap"
    run("--direct", "--terrain", "posts", "--duration", "1", "--record", str(path))
    ((_, _, grid),) = recorded(path, "/map")
    cells = np.asarray(grid.data).reshape(grid.info.height, grid.info.width)
    corner, cell = grid.info.origin.position, grid.info.resolution

    def is_free(x: float, y: float) -> bool:
        column, row = int((x - corner.x) // cell), int((y - corner.y) // cell)
        return 0 <= row < len(cells) and 0 <= column < cells.shape[1] and bool(cells[row, column] == 0)

    space, bounds = base.RealVectorStateSpace(2), base.RealVectorBounds(2)
    bounds.setLow(-9.0)
    bounds.setHigh(9.0)
    space.setBounds(bounds)
    setup = geometric.SimpleSetup(space)
    setup.setStateValidityChecker(lambda state: is_free(state[0], state[1]))
    ends = [space.allocState() for _ in range(2)]
    for state, place in zip(ends, (START, GOAL), strict=True):
        state[0], state[1] = place
    setup.setStartAndGoalStates(*ends)
    setup.setPlanner(geometric.RRTConnect(setup.getSpaceInformation()))
    # Until it is there: a limit of time would make the path depend on the machine.
    found_one = base.exactSolnPlannerTerminationCondition(setup.getProblemDefinition())
    assert setup.solve(found_one)
    found = setup.getSolutionPath()
    found.interpolate(200)
    places = [(state[0], state[1]) for state in found.getStates()]
    assert math.dist(places[0], START) < 0.01
    assert math.dist(places[-1], GOAL) < 0.01
    hazards = [
        o for o in world_of(RunValue.of(terrain="posts")).obstacles if o.kind is ObstacleKind.HAZARD
    ]
    assert hazards
    for hazard in hazards:
        gap = min(math.dist(place, hazard.position[:2]) for place in places)
        assert gap > min(hazard.half_size[:2])
