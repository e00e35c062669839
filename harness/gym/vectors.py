"""Many environments at once, as Gymnasium's registry calls for them."""

from functools import partial

from harness.gym.goal_env import PointNavGoalEnv
from harness.gym.point_nav import PointNavEnv
from harness.gym.processes import vector
from harness.gym.robo_terrain import RoboTerrainEnv

point_nav_vector = partial(vector, PointNavEnv)
point_nav_goal_vector = partial(vector, PointNavGoalEnv)
robo_terrain_vector = partial(vector, RoboTerrainEnv)
