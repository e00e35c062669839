"""Extended columns: what RoboTerrain's twelve leave unsaid, from the same samples. No ROS."""
