"""Learning environments: rovers on rough terrain as Gymnasium has environments (extra [gym]).

    import gymnasium, harness.gym
    env = gymnasium.make("RoverHarness/PointNav-v0", terrain="gravel")
    envs = gymnasium.make_vec("RoverHarness/PointNav-v0", num_envs=8, terrain="gravel")

docs/gym.md has a section for each: spaces, reward, endings, options.
"""

import sys
from functools import partial
from typing import TYPE_CHECKING, Any

from harness.base.errors import UsageError
from rover_metrics.plugins import Shipped

try:
    import gymnasium
except ImportError as error:
    _MEND = "harness.gym needs Gymnasium; pip install 'rover-harness[gym]'"
    if sys.argv[:1] == ["-m"]:  # a program of this package, not loaded yet
        print(_MEND, file=sys.stderr)
        sys.exit(UsageError.exit_code)
    raise UsageError(_MEND) from error

if TYPE_CHECKING:
    from harness.gym.options import Curriculum, Randomisation
    from harness.gym.point_nav import PointNavWeights
    from harness.gym.robo_terrain import Defects

__all__ = ["ENVIRONMENTS", "Curriculum", "Defects", "PointNavWeights", "Randomisation"]

ENVIRONMENTS = Shipped[Any](
    "harness.gym",
    {
        "RoverHarness/PointNav-v0": ".point_nav:PointNavEnv",
        "RoverHarness/PointNavGoal-v0": ".goal_env:PointNavGoalEnv",
        "RoverHarness/RoboTerrain-v0": ".robo_terrain:RoboTerrainEnv",
    },
)
_VECTORS = {  # of each environment, as Gymnasium's registry calls for many at once
    "point_nav_vector": "RoverHarness/PointNav-v0",
    "point_nav_goal_vector": "RoverHarness/PointNavGoal-v0",
    "robo_terrain_vector": "RoverHarness/RoboTerrain-v0",
}
_PLACES = Shipped[object](
    "harness.gym",
    {
        "Curriculum": ".options:Curriculum",
        "Defects": ".robo_terrain:Defects",
        "PointNavWeights": ".point_nav:PointNavWeights",
        "Randomisation": ".options:Randomisation",
    },
)

# The registry has all by name: a spec whose entry points are text can be written to a file.
for _vector, _id in _VECTORS.items():
    if _id not in gymnasium.registry:
        _place = ENVIRONMENTS.places[_id]
        gymnasium.register(
            _id, entry_point=f"{__name__}{_place}", vector_entry_point=f"{__name__}:{_vector}"
        )


def __getattr__(name: str) -> object:
    if name in _VECTORS:
        from harness.gym.many import ManyRovers  # noqa: PLC0415 - which one environment does without

        return partial(ManyRovers, ENVIRONMENTS[_VECTORS[name]])
    if name not in _PLACES:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    return _PLACES[name]
