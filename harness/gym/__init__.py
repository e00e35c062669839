"""Learning environments: rovers on rough terrain as Gymnasium has environments (extra [gym]).

    import gymnasium, harness.gym
    env = gymnasium.make("RoverHarness/PointNav-v0", terrain="gravel")
    envs = gymnasium.make_vec("RoverHarness/PointNav-v0", num_envs=8, terrain="gravel")

docs/gym.md has a section for each: spaces, reward, endings, options.
"""

import sys
from functools import partial

from harness.base.errors import UsageError

try:
    import gymnasium
except ImportError as error:
    _MEND = "harness.gym needs Gymnasium; pip install 'rover-harness[gym]'"
    if sys.argv[:1] == ["-m"]:  # a program of this package, which is not loaded yet to tell it
        print(_MEND, file=sys.stderr)
        sys.exit(UsageError.exit_code)
    raise UsageError(_MEND) from error

from harness.gym.goal_env import PointNavGoalEnv
from harness.gym.options import Curriculum, Randomisation
from harness.gym.point_nav import PointNavEnv, PointNavWeights
from harness.gym.processes import vector
from harness.gym.robo_terrain import Defects, RoboTerrainEnv

__all__ = ["ENVIRONMENTS", "Curriculum", "Defects", "PointNavWeights", "Randomisation"]

ENVIRONMENTS = {
    "RoverHarness/PointNav-v0": PointNavEnv,
    "RoverHarness/PointNavGoal-v0": PointNavGoalEnv,
    "RoverHarness/RoboTerrain-v0": RoboTerrainEnv,
}
# The registry has them by name: a spec whose entry points are text can be written to a file.
point_nav_vector = partial(vector, PointNavEnv)
point_nav_goal_vector = partial(vector, PointNavGoalEnv)
robo_terrain_vector = partial(vector, RoboTerrainEnv)
_VECTORS = ("point_nav_vector", "point_nav_goal_vector", "robo_terrain_vector")

for (_id, _class), _vector in zip(ENVIRONMENTS.items(), _VECTORS, strict=True):
    if _id not in gymnasium.registry:
        gymnasium.register(
            _id,
            entry_point=f"{_class.__module__}:{_class.__name__}",
            vector_entry_point=f"harness.gym:{_vector}",
        )
