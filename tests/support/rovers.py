"""The project's two rovers, as tests name them."""

from harness.robots import find_rover

LEO, ROVER_ZERO4WD = find_rover("leo"), find_rover("rover_zero4wd")
